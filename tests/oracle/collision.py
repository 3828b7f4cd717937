"""Exact collision test of two polygons for very many relative motions.

B is placed as R(phi) B + D + tau in A's frame. Two polygons overlap where a pair of edges crosses properly, or where
one holds a corner of the other. The depth of an overlap is the deepest such corner's distance to the other's boundary
(a lower bound of the move that would part them); a crossing with no corner inside counts the common piece's width.
"""

from __future__ import annotations

import numba
import numpy as np
import shapely

from .geometry import turn

Edges = np.ndarray  # (n, 4): x0, y0, x1, y1
NEAR = 1e-7  # crossings shallower than this at the corners are measured by their common piece too
AT_ONCE = 2000  # of these


def edges_of(polygon: shapely.Polygon) -> Edges:
    """Edges (n, 4) of all rings."""
    rings = [shapely.get_coordinates(r) for r in (polygon.exterior, *polygon.interiors)]
    return np.concatenate([np.hstack([r[:-1], r[1:]]) for r in rings])


@numba.njit(cache=True)
def _inside(x: float, y: float, edges: np.ndarray) -> bool:
    """Even-odd rule."""
    odd = False
    for x0, y0, x1, y1 in edges:
        if (y0 > y) != (y1 > y) and x < x0 + (y - y0) * (x1 - x0) / (y1 - y0):
            odd = not odd
    return odd


@numba.njit(cache=True)
def _distance(x: float, y: float, edges: np.ndarray) -> float:
    """From a point to the nearest edge."""
    best = np.inf
    for x0, y0, x1, y1 in edges:
        ex, ey = x1 - x0, y1 - y0
        t = ((x - x0) * ex + (y - y0) * ey) / (ex * ex + ey * ey)
        t = min(max(t, 0.0), 1.0)
        dx, dy = x - x0 - t * ex, y - y0 - t * ey
        best = min(best, dx * dx + dy * dy)
    return np.sqrt(best)


