"""How far parts that interlock can get at most, from nothing but the outer regions of their joints."""

from __future__ import annotations

import numpy as np

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.bound.joint_constraints import AngleRanges, first_ranges
from wiggleroom.bound.outer_regions import local_outer_regions, outer_regions
from wiggleroom.deadline import WorkBudget
from wiggleroom.errors import Stop
from wiggleroom.search.prepare import survey


def furthest(assembly: Assembly, work: float, stop: Stop | None = None) -> float | None:
    """A distance [mm] that no point of any part exceeds in any motion that starts at rest; None where none was found.

    Walls round rest may take some `work`, see `WorkBudget`; where they do not close joints enough, outer slices may take as much.

    It needs joints that close round each other. Along paths to what is fixed, turns add up, and so do shifts of the joints' pivots
    and the swing of the arms between them.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> 0.03 < furthest(wr.patterns.chain(2, joint="swallowtail", gap=0.02), 60_000) < 0.2
    True
    """
    surveyed = survey(assembly)
    fixed = surveyed.bodies.fixed
    ranges = first_ranges(fixed, *local_outer_regions(surveyed, WorkBudget(work, stop)))
    if not _bounded(ranges):
        ranges = first_ranges(fixed, *outer_regions(surveyed, WorkBudget(work, stop)))
    if not _bounded(ranges):
        return None
    turn = np.minimum(np.maximum(-ranges.low, ranges.high), np.pi)
    return float((ranges.far + 2 * np.sin(turn / 2) * surveyed.bodies.radius).max())


def _bounded(ranges: AngleRanges) -> bool:
    return bool(np.isfinite(ranges.far).all())
