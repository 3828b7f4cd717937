"""Whatever is found in a notebook: IPython's own formatter, a notebook that is run, and the frame in a real browser."""

from __future__ import annotations

import dataclasses
import re
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

import wiggleroom as wr
from tests.standalone import told
from wiggleroom.displayable import Displayable

EXAMPLES = Path(__file__).parents[1] / "examples"
CHAIN = wr.patterns.chain(3, joint="tee", gap=0.02)
FINGERS = wr.patterns.chain(3, joint="finger", gap=0.05)
PULL = wr.Pull("b3", (0, 1))
SHOWN = {
    "assembly": lambda: CHAIN,
    "answer": lambda: wr.flex(CHAIN, PULL, search=0),
    "check": lambda: wr.check(CHAIN),
    "sweep": lambda: wr.sweep(CHAIN, [0.01, 0.02], PULL),
    "gap": lambda: wr.allowable_gap(CHAIN, PULL, at_most=0.1),
    "largest gap": lambda: wr.largest_gap(FINGERS),
    "free space": lambda: wr.free_space(CHAIN, "b1", "b2"),
    "plan": lambda: plan(),
    "plan, ranked": lambda: wr.rank_plan(plan()),
}
"""What is shown as a page."""
ALONE = {
    "tight": lambda: wr.tight_verdict(CHAIN),
    "drag": lambda: wr.Live(CHAIN).drag("b3", (2.0, 0.0), (2.0, 5.0)),
    "escape": lambda: wr.check(wr.patterns.chain(2, joint="finger", gap=0.05)).escapes[0],
}
"""What knows no assembly, and is shown as text."""
NO_RESULTS = {
    "Closer", "Contact", "Bound", "Drawing", "HalfPlane", "Hull", "JointGap", "Live", "Part", "Pull", "Region", "Spread", "Tolerance",
    "Towards", "Translation", "Turn", "W",
}  # fmt: skip
"""What is asked with, and entries of results."""


@cache
def made(what: str) -> Any:
    """What a question returns, asked once."""
    return (SHOWN | ALONE)[what]()


@cache
def plan() -> wr.Plan:
    return wr.plan(FINGERS)


class Frame(HTMLParser):
    """The attributes of the one element, as a browser reads them."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.seen: list[tuple[str, dict[str, Any]]] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append((tag, dict(attrs)))


@pytest.mark.parametrize("what", SHOWN)
def test_it_shows_itself_as_a_page_and_as_text(what: str) -> None:
    formatters = pytest.importorskip("IPython.core.formatters")
    bundle, _ = formatters.DisplayFormatter().format(made(what))
    ((tag, given),) = Frame(bundle["text/html"]).seen
    assert tag == "iframe"
    assert "allow-same-origin" not in given["sandbox"]
    page = told(given["srcdoc"])
    assert len(page["opened"]["parts"]) == 3
    text = bundle["text/plain"]
    assert len(text) < 1500
    assert "array" not in text, "no dump of numbers"
    assert given["title"] == text.splitlines()[0]


@pytest.mark.parametrize("what", ALONE)
def test_what_knows_no_assembly_shows_itself_in_a_line_or_two(what: str) -> None:
    found = made(what)
    bundle = found._repr_mimebundle_()
    assert set(bundle) == {"text/plain"}
    text = bundle["text/plain"]
    assert 5 < len(text) < 300
    assert "array" not in text
    assert type(found).__name__ not in text, "words, not a dump"


def test_all_that_questions_return_shows_itself() -> None:
    classes = {name: value for name in wr.__all__ if isinstance(value := getattr(wr, name), type)}
    results = {name for name, value in classes.items() if dataclasses.is_dataclass(value)} - NO_RESULTS
    assert {name for name in results if not issubclass(classes[name], Displayable)} == set()


def test_an_assembly_in_space_shows_itself() -> None:
    burr = wr.read(EXAMPLES / "44_six_piece_burr" / "burr.json")
    bundle = burr._repr_mimebundle_()
    ((_, given),) = Frame(bundle["text/html"]).seen
    assert all(f">{name}</label>" in given["srcdoc"] for name in burr.names)
    assert bundle["text/plain"].startswith(f"{len(burr.names)} parts, gap ")


def test_a_notebook_is_run_and_keeps_what_it_showed() -> None:
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    cells = [
        "import wiggleroom as wr\nchain = wr.patterns.chain(3, joint='tee', gap=0.02)\nchain",
        "wr.flex(chain, wr.Pull('b3', (0, 1)))",
        "wr.free_space(chain, 'b1', 'b2')",
        "wr.largest_gap(wr.patterns.chain(3, joint='finger', gap=0.05))",
        "wr.Live(chain).drag('b3', (2.0, 0.0), (2.0, 5.0))",
    ]
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source) for source in cells])
    nbclient.NotebookClient(book, timeout=300, kernel_name="python3").execute()
    nbformat.validate(book)
    shown = [cell.outputs[-1].data for cell in book.cells]
    assert [sorted(data) for data in shown] == [["text/html", "text/plain"]] * 4 + [["text/plain"]]
    for data in shown[:4]:
        ((_, given),) = Frame(data["text/html"]).seen
        assert len(told(given["srcdoc"])["opened"]["parts"]) == 3


def test_names_of_parts_stay_names() -> None:
    from wiggleroom.assembly.build import assemble
    from wiggleroom.drawing.model import Drawing, Part, Region

    box = Region(CHAIN.parts[0].regions[0].outer, ())
    nasty = "\"></iframe><script>alert('x')</script>"
    made = assemble(Drawing((Part(nasty, (box,), fixed=True), Part("b", (box,), (50.0, 0.0, 0.0)))), gap=0.1)
    html = made._repr_mimebundle_()["text/html"]
    ((tag, given),) = Frame(html).seen
    assert tag == "iframe"
    assert told(given["srcdoc"])["opened"]["parts"][0]["name"] == nasty


@pytest.mark.slow
@pytest.mark.parametrize("what", ["answer", "free space", "plan, ranked"])
def test_the_frame_shows_the_page_in_a_browser(what: str, browser: Any, tmp_path: Any) -> None:
    found = made(what)
    bundle = found._repr_mimebundle_()
    (tmp_path / "cell.html").write_text(f"<!doctype html><meta charset=utf-8>{bundle['text/html']}")
    page = browser.new_page()
    wrong: list[str] = []
    page.on("pageerror", lambda e: wrong.append(str(e)))
    asked: list[str] = []
    page.on("request", lambda r: asked.append(r.url))
    page.goto((tmp_path / "cell.html").as_uri())
    frame = page.frame_locator("iframe")
    frame.locator("canvas").first.wait_for(timeout=180_000)
    said = frame.locator("body").inner_text()
    assert re.search(r"3 parts|0\.\d+ mm|against the gap|b2 turns", said)
    assert not wrong
    assert all(url.startswith(("file:", "data:", "about:", "blob:")) for url in asked)
    page.close()
