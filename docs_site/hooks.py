"""What the site has beyond docs/: files that stand elsewhere in the repository, the reference, and live pages in the gallery."""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

from docs_site.live_pages import PICTURE
from wiggleroom.schema.generate import tables

TOP = Path(__file__).parents[1]
LIVE = TOP / "out" / "live"
"""Live pages of the gallery, by the names of their pictures: `python -m docs_site.live_pages` makes them."""
ELSEWHERE = {
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
    "extras/inkscape/README.md": "extras-inkscape.md",
    "extras/freecad/README.md": "extras-freecad.md",
    "examples/drawings/SOURCES.md": "drawings-sources.md",
    "benchmarks/results/measurements.md": "measurements.md",
    "benchmarks/results/public_drawings.md": "public-drawings.md",
    "benchmarks/results/sheets.md": "measured-sheets.md",
}
"""Pages that stand outside docs/, and their places in the site."""
TYPED = ("json.md", "page-protocol.md")
"""Pages whose tables are generated; the types in them hold brackets, which are no links."""
LINK = re.compile(r"(?<=\]\()([^)\s#:]+)(#[^)\s]*)?(?=\))")


def on_files(files: Files, config: Any) -> Files:
    """Add what stands elsewhere."""
    for source, place in ELSEWHERE.items():
        text = (TOP / source).read_text(encoding="utf-8")
        files.append(File.generated(config, place, content=with_links(text, source)))
    files.append(File.generated(config, "reference.md", content=reference()))
    files.append(File.generated(config, "schema/README.md", content=schemas()))
    worker = Path(__file__).with_name("iframe-worker.js")
    files.append(File.generated(config, f"assets/{worker.name}", abs_src_path=str(worker)))
    for page in sorted(LIVE.glob("*.html")):
        files.append(File.generated(config, f"live/{page.name}", abs_src_path=str(page)))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Files) -> str:  # noqa: ARG001
    """Make links between files of the repository links of the site; in the gallery show live pages."""
    source = page.file.src_uri
    if page.file.generated_by is not None:
        return markdown
    if source in TYPED:
        markdown = re.sub(
            r"^\| `.*$",
            lambda m: m[0].replace("[", "&#91;").replace("]", "&#93;"),
            tables(markdown),
            flags=re.MULTILINE,
        )
    if source == "gallery.md":
        markdown = PICTURE.sub(live, markdown)
    return with_links(markdown, f"docs/{source}")


def with_links(text: str, source: str) -> str:
    """Text of a file of the repository, its links turned to where their files are in the site."""
    return LINK.sub(lambda m: place_of(m[1], source) + (m[2] or ""), text)


def place_of(link: str, source: str) -> str:
    """Where a link of a file leads in the site; files that the site does not have keep their links, and the build says so."""
    target = posixpath.normpath(posixpath.join(posixpath.dirname(source), link))
    if target in ELSEWHERE:
        return ELSEWHERE[target]
    if target == "docs/schema":
        return "schema/README.md"
    if target.startswith("docs/"):
        return target.removeprefix("docs/")
    return link


def live(found: re.Match[str]) -> str:
    """A picture of the gallery, and behind it its live page where there is one."""
    name = found[1].split(".")[0]
    if not (LIVE / f"{name}.html").exists():
        return found[0]
    return (
        f'{found[0]}\n\n<details class="live"><summary>Use it here</summary>\n'
        f'<iframe src="live/{name}.html" title="{name}, live" loading="lazy" sandbox="allow-scripts allow-downloads" '
        f'style="width:100%;height:560px;border:1px solid #8884"></iframe>\n<p><a href="live/{name}.html">alone</a></p></details>'
    )


GROUPS = {
    "Ask": (
        "read",
        "assemble",
        "flex",
        "check",
        "prove",
        "prepare",
        "free_space",
        "largest_gap",
        "tight_verdict",
        "blocking",
    ),
    "Study": ("rank", "tighten", "sweep", "sample", "allowable_gap", "clearances", "worst_case", "read_tolerances"),
    "Show and make": ("film", "patterns", "coupon"),
    "Goals": ("Pull", "Turn", "W", "Towards", "Translation", "Closer"),
    "Errors": ("WiggleroomError", "InputError", "MissingExtraError", "StoppedError", "TouchingError"),
}


def reference() -> str:
    """The reference: every public name once, by what it is for; its text is its docstring."""
    import wiggleroom

    grouped = {name for names in GROUPS.values() for name in names}
    rest = tuple(sorted(set(wiggleroom.__all__) - grouped))
    wrong = grouped - set(wiggleroom.__all__)
    if wrong:
        message = f"docs_site/hooks.py: these are not public: {', '.join(sorted(wrong))}"
        raise ValueError(message)
    text = [
        "# Reference\n\nEverything that `import wiggleroom as wr` has, from the docstrings. "
        "[Python](python.md) shows how it goes together.\n"
    ]
    for title, names in {**GROUPS, "What is asked and answered": rest}.items():
        text.append(f"## {title}\n")
        text += [f"::: {home(name)}\n" for name in names]
    return "\n".join(text)


def schemas() -> str:
    """The folder of JSON schemas as a page."""
    names = sorted(path.name for path in (TOP / "docs" / "schema").glob("*.json"))
    return "# JSON schemas\n\n" + "".join(f"- [{name}]({name})\n" for name in names)


def home(name: str) -> str:
    """Full name of a public name."""
    import wiggleroom

    where = f"wiggleroom.{wiggleroom._HOME[name]}"
    return f"{where}.{name}"
