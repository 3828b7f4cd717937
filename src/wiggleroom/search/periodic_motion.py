"""Periodic motions: a path to a state congruent to an earlier one, with a larger objective, can be repeated without end.

Turn a body about its centroid by a symmetry of its outline, and the same material lies there. So let a path lead from a state to another
one that differs from it by such turns alone. Turned in the same way, the path leads on from there: every body is where a body of the
same outline was on the path before, and nothing overlaps. What turns gain in one period they gain in every one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.drawing.model import Goal, Part, Region
from wiggleroom.errors import InputError, StoppedError
from wiggleroom.geometry.rigid_motions import of_bodies, of_parts
from wiggleroom.geometry.rotational_symmetry import symmetry_order, symmetry_orders
from wiggleroom.program.objectives import Approach, Objective, PointMotion, Points, Sum
from wiggleroom.search.incumbent import PathSegment, Start, start_at_rest
from wiggleroom.search.local_search import LocalSearch
from wiggleroom.search.moves import CLIMB
from wiggleroom.search.path_check import CheckedPath, check_path
from wiggleroom.search.prepare import Prepared, prepare_as_drawn
from wiggleroom.search.turn_in_place import round_middles, turned_about
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SYMMETRY_TOLERANCE = 1e-10
"""Corners agree where they do to this share of the drawing's size: half of what the audit moves outlines inward by."""
MAX_FREE_BODIES = 50
"""In larger assemblies no period is looked for."""
MAX_TURNS = 4.2
"""The search goes on up to this many turns where the first one leads to no congruent state."""
MAX_STATES = 6
"""At most this many congruent states are steered to, the nearest to the path first."""
STEPS_BETWEEN = 8
"""Places between two points of the path at which congruent states are looked for."""
FIRST_STATES = 6
"""At most this many points of the path are tried as the beginning of a period, rest first."""
FURTHER = 3.0
"""The turns of a path that ends early are looked at up to this multiple of them."""
MAX_STEERING = 25.0
"""Congruent states further from the path than this multiple of the clearance are left alone."""
ARRIVAL = 0.3
"""A state this share of the clearance away is reached by a straight piece; the audit judges it."""
MIN_TURN = 0.3
"""Gears are looked at more closely where one that is asked for turns by this share of its pitch."""
PLACES_IN_A_TURN = 64
"""Waypoints of a turn in place."""


@dataclass(frozen=True, eq=False)
class PeriodicMotion:
    """A path from rest whose last stretch can be repeated without end.

    Parameters
    ----------
    motions : (k, n, 3) float64 [mm, mm, rad]
        Waypoints of the bodies, from rest to one period on.
    waypoints : (k, parts, 3) float64 [mm, mm, rad]
        The same of the parts.
    first : int
        The waypoint at which the period begins.
    turn : (n,) float64 [rad]
        How far each body is turned in a period.
    gain : float
        Of the objective in a period.
    """

    motions: Floats
    waypoints: Floats
    first: int
    turn: Floats
    gain: float


def periodic_motion(search: LocalSearch, asked: tuple[Goal, ...]) -> tuple[LocalSearch, PeriodicMotion | None]:
    """A path that repeats and gains, near the one that was found; where a full turn gives none, some more turns are tried.

    Parameters
    ----------
    search : LocalSearch
        Ended; of the path to its best motion, what is certain is used.
    asked : tuple of goals
        What its objective is made of.

    Returns
    -------
    LocalSearch
        The same, or that which made more turns.
    PeriodicMotion or None
        None where none was found.
    """
    ready = search.ready
    free = ~ready.bodies.fixed
    weights = _turn_weights(search.objective, len(free))
    if search.best is None or not (weights[free] != 0).any() or free.sum() > MAX_FREE_BODIES:
        return search, None
    exact = SYMMETRY_TOLERANCE * ready.size
    orders = symmetry_orders(ready.bodies.shapes, exact)[ready.bodies.shape]
    found = _repeats(search, weights, orders) or _cover_repeats(search, asked, weights, orders, exact)
    if found is None and search.unlimited and search.best.solution.status is not SolverStatus.ESCAPING:
        search = _gone_on(search)
        found = _repeats(search, weights, orders)
    return search, found


