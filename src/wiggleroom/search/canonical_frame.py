"""A canonical frame: the same assembly given in another place, order or unit has the same answer.

Order, place, direction, handedness and unit are chosen from the outlines and from what is asked; regions that share a side are one. A
search takes many decisions, between equals too, so its answer would else depend on which part is named first. Coordinates are rounded far
below any tolerance: what was turned or scaled is then the same to the last digit.

The incumbent of a search there is carried to the frame of the question: later questions start from it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, rings_at
from wiggleroom.assembly.loops import region_of
from wiggleroom.drawing.model import Goal, Part, Pull, Region, Towards, Turn, Vector, W
from wiggleroom.freespace.cells.cells import CellWish, grow_cells, select
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.geometry.rigid_motions import of_bodies, of_parts
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import ZERO_MOTION, Objective
from wiggleroom.search.answer import Answer, Contact
from wiggleroom.search.incumbent import Incumbent, PathSegment, Start
from wiggleroom.search.local_search import LocalSearch
from wiggleroom.search.moves import WITHOUT_BRANCHES
from wiggleroom.search.prepare import Prepared
from wiggleroom.solve.solution import Solution
from wiggleroom.verdict import SAME_END

Floats = NDArray[np.float64]

GRID = 2.0**-36
"""Coordinates are multiples of this share of the size."""
ORDER_DIGITS = 7
"""Digits to which parts and regions are compared."""
DISTINCT = 1e-4
"""A vector shorter than this share of what it is made of has no direction."""
ALIGNED = 1e-3
"""Edges agree on two axes where their sum, as fourfold angles, is longer than this share of their total."""
FIRST_QUARTER = np.radians(-37.3)
"""The main direction lies within the quarter turn from here on from the x axis; no usual direction lies at its ends."""

ONE_ROUND = replace(WITHOUT_BRANCHES, moves=())
"""The same end, solved again in new cells."""


@dataclass(frozen=True, eq=False)
class CanonicalFrame:
    """An assembly in its own frame, x' = scale * axes (x - origin).

    Parameters
    ----------
    assembly : Assembly
        Parts in canonical order, none turned about its reference point.
    goals : tuple of goals
        Worth `worth` times what they were; the largest weight among them is one, so that a turn is the same in every unit.
    order : (n,) int64
        Number of each of its parts in the assembly that was given.
    origin : (2,) float64 [mm]
    axes : (2, 2) float64
        Orthogonal; of determinant -1 where it is the mirror image.
    scale, worth : float
    """

    assembly: Assembly
    goals: tuple[Goal, ...]
    order: NDArray[np.int64]
    origin: Floats
    axes: Floats
    scale: float
    worth: float

    @property
    def sense(self) -> float:
        """1, or -1 where turns go the other way."""
        return float(np.sign(np.linalg.det(self.axes)))

    def motions(self, motions: Floats) -> Floats:
        """Motions (k, n, 3) of the parts in the frame and order in which they were given [mm, mm, rad]."""
        out = np.empty_like(motions)
        out[:, self.order, :2] = motions[..., :2] @ self.axes / self.scale
        out[:, self.order, 2] = self.sense * motions[..., 2]
        return out

    def contact(self, contact: Contact) -> Contact:
        """A contact in the frame in which the assembly was given."""
        x, y = self.origin + np.array(contact.point) @ self.axes / self.scale
        nx, ny = np.array(contact.normal) @ self.axes
        force = contact.force * self.scale / self.worth
        return replace(contact, point=(float(x), float(y)), normal=(float(nx), float(ny)), force=force)

    def answer(self, found: Answer, assembly: Assembly, asked: tuple[Goal, ...]) -> Answer:
        """An answer about the canonical assembly as one about the assembly that was given."""
        waypoints, unit = self.motions(found.waypoints), self.worth
        bound, search = found.bound, found.search
        if bound is not None and bound.at_most is not None:
            bound = replace(bound, at_most=bound.at_most / unit)
        if search is not None and search.next_best is not None:
            search = replace(search, next_best=search.next_best / unit)
        period = found.period
        if period is not None:
            turn = np.empty_like(period.turn)
            turn[self.order] = self.sense * period.turn
            period = replace(period, objective=period.objective / unit, turn=turn)
        return replace(
            found,
            period=period,
            assembly=assembly,
            goals=asked,
            objective=None if found.objective is None else found.objective / unit,
            motion=waypoints[-1],
            waypoints=waypoints,
            contacts=tuple(map(self.contact, found.contacts)),
            deepest_overlap=found.deepest_overlap / self.scale,
            at_most=None if found.at_most is None else found.at_most / unit,
            bound=bound,
            search=search,
            warm_start=None,
        )


def canonical_frame(assembly: Assembly, asked: tuple[Goal, ...]) -> CanonicalFrame:
    """The frame that belongs to an assembly and what is asked of it.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> frame = canonical_frame(wr.patterns.chain(3, joint="tee", gap=0.01), (Pull("b3", (0.0, 1.0)),))
    >>> frame.assembly.names, frame.goals[0].part
    (('b1', 'b2', 'b3'), 'b3')
    """
    made = [replace(part, regions=merged(part.regions)) if len(part.regions) > 1 else part for part in assembly.parts]
    rings = [rings_at(part) for part in made]
    corners = np.concatenate([ring for its in rings for ring in its])
    origin = corners[0] + _centroid([ring - corners[0] for its in rings for ring in its])
    size = float(np.hypot(*(corners - origin).T).max())
    vectors = _vectors(assembly, asked, [[(ring - origin) / size for ring in its] for its in rings], origin, size)
    main = next((v for v in vectors if np.hypot(*v) > DISTINCT), np.array([1.0, 0.0]))
    mirrored = _sense(asked) < 0
    if _sense(asked) == 0:
        sides = (float(main[0] * v[1] - main[1] * v[0]) for v in vectors)
        mirrored = next((side < 0 for side in sides if abs(side) > DISTINCT * np.hypot(*main)), False)
    flip = np.diag([1.0, -1.0 if mirrored else 1.0])
    edges = np.concatenate([np.roll(ring, -1, 0) - ring for its in rings for ring in its]) @ flip
    angle = _angle(flip @ main, edges)
    c, s = np.cos(angle), np.sin(angle)
    axes = np.array([[c, s], [-s, c]]) @ flip
    # the outline of a part is told about its reference point, wherever that lies
    parts = [_part(part, origin, axes, 1 / size) for part in made]
    order = sorted(range(len(parts)), key=lambda k: _key(parts[k]))
    goals = tuple(_goal(goal, origin, axes, 1 / size) for goal in asked)
    heaviest = max(map(_weight, goals), default=0.0) or 1.0
    goals = tuple(replace(goal, weight=goal.weight / heaviest) for goal in goals)
    drawn = replace(
        assembly.drawing,
        parts=tuple(parts[k] for k in order),
        gap=assembly.gap / size,
        gaps=(),
        goals=goals,
        tolerances=(),
    )
    numbers = np.array(order, dtype=np.int64)
    return CanonicalFrame(Assembly(drawn.parts, drawn), goals, numbers, origin, axes, 1 / size, 1 / (size * heaviest))


def _part(part: Part, origin: Floats, axes: Floats, scale: float) -> Part:
    """A part in the frame, its outlines in canonical order."""
    c, s = np.cos(part.at[2]), np.sin(part.at[2])
    turned = scale * axes @ np.array([[c, -s], [s, c]])
    mirrored = np.linalg.det(axes) < 0

    def ring(points: Floats) -> Floats:
        found = GRID * np.round(points @ turned.T / GRID)
        found = found[::-1] if mirrored else found
        return np.roll(found, -min(range(len(found)), key=lambda k: _rounded(found[k])), axis=0)

    regions = [
        Region(ring(r.outer), tuple(sorted(map(ring, r.holes), key=lambda hole: _rounded(hole[0]))))
        for r in part.regions
    ]
    x, y = GRID * np.round(scale * axes @ (np.array(part.at[:2]) - origin) / GRID)
    regions.sort(key=lambda r: _rounded(r.outer[0]))
    return replace(part, regions=tuple(regions), at=(float(x), float(y), 0.0), offset=0.0)


def merged(regions: Sequence[Region]) -> tuple[Region, ...]:
    """The same material, regions that share a side as one.

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> len(merged([Region(square), Region(square + (1.0, 0.0))]))
    1
    """
    pieces = shapely.get_parts(shapely.union_all([shapely.Polygon(r.outer, r.holes) for r in regions]))
    if len(pieces) == len(regions):
        return tuple(regions)
    return tuple(region_of(piece) for piece in shapely.orient_polygons(pieces))


def _key(part: Part) -> tuple[Any, ...]:
    """Where a part lies, in its order among others."""
    first = part.regions[0].outer[0] + part.at[:2]
    return not part.fixed, *_rounded(first), *(_rounded(c) for c in part.regions[0].outer + part.at[:2])


def _rounded(point: Floats) -> tuple[float, ...]:
    return tuple((np.round(point, ORDER_DIGITS) + 0.0).tolist())


def _goal(goal: Goal, origin: Floats, axes: Floats, scale: float) -> Goal:
    """What is asked, in the frame; worth `scale` times as much."""
    sense = np.linalg.det(axes)

    def spot(point: Vector | None) -> tuple[float, float] | None:
        return None if point is None else _pair(scale * axes @ (np.array(point) - origin))

    if isinstance(goal, Pull):
        direction = np.array(goal.direction, dtype=float)
        return replace(goal, direction=_pair(axes @ (direction / np.hypot(*direction))), point=spot(goal.point))
    if isinstance(goal, Turn):
        same = (goal.sense == "ccw") == (sense > 0)
        return replace(goal, sense="ccw" if same else "cw", weight=goal.weight * scale)
    if isinstance(goal, W):
        x, y = axes @ np.array(goal.w[:2], dtype=float)
        return replace(goal, w=(float(x), float(y), float(goal.w[2] * sense * scale)))
    if isinstance(goal, Towards):
        target = spot(goal.target)
        return replace(goal, point=spot(goal.point), target=target or goal.target, weight=goal.weight / scale)
    return replace(goal, weight=goal.weight / scale)


def _weight(goal: Goal) -> float:
    """How much the objective changes at most with a motion of one length, or of one angle."""
    return abs(goal.weight) * (max(float(np.hypot(*goal.w[:2])), abs(goal.w[2])) if isinstance(goal, W) else 1.0)


def _pair(v: Floats) -> tuple[float, float]:
    x, y = GRID * np.round(v / GRID)
    return float(x), float(y)


def _sense(asked: Sequence[Goal]) -> float:
    """Sum of the turns that are asked for, counter-clockwise ones positive."""
    turns = [g.weight * (1 if g.sense == "ccw" else -1) for g in asked if isinstance(g, Turn)]
    return float(sum(turns) + sum(g.weight * g.w[2] for g in asked if isinstance(g, W)))


def _vectors(
    assembly: Assembly, asked: Sequence[Goal], rings: list[list[Floats]], origin: Floats, size: float
) -> list[Floats]:
    """Vectors that turn with the assembly: what is pulled and where, what is fixed, and how the material lies about its centroid."""
    pulls = [g for g in asked if isinstance(g, Pull)]
    out = [sum((g.weight * np.array((x, y)) / np.hypot(x, y) for g in pulls for x, y in [g.direction]), np.zeros(2))]
    out += [np.array(g.w[:2], dtype=float) / max(np.hypot(*g.w[:2]), 1e-300) for g in asked if isinstance(g, W)]
    for goal in asked:
        if isinstance(goal, Pull) and goal.point is not None:
            out.append((np.array(goal.point) - origin) / size)
        elif isinstance(goal, Pull | Turn | W | Towards):
            out.append(_centroid(rings[assembly.names.index(goal.part)]))
    fixed = [ring for part, its in zip(assembly.parts, rings, strict=True) for ring in its if part.fixed]
    if fixed:
        out.append(_centroid(fixed))
    everything = [ring for its in rings for ring in its]
    x, y = np.array([_moment(everything, lambda p, k=k: (p[:, 0] ** 2 + p[:, 1] ** 2) * p[:, k]) for k in (0, 1)])
    xx, yy, xy = (
        _moment(everything, lambda p: p[:, 0] ** 2),
        _moment(everything, lambda p: p[:, 1] ** 2),
        _moment(everything, lambda p: p[:, 0] * p[:, 1]),
    )
    angle = np.arctan2(2 * xy, xx - yy) / 2
    axis = np.hypot(2 * xy, xx - yy) * np.array([np.cos(angle), np.sin(angle)])
    reference = next((v for v in [*out, np.array([x, y])] if np.hypot(*v) > DISTINCT), axis)
    return [*out, np.array([x, y]), axis * np.sign(axis @ reference)]


def _centroid(rings: Sequence[Floats]) -> Floats:
    area = _moment(rings, lambda p: np.ones(len(p)))
    return np.array([_moment(rings, lambda p, k=k: p[:, k]) for k in (0, 1)]) / area


def _moment(rings: Sequence[Floats], of: Any) -> float:
    """Integral of a cubic polynomial of the place over the material, hole rings running the other way; exact."""
    total = 0.0
    for ring in rings:
        after = np.roll(ring, -1, 0)
        area = (ring[:, 0] * after[:, 1] - after[:, 0] * ring[:, 1]) / 2  # triangles with the origin
        value = -27 / 48 * of((ring + after) / 3)
        for a, b in ((0.2, 0.2), (0.6, 0.2), (0.2, 0.6)):
            value = value + 25 / 48 * of(a * ring + b * after)
        total += float(area @ value)
    return total


def _angle(main: Floats, edges: Floats) -> float:
    """Direction of the x axis [rad]: along the edges where these agree, as near to the main direction as that allows."""
    direction = float(np.arctan2(main[1], main[0]))
    length, angle = np.hypot(*edges.T), np.arctan2(edges[:, 1], edges[:, 0])
    total = complex((length * np.exp(4j * angle)).sum())
    if abs(total) < ALIGNED * length.sum():
        return direction
    along = float(np.angle(total)) / 4
    quarters = np.floor((direction - along - FIRST_QUARTER) / (np.pi / 2))
    return along + float(quarters) * np.pi / 2


def carried_incumbent(
    ready: Prepared,
    objective: Objective,
    solve: Callable[..., Solution],
    found: Answer,
    frame: CanonicalFrame,
    waypoints: Floats,
) -> Incumbent | None:
    """Solve the last program of a search again in this frame, in more rounds where one is not enough; None where cells do not grow.

    Parameters
    ----------
    ready : Prepared
    objective : Objective
    solve : callable
        Solver.
    found : Answer
        In the other frame.
    frame : CanonicalFrame
    waypoints : (k, parts, 3) float64 [mm, mm, rad]
        Of that answer, in this frame.
    """
    there = found.warm_start
    if there is None:
        return None
    program, bodies = there.program, ready.bodies
    inner = of_parts(frame.assembly, program.bodies, program.motion(there.solution.inner)[None])
    path = of_bodies(ready.assembly, bodies, np.concatenate([waypoints[:-1], frame.motions(inner), waypoints[-1:]]))
    body = np.array([bodies.body_of[frame.order[members[0]]] for members in program.bodies.members])
    n = len(body)
    one, other = body[program.cells.a], body[program.cells.b]
    key = np.minimum(one, other) * n + np.maximum(one, other)
    a, b = key // n, key % n
    keep = relative_pose(bodies, a, b, path[-1])[:, None]
    room = np.full(len(a), ready.clearance)
    cells, good = grow_cells(bodies, a, b, relative_pose(bodies, a, b, path[-2]), room, wish=CellWish(keep))
    if not good.all():
        return None
    free = build_program(bodies, select(cells, np.zeros(0, dtype=np.int64)), ZERO_MOTION, length=ready.clearance)
    segment = PathSegment(free, tuple(free.variables(motion) for motion in path[:-1]))
    search = LocalSearch(ready, objective, solve, ONE_ROUND)
    mu = there.solution.inner_mu / frame.worth
    once = search.improve(Start(cells, path[-2], (segment,), mu=mu, tolerance=there.tolerance))
    end = objective.value(path[-1])
    if once is None or once.value >= end - SAME_END * abs(end):
        return once
    # held by the border of a new cell, where nothing touches: its forces say nothing about contacts
    return LocalSearch(ready, objective, solve, WITHOUT_BRANCHES).improve(once.start())
