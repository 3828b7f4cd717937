"""Half-planes: corners of one part before lines of edges of the other, linearised where the parts lie now.

For every corner near an edge of the other part and in front of it, its distance from the line is a row. Past a corner that
sticks out only one of the two edges can be asked for: the one whose line is further away. That choice makes the
region convex, and smaller than the truth. To first order in the relative motion a row is a face N g + D <= 0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import njit
from wiggleroom.freespace.models.halfspaces import Halfspaces
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.relative_pose import relative_pose

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_PENETRATION = 0.1
"""A corner that has come behind the nearest edge by less than this share of the reach is asked to come out again."""


def half_planes(bodies: Bodies, a: Ints, b: Ints, motion: Floats, reach: float) -> Halfspaces:
    """Rows of pairs of bodies at `motion` (n, 3) [mm, mm, rad], in relative motions from there.

    Parameters
    ----------
    bodies : Bodies
    a, b : (P,) int64
    motion : (n, 3) float64 [mm, mm, rad]
    reach : float [mm]
        Corners further than this from an edge do not see it.

    Source: Lensgraf and others, "PuzzleFlex: kinematic motion of chains with loose joints" (ICRA 2020); which corners and lines make
    rows is ours: the text (arXiv 1906.08708) was not read in full.
    """
    pose = relative_pose(bodies, a, b, motion)
    shapes = bodies.shapes
    before = np.empty_like(shapes.after)
    before[shapes.after] = np.arange(len(before))
    arguments = (
        pose, bodies.shape[a], bodies.shape[b], bodies.radius[a], bodies.radius[b], shapes.corner, before, shapes.after, shapes.normal,
        shapes.length, shapes.first, reach,
    )  # fmt: skip
    count = np.zeros(len(a), dtype=np.int64)
    nothing = np.zeros((0, 3)), np.zeros(0)
    _rows(*arguments, count, np.zeros(len(a) + 1, dtype=np.int64), *nothing)
    row = np.concatenate([[0], np.cumsum(count)])
    normal, offset = np.empty((row[-1], 3)), np.empty(row[-1])
    _rows(*arguments, count, row, normal, offset)
    return Halfspaces(a, b, row, normal, offset, np.zeros((len(a), 2)), pose)


@njit(cache=True, nogil=True, error_model="numpy")
def _rows(
    pose: Floats, sa: Ints, sb: Ints, ra: Floats, rb: Floats, corner: Floats, before: Ints, after: Ints, normal: Floats,
    length: Floats, first: Ints, reach: float, count: Ints, row: Ints, out_normal: Floats, out_offset: Floats,
) -> None:  # fmt: skip
    """Count the rows of every pair and, where there is room for them, write them."""
    write = len(out_offset) > 0
    for p in range(len(pose)):
        x, y = pose[p, 0], pose[p, 1]
        c, s = np.cos(pose[p, 2]), np.sin(pose[p, 2])
        n = 0
        for role in range(2):  # corners of B before edges of A, then corners of A before edges of B
            mine, other = (sa[p], sb[p]) if role == 0 else (sb[p], sa[p])
            far = ra[p] if role == 0 else rb[p]
            for v in range(first[other], first[other + 1]):
                vx, vy = corner[v, 0], corner[v, 1]
                if role == 0:
                    px, py = c * vx - s * vy + x, s * vx + c * vy + y
                else:
                    px, py = c * (vx - x) + s * (vy - y), c * (vy - y) - s * (vx - x)
                if px * px + py * py > (far + reach) ** 2:
                    continue
                # where a corner is inside, the nearest edge is its way out; other lines it is behind say nothing
                nearest = np.inf
                for e in range(first[mine], first[mine + 1]):
                    ex, ey = px - corner[e, 0], py - corner[e, 1]
                    t = -normal[e, 1] * ex + normal[e, 0] * ey
                    if 0.0 <= t <= length[e]:
                        nearest = min(nearest, abs(normal[e, 0] * ex + normal[e, 1] * ey))
                for e in range(first[mine], first[mine + 1]):
                    nx, ny = normal[e, 0], normal[e, 1]
                    ex, ey = px - corner[e, 0], py - corner[e, 1]
                    d = nx * ex + ny * ey
                    if d < -min(MAX_PENETRATION * reach, nearest) or d > reach:
                        continue
                    t = ny * -ex + nx * ey  # along the edge, from its start
                    if t < -reach or t > length[e] + reach:
                        continue
                    if t < 0.0 or t > length[e]:
                        # past the end: the next edge decides, unless this one's line is the further one
                        f = before[e] if t < 0.0 else after[e]
                        gx, gy = (px - corner[f, 0], py - corner[f, 1])
                        beside = normal[f, 0] * gx + normal[f, 1] * gy
                        bend = nx * normal[f, 1] - ny * normal[f, 0]
                        if bend < 0.0 if t < 0.0 else bend > 0.0:
                            if d < 0.0 or beside > d or (beside == d and f < e):
                                continue
                        elif -t > MAX_PENETRATION * reach or t - length[e] > MAX_PENETRATION * reach:
                            continue  # an inner corner: both edges count, also where it is a little inside one of them
                    if write:
                        k = row[p] + n
                        if role == 0:
                            # d + n . (change of p): p moves with B, turned about B's origin
                            wx, wy = px - x, py - y
                            out_normal[k, 0], out_normal[k, 1] = -nx, -ny
                            out_normal[k, 2] = -(ny * wx - nx * wy)
                        else:
                            # seen from B: the line turns with B, m = R n
                            mx, my = c * nx - s * ny, s * nx + c * ny
                            out_normal[k, 0], out_normal[k, 1] = mx, my
                            out_normal[k, 2] = -(mx * (vy - y) - my * (vx - x))
                        out_offset[k] = -d
                    n += 1
        count[p] = n
