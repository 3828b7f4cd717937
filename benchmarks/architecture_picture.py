"""The picture of the packages: `python -m benchmarks.architecture_picture docs/pictures/architecture.svg`.

What each package is for is read from its first line; the small lines below name all that it imports from.
"""

from __future__ import annotations

import ast
import sys
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape

from tests.test_imports import KNOWN, ORDER, imported

LANES = (
    (
        "the path of a question",
        ["drawing", "assembly", "geometry", "freespace", "program", "solve", "search", "flex_walls", "maximise"],
    ),
    (
        "other questions",
        ["bound", "form_closure", "disassembly", "planning", "sensitivity", "live", "mating", "spatial"],
    ),
    ("what people and programs get", ["questions", "schema", "report", "studies", "app", "cli"]),
    ("judges, which share nothing with what they judge, and comparisons", ["audit", "verify", "compare", "bench"]),
)
EVERYWHERE = (
    "errors",
    "deadline",
    "context",
    "provenance",
    "files",
    "displayable",
    "verdict",
    "compiled",
    "parallel",
)  # not drawn: anyone may import them
WIDTH, GAP, LEFT = 176.0, 14.0, 24.0


def summary(name: str) -> str:
    """First sentence of a package or module."""
    said = ast.get_docstring(ast.parse(KNOWN[f"wiggleroom.{name}"].read_text(encoding="utf-8"))) or ""
    return said.split("\n", 1)[0].split("; ", 1)[0].split(": ", 1)[0].rstrip(".")


def imports_of(name: str) -> list[str]:
    """Packages that one imports from, in order."""
    own = [module for module in KNOWN if module.split(".")[1:2] == [name]]
    found = {one.split(".")[1] for module in own for one in imported(module, KNOWN[module], KNOWN) if "." in one}
    return [one for one in ORDER if one in found - {name, *EVERYWHERE}]


def wrapped(text: str, width: int) -> list[str]:
    """Lines of at most so many characters."""
    lines = [""]
    for word in text.split():
        if len(lines[-1]) + len(word) + 1 > width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return lines


@dataclass(frozen=True)
class Box:
    """One package: its name, what it is for, what it imports from."""

    name: str
    said: list[str]
    uses: list[str]

    @property
    def height(self) -> float:
        """What its text needs."""
        return 44.0 + 14 * len(self.said) + 12 * len(self.uses)

    def drawn(self, x: float, y: float, height: float) -> list[str]:
        """The box at a place, as high as the others beside it."""
        out = [
            f'<rect x="{x:g}" y="{y:g}" width="{WIDTH:g}" height="{height:g}" rx="8" fill="#f6f8fa" stroke="#1f5f99"/>'
        ]
        out.append(text(x + 12, y + 22, 15, "#1f2933", self.name, ' font-weight="600"'))
        out += [text(x + 12, y + 41 + 14 * k, 11, "#1f2933", line) for k, line in enumerate(self.said)]
        below = y + height - 10 - 12 * (len(self.uses) - 1)
        return [*out, *(text(x + 12, below + 12 * k, 9.5, "#66727f", line) for k, line in enumerate(self.uses))]


def text(x: float, y: float, size: float, colour: str, line: str, style: str = "") -> str:
    """One line of text."""
    return f'<text x="{x:g}" y="{y:g}" font-size="{size:g}"{style} fill="{colour}">{escape(line)}</text>'


def picture() -> str:
    """The whole picture as SVG."""
    lanes = [
        [Box(name, wrapped(summary(name), 26), wrapped(", ".join(imports_of(name)), 30)) for name in names]
        for _, names in LANES
    ]
    width, y, out = 2 * LEFT + max(map(len, lanes)) * (WIDTH + GAP) - GAP, 44.0, []
    for row, (boxes, (title, _)) in enumerate(zip(lanes, LANES, strict=True)):
        out.append(text(LEFT, y - 12, 13, "#66727f", title))
        height = max(box.height for box in boxes)
        for k, box in enumerate(boxes):
            x = LEFT + k * (WIDTH + GAP)
            out += box.drawn(x, y, height)
            if row == 0 and k:
                out.append(
                    f'<path d="M{x - GAP:g},{y + 20:g}h{GAP - 5:g}l-4,-4m4,4l-4,4" fill="none" stroke="#1f5f99" stroke-width="1.6"/>'
                )
        y += height + 44
    size = f'viewBox="0 0 {width:g} {y - 20:g}" width="{width:g}" height="{y - 20:g}"'
    font = "font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\""
    paper = f'<rect width="{width:g}" height="{y - 20:g}" fill="#ffffff"/>'
    return "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" {size} {font}>', paper, *out, "</svg>", ""])


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(picture(), encoding="utf-8")
