"""A page in a browser: opened against its server, what is seen on it, and its replies held back."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlparse

import pytest

import wiggleroom as wr
from tests.app_client import TOKEN, Served
from tests.page_waits import PATIENCE, faded, settled
from wiggleroom.app.open_requests import first_open
from wiggleroom.cli.options import QuestionOptions
from wiggleroom.cli.serve_command import FirstRequest

AXE = Path(__file__).parents[1] / "web" / "node_modules" / "axe-core" / "axe.min.js"
"""Accessibility rules; `npm ci` in `web` brings them."""
PEG = {
    "format": "wiggleroom/1",
    "gap": 1,
    "parts": [
        {
            "name": "frame",
            "outline": [[0, 0], [30, 0], [30, 30], [0, 30]],
            "holes": [[[10, 10], [20, 10], [20, 20], [10, 20]]],
            "fixed": True,
        },
        {"name": "peg", "outline": [[-5, -5], [5, -5], [5, 5], [-5, 5]], "at": [15, 15, 0]},
    ],
    "pull": [{"part": "peg", "direction": [1, 0]}],
}
"""A peg of 10 mm in a hole of 10 mm: with a gap g it moves by g each way, and turns by little."""


def accessible(page: Any) -> None:
    """Axe finds nothing, on all that is seen now."""
    faded(page)
    page.evaluate(AXE.read_text())
    found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")["violations"]
    assert [(one["id"], [node["html"][:160] for node in one["nodes"]]) for one in found] == []


@contextmanager
def serving(path: Path | None) -> Iterator[Served]:
    first = None if path is None else first_open(path, wr.read(str(path)).drawing, None, None, None)
    one = Served(None if first is None else lambda: first)
    try:
        yield one
    finally:
        one.close()


@contextmanager
def following(path: Path) -> Iterator[Served]:
    """A server of a file as the command starts it: what is open follows what is on disk."""
    one = Served(FirstRequest(str(path), QuestionOptions()))
    try:
        yield one
    finally:
        one.close()


@contextmanager
def visiting(browser: Any, served: Served, **how: Any) -> Iterator[Any]:
    """A page of its own; whatever it complains about fails the test, and so does any word to another address."""
    context = browser.new_context(viewport={"width": 1440, "height": 900}, accept_downloads=True, **how)
    context.set_default_timeout(1000 * PATIENCE)
    page = context.new_page()
    wrong: list[str] = []
    home = f"127.0.0.1:{served.port}"
    page.on("pageerror", lambda error: wrong.append(str(error)))
    # a reload asks without the token; the refusal goes on to the page with the token that the tab keeps
    page.on(
        "console",
        lambda said: (
            wrong.append(said.text)
            if said.type == "error" and not ("403" in said.text and urlparse(said.location["url"]).path == "/")
            else None
        ),
    )
    page.on(
        "request",
        lambda asked: None if home in asked.url or asked.url[:5] in ("data:", "blob:") else wrong.append(asked.url),
    )
    page.goto(f"http://{home}/?token={TOKEN}")
    try:
        yield page
        assert not wrong
    finally:
        context.close()


def answered(page: Any, words: str) -> None:
    """Wait until the headline says this, as the full answer."""
    page.locator("#answer[data-settled=true]", has_text=words).wait_for()


def without(page: Any, kind: str) -> None:
    """Requests of a kind never reach the server."""

    def between(line: Any) -> None:
        server = line.connect_to_server()
        line.on_message(lambda said: None if json.loads(said)["kind"] == kind else server.send(said))

    page.route_web_socket(re.compile("/socket"), between)


def foot(page: Any) -> tuple[float, float]:
    """Where the arrow of the pull stands on the canvas [px]."""
    base = page.locator(".pull .base").first
    return float(base.get_attribute("cx")), float(base.get_attribute("cy"))


def still(page: Any) -> tuple[float, float]:
    """The same when it has come to rest."""
    return settled(page, lambda: foot(page))


def at_rest(page: Any) -> tuple[float, float]:
    page.get_by_label("place on the path from rest").fill("0")
    rest = still(page)
    page.get_by_label("place on the path from rest").fill("1000")
    return rest


def pixels_per_mm(page: Any) -> float:
    """Scale of the picture, from the answer: the peg's reference point goes 1 mm to the right."""
    rest = at_rest(page)
    moved = still(page)
    factor = float(re.search(r"×([\d.]+)", page.locator(".player select option").first.inner_text()).group(1))  # type: ignore[union-attr]
    assert moved[1] == pytest.approx(rest[1], abs=0.01)
    return (moved[0] - rest[0]) / factor


def canvas(page: Any) -> dict[str, float]:
    return page.locator(".stage canvas").bounding_box()


class Late:
    """Replies of some kinds reach the page only when they are let go."""

    def __init__(self, page: Any, kinds: set[str]) -> None:
        self.kinds = kinds
        self.held: list[tuple[str, list[str | bytes]]] = []
        self.frames: list[str | bytes] = []
        page.route_web_socket(re.compile("/socket"), self.between)

    def between(self, line: Any) -> None:
        self.line = line
        line.connect_to_server().on_message(self.take)

    def take(self, said: str | bytes) -> None:
        self.frames.append(said)
        if isinstance(said, str):
            kind = json.loads(said)["kind"]
            if kind in self.kinds:
                self.held.append((kind, self.frames))
            else:
                self.send(self.frames)
            self.frames = []

    def send(self, frames: list[str | bytes]) -> None:
        for one in frames:
            self.line.send(one)

    def go(self) -> None:
        for _, frames in self.held:
            self.send(frames)
