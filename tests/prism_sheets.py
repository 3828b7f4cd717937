"""Cutting sheets of boxes with walls on the edges of a convex polygon."""

from __future__ import annotations

import numpy as np
import shapely
from benchmarks.sheet_drawings import Design

Floats = np.ndarray


def regular(sides: int, apothem: float) -> Floats:
    turns = 0.3 + 2 * np.pi * np.arange(sides) / sides
    return apothem / np.cos(np.pi / sides) * np.column_stack([np.cos(turns), np.sin(turns)])


def turning(corners: Floats) -> list[float]:
    """By how much the edges of a convex polygon turn at every corner [rad]."""
    along = np.roll(corners, -1, axis=0) - corners
    along = along / np.hypot(*along.T)[:, None]
    return [float(np.arccos(along[k - 1] @ along[k])) for k in range(len(corners))]


def prism(
    corners: Floats, high: float, t: float, *, lid: bool = False, rows: tuple[int, ...] = (9,), shift: float = 0.0
) -> Design:
    """Upright walls on the edges of a convex polygon, outer faces on it; where edges turn by a, fingers are t sin a long.

    Parameters
    ----------
    corners : (n, 2) float64 [mm]
        Anticlockwise.
    rows : tuple of int
        Stretches of the finger rows at the corners, one after the other and again.
    shift : float [mm]
        Of the tabs from the middle of every wall.
    """
    turn, along = turning(corners), np.roll(corners, -1, axis=0) - corners
    top = high - t if lid else high
    walls, floor, joined = {}, shapely.Polygon(corners), set()
    for k, (corner, edge) in enumerate(zip(corners, along, strict=True)):
        long = float(np.hypot(*edge))
        wall, x = shapely.box(0, t, long, top), edge / long
        inward = np.array([-x[1], x[0]])
        for middle in (long / 3 + shift, 2 * long / 3 + shift):
            for low in (0.0, top)[: 1 + lid]:
                wall = wall.union(shapely.box(middle - 3, low, middle + 3, low + t))
            a, b = corner + x * (middle - 3), corner + x * (middle + 3)
            floor = floor.difference(shapely.Polygon([a - inward, b - inward, b + inward * t, a + inward * t]))
        for end, odd in ((k, 0), ((k + 1) % len(corners), 1)):
            deep, edges = t * np.sin(turn[end]), np.linspace(t, top, rows[end % len(rows)] + 1)
            left, right = (-1.0, deep) if end == k else (long - deep, long + 1)
            gone = [shapely.box(left, edges[i], right, edges[i + 1]) for i in range(odd, len(edges) - 1, 2)]
            wall = wall.difference(shapely.union_all(gone))
        walls[f"wall {k}"] = wall
        joined |= {frozenset({f"wall {k}", f"wall {(k + 1) % len(corners)}"}), frozenset({f"wall {k}", "floor"})}
        joined |= {frozenset({f"wall {k}", "lid"})} if lid else set()
    return Design("prism", t, {"floor": floor} | walls | ({"lid": floor} if lid else {}), joined, (0.0, 0.0, high))
