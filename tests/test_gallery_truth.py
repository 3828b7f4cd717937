"""The gallery's values against truths of their own: closed forms and the dynamic programme of tests/oracle."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import shapely

import wiggleroom as wr

from .oracle.chain import reach
from .oracle.geometry import inset_polygon
from .oracle.slices import Slices

EXAMPLES = Path(__file__).parents[1] / "examples"
SHEET, SIDE_SLOT = 2.8, 3.6


def expected(folder: str) -> list[float]:
    return [entry["objective"] for entry in json.loads((EXAMPLES / folder / "expected.json").read_text())]


@pytest.mark.parametrize(("k", "slot"), [(0, 3.0), (1, 3.5), (2, 4.5)])
def test_shelf_leans_as_far_as_its_narrower_slot_lets_it(k, slot):
    """A strip leans until two opposite corners of the slot hold it; the play left in the other slots adds to the sway."""

    def play(wide: float, lean: float) -> float:
        return wide * np.cos(lean) - SHEET * np.sin(lean) - SHEET

    leans = np.linspace(0.0, 0.5, 2_000_001)
    lean = leans[np.minimum(play(slot, leans), play(SIDE_SLOT, leans)) >= 0][-1]
    sway = 100 * np.sin(lean) + play(SIDE_SLOT, lean) * np.tan(lean) + play(slot, lean) / np.cos(lean)
    assert expected("14_shelf")[2 * k : 2 * k + 2] == pytest.approx([lean, sway], rel=1e-5)


@pytest.mark.slow
def test_row_of_the_space_divider_is_worth_what_the_dynamic_programme_says():
    ring = wr.read(EXAMPLES / "19_space_divider" / "row.svg", gap=0.9).drawing.parts[1].regions[0].outer
    unit = inset_polygon(shapely.Polygon(np.asarray(ring) / 56), 0.45 / 56)
    joint = Slices(unit, unit, (1.0, 0.0))
    pushed, _, turned, _ = expected("19_space_divider")
    assert pushed == pytest.approx(56 * reach(joint, 12).value, rel=1e-8)
    assert turned == pytest.approx(11 * joint.high, rel=1e-8)
