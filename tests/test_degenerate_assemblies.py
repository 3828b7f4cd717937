"""Assemblies at the edge of sense: nothing meets, a reference point far away, neighbours that are as near as they come."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.audit import part
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing

FRAME, BLOCK = shapely.box(-2, -2, 2, 2) - shapely.box(-1, -1, 1, 1), shapely.box(-0.8, -0.8, 0.8, 0.8)


def framed(far: float = 0.0, **more: object) -> wr.Assembly:
    shapes = [shapely.transform(g, lambda points: points + np.array([far, 0.0])) for g in (FRAME, BLOCK)]
    parts = part("f", shapes[0], (0.0, 0.0, 0.0), True), part("b", shapes[1], (0.0, 0.0, 0.0), False)
    return assemble(Drawing(parts, goals=(wr.Pull("b", (1, 0)),), **more), gap=0.0)


def test_what_meets_nothing_is_unbounded() -> None:
    assert wr.flex(framed(ignore=(("f", "b"),)), search=0).verdict == "unbounded"


def test_a_reference_point_far_away_is_moved_into_the_outline() -> None:
    assembly = framed(1e8)
    assert wr.flex(assembly, search=0).objective == pytest.approx(0.2, rel=1e-6)
    assert "reference point" in assembly.drawing.notes[0]
    assert not framed(100.0).drawing.notes


def test_closer_is_optimal_where_no_neighbour_can_come_nearer() -> None:
    blocks = part("a", BLOCK, (0.0, 0.0, 0.0), True), part("b", shapely.box(50, 0, 51, 1), (0.0, 0.0, 0.0), False)
    answer = wr.flex(assemble(Drawing(blocks, goals=(wr.Closer(),)), gap=0.0), search=0)
    assert (answer.verdict, answer.objective) == ("optimal", 0.0)
