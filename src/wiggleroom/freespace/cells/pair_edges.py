"""Compiled geometry of one pair: the outlines of both parts in one table, and what one part sees of the other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, njit
from wiggleroom.geometry.bodies import BodyShapes

EDGE = np.dtype(
    [
        ("x", "f8"), ("y", "f8"),  # where it begins [mm]
        ("nx", "f8"), ("ny", "f8"), ("off", "f8"),  # its line is where n . p = off, n the outward unit normal
        ("after", "i8"),  # the next edge of the ring
        ("seen_x", "f8"), ("seen_y", "f8"),  # where A sees it begin, from the pose looked from
    ],
    align=True,
)  # fmt: skip
"""An edge and the corner it begins at, in the frame of its part."""
RUN = np.dtype([("begin", "i8"), ("end", "i8"), ("x", "f8"), ("y", "f8"), ("radius", "f8")], align=True)
"""A run of consecutive edges and a disc round it [mm]."""


class EdgeTable(NamedTuple):
    """All shapes: edges (N,) EDGE and runs (C,) RUN; those of shape s are rows first[s] .. and run_first[s] .. ."""

    edges: np.ndarray
    runs: np.ndarray
    first: NDArray[np.int64]
    run_first: NDArray[np.int64]


class Pair(NamedTuple):
    """Both parts: edges of A, rows 0 .. na, then of B, rows na .. n; runs of A, rows 0 .. ra, then of B, rows ra .. r.

    Whose an edge is, its row says: `edge < na` is an edge of A, and a line of kind A_EDGE; the others are of B, and of kind B_EDGE.
    """

    edges: np.ndarray
    runs: np.ndarray
    na: int
    n: int
    ra: int
    r: int


class Pose(NamedTuple):
    """Relative pose of B in A's frame [mm, mm, rad], with the cosine and sine of the angle."""

    x: float
    y: float
    psi: float
    c: float
    s: float


def edge_table(shapes: BodyShapes) -> EdgeTable:
    """All shapes for compiled code."""
    edges, runs = np.zeros(len(shapes.corner), dtype=EDGE), np.zeros(len(shapes.run_disc), dtype=RUN)
    edges["x"], edges["y"] = shapes.corner.T
    edges["nx"], edges["ny"] = shapes.normal.T
    edges["off"] = shapes.normal[:, 0] * shapes.corner[:, 0] + shapes.normal[:, 1] * shapes.corner[:, 1]
    edges["after"] = shapes.after
    runs["begin"], runs["end"] = shapes.run[:-1], shapes.run[1:]
    runs["x"], runs["y"], runs["radius"] = shapes.run_disc.T
    return EdgeTable(edges, runs, shapes.first, shapes.run_first)


@njit(**COMPILED_CALLERS_ONLY)
def copy_shape(outlines, shape, edges, n, runs, r):
    """Copy a shape to rows n .. of a pair's edges and r .. of its runs; the rows after them."""
    first, run_first = outlines.first[shape], outlines.run_first[shape]
    shift = n - first
    for k in range(first, outlines.first[shape + 1]):
        edges[n] = outlines.edges[k]
        edges[n].after += shift
        n += 1
    for k in range(run_first, outlines.run_first[shape + 1]):
        runs[r] = outlines.runs[k]
        runs[r].begin += shift
        runs[r].end += shift
        r += 1
    return n, r


@njit(**COMPILED_CALLERS_ONLY)
def vector_length(x, y):
    """Length of a vector; the library's own, which guards against overflow, takes ten times as long."""
    return np.sqrt(x * x + y * y)


@njit(**COMPILED_CALLERS_ONLY)
def posed(x, y, psi):
    """Relative pose."""
    return Pose(x, y, psi, np.cos(psi), np.sin(psi))


@njit(**COMPILED_CALLERS_ONLY)
def corner_in_frame(pair, edge, v, pose):
    """Corner v of one part in the frame of the part that `edge` is of."""
    x, y, c, s = pair.edges[v].x, pair.edges[v].y, pose.c, pose.s
    if edge < pair.na:
        return c * x - s * y + pose.x, s * x + c * y + pose.y
    x, y = x - pose.x, y - pose.y
    return c * x + s * y, -s * x + c * y


@njit(**COMPILED_CALLERS_ONLY)
def wall_value(pair, edge, v, pose):
    """Wall value h: how far corner v is in front of the line of `edge`."""
    x, y = corner_in_frame(pair, edge, v, pose)
    e = pair.edges[edge]
    return e.nx * (x - e.x) + e.ny * (y - e.y)


@njit(**COMPILED_CALLERS_ONLY)
def edge_in_front(pair, edge, other, pose):
    """How far the whole edge `other` is in front of the line of `edge`."""
    return min(wall_value(pair, edge, other, pose), wall_value(pair, edge, pair.edges[other].after, pose))


@njit(**COMPILED_CALLERS_ONLY)
def normal_in_frame(pair, edge, psi):
    """Normal of the line of `edge` in the frame of the other part."""
    e, c, s = pair.edges[edge], np.cos(psi), np.sin(psi)
    if edge < pair.na:
        s = -s
    return c * e.nx - s * e.ny, s * e.nx + c * e.ny


@njit(**COMPILED_CALLERS_ONLY)
def orientation(a, b, p):
    """Positive where A sees corner p left of the line from corner a to b."""
    return (b.seen_x - a.seen_x) * (p.seen_y - a.seen_y) - (b.seen_y - a.seen_y) * (p.seen_x - a.seen_x)


@njit(**COMPILED_CALLERS_ONLY)
def squared_distance_to_edge(p, a, b):
    """Squared distance of corner p and the segment from corner a to b, as A sees them."""
    ux, uy = b.seen_x - a.seen_x, b.seen_y - a.seen_y
    px, py = p.seen_x - a.seen_x, p.seen_y - a.seen_y
    t = (px * ux + py * uy) / (ux * ux + uy * uy)
    t = min(1.0, max(0.0, t))
    ex, ey = px - t * ux, py - t * uy
    return ex * ex + ey * ey


@njit(**COMPILED_CALLERS_ONLY)
def squared_distance(pair, i, j):
    """Squared distance of two edges, as A sees them; 0 where they cross."""
    a, c = pair.edges[i], pair.edges[j]
    b, d = pair.edges[a.after], pair.edges[c.after]
    if orientation(a, b, c) * orientation(a, b, d) < 0.0 and orientation(c, d, a) * orientation(c, d, b) < 0.0:
        return 0.0
    return min(
        min(squared_distance_to_edge(c, a, b), squared_distance_to_edge(d, a, b)),
        min(squared_distance_to_edge(a, c, d), squared_distance_to_edge(b, c, d)),
    )
