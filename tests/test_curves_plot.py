"""Panels of curves: marks must lie where the axes say."""

from __future__ import annotations

import re

import numpy as np
import pytest

from wiggleroom.report.pictures.curve_panels import MARKS, Curve, Style, around, legend, mark

BLUE = Style("#1f5f99")


def places(found: list[str]) -> np.ndarray:
    return np.array(
        [[float(v) for v in re.findall(r"translate\(([-\d.]+) ([-\d.]+)\)", m)[0]] for m in found if "mark" in m]
    )


@pytest.mark.parametrize("log", [(False, False), (True, True), (True, False)])
def test_marks_lie_where_the_grid_lines_say(log: tuple[bool, bool]) -> None:
    curve = Curve("a", np.array([1.0, 10.0, 100.0]), np.array([0.1, 1.0, 10.0]), BLUE)
    panel = around(50, 20, 400, 300, [curve], log)
    axes = "".join(panel.axes("", ("x", "y")))
    numbers = {
        float(t): float(x) for x, t in re.findall(r'<text x="([\d.]+)"[^>]*text-anchor="middle">([\d.]+)<', axes)
    }
    marks = places(panel.curve(curve))
    common = [x for x in curve.x.tolist() if x in numbers]
    assert common
    for x in common:
        assert marks[curve.x.tolist().index(x), 0] == pytest.approx(numbers[x], abs=0.01)
    assert (np.diff(marks[:, 1]) < 0).all()
    assert (marks[:, 0] > 50).all()
    assert (marks[:, 0] < 450).all()


def test_logarithmic_axes_space_powers_evenly() -> None:
    curve = Curve("a", np.array([1.0, 10.0, 100.0]), np.array([1.0, 2.0, 4.0]), BLUE)
    marks = places(around(0, 0, 400, 300, [curve], (True, True)).curve(curve))
    assert np.ptp(np.diff(marks[:, 0])) < 0.02
    assert np.ptp(np.diff(marks[:, 1])) < 0.02


def test_points_that_are_not_finite_are_left_out() -> None:
    curve = Curve("a", np.array([1.0, 2.0, 3.0]), np.array([1.0, np.nan, 3.0]), BLUE)
    assert len(places(around(0, 0, 100, 100, [curve]).curve(curve))) == 2


def test_every_mark_is_drawn_and_named() -> None:
    made = {kind: mark(0, 0, Style("#000000", kind)) for kind in MARKS}
    assert len(set(made.values())) == len(MARKS)
    entries = [(f"a rather long name of method {k}", Style("#000000", kind)) for k, kind in enumerate(MARKS)]
    found, end = legend(entries, 0, 100, 500)
    assert len(found) == len(MARKS)
    assert end > 100  # it takes more than one line
