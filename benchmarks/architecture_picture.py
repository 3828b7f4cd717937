"""The picture of the packages: `python -m benchmarks.architecture_picture docs/pictures/architecture.svg`.

Names, their order and what each is for are read from the code; a line below says what a package imports from.
"""

from __future__ import annotations

import ast
import sys
from pathlib import Path
from xml.sax.saxutils import escape

from tests.test_imports import KNOWN, ORDER, imported

LANES = (
    (
        "the path of a question",
        ["drawing", "assembly", "geometry", "freespace", "program", "solve", "search", "maximise"],
    ),
    ("other questions", ["bound", "compare", "tight", "separate", "sensitivity", "live", "mating", "spatial"]),
    ("what people and programs get", ["questions", "schema", "report", "audit", "verify", "bench", "app", "cli"]),
)
EVERYWHERE = ("errors", "deadline", "provenance", "files", "verdict")  # not drawn: anyone may import them
WIDTH, HEIGHT, GAP, LEFT = 176.0, 104.0, 14.0, 24.0


def summary(name: str) -> str:
    """First sentence of a package or module."""
    said = ast.get_docstring(ast.parse(KNOWN[f"wiggleroom.{name}"].read_text(encoding="utf-8"))) or ""
    return said.split("\n", 1)[0].split(": ", 1)[0].rstrip(".")


def imports_of(name: str) -> list[str]:
    """Packages that one imports from, in order."""
    own = [module for module in KNOWN if module.split(".")[1:2] == [name]]
    found = {one.split(".")[1] for module in own for one in imported(module, KNOWN[module], KNOWN) if "." in one}
    return [one for one in ORDER if one in found - {name, *EVERYWHERE}]


def wrapped(text: str, width: int, most: int) -> list[str]:
    """Lines of at most so many characters."""
    lines = [""]
    for word in text.split():
        if len(lines[-1]) + len(word) + 1 > width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return lines if len(lines) <= most else [*lines[: most - 1], lines[most - 1] + " …"]


def box(name: str, x: float, y: float) -> list[str]:
    """One package."""
    out = [f'<rect x="{x}" y="{y}" width="{WIDTH}" height="{HEIGHT}" rx="8" fill="#f6f8fa" stroke="#1f5f99"/>']
    out.append(f'<text x="{x + 12}" y="{y + 22}" font-size="15" font-weight="600" fill="#1f2933">{name}</text>')
    for k, line in enumerate(wrapped(summary(name), 26, 3)):
        out.append(f'<text x="{x + 12}" y="{y + 41 + 14 * k}" font-size="11" fill="#1f2933">{escape(line)}</text>')
    uses = wrapped(", ".join(imports_of(name)), 30, 2)
    for k, line in enumerate(uses):
        out.append(f'<text x="{x + 12}" y="{y + 84 + 12 * k}" font-size="9.5" fill="#66727f">{escape(line)}</text>')
    return out


def picture() -> str:
    """The whole picture as SVG."""
    most = max(len(names) for _, names in LANES)
    width, height = 2 * LEFT + most * (WIDTH + GAP) - GAP, 40 + len(LANES) * (HEIGHT + 56)
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" width="{width:g}" height="{height:g}" '
        "font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\">",
        f'<rect width="{width:g}" height="{height:g}" fill="#ffffff"/>',
    ]
    for row, (title, names) in enumerate(LANES):
        y = 44 + row * (HEIGHT + 56)
        out.append(f'<text x="{LEFT}" y="{y - 12}" font-size="13" fill="#66727f">{title}</text>')
        for k, name in enumerate(names):
            x = LEFT + k * (WIDTH + GAP)
            out += box(name, x, y)
            if row == 0 and k:
                out.append(
                    f'<path d="M{x - GAP},{y + 20}h{GAP - 5}l-4,-4m4,4l-4,4" fill="none" stroke="#1f5f99" stroke-width="1.6"/>'
                )
    return "\n".join([*out, "</svg>", ""])


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(picture(), encoding="utf-8")
