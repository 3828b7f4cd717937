"""What the page takes from files and what it saves: reports, outlines to cut, files that change; in a real browser."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.app_client import TOKEN, Served
from tests.browser_page import answered, visiting, without

pytestmark = pytest.mark.slow


def saved(page: Any, words: str) -> Path:
    """What is saved under an entry of the menu."""
    page.get_by_role("button", name="Save", exact=True).click()
    with page.expect_download() as coming:
        page.get_by_role("menuitem", name=words).click()
    return Path(coming.value.path())


def test_what_is_saved_before_the_search_has_ended_says_that_it_may_find_more(
    browser: Any, peg: Served, opened: Any
) -> None:
    with visiting(browser, peg) as page:
        without(page, "bound")  # the search in idle time
        page.goto(f"http://127.0.0.1:{peg.port}/?token={TOKEN}")
        answered(page, "peg moves 1 mm")
        report, picture = (saved(page, words).read_text() for words in ("Report html", "Picture svg"))
    assert "found so far" in picture
    assert "optimal" not in picture
    opened(report).locator(".headline .facts", has_text="found so far").wait_for()
    with visiting(browser, peg) as page:
        answered(page, "peg moves 1 mm")
        page.locator(".headline .facts", has_text="optimal").wait_for()
        report = saved(page, "Report html").read_text()
    facts = opened(report).locator(".headline .facts")
    facts.filter(has_text="gap 1 mm").wait_for()
    assert facts.inner_text().split()[0] in ("optimal", "proven")
