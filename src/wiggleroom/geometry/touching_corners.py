"""Corners of bodies that touch edges of their neighbours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import NO_ALLOCATION, njit
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.row_kinds import A_EDGE

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class TouchingCorners:
    """Corners that touch an edge, of each of P pairs.

    Parameters
    ----------
    row : (P + 1,) int64
        Those of pair p are row[p] .. row[p + 1].
    kind, edge, corner : (R,) int64
        Edge and corner as rows of `BodyShapes`; kind A_EDGE or B_EDGE of `row_kinds`.
    place : (R,) float64
        Foot of the corner along the edge: 0 at its start, 1 at its end.
    d : (R, 3) float64
        Derivatives of the distances with respect to the relative pose (q, psi).
    """

    row: Ints
    kind: Ints
    edge: Ints
    corner: Ints
    place: Floats
    d: Floats


def touching_corners(bodies: Bodies, a: Ints, b: Ints, pose: Floats, distance: float, beyond: float) -> TouchingCorners:
    """Corners of pairs (P,) of bodies that touch edges at relative poses (P, 3): no further than `distance` [mm] before or behind them.

    Parameters
    ----------
    bodies : Bodies
    a, b : (P,) int64
    pose : (P, 3) float64 [mm, mm, rad]
    distance : float [mm]
    beyond : float
        How far beyond the ends of the edge a corner may lie, as a share of its length.
    """
    shapes, row = bodies.shapes, np.zeros(len(a) + 1, dtype=np.int64)
    table = shapes.first, shapes.corner, shapes.normal, shapes.length, distance, beyond
    who = pose, bodies.shape[a], bodies.shape[b]
    none = np.zeros((3, 0), dtype=np.int64), np.zeros((4, 0))
    list_touching(*who, *table, row, *none, False)
    found, values = np.empty((3, row[-1]), dtype=np.int64), np.empty((4, row[-1]))
    list_touching(*who, *table, row, found, values, True)
    kind, edge, corner = found
    return TouchingCorners(row, kind, edge, corner, values[0], values[1:].T)


@njit(**NO_ALLOCATION)
def list_touching(g, shape_a, shape_b, first, corner, normal, length, distance, beyond, row, found, values, fill):
    """Corners that touch edges at relative poses g (P, 3): counted into row (P + 1,), and listed where `fill`."""
    at = 0
    for p in range(len(shape_a)):
        row[p] = at
        c, s = np.cos(g[p, 2]), np.sin(g[p, 2])
        for kind in range(2):
            own, other = (shape_a[p], shape_b[p]) if kind == A_EDGE else (shape_b[p], shape_a[p])
            for v in range(first[other], first[other + 1]):
                dx, dy = corner[v, 0], corner[v, 1]
                if kind == A_EDGE:
                    x, y = c * dx - s * dy + g[p, 0], s * dx + c * dy + g[p, 1]
                    dx, dy = x - g[p, 0], y - g[p, 1]
                else:
                    dx, dy = dx - g[p, 0], dy - g[p, 1]
                    x, y = c * dx + s * dy, -s * dx + c * dy
                for e in range(first[own], first[own + 1]):
                    rx, ry = x - corner[e, 0], y - corner[e, 1]
                    if abs(normal[e, 0] * rx + normal[e, 1] * ry) > distance:
                        continue
                    place = (normal[e, 0] * ry - normal[e, 1] * rx) / length[e]
                    if abs(place - 0.5) > 0.5 + beyond:
                        continue
                    if fill:
                        nx, ny = normal[e, 0], normal[e, 1]
                        if kind != A_EDGE:
                            nx, ny = -(c * nx - s * ny), -(s * nx + c * ny)
                        found[0, at], found[1, at], found[2, at] = kind, e, v
                        values[0, at], values[1, at], values[2, at] = place, nx, ny
                        values[3, at] = ny * dx - nx * dy
                    at += 1
    row[len(shape_a)] = at
