"""The way from rest: way-points close enough together that nothing can overlap between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.neighbours import placed, relative_rest
from wiggleroom.program import contact_functions as kernel
from wiggleroom.program.nonlinear_program import Program
from wiggleroom.program.retraction import Retraction
from wiggleroom.solve.factorisation import Factor, factor

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MOST_SPLITS = 12
"""A piece of the way is halved at most this often."""
BY_DISTANCE = 3
"""After so many halvings, pairs whose rows are in doubt are measured too: walls say little about parts that are far apart."""
ASIDE = 0.25
"""Share of the clearance by which straight motion of a reference point may leave straight motion of its body."""


@dataclass(frozen=True, eq=False)
class Way:
    """A way from rest.

    Parameters
    ----------
    motions : (k, n, 3) float64 [mm, mm, rad]
        Way-points; between them every body moves straight, or the reference point of each of its parts does.
    certain : int
        Up to so many way-points no pair of the programs overlaps anywhere.
    strangers : (p,) and (p,) int64
        Pairs of bodies outside the last program that may meet on it.
    """

    motions: Floats
    certain: int
    strangers: tuple[Ints, Ints]

    @property
    def sure(self) -> bool:
        """True where nothing overlaps anywhere along the way."""
        return self.certain == len(self.motions) and not len(self.strangers[0])


def whole_way(
    bodies: Bodies,
    arm: Floats,
    legs: list[tuple[Program, tuple[Floats, ...]]],
    known: Ints,
    barred: Ints,
    slack: float,
) -> Way:
    """Check a way that consists of legs, each inside the cells of one program.

    Parameters
    ----------
    bodies : Bodies
    arm : (n,) float64 [mm]
        How far the reference points of each body's parts lie from its own.
    legs : list of (program, points)
    known, barred : (m,) int64
        Keys a * n + b of the pairs that the program holds, and of those that never collide.
    slack : float [mm]
        Violation that counts as none.
    """
    motions = [legs[0][0].motion(legs[0][1][0])]
    certain = 1
    for program, points in legs:
        refined, good = checked_way(program, Retraction(program), points, arm, slack)
        if certain == len(motions):
            certain += good - 1
        motions += [program.motion(p) for p in refined[1:]]
    aside = ASIDE * legs[-1][0].length
    way = _denser(np.array(motions), arm, aside)
    certain = len(way) if certain == len(motions) else len(_denser(np.array(motions[:certain]), arm, aside))
    return Way(way, certain, strangers(bodies, arm, way, known, barred))


def _denser(motions: Floats, arm: Floats, aside: float) -> Floats:
    """The same straight pieces, cut until no reference point leaves straight motion of its body by more than `aside` [mm]."""
    turn = np.abs(np.diff(motions[:, :, 2], axis=0))
    pieces = np.ceil(np.sqrt((arm * turn**2).max(axis=1, initial=0.0) / (8 * aside))).astype(int)
    out = [motions[:1]]
    for k, count in enumerate(np.maximum(pieces, 1)):
        share = np.arange(1, count + 1)[:, None, None] / count
        out.append(motions[k] + share * (motions[k + 1] - motions[k]))
    return np.concatenate(out)


def checked_way(
    program: Program, retraction: Retraction, points: tuple[Floats, ...], arm: Floats, slack: float
) -> tuple[list[Floats], int]:
    """Refine a way until straight motion between its points certainly stays free of overlap for all pairs of the program.

    Parameters
    ----------
    program : Program
    retraction : Retraction
    points : tuple of (3F,) float64
        Way-points in scaled variables.
    arm : (n,) float64 [mm]
        How far the reference points of each body's parts lie from its own.
    slack : float [mm]
        Violation that counts as none.

    Returns
    -------
    points : list of (3F,) float64
        The way with the points that were needed in between.
    certain : int
        So many of them are certainly reached: all, but where halving did not help.
    """
    rows = [program.values(u) * program.length for u in points]
    out, certain, sure = [points[0]], 1, True
    matrix: Factor | None = None
    todo = [(points[k], rows[k], points[k + 1], rows[k + 1], 0) for k in range(len(points) - 1)][::-1]
    while todo:
        u, at_u, v, at_v, depth = todo.pop()
        low = np.flatnonzero(_least(at_u, at_v, _curvature(program, arm, u, v)) < -slack)
        if len(low) and not (depth >= BY_DISTANCE and _apart(program, arm, u, v, low)):
            if depth < MOST_SPLITS and sure:
                matrix = matrix or factor(program.pattern)
                held = np.minimum(at_u, at_v) > 0  # other pairs are far apart, behind their walls
                middle = _middle(program, retraction, matrix, u, v, held * (at_u + at_v) / (2 * program.length))
                between = program.values(middle) * program.length
                todo += [(middle, between, v, at_v, depth + 1), (u, at_u, middle, between, depth + 1)]
                continue
            sure = False
        out.append(v)
        certain += sure
    return out, certain


def _middle(program: Program, retraction: Retraction, matrix: Factor, u: Floats, v: Floats, target: Floats) -> Floats:
    """A point half way between two, moved until its rows are about `target` (R,), the mean of theirs, where they fell behind.

    Rows whose target is 0 are left alone.

    """
    middle = retraction.between(u, v)
    weight = np.where(target > 0, 1.0 / np.maximum(target, 1e-12) ** 2, 0.0)
    for _ in range(10):
        at = program.linearise(middle)
        short = np.where(target > 0, np.maximum(target - at.h, 0.0), 0.0)
        if (short <= target / 2).all():
            break
        shift = 1e-6
        while not matrix.update(at.condensed(weight, np.zeros_like(weight), share=0.0), shift):
            shift *= 100
        middle = retraction.step(middle, matrix.solve(at.against(weight * short)), at)
    return middle


def _apart(program: Program, arm: Floats, u: Floats, v: Floats, rows: Ints) -> bool:
    """True where the pairs of some rows do not meet on the straight piece from u to v, by their distance at its ends."""
    cells, bodies = program.cells, program.bodies
    pairs = np.unique(cells.pair[rows])
    a, b, one, other = cells.a[pairs], cells.b[pairs], program.motion(u), program.motion(v)
    room = _distance(bodies, one, a, b) + _distance(bodies, other, a, b)
    return bool((room > _passing(bodies, arm, np.array([one, other]), a, b)).all())


def _least(one: Floats, other: Floats, curvature: Floats) -> Floats:
    """Least value [mm] that each row can take between its values at both ends, for a given bound of its second derivative."""
    drop = other - one
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.where(curvature > 0, 0.5 - drop / curvature, 0.0)
    t = np.clip(t, 0.0, 1.0)
    inside = one + t * drop - curvature / 2 * t * (1 - t)
    return np.minimum(inside, np.minimum(one, other))


def _curvature(program: Program, arm: Floats, u: Floats, v: Floats) -> Floats:
    """Bound (R,) [mm] of every row's second derivative along the straight piece from u to v."""
    cells, bodies = program.cells, program.bodies
    bound = _acceleration(bodies, arm, cells.a, cells.b, program.motion(u), program.motion(v))
    return np.repeat(bound, np.diff(cells.row)) * (program.kind <= kernel.B_EDGE)


