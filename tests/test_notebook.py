"""Answers, studies and assemblies in a notebook: IPython's own formatter, and the frame in a real browser."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from typing import Any

import pytest

import wiggleroom as wr
from tests.standalone import told

CHAIN = wr.patterns.chain(3, joint="tee", gap=0.02)
PULL = wr.Pull("b3", (0, 1))
SHOWN = {
    "assembly": lambda: CHAIN,
    "answer": lambda: wr.flex(CHAIN, PULL),
    "check": lambda: wr.check(CHAIN),
    "rank": lambda: wr.rank(CHAIN, PULL),
    "tighten": lambda: wr.tighten(CHAIN, PULL, parts=1, workers=1),
    "sweep": lambda: wr.sweep(CHAIN, [0.01, 0.02], PULL),
    "sample": lambda: wr.sample(CHAIN, 0.002, PULL, draws=4, workers=1),
    "gap": lambda: wr.allowable_gap(CHAIN, PULL, at_most=0.1),
}


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
    bundle, _ = formatters.DisplayFormatter().format(SHOWN[what]())
    ((tag, given),) = Frame(bundle["text/html"]).seen
    assert tag == "iframe"
    assert "allow-same-origin" not in given["sandbox"]
    page = told(given["srcdoc"])
    assert len(page["opened"]["parts"]) == 3
    text = bundle["text/plain"]
    assert len(text) < 1500
    assert "array" not in text, "no dump of numbers"
    assert given["title"] == text.splitlines()[0]


def test_the_page_in_the_frame_carries_the_answer() -> None:
    answer = wr.flex(CHAIN, PULL)
    bundle = answer._repr_mimebundle_()
    ((_, given),) = Frame(bundle["text/html"]).seen
    assert told(given["srcdoc"])["answers"][0]["flex"]["objective"] == answer.objective
    assert f"{answer.objective:.4g}" in bundle["text/plain"].splitlines()[0]


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


def test_an_empty_sweep_is_text_alone() -> None:
    from dataclasses import replace

    sweep = SHOWN["sweep"]()
    none = replace(sweep, steps=tuple(replace(s, answer=None) for s in sweep.steps))
    assert set(none._repr_mimebundle_()) == {"text/plain"}


@pytest.mark.slow
@pytest.mark.parametrize("what", ["assembly", "answer", "sweep"])
def test_the_frame_shows_the_page_in_a_browser(what: str, browser: Any, tmp_path: Any) -> None:
    found = SHOWN[what]()
    bundle = found._repr_mimebundle_()
    (tmp_path / "cell.html").write_text(f"<!doctype html><meta charset=utf-8>{bundle['text/html']}")
    page = browser.new_page()
    wrong: list[str] = []
    page.on("pageerror", lambda e: wrong.append(str(e)))
    asked: list[str] = []
    page.on("request", lambda r: asked.append(r.url))
    page.goto((tmp_path / "cell.html").as_uri())
    frame = page.frame_locator("iframe")
    frame.locator("canvas").first.wait_for(timeout=60_000)
    said = frame.locator("body").inner_text()
    assert re.search(r"3 parts|0\.\d+ mm|against the gap", said)
    assert not wrong
    assert all(url.startswith(("file:", "data:", "about:", "blob:")) for url in asked)
    page.close()
