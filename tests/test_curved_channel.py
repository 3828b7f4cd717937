"""Curved pieces that mesh leave a round channel together, by a turn about its centre."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.audit import part
from wiggleroom.assembly.build import assemble
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.drawing.model import Drawing

CENTRE = np.array([3.0, -2.0])


def sector(inner: float, outer: float, begin: float, end: float, count: int) -> shapely.Polygon:
    """A piece of a ring about the centre, between two angles [deg]."""
    angle = np.radians(np.linspace(begin, end, count + 1))
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    return shapely.Polygon(CENTRE + np.concatenate([outer * ring, inner * ring[::-1]]))


def channel(lid: bool = False) -> wr.Assembly:
    """Two curved bars in a round channel, a head of the one in a pocket of the other: the channel keeps them from parting sideways."""
    block = shapely.box(-5, -2, 11, 6) - sector(4, 6, 0 if lid else -5, 165, 60)
    head = sector(4.6, 5.4, 78, 84, 6) | sector(4.3, 5.7, 84, 87, 6)
    room = sector(4.55, 5.45, 70, 84, 8) | sector(4.25, 5.75, 83.2, 87.8, 6)
    front, back = sector(4.05, 5.95, 6, 80, 40) | head, sector(4.05, 5.95, 80.8, 160, 40) - room
    if lid:
        block |= shapely.box(6.5, -3, 9.5, -2)
    still = (0.0, 0.0, 0.0)
    parts = part("block", block, still, True), part("front", front, still), part("back", back, still)
    return assemble(Drawing(parts), gap=0.0)


@pytest.mark.slow
def test_check_names_those_that_leave_together() -> None:
    found = wr.check(channel())
    assert found.verdict == "comes apart"
    assert found.escapes[0].parts == ("front", "back")
    assert audit_path(found.assembly, found.escapes[0].path).free


@pytest.mark.slow
def test_a_channel_with_a_lid_holds_them() -> None:
    assert wr.check(channel(lid=True)).verdict != "comes apart"
