"""A server and a browser for the tests of pages, and the known limits of the search."""

from __future__ import annotations

import gc
import json
import shutil
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.page_waits import PATIENCE

LOCAL = "ends in a local optimum: some joints of a long chain take the other one of two nearly equal ends"
KNOWN = {  # each by the end of its test's name; the list may only get shorter
    "test_chain_turned_and_far_away_is_the_same[arrow-0.03-10]": LOCAL,
}


def pytest_configure() -> None:
    """Interrupts reach tests and the programs that they start, also where whoever runs them ignores interrupts (nohup, background)."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    gc.disable()  # nothing of what is collected is garbage, and looking for some among it takes a quarter of the time


def pytest_collection_finish() -> None:
    """From here on garbage is looked for again, but not among modules and tests."""
    gc.freeze()
    gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what needs a browser, which must run in processes of its own: its loop of events stays in them.

    Expect the known limits, each as it is: one that is mended, or crashes, is a failure until it is taken off the list.
    """
    for item in items:
        if "browser" in getattr(item, "fixturenames", ()):
            item.add_marker("browser")
        reason = KNOWN.get(item.name)
        if reason:
            item.add_marker(pytest.mark.xfail(reason=reason, raises=AssertionError, strict=True))


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch) -> Callable[..., int]:
    """The command line: its words, and its exit code."""
    from wiggleroom.cli import main

    def run(*words: object) -> int:
        monkeypatch.setattr("sys.argv", ["wiggleroom", *map(str, words)])
        return main()

    return run


@pytest.fixture
def command_output(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str, list[str]]]:
    """The command line: its words, and its exit code, its stdout and the lines of its stderr."""
    from wiggleroom.cli import main

    def run(*words: object) -> tuple[int, str, list[str]]:
        monkeypatch.setattr("sys.argv", ["wiggleroom", *map(str, words)])
        code = main()
        out, err = capfd.readouterr()
        return code, out, err.splitlines()

    return run


@pytest.fixture(scope="module")
def served() -> Iterator[Any]:
    """The server of the page, on a port of its own."""
    from tests.app_client import Served  # only these tests need what the page needs

    one = Served()
    yield one
    one.close()


@pytest.fixture(scope="module")
def page(served: Any) -> Iterator[Any]:
    """A page without a browser."""
    with served.visit() as one:
        yield one


@pytest.fixture(scope="module")
def peg(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """The server of the page with a peg in its hole open."""
    from tests.browser_page import PEG, serving

    path = tmp_path_factory.mktemp("peg") / "peg.json"
    path.write_text(json.dumps(PEG))
    with serving(path) as one:
        yield one


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """A headless Chromium; .ci/run installs one, elsewhere these tests are left out."""
    playwright = pytest.importorskip("playwright.sync_api")
    where = next((w for w in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if w), None)
    if where is None:
        pytest.skip("no Chromium on this machine")
    with playwright.sync_playwright() as p:
        opened = p.chromium.launch(executable_path=where, args=["--no-sandbox", "--disable-background-networking"])
        yield opened
        opened.close()


@pytest.fixture
def opened(browser: Any, tmp_path: Path) -> Iterator[Any]:
    """Open an answer's report; every message but those of graphics drivers and every request but that for the file is a failure."""
    trouble: list[str] = []
    pages = []

    def show(html: str, **how: Any) -> Any:
        (tmp_path / "report.html").write_text(html, encoding="utf-8")
        page_of = browser.new_page(**how)
        page_of.set_default_timeout(1000 * PATIENCE)
        page_of.on("pageerror", lambda e: trouble.append(str(e)))
        page_of.on("console", lambda m: None if "GL Driver Message" in m.text else trouble.append(m.text))
        page_of.on("request", lambda r: trouble.append(r.url) if not r.url.endswith("report.html") else None)
        page_of.goto((tmp_path / "report.html").as_uri())
        pages.append(page_of)
        return page_of

    yield show
    for one in pages:
        one.close()
    assert trouble == []