@numba.njit(cache=True)
def _crosses(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether any edge of `a` properly crosses any edge of `b`."""
    for bx0, by0, bx1, by1 in b:
        low_x, high_x = min(bx0, bx1), max(bx0, bx1)
        low_y, high_y = min(by0, by1), max(by0, by1)
        bx, by = bx1 - bx0, by1 - by0
        for ax0, ay0, ax1, ay1 in a:
            if max(ax0, ax1) < low_x or min(ax0, ax1) > high_x or max(ay0, ay1) < low_y or min(ay0, ay1) > high_y:
                continue
            s0 = bx * (ay0 - by0) - by * (ax0 - bx0)
            s1 = bx * (ay1 - by0) - by * (ax1 - bx0)
            if (s0 > 0) == (s1 > 0) or s0 == 0 or s1 == 0:
                continue
            ax, ay = ax1 - ax0, ay1 - ay0
            t0 = ax * (by0 - ay0) - ay * (bx0 - ax0)
            t1 = ax * (by1 - ay0) - ay * (bx1 - ax0)
            if (t0 > 0) != (t1 > 0) and t0 != 0 and t1 != 0:
                return True
    return False


@numba.njit(cache=True)
def _deepest(corners: np.ndarray, edges: np.ndarray) -> float:
    """How far the deepest of the corners lies inside; 0 where none does."""
    deepest = 0.0
    for i in range(len(corners)):
        if _inside(corners[i, 0], corners[i, 1], edges):
            deepest = max(deepest, _distance(corners[i, 0], corners[i, 1], edges))
    return deepest


@numba.njit(cache=True)
def _scan(
    a: np.ndarray, b: np.ndarray, d: np.ndarray, samples: np.ndarray, deep: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Whether edges cross, and the depth of corners, for every sample (k, 3); a crossing-free pair needs one corner.

    Unless `deep`, the depths of those that cross stay zero.
    """
    crossing = np.zeros(len(samples), dtype=np.bool_)
    depth = np.zeros(len(samples))
    placed = np.empty_like(b)
    for k in range(len(samples)):
        c, s = np.cos(samples[k, 2]), np.sin(samples[k, 2])
        x, y = d[0] + samples[k, 0], d[1] + samples[k, 1]
        for j in range(len(b)):
            for i in (0, 2):
                placed[j, i] = c * b[j, i] - s * b[j, i + 1] + x
                placed[j, i + 1] = s * b[j, i] + c * b[j, i + 1] + y
        crossing[k] = _crosses(a, placed)
        if crossing[k] and not deep:
            continue
        if crossing[k] or _inside(placed[0, 0], placed[0, 1], a) or _inside(a[0, 0], a[0, 1], placed):
            depth[k] = max(_deepest(placed, a), _deepest(a, placed))
    return crossing, depth


def _scanned(
    A: shapely.Polygon, B: shapely.Polygon, relative: np.ndarray, D: np.ndarray, deep: bool
) -> tuple[np.ndarray, ...]:
    samples = np.ascontiguousarray(np.atleast_2d(relative), dtype=float)
    return _scan(edges_of(A), edges_of(B), np.asarray(D, dtype=float), samples, deep)


def overlaps(A: shapely.Polygon, B: shapely.Polygon, relative: np.ndarray, D: np.ndarray) -> np.ndarray:
    """Whether the interiors meet, (k,) bool, for relative motions (k, 3); contact within rounding may go either way."""
    crossing, depth = _scanned(A, B, relative, D, deep=False)
    return crossing | (depth > 0)


def depths(A: shapely.Polygon, B: shapely.Polygon, relative: np.ndarray, D: np.ndarray) -> np.ndarray:
    """Depth (k,) of the overlap [length] for relative motions (k, 3); 0 where there is none."""
    samples = np.atleast_2d(relative)
    crossing, depth = _scanned(A, B, samples, D, deep=True)
    near = np.flatnonzero(crossing & (depth < NEAR))
    for some in np.array_split(near, len(near) // AT_ONCE + 1):
        depth[some] = np.maximum(depth[some], _common_widths(A, B, samples[some], D))
    return depth


def free(A: shapely.Polygon, B: shapely.Polygon, D: np.ndarray, samples: np.ndarray, tol: float) -> np.ndarray:
    """Which relative motions (k, 3) overlap by no more than `tol` [length], (k,) bool."""
    return depths(A, B, samples, D) <= tol


def _common_widths(A: shapely.Polygon, B: shapely.Polygon, relative: np.ndarray, D: np.ndarray) -> np.ndarray:
    """Width (k,) of the widest piece that both cover, for relative motions (k, 3)."""
    widths = np.zeros(len(relative))
    if not len(relative):
        return widths
    turns = np.array([turn(phi) for phi in relative[:, 2]])
    moves = (D + relative[:, :2])[:, None]
    shell, *holes = (
        shapely.linearrings(shapely.get_coordinates(ring) @ turns.transpose(0, 2, 1) + moves)
        for ring in (B.exterior, *B.interiors)
    )
    placed = shapely.polygons(shell, holes=np.stack(holes, axis=1) if holes else None)
    pieces, of = shapely.get_parts(shapely.intersection(A, placed), return_index=True)
    area = shapely.area(pieces)
    solid = area > 0
    np.maximum.at(widths, of[solid], 2 * area[solid] / shapely.length(pieces[solid]))
    return widths


def pose_depth(parts: list[list[shapely.Polygon]], at: np.ndarray, motion: np.ndarray) -> float:
    """Deepest overlap of any two parts after `motion` (n, 3) about their reference points `at` (n, 2).

    Outlines are given where they lie at rest; a part may have several.
    """
    worst = 0.0
    for i in range(len(parts)):
        for j in range(i + 1, len(parts)):
            relative = relative_motion(at[i], at[j], motion[i], motion[j])
            for p in parts[i]:
                for q in parts[j]:
                    local = [shapely.transform(r, lambda c, o=o: c - o) for r, o in ((p, at[i]), (q, at[j]))]
                    worst = max(worst, float(depths(local[0], local[1], relative, at[j] - at[i])[0]))
    return worst


def relative_motion(at_a: np.ndarray, at_b: np.ndarray, move_a: np.ndarray, move_b: np.ndarray) -> np.ndarray:
    """(tau_x, tau_y, phi) of B in A's frame against rest; motions (..., 3) about the reference points."""
    apart = np.asarray(at_b) - at_a
    moved = apart + move_b[..., :2] - move_a[..., :2]
    c, s = np.cos(move_a[..., 2]), np.sin(move_a[..., 2])
    tau = np.stack([c * moved[..., 0] + s * moved[..., 1], -s * moved[..., 0] + c * moved[..., 1]], axis=-1) - apart
    return np.concatenate([tau, (move_b[..., 2] - move_a[..., 2])[..., None]], axis=-1)