def _acceleration(bodies: Bodies, arm: Floats, a: Ints, b: Ints, one: Floats, other: Floats) -> Floats:
    """Bound (p,) [mm] of the acceleration of any corner of either body, seen from the other, on a straight piece run in unit time.

    Seen from a body that turns by t, a point at distance r that is carried past by c accelerates by at most r t^2 + 2 c t. Where a point
    at distance r from a body's own moves straight instead, the body's own accelerates by at most r t^2.
    """
    change = other - one
    turn = np.abs(change[a, 2]) + np.abs(change[b, 2])
    swing = arm[a] * change[a, 2] ** 2 + arm[b] * change[b, 2] ** 2
    carry = np.hypot(*(change[b] - change[a])[:, :2].T) + swing / 2
    place = bodies.rest[:, :2] + one[:, :2]
    far = np.hypot(*(place[b] - place[a]).T) + carry + bodies.radius[a] + bodies.radius[b]
    return far * turn**2 + 2 * carry * turn + swing


def strangers(bodies: Bodies, arm: Floats, motions: Floats, known: Ints, barred: Ints) -> tuple[Ints, Ints]:
    """Pairs outside the program that cannot be shown to stay apart along straight motion between way-points.

    Between two way-points no corner of B moves further past A than the relative shift plus radius times turn; where that is less than the
    distances at both ends together, the pair does not meet.

    Parameters
    ----------
    bodies : Bodies
    arm : (n,) float64 [mm]
        How far the reference points of each body's parts lie from its own.
    motions : (k, n, 3) float64 [mm, mm, rad]
    known, barred : (m,) int64
        Keys a * n + b of the pairs that the program holds, and of those that never collide.

    Returns
    -------
    a, b : (p,) int64
        Bodies that may meet.
    """
    n = len(bodies.fixed)
    seen = np.concatenate([known, barred])
    step = np.diff(motions, axis=0)
    swing = arm * step[:, :, 2] ** 2
    travel = np.hypot(step[:, :, 0], step[:, :, 1]) + bodies.radius * np.abs(step[:, :, 2]) + swing
    found: list[Ints] = []
    k = 0
    while k < len(step):
        # as many pieces at once as keep every body within half a radius of where it is now
        reach = np.cumsum(travel[k:], axis=0)
        many = max(1, int((reach.max(axis=1) < 0.5 * np.median(bodies.radius)).sum()))
        moved = reach[many - 1]
        middle = (bodies.rest + motions[k])[:, :2]
        swept = _squares(middle, bodies.radius + moved)
        a, b = shapely.STRtree(swept).query(swept)
        keep = (a < b) & ~(bodies.fixed[a] & bodies.fixed[b]) & ~np.isin(a * n + b, seen)
        a, b = a[keep], b[keep]
        passing = _passing(bodies, arm, motions[k : k + many + 1], a, b)
        near = np.hypot(*(middle[b] - middle[a]).T) - bodies.radius[a] - bodies.radius[b] <= passing
        a, b, passing = a[near], b[near], passing[near]
        near = _distance(bodies, motions[k], a, b) <= passing
        a, b = a[near], b[near]
        for piece in range(k, k + many):
            if len(a):
                a, b = _uncertain(bodies, motions[piece], motions[piece + 1], a, b, swing[piece] / 8, found)
        k += many
    keys = np.unique(np.concatenate(found)) if found else np.zeros(0, dtype=np.int64)
    return keys // n, keys % n