def _cover_repeats(
    search: LocalSearch, asked: tuple[Goal, ...], weights: Floats, orders: Ints, exact: float
) -> PeriodicMotion | None:
    """A path that repeats of parts that are a little larger and more symmetric."""
    ready, best = search.ready, search.best
    cover = symmetric_cover(ready.assembly, ready.clearance, exact)
    if cover is None or best is None:
        return None
    orders = np.maximum(orders, [cover[1][members[0]] for members in ready.bodies.members])
    if (np.abs(best.motion[:, 2]) < MIN_TURN * 2 * np.pi / orders)[weights != 0].all():
        return None
    try:
        wider = prepare_as_drawn(cover[0], stop=search.stop)
    except (InputError, StoppedError):  # the cover touches
        return None
    climb = LocalSearch(wider, wider.objective(asked), search.solve, search.policy, search.stop, search.tell)
    climb.rounds = search.rounds
    climb.improve(start_at_rest(wider))
    found = _repeats(climb, weights, orders)
    search.rounds, search.iterations = climb.rounds, search.iterations + climb.iterations
    if found is None or not audit_path(ready.assembly, found.waypoints).free:
        return None
    return replace(found, motions=of_bodies(ready.assembly, ready.bodies, found.waypoints))


def _gone_on(search: LocalSearch) -> LocalSearch:
    """The search continued for more turns; the search as it was where that gains nothing."""
    further = replace(search, turn_limit=MAX_TURNS * 2 * np.pi, best=None, last=None, coming=None, checked=None)
    found = None if search.best is None else further.improve(search.best.start())
    search.rounds, search.iterations = further.rounds, further.iterations
    better = found is not None and found.value > search.certain_value()[0] and further.checked_path(found).sure
    return further if better else search


def _repeats(search: LocalSearch, weights: Floats, orders: Ints) -> PeriodicMotion | None:
    """A path that repeats, of bodies with symmetries of some orders (n,)."""
    if search.best is None:
        return None
    checked = search.checked_path(search.best)
    if not checked.certain:
        return None
    step = 2 * np.pi / orders
    found = _in_place(search, checked, weights, step)
    if found is not None:
        return found
    count = sum(len(segment.points) for segment in checked.kept)
    for first in dict.fromkeys(np.linspace(0, count - 1, FIRST_STATES + 1).astype(int)[:-1].tolist()):
        for target in _congruent_states(search, checked, weights, step, first):
            if search.stopped:
                return None
            path = _steered(search, target)
            if path is not None:
                begin = int(np.abs(path - target.base).max(axis=(1, 2)).argmin())
                waypoints = of_parts(search.ready.assembly, search.ready.bodies, path)
                return PeriodicMotion(path, waypoints, begin, target.turn, float(weights @ target.turn))
    return None


@dataclass(frozen=True, eq=False)
class _CongruentState:
    """A state of the path with every body turned by a symmetry.

    Its motion is that of `base` (n, 3) with `turn` (n,) added; steering towards it begins at the end of `segments`, at some `distance`.
    """

    base: Floats
    turn: Floats
    segments: tuple[PathSegment, ...]
    distance: float

    @property
    def motion(self) -> Floats:
        """Motion (n, 3) [mm, mm, rad]."""
        return self.base + np.column_stack([np.zeros((len(self.turn), 2)), self.turn])


def _turn_weights(objective: Objective, n: int) -> Floats:
    """What an objective gains (n,) per turn [rad] of each body, in the long run."""
    out = np.zeros(n)
    for term in objective.terms if isinstance(objective, Sum) else (objective,):
        if isinstance(term, PointMotion):
            np.add.at(out, term.body, term.turn)
    return out


def _in_place(search: LocalSearch, path: CheckedPath, weights: Floats, step: Floats) -> PeriodicMotion | None:
    """Bodies that turn alone, at rest or at the end."""
    ready = search.ready
    asked = np.flatnonzero((weights != 0) & ~ready.bodies.fixed)
    way = path.motions()
    for first in dict.fromkeys((0, path.certain - 1)):
        state = way[first]
        for body in asked.tolist():
            for angle, turning in _turns_alone(ready, state, body, float(np.sign(weights[body]) * step[body])):
                begin = first + int((turning[0] != state).any())
                motions = np.concatenate([way[:begin], turning])
                waypoints = of_parts(ready.assembly, ready.bodies, motions)
                if audit_path(ready.assembly, waypoints[first:]).free:
                    turn = np.zeros(len(weights))
                    turn[body] = angle
                    return PeriodicMotion(motions, waypoints, begin, turn, float(weights @ turn))
    return None


