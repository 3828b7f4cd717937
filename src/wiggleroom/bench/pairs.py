"""Pairs of blocks whose free spaces are compared."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from wiggleroom.assembly import patterns
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing, Part, Region

GAP = 0.01
"""Of all pairs [mm]; blocks have side 1."""
PAIR = ("b1", "b2")
"""Names of the two blocks."""

CENTRE, INNER, OUTER, ARC = (0.0, -0.55), 0.44, 0.62, 40.0
"""Arc: its centre from the middle of the side, its radii, and how far it goes [deg]."""
CHORDS = 10
"""Of the arc."""


def arc() -> Assembly:
    """Two blocks joined by a tongue that is part of a ring: one comes out by turning about a point beside the joint."""
    centre = np.array(CENTRE)
    angle = np.radians(np.linspace(0.0, ARC, CHORDS + 1))
    direction = np.column_stack([-np.sin(angle), np.cos(angle)])
    outer, inner = centre + OUTER * direction, centre + INNER * direction[::-1]
    line = np.vstack([(0.0, 0.5), outer, inner, (0.0, -0.5)])  # down the side, material on the right
    block = Region(np.vstack([np.add(line, (-0.5, 0.0)), np.add(line[::-1], (0.5, 0.0))]))
    parts = tuple(Part(name, (block,), (float(k), 0.0, 0.0), fixed=k == 0) for k, name in enumerate(PAIR))
    return assemble(Drawing(parts), gap=GAP)


def wedge() -> Assembly:
    """Two blocks that nothing keeps from leaving each other."""
    return patterns.chain(2, "swallowtail", GAP, neck=0.4, end=0.2)


PAIRS: dict[str, Callable[[], Assembly]] = {
    "tee": lambda: patterns.chain(2, "tee", GAP),
    "swallowtail": lambda: patterns.chain(2, "swallowtail", GAP),
    "dovetail": lambda: patterns.chain(2, "dovetail", GAP),
    "arc": arc,
    "round": lambda: patterns.chain(2, "revolute", GAP),
    "open wedge": wedge,
}
"""Registry: what makes each pair; its blocks are "b1", fixed, and "b2"."""