def _uncertain(
    bodies: Bodies, one: Floats, other: Floats, a: Ints, b: Ints, aside: Floats, found: list[Ints], depth: int = 0
) -> tuple[Ints, Ints]:
    """Note in `found` the pairs that may meet on one piece, halving it where needed; returns the others.

    `aside` (n,) [mm] is how far each body may be beside straight motion.
    """
    n = len(bodies.fixed)
    room = _distance(bodies, one, a, b) + _distance(bodies, other, a, b) - 2 * (aside[a] + aside[b])
    doubt = room <= _passing(bodies, np.zeros(n), np.array([one, other]), a, b)
    x, y = a[doubt], b[doubt]
    if len(x) and depth < MOST_SPLITS:
        middle = (one + other) / 2
        x, y = _uncertain(bodies, one, middle, x, y, aside, found, depth + 1)
        x, y = _uncertain(bodies, middle, other, x, y, aside, found, depth + 1)
    else:
        found.append(x * n + y)
        x, y = x[:0], y[:0]
    return np.concatenate([a[~doubt], x]), np.concatenate([b[~doubt], y])


def _distance(bodies: Bodies, motion: Floats, a: Ints, b: Ints) -> Floats:
    geometry = placed(bodies, motion, np.unique(np.concatenate([a, b])))
    return shapely.distance(geometry[a], geometry[b])


def _passing(bodies: Bodies, arm: Floats, motions: Floats, a: Ints, b: Ints) -> Floats:
    """How long the way of any corner of B past A can be (p,) [mm], summed over the pieces between way-points."""
    total = np.zeros(len(a))
    before = relative_rest(bodies, a, b, motions[0])
    for k in range(1, len(motions)):
        after = relative_rest(bodies, a, b, motions[k])
        change = after - before
        total += np.hypot(change[:, 0], change[:, 1]) + bodies.radius[b] * np.abs(change[:, 2])
        # speed differs from its mean by at most half of it
        total += _acceleration(bodies, arm, a, b, motions[k - 1], motions[k]) / 2
        before = after
    return total


def _squares(middle: Floats, half: Floats) -> NDArray[np.object_]:
    """Squares round points (n, 2), `half` (n,) [mm] to each side."""
    low, high = middle - half[:, None], middle + half[:, None]
    return shapely.box(*low.T, *high.T)