def _turns_alone(ready: Prepared, state: Floats, body: int, step: float) -> Iterator[tuple[float, Floats]]:
    """Motions (k, n, 3) in which a body turns alone from a state (n, 3), and by how much [rad].

    By a step of its symmetry about its centroid; once round about the middle of a round outline or bore, which is put where it was at rest.
    """
    whole = float(np.copysign(2 * np.pi, step))
    for angle, middle in ((step, None), *((whole, middle) for middle in round_middles(ready, body))):
        count = max(4, int(np.ceil(PLACES_IN_A_TURN * abs(angle) / (2 * np.pi))))
        turns = state[body, 2] + angle * np.arange(count + 1) / count
        turning = np.repeat(state[None], count + 1, axis=0)
        if middle is None:
            turning[:, body, 2] = turns
        else:
            turning[:, body] = turned_about(ready, body, middle, turns)[:, body]
        yield angle, turning


def _congruent_states(
    search: LocalSearch, path: CheckedPath, weights: Floats, step: Floats, first: int
) -> Iterator[_CongruentState]:
    """States congruent to point `first` of the path, with a larger objective, that the path comes near to later.

    Of those that are nearly as near as the nearest, the one of the shortest period comes first.
    """
    bodies, clearance = search.ready.bodies, search.ready.clearance
    points = [(k, i) for k, segment in enumerate(path.kept) for i in range(len(segment.points))]
    motions = np.array([path.kept[k].program.motion(path.kept[k].points[i]) for k, i in points])
    free, base = ~bodies.fixed, motions[first]
    share = np.arange(STEPS_BETWEEN)[:, None, None] / STEPS_BETWEEN
    found: dict[tuple[int, ...], _CongruentState] = {}
    for at in range(first, len(motions)):
        if at < len(motions) - 1:
            change = motions[at] + share * (motions[at + 1] - motions[at]) - base
        else:  # the path gone on with, middles as at its beginning
            change = (1 + (FURTHER - 1) * share) * (motions[at] - base) * (0, 0, 1)
        count = np.where(free, np.round(change[:, :, 2] / step), 0.0)
        change[:, :, 2] -= count * step
        away = np.hypot(change[..., 0], change[..., 1]) + bodies.radius * np.abs(change[..., 2])
        distance = away[:, free].max(axis=1)
        for j in np.flatnonzero((count * step @ weights > 0) & (distance < MAX_STEERING * clearance)):
            key = tuple(count[j].astype(int).tolist())
            if key in found and found[key].distance <= distance[j]:
                continue
            k, i = points[min(at + int(2 * j >= STEPS_BETWEEN), len(points) - 2)]  # the last one touches
            segments = (*path.kept[:k], PathSegment(path.kept[k].program, path.kept[k].points[: i + 1]))
            found[key] = _CongruentState(base, count[j] * step, segments, float(distance[j]))
    if found:
        near = max(2 * min(state.distance for state in found.values()), 4 * clearance)
        order = sorted(found.values(), key=lambda s: (max(s.distance, near), float(weights @ s.turn)))
        yield from order[:MAX_STATES]


def _steered(search: LocalSearch, target: _CongruentState) -> Floats | None:
    """Waypoints (k, n, 3) of the way to a congruent state; None where it is not reached."""
    ready, bodies = search.ready, search.ready.bodies
    goal = _approach(search, target.motion)
    segment = target.segments[-1]
    begin = segment.program.motion(segment.points[-1])
    goal = replace(goal, zero=goal.value(begin))
    climb = LocalSearch(ready, goal, search.solve, CLIMB, search.stop, search.tell, rounds=search.rounds)
    found = climb.improve(Start(segment.program.cells, begin, target.segments))
    search.rounds, search.iterations = climb.rounds, search.iterations + climb.iterations
    for stage, spent in climb.seconds.items():
        search.seconds[stage] += spent
    if found is None:
        return None
    left = found.motion - target.motion
    away = np.hypot(left[:, 0], left[:, 1]) + bodies.radius * np.abs(left[:, 2])
    if away.max() > ARRIVAL * ready.clearance:
        return None
    arrival = PathSegment(found.program, (found.solution.u, found.program.variables(target.motion)))
    path = check_path(ready, (*found.path, arrival), search.stop)
    if not path.sure:
        return None
    return np.concatenate([path.motions()[:-1], target.motion[None]])  # without the rounding of the program's units


