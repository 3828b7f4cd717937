"""The way from rest: way-points close enough together that nothing can overlap between them."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.pairs.neighbours import placed
from wiggleroom.pairs.shapes import Bodies
from wiggleroom.program.build import Program
from wiggleroom.program.retract import Retraction

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MOST_SPLITS = 12
"""A piece of the way is halved at most this often."""


def checked_way(program: Program, retraction: Retraction, points: list[Floats], slack: float) -> tuple[list[Floats], bool]:
    """Refine a way until straight motion between its points certainly stays inside all rows of the program.

    Along a straight piece a row deviates from the chord through its end values by at most an eighth of its second derivative. A body's
    corner at distance r that turns by t and is carried past by v accelerates by at most r t^2 + 2 v t, in units of the piece's length.

    Parameters
    ----------
    program : Program
    retraction : Retraction
    points : list of (3F,) float64
        Way-points in scaled variables.
    slack : float [mm]
        Deviation that counts as none.

    Returns
    -------
    points : list of (3F,) float64
        The way with the points that were needed in between.
    sure : bool
        False where halving did not help.
    """
    out, sure = [points[0]], True
    todo = [(points[k], points[k + 1], 0) for k in range(len(points) - 1)][::-1]
    values: dict[int, Floats] = {}

    def rows(u: Floats) -> Floats:
        key = id(u)
        if key not in values:
            values[key] = program.values(u) * program.length
        return values[key]

    while todo:
        u, v, depth = todo.pop()
        room = np.minimum(rows(u), rows(v)) + slack
        if (room < _bend(program, u, v)).any():
            if depth < MOST_SPLITS:
                middle = retraction.between(u, v)
                todo += [(middle, v, depth + 1), (u, middle, depth + 1)]
                continue
            sure = False
        values.pop(id(u), None)
        out.append(v)
    return out, sure


def _bend(program: Program, u: Floats, v: Floats) -> Floats:
    """Largest deviation (R,) [mm] of every row from its chord along the straight piece from u to v."""
    P, cells = program, program.cells
    change = P.motion(v) - P.motion(u)
    da, db = change[cells.a], change[cells.b]
    turn = np.abs(da[:, 2]) + np.abs(db[:, 2])
    g, _ = P.relative(P.motion(u))
    far = np.hypot(g[:, 0], g[:, 1])
    carry = np.hypot(*(db - da)[:, :2].T)
    reach = P.bodies.radius[cells.a] + P.bodies.radius[cells.b] + far + carry
    bend = (reach * turn**2 + 2 * carry * turn) / 8
    return np.repeat(bend, np.diff(cells.row)) * (P.kind <= 1)


def strangers(bodies: Bodies, motions: list[Floats], known: Ints, barred: Ints) -> list[tuple[int, int, int]]:
    """Pairs outside the program that may meet along a way: (a, b, point before which they were certainly apart).

    No corner moves further between two way-points than its body's shift plus radius times turn, so a pair further apart than both move
    cannot meet in between.
    """
    n = len(bodies.fixed)
    found: dict[tuple[int, int], int] = {}
    seen = np.concatenate([known, barred])
    for k in range(len(motions) - 1):
        change = motions[k + 1] - motions[k]
        moved = np.hypot(*change[:, :2].T) + bodies.radius * np.abs(change[:, 2])
        if not moved.any():
            continue
        geometry = placed(bodies, motions[k])
        swept = _boxes(geometry, moved)
        a, b = shapely.STRtree(swept).query(swept)
        keep = (a < b) & ~(bodies.fixed[a] & bodies.fixed[b]) & ~np.isin(a * n + b, seen)
        a, b = a[keep], b[keep]
        near = shapely.distance(geometry[a], geometry[b]) <= moved[a] + moved[b]
        for i, j in zip(a[near], b[near], strict=True):
            found.setdefault((int(i), int(j)), k)
    return [(a, b, k) for (a, b), k in found.items()]


def _boxes(geometry: NDArray[np.object_], grow: Floats) -> NDArray[np.object_]:
    bounds = shapely.bounds(geometry)
    return shapely.box(bounds[:, 0] - grow, bounds[:, 1] - grow, bounds[:, 2] + grow, bounds[:, 3] + grow)
