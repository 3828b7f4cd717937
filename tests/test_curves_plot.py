"""Panels of curves: marks must lie where the axes say."""

from __future__ import annotations

import re

import numpy as np
import pytest

from wiggleroom.report.pictures.curve_panels import Curve, Style, around

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
