"""An upper bound in space where all parts move in one plane: that of a cross-section.

Where every body is locked along one axis and in both turns about the others, it moves in the plane across that axis. Parts that are
apart have cross-sections that are apart, at every level. So no motion is worth more than the planar bound of any cross-section.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.drawing.model import Drawing, Goal, Part, Pull, Region, Turn
from wiggleroom.errors import InputError
from wiggleroom.search.answer import MAX_BOUND_RATIO, PROVEN_WITHIN, Answer
from wiggleroom.spatial.bodies.rotations import unit_vector
from wiggleroom.spatial.bodies.spatial_bodies import grouped
from wiggleroom.verdict import PathState, Verdict

Floats = NDArray[np.float64]

MAX_LEVELS = 3
"""Number of cross-sections that are looked at, at most: those of most parts."""
MAX_WORK = 5000.0
"""Work of the bound of one cross-section, about milliseconds."""
ROUNDING = 1e-10
"""Corners of cross-sections are rounded to this share of the size, and outlines then moved inward by twice as much."""
CRUMB = 1e-8
"""What of a cross-section is narrower than twice this share of the size is left out: less material leaves more room."""
MARGIN = 1e-9
"""The bound is larger by this share, for rounding."""


def with_cross_section_bound(answer: Answer, context: Context = UNLIMITED) -> Answer:
    """The answer with a bound, where one says something; its verdict `proven` where that is near enough."""
    began = time.perf_counter()
    value = answer.objective
    if not value or not answer.verdict.ends:
        return answer
    axis = _plane_of_motion(answer.assembly)
    if axis is None:
        return answer
    most = cross_section_bound(answer.assembly, answer.goals, axis, context)
    spent = time.perf_counter() - began
    seconds = answer.seconds | {"bound": spent, "total": answer.seconds["total"] + spent}
    return with_known_bound(replace(answer, seconds=seconds), most)


def with_known_bound(answer: Answer, most: float | None) -> Answer:
    """The answer with a bound that holds, where one is known that says something; `proven` where it is near enough."""
    value = answer.objective
    if most is None or not value or not answer.verdict.ends or not value <= most <= MAX_BOUND_RATIO * value:
        return answer
    near = most <= PROVEN_WITHIN * value and answer.path == PathState.CHECKED
    return replace(answer, at_most=most, verdict=Verdict.PROVEN if near else answer.verdict)


def cross_section_bound(
    assembly: Assembly, goals: Sequence[Goal], axis: int, context: Context = UNLIMITED
) -> float | None:
    """Value that no motion in the plane across an axis exceeds; None where no cross-section says anything."""
    # all that answers in the plane takes longer to import than most questions in space take
    from wiggleroom.assembly.build import assemble
    from wiggleroom.bound.dual_bound import with_bound_by_work
    from wiggleroom.maximise import flex

    across = [(axis + 1) % 3, (axis + 2) % 3]
    asked = _in_plane(assembly, goals, axis, across)
    if not asked:
        return None
    sections = _Sections(assembly, axis, across)
    found = []
    for level in sections.levels({goal.part for goal in asked}):
        parts = sections.parts(level)
        names = {p.name for p in parts}
        drawing = Drawing(
            parts,
            glue=tuple(kept for g in assembly.drawing.glue if len(kept := tuple(n for n in g if n in names)) > 1),
            ignore=tuple(pair for pair in assembly.drawing.ignore if set(pair) <= names),
        )
        try:
            answer = with_bound_by_work(
                flex(assemble(drawing), asked, search=0, stop=context.stop), MAX_WORK, context.stop
            )
        except InputError:
            continue
        if answer.at_most is not None:
            found.append(answer.at_most * (1 + MARGIN))
    return min(found, default=None)


def _plane_of_motion(assembly: Assembly) -> int | None:
    """The axis along which no body moves, nor turns about the others; None where there is none."""
    free = grouped(assembly).bodies.free
    for axis in range(3):
        locked = [axis, *(3 + k for k in range(3) if k != axis)]
        if not free[:, locked].any():
            return axis
    return None


def _in_plane(assembly: Assembly, goals: Sequence[Goal], axis: int, across: list[int]) -> list[Pull | Turn]:
    """What is asked, in the plane across an axis; empty where it cannot be said there."""
    reference, names = assembly.reference, assembly.names
    found: list[Pull | Turn] = []
    for goal in goals:
        if isinstance(goal, Turn):
            unit = unit_vector(goal.sense)
            if abs(unit[axis]) < 1.0:
                return []
            found.append(Turn(goal.part, "ccw" if unit[axis] > 0 else "cw", goal.weight))
            continue
        if not isinstance(goal, Pull):
            return []
        unit = unit_vector(goal.direction)
        share = float(np.linalg.norm(unit[across]))
        at = reference[names.index(goal.part)] if goal.point is None else np.array(goal.point)
        if share == 0.0:
            return []
        x, y = unit[across].tolist()
        u, v = at[across].tolist()
        found.append(Pull(goal.part, (x, y), (u, v), goal.weight * share))
    return found


class _Sections:
    """Cross-sections of all parts at rest, across an axis."""

    def __init__(self, assembly: Assembly, axis: int, across: list[int]) -> None:
        self._assembly, self._axis, self._across = assembly, axis, across
        self._corners = [
            [piece.corners @ p.R.T + p.at for piece in made.pieces]
            for p, made in zip(assembly.parts, assembly.solids, strict=True)
        ]
        self._grid = ROUNDING * assembly.size

    def levels(self, wanted: set[str]) -> list[float]:
        """Levels at which the wanted parts and most others are cut, those of most parts first."""
        ends = [(np.vstack(c)[:, self._axis].min(), np.vstack(c)[:, self._axis].max()) for c in self._corners]
        heights = np.unique(np.concatenate([c[:, self._axis] for pieces in self._corners for c in pieces]))
        middles = (heights[1:] + heights[:-1]) / 2
        far = np.diff(heights)
        cut = np.array([(low < middles) & (middles < high) for low, high in ends])
        all_wanted = np.all([cut[k] for k, name in enumerate(self._assembly.names) if name in wanted], axis=0)
        order = np.lexsort([-far, -cut.sum(axis=0)])
        thick = far > 1e3 * self._grid
        return [float(middles[k]) for k in order if all_wanted[k] and thick[k]][:MAX_LEVELS]

    def parts(self, level: float) -> tuple[Part, ...]:
        """Planar parts: what is cut at a level."""
        found = []
        for part, pieces in zip(self._assembly.parts, self._corners, strict=True):
            cuts = [polygon for corners in pieces if (polygon := self._cut(corners, level)) is not None]
            if not cuts:
                continue
            whole = shapely.union_all(cuts, grid_size=self._grid).buffer(
                -2 * self._grid, join_style="mitre", mitre_limit=1e3
            )
            crumb = CRUMB * self._assembly.size
            lumps = [p for p in shapely.get_parts(whole) if not p.buffer(-crumb, join_style="mitre").is_empty]
            regions = tuple(
                Region(
                    np.array(p.exterior.coords)[:-1],
                    tuple(np.array(h.coords)[:-1] for h in p.interiors),
                )
                for p in shapely.orient_polygons(lumps)
            )
            if regions:
                found.append(Part(part.name, regions, fixed=part.fixed))
        return tuple(found)

    def _cut(self, corners: Floats, level: float) -> shapely.Polygon | None:
        """Where a convex piece is cut at a level: the hull of the cuts of all lines between corners above and below."""
        height = corners[:, self._axis] - level
        above, below = corners[height > 0], corners[height <= 0]
        if not len(above) or not len(below):
            return None
        up, down = height[height > 0], height[height <= 0]
        share = (up[:, None] / (up[:, None] - down[None]))[:, :, None]
        points = above[:, None] + share * (below[None] - above[:, None])
        hull = shapely.MultiPoint(points[:, :, self._across].reshape(-1, 2)).convex_hull
        return hull if hull.geom_type == "Polygon" else None
