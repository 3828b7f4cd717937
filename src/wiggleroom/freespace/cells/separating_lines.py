"""Compiled test for which edges lines separate.

A *line* is the line of one edge of A (A_EDGE) or of B (B_EDGE). A *wall* keeps one corner of the other part in front of a line. An edge
pair is *separated* by a line over an angle interval when the walls on that line keep the other part's edge in front of the line by at least
as much as the owner's own edge reaches in front of it; then the two edges cannot cross. A cell is free of overlap over an interval as soon
as every edge pair is separated there: its slices are convex, so nothing forbidden can begin inside without two edges crossing. How far a
corner stays in front is a sinusoid of the angle, so its least value over an interval is closed form: nothing is sampled.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, njit
from wiggleroom.freespace.cells.pair_edges import (
    EDGE,
    RUN,
    EdgeTable,
    corner_in_frame,
    normal_in_frame,
    squared_distance,
    vector_length,
)

MAX_LINES = 400
"""Lines of one cell that there is room for."""
MAX_WALLS_PER_LINE = 48
"""Walls on one line that there is room for."""
MAX_LINE_CORNERS = 1600
"""Corners of the polygon of a slice that there is room for."""
LINES, PAIRS = 0, 1
"""Places in `number`: how many lines, and how many open pairs of edges there are."""
UNSEEN, SEEN, SEPARATED = 0, 1, 2
"""States of a pair of runs of edges."""

LINE = np.dtype([("edge", "i8"), ("count", "i8"), ("before", "i8"), ("walls", "i8", (MAX_WALLS_PER_LINE,))], align=True)
"""A line, the number of walls on it, now and before the present step, and their corners."""
RUN_PAIR = np.dtype([("state", "i8"), ("bound", "f8")], align=True)
"""What is known of a run of A and one of B: UNSEEN, SEEN or SEPARATED, and a lower bound of their distance [mm]."""
OPEN_PAIR = np.dtype([("a", "i8"), ("b", "i8"), ("apart2", "f8"), ("postponed", "i8")], align=True)
"""An edge pair that no line separates, the square of its distance [mm^2], and whether it waits for the lines of other pairs."""


class Workspace(NamedTuple):
    """Room to work in, as large as the largest pair needs.

    Parameters
    ----------
    edges : (n,) EDGE
    runs : (r,) RUN
        For the table of the pair.
    number : (2,) int64
        How many lines and open pairs there are.
    corners : (3, n) float64 [mm]
        x and y of the corners that the edges begin at, and how far each stays in front of one line, while that is worked out.
    lines : (MAX_LINES,) LINE
        Lines of the cell being grown.
    ahead : (MAX_LINES, n) float64 [mm]
        How far each edge of a line's owner reaches in front of it, and each edge of the other part stays in front at least.
    run_ahead : (MAX_LINES, r) float64 [mm]
        The same for whole runs of edges.
    run_pairs : (r / 2, r / 2) RUN_PAIR
        All runs of A with all of B.
    open_pairs : (n^2 / 4,) OPEN_PAIR
        Edge pairs that nothing separates, as far as they have been looked for.
    polygons : (2, MAX_LINE_CORNERS, 2) float64 [mm]
        A slice, clipped from one into the other.
    """

    edges: np.ndarray
    runs: np.ndarray
    number: NDArray[np.int64]
    corners: NDArray[np.float64]
    lines: np.ndarray
    ahead: NDArray[np.float64]
    run_ahead: NDArray[np.float64]
    run_pairs: np.ndarray
    open_pairs: np.ndarray
    polygons: NDArray[np.float64]


def workspace_for(outlines: EdgeTable) -> Workspace:
    """Room for any pair of these shapes."""
    n, r = int(np.diff(outlines.first).max()), int(np.diff(outlines.run_first).max())
    return Workspace(
        edges=np.empty(2 * n, dtype=EDGE),
        runs=np.empty(2 * r, dtype=RUN),
        number=np.zeros(2, dtype=np.int64),
        corners=np.empty((3, 2 * n)),
        lines=np.empty(MAX_LINES, dtype=LINE),
        ahead=np.empty((MAX_LINES, 2 * n)),
        run_ahead=np.empty((MAX_LINES, 2 * r)),
        run_pairs=np.empty((r, r), dtype=RUN_PAIR),
        open_pairs=np.empty(n * n, dtype=OPEN_PAIR),
        polygons=np.empty((2, MAX_LINE_CORNERS, 2)),
    )


@njit(**COMPILED_CALLERS_ONLY)
def line_of(pair, work, edge):
    """Line of an edge, added where there is none yet; -1 where there is no room for it."""
    number = work.number[LINES]
    for k in range(number):
        if work.lines[k].edge == edge:
            return k
    if number == MAX_LINES:
        return -1
    work.number[LINES] = number + 1
    line = work.lines[number]
    line.edge, line.count = edge, 0
    own = pair.edges[edge]
    begin, end = (0, pair.ra) if edge < pair.na else (pair.ra, pair.r)
    for r in range(begin, end):
        most = -np.inf
        for i in range(pair.runs[r].begin, pair.runs[r].end):
            e = pair.edges[i]
            f = pair.edges[e.after]
            d = max(own.nx * e.x + own.ny * e.y, own.nx * f.x + own.ny * f.y) - own.off
            if i == edge:
                d = 0.0
            work.ahead[number, i] = d
            most = max(most, d)
        work.run_ahead[number, r] = most
    return number


@njit(**COMPILED_CALLERS_ONLY)
def add_wall(line, v):
    """Put a wall for corner v on a line, where it is not there yet; False where there is no room for it."""
    count = line.count
    for k in range(count):
        if line.walls[k] == v:
            return True
    if count == MAX_WALLS_PER_LINE:
        return False
    line.walls[count] = v
    line.count = count + 1
    return True


@njit(**COMPILED_CALLERS_ONLY)
def least_in_front(px, py, qx, qy, dx, dy):
    """Least n(psi) . d while the unit normal n turns counter-clockwise from p to q (less than half a turn)."""
    at_p, at_q = px * dx + py * dy, qx * dx + qy * dy
    least = at_p if at_p < at_q else at_q  # min and max are slower
    if (py * dx - px * dy >= 0.0) & (dy * qx - dx * qy >= 0.0) & ((px + qx) * dx + (py + qy) * dy < 0.0):
        least = -np.sqrt(dx * dx + dy * dy)
    return least


@njit(**COMPILED_CALLERS_ONLY)
def set_ahead(pair, work, k, p, q):
    """How far each edge of the other part stays in front of line k over the angles [p, q], by edge and by run."""
    line = work.lines[k]
    if line.edge < pair.na:  # the normal turns clockwise as B turns counter-clockwise
        p, q = q, p
        begin, end = pair.ra, pair.r
    else:
        begin, end = 0, pair.ra
    px, py = normal_in_frame(pair, line.edge, p)
    qx, qy = normal_in_frame(pair, line.edge, q)
    first, last = pair.runs[begin].begin, pair.runs[end - 1].end
    x, y, least = work.corners[0, first:last], work.corners[1, first:last], work.corners[2, first:last]
    least[:] = -np.inf
    for m in range(line.count):
        vx, vy = pair.edges[line.walls[m]].x, pair.edges[line.walls[m]].y
        for w in range(len(x)):
            d = least_in_front(px, py, qx, qy, x[w] - vx, y[w] - vy)
            if d > least[w]:
                least[w] = d
    for r in range(begin, end):
        most = np.inf
        for j in range(pair.runs[r].begin, pair.runs[r].end):
            d = min(least[j - first], least[pair.edges[j].after - first])
            work.ahead[k, j] = d
            most = min(most, d)
        work.run_ahead[k, r] = most


@njit(**COMPILED_CALLERS_ONLY)
def separates(of_a, ahead, k, i, j, tiny):
    """True where line k, of A or not, separates edge (or run) i of A from edge (or run) j of B."""
    if of_a:
        return ahead[k, i] <= ahead[k, j] + tiny
    return ahead[k, j] <= ahead[k, i] + tiny


@njit(**COMPILED_CALLERS_ONLY)
def separated(pair, work, ahead, i, j, tiny):
    """True where any line separates edge (or run) i of A from edge (or run) j of B."""
    for k in range(work.number[LINES]):  # noqa: SIM110 (compiled code has no generators)
        if separates(work.lines[k].edge < pair.na, ahead, k, i, j, tiny):
            return True
    return False


@njit(**COMPILED_CALLERS_ONLY)
def separated_piecewise(pair, work, cut, other, p, q, tiny):
    """True where lines together separate all of edge `cut` from edge `other`: one line the piece up to a point of it, another the rest."""
    up_to, down_to = 0.0, 1.0
    begin, end = pair.edges[cut], pair.edges[pair.edges[cut].after]
    for k in range(work.number[LINES]):
        line = work.lines[k]
        own = pair.edges[line.edge]
        if (line.edge < pair.na) == (cut < pair.na):  # what lies behind the parallel that `other` stays in front of
            most = work.ahead[k, other] + tiny
            low = most - (own.nx * begin.x + own.ny * begin.y - own.off)
            high = most - (own.nx * end.x + own.ny * end.y - own.off)
            up_to, down_to = _longer(up_to, down_to, low, high)
            continue
        least = work.ahead[k, other] - tiny
        px, py = normal_in_frame(pair, line.edge, p if cut < pair.na else q)
        qx, qy = normal_in_frame(pair, line.edge, q if cut < pair.na else p)
        for w in range(
            line.count
        ):  # in between a point stays in front by at least the mean of both ends, a minimum being concave
            v = pair.edges[line.walls[w]]
            low = least_in_front(px, py, qx, qy, begin.x - v.x, begin.y - v.y) - least
            high = least_in_front(px, py, qx, qy, end.x - v.x, end.y - v.y) - least
            up_to, down_to = _longer(up_to, down_to, low, high)
    return up_to >= down_to


@njit(**COMPILED_CALLERS_ONLY)
def _longer(up_to, down_to, low, high):
    """Ends of the separated pieces of an edge, with the piece where a linear function, `low` and `high` at its ends, is not negative."""
    if low >= 0.0:
        up_to = max(up_to, 1.0 if high >= 0.0 else low / (low - high))
    if high >= 0.0:
        down_to = min(down_to, 0.0 if low >= 0.0 else low / (low - high))
    return up_to, down_to


@njit(**COMPILED_CALLERS_ONLY)
def remove_open_pair(work, n):
    """Take one edge pair from the list of open ones."""
    last = work.number[PAIRS] - 1
    work.open_pairs[n] = work.open_pairs[last]
    work.number[PAIRS] = last


@njit(**COMPILED_CALLERS_ONLY)
def classify_run_pairs(pair, work, pose, tiny):
    """Which pairs of runs some line separates whole, and how near to each other the others are at least at a pose."""
    for v in range(pair.n):
        e = pair.edges[v]
        e.seen_x, e.seen_y = e.x, e.y
        if v >= pair.na:
            e.seen_x, e.seen_y = corner_in_frame(pair, 0, v, pose)
    work.number[PAIRS] = 0
    for j in range(pair.ra, pair.r):
        b = pair.runs[j]
        x, y = pose.c * b.x - pose.s * b.y + pose.x, pose.s * b.x + pose.c * b.y + pose.y
        for i in range(pair.ra):
            a, run_pair = pair.runs[i], work.run_pairs[i, j - pair.ra]
            run_pair.state = SEPARATED if separated(pair, work, work.run_ahead, i, j, tiny) else UNSEEN
            run_pair.bound = max(0.0, vector_length(x - a.x, y - a.y) - b.radius - a.radius)


@njit(**COMPILED_CALLERS_ONLY)
def nearest_open(pair, work, tiny):
    """Place in the list of the nearest edge pair that no line separates and that does not wait, or -1; near runs are opened first."""
    best, where = np.inf, -1
    for n in range(work.number[PAIRS]):
        if work.open_pairs[n].apart2 < best and not work.open_pairs[n].postponed:
            best, where = work.open_pairs[n].apart2, n
    while True:
        near, a, b = np.sqrt(best), -1, -1
        for i in range(pair.ra):
            for j in range(pair.ra, pair.r):
                run_pair = work.run_pairs[i, j - pair.ra]
                if run_pair.state == UNSEEN and run_pair.bound < near:
                    near, a, b = run_pair.bound, i, j
        if a < 0:
            return where
        work.run_pairs[a, b - pair.ra].state = SEEN
        for i in range(pair.runs[a].begin, pair.runs[a].end):
            for j in range(pair.runs[b].begin, pair.runs[b].end):
                if separated(pair, work, work.ahead, i, j, tiny):
                    continue
                n = work.number[PAIRS]
                found = work.open_pairs[n]
                found.a, found.b, found.apart2, found.postponed = i, j, squared_distance(pair, i, j), 0
                work.number[PAIRS] = n + 1
                if found.apart2 < best:
                    best, where = found.apart2, n


@njit(**COMPILED_CALLERS_ONLY)
def remove_separated_pairs(pair, work, k, tiny):
    """Take what line k separates out of the pairs of runs and out of the list of open edge pairs."""
    of_a = work.lines[k].edge < pair.na
    for i in range(pair.ra):
        for j in range(pair.ra, pair.r):
            if separates(of_a, work.run_ahead, k, i, j, tiny):
                work.run_pairs[i, j - pair.ra].state = SEPARATED
    kept = 0
    for n in range(work.number[PAIRS]):
        one = work.open_pairs[n]
        if not separates(of_a, work.ahead, k, one.a, one.b, tiny):
            work.open_pairs[kept] = one
            kept += 1
    work.number[PAIRS] = kept