def _approach(search: LocalSearch, target: Floats) -> Approach:
    """Squared distances from a state: of two points of every free body, at its radius."""
    bodies = search.ready.bodies
    body = np.repeat(np.flatnonzero(~bodies.fixed), 2)
    arm = np.zeros((len(body), 2))
    arm[::2, 0] = arm[1::2, 1] = bodies.radius[body[::2]]
    points = Points(body, arm)
    return Approach(points, -points.moved(target), np.ones(len(body)))


MAX_ASYMMETRY = 0.01
"""Images of an outline that differ from it by less than this share of the clearance are covered."""
MAX_BORE_LOSS = 0.05
"""Share of the clearance that a bore may lose besides."""
MAX_BORE_CORNERS = 400
"""Corners that a bore made round may have, but for what its symmetry needs."""
MIN_ROUNDNESS = 0.8
"""A hole is a bore where the largest circle in it about the middle has this share of its radius."""


def symmetric_cover(assembly: Assembly, clearance: float, exact: float) -> tuple[Assembly, tuple[int, ...]] | None:
    """The assembly with free parts covered by more symmetric ones, and the order of the symmetry of every part.

    Parameters
    ----------
    assembly : Assembly
    clearance : float [mm]
        Typical clearance between neighbours.
    exact : float [mm]
        Differences that count as none.

    Returns
    -------
    Assembly and orders, or None
        None where no free part is symmetric but for its holes and some digits. Between each part and its cover lies an outline of
        exactly this symmetry about the cover's centroid: the union of the part's images, with the cover's holes.
    """
    glued = {name for names in assembly.drawing.glue for name in names}
    covers = [
        (part, 1) if part.fixed or part.name in glued or len(part.regions) > 1 else _cover(part, clearance, exact)
        for part in assembly.parts
    ]
    if all(order == 1 for _, order in covers):
        return None
    parts = tuple(cover for cover, _ in covers)
    return replace(assembly, parts=parts), tuple(order for _, order in covers)


def _cover(part: Part, clearance: float, exact: float) -> tuple[Part, int]:
    """A part's cover and its order; the part itself and 1 where it has none that is more symmetric."""
    region, allowed = part.regions[0], MAX_ASYMMETRY * clearance
    outer = region.outer
    order = _order(outer, allowed)
    if order == 1:
        return part, 1
    if _order(outer, exact) != order:
        outer = _grown(outer, 2 * allowed)
        if _order(region.outer, 2 * allowed, _middle(outer)) % order:
            return part, 1
    middle = _middle(outer)
    bores = (_bore(hole, middle, order, clearance) for hole in region.holes)
    return replace(part, regions=(Region(outer, tuple(bore for bore in bores if bore is not None)),)), order


def _middle(ring: Floats) -> Floats:
    return np.array(shapely.Polygon(ring).centroid.coords[0])


def _order(ring: Floats, tolerance: float, middle: Floats | None = None) -> int:
    """Order of the symmetry of a ring about a point, by default its centroid."""
    after = np.roll(np.arange(len(ring)), -1)
    return symmetry_order(ring - (_middle(ring) if middle is None else middle), after, tolerance)


def _bore(hole: Floats, middle: Floats, order: int, clearance: float) -> Floats | None:
    """A regular polygon in a hole (m, 2), clockwise; None where the hole is not round about the middle: it is filled."""
    ring = shapely.Polygon(hole)
    radius = shapely.distance(ring.exterior, shapely.Point(middle))
    if not shapely.contains_xy(ring, *middle) or radius < MIN_ROUNDNESS * np.hypot(*(hole - middle).T).max():
        return None
    least = np.pi / np.sqrt(2 * MAX_BORE_LOSS * clearance / radius)
    count = order * int(np.ceil(max(least, 12) / order))
    if count > max(MAX_BORE_CORNERS, order):
        return None
    angle = -2 * np.pi * np.arange(count) / count
    return np.asarray(middle + radius * np.column_stack([np.cos(angle), np.sin(angle)]))


def _grown(ring: Floats, outward: float) -> Floats:
    """An outline further out, with mitred corners."""
    wider = shapely.buffer(shapely.Polygon(ring), outward, join_style="mitre", mitre_limit=100.0)
    return np.asarray(shapely.orient_polygons(wider).exterior.coords)[:-1]
