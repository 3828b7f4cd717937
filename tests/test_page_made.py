"""Blocks with joints that are made on the page: sizes are set there, and the answer is that of the same blocks in Python."""

from __future__ import annotations

import re
from typing import Any

import pytest

import wiggleroom as wr
from tests.browser_page import accessible, serving, visiting
from tests.page_waits import until
from wiggleroom.assembly.patterns import chain

pytestmark = pytest.mark.slow


def answer_of(page: Any) -> float:
    """Far the last block goes [mm], by the headline; nan while that is not known."""
    said = page.locator("#answer[data-settled=true]").all_inner_texts()
    found = re.search(r"moves ([\d.]+) mm in", said[0]) if said else None
    return float(found.group(1)) if found else float("nan")


def expected(gap: float, n: int, **sizes: Any) -> float:
    made = chain(n, gap=gap, pitch=20, **sizes)
    return float(wr.flex(made, wr.Pull(made.names[-1], (1.0, 0.0))).objective or 0.0)


def answers(page: Any, value: float) -> None:
    until(page, lambda: abs(answer_of(page) - value) < 2e-3 * value, f"{value} mm are expected")


def test_the_sizes_of_a_joint_are_set_and_the_question_stays(browser: Any) -> None:
    with serving(None) as served, visiting(browser, served) as page:
        page.get_by_role("button", name="Make joints").click()
        page.locator(".filename", has_text="chain.json").wait_for()
        answers(page, expected(0.3, 4, joint="swallowtail"))
        accessible(page)
        gap = page.get_by_label("gap, mm", exact=True)
        gap.fill("0.5")
        gap.press("Enter")
        answers(page, expected(0.5, 4, joint="swallowtail"))
        neck = page.get_by_role("textbox", name="neck, mm")
        neck.fill("3")
        neck.press("Enter")
        answers(page, expected(0.5, 4, joint="swallowtail", neck=0.15))
        neck.fill("30")
        neck.press("Enter")
        page.get_by_role("alert").filter(has_text="choose sizes that fit each other").wait_for()
        until(page, lambda: neck.input_value() == "3", "the box shows a size that is not drawn")
        page.get_by_label("family of the joint").select_option("tee")
        answers(page, expected(0.5, 4, joint="tee"))
        head = page.get_by_role("slider", name="head", exact=True)
        head.fill("0.35")
        answers(page, expected(0.5, 4, joint="tee", head=0.35))
        page.reload()
        answers(page, expected(0.5, 4, joint="tee", head=0.35))
        page.keyboard.press("Control+z")
        answers(page, expected(0.3, 4, joint="tee", head=0.35))
