"""Ends of open lines that meet, and the closed outlines that lines make one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.model import Points
from wiggleroom.drawing.outlines.connected_components import components
from wiggleroom.drawing.outlines.rings import extents

Ints = NDArray[np.int64]

JOIN_DISTANCE = 0.05
"""Open ends nearer than this [mm] are joined, ..."""
JOIN_SHARE = 0.01
"""... and nearer than this share of the shortest line."""
BEAM, PAIR_SHARE = 0.1, 0.02
"""An end with one other alone near is joined over the width of a beam [mm], and this share of the shorter of their lines."""
CLOSING_SHARE = 1e-3
"""The two ends of one line nearer than this share of its size are one, if no other end is near; ..."""
ALONE = 3.0
"""... that is nearer than so many times their distance."""
COINCIDENCE_TOLERANCE = 1e-9
"""Ends nearer than this share of the drawing's size are one."""


@dataclass(frozen=True, eq=False)
class Ends:
    """Ends of open lines, those that meet numbered alike.

    Parameters
    ----------
    node : (n, 2) int
        Number of the first and of the last point of every line.
    at : (m, 2) float64 [mm]
        Where each numbered point lies.
    widest : float [mm]
        The largest distance that was closed.
    """

    node: Ints
    at: Points
    widest: float


def join_ends(
    lines: Sequence[Points], tolerance: float, size: float, *, further: bool = False, rings: Sequence[Points] = ()
) -> Ends:
    """Which ends meet: those in one place, and open ones with the nearest within `tolerance` [mm].

    An end that meets another one already is not drawn to a third, so that a clearance between two closed outlines of
    single lines stays.

    Parameters
    ----------
    lines : sequence of (n, 2) float64 [mm]
    tolerance : float [mm]
    size : float [mm]
        Of the drawing.
    further : bool
        Whether two ends with no other one near are joined over more than `tolerance`: up to `BEAM` and `PAIR_SHARE` of
        the shorter of their lines, the two ends of one line up to `CLOSING_SHARE` of its size.
    rings : sequence of (n, 2) float64 [mm]
        Closed outlines; an end that lies on one of them, or on another line, is not joined further.

    Examples
    --------
    >>> lines = [np.array([[0.0, 0], [9, 0]]), np.array([[9.0, 0.01], [9, 9]]), np.array([[9.0, 9], [0, 0]])]
    >>> join_ends(lines, 0.05, 9.0).node.tolist()
    [[0, 1], [1, 2], [2, 0]]
    """
    last = np.cumsum([len(line) for line in lines]) - 1
    ends = np.concatenate(lines)[np.column_stack([np.append(0, last[:-1] + 1), last]).ravel()]
    sizes = extents(list(lines)).max(axis=1)
    points = shapely.points(ends)
    tree = shapely.STRtree(points)
    first, second = tree.query(points, predicate="dwithin", distance=COINCIDENCE_TOLERANCE * size)
    label = components(len(ends), first, second)
    count = np.bincount(label)
    loose = count == 1
    widest = 0.0
    rows = np.flatnonzero(loose[label])
    first, second = tree.query(points[rows], predicate="dwithin", distance=tolerance)
    first = rows[first]
    apart = np.hypot(*(ends[first] - ends[second]).T)
    short = (sizes <= tolerance).tolist()
    merged = np.arange(len(count))
    for k in np.lexsort((second, first, apart)).tolist():
        a, b = int(label[first[k]]), int(label[second[k]])
        if a == b or merged[a] == merged[b] or not loose[a]:
            continue
        if first[k] // 2 == second[k] // 2 and short[first[k] // 2]:
            continue  # a line so short joins others, not itself
        merged[merged == merged[a]] = merged[b]
        loose[a] = loose[b] = False
        widest = max(widest, float(apart[k]))
    if further:
        lengths = np.repeat(sizes, 2)
        loose &= ~_on_lines(ends, label, loose, lines, rings, COINCIDENCE_TOLERANCE * size)
        for a, b, apart_here in _pairs_alone(ends, label, loose, lengths, tree):
            merged[merged == merged[a]] = merged[b]
            widest = max(widest, apart_here)
    label = merged[label]
    kept, node = np.unique(label, return_inverse=True)
    at = np.empty((len(kept), 2))
    at[node[::-1]] = ends[::-1]  # the first end of each place says where it lies
    order = np.argsort(np.unique(node, return_index=True)[1], kind="stable")
    rank = np.empty(len(kept), dtype=np.int64)
    rank[order] = np.arange(len(kept))
    return Ends(rank[node].reshape(-1, 2), at[order], widest)


def _on_lines(
    ends: Points, label: Ints, loose: NDArray[np.bool_], lines: Sequence[Points], rings: Sequence[Points], within: float
) -> NDArray[np.bool_]:
    """Labels of loose ends that lie on a closed outline or on another line."""
    rows = np.flatnonzero(loose[label])
    if not len(rows):
        return np.zeros(len(loose), dtype=bool)
    drawn = [*lines, *(np.vstack([ring, ring[:1]]) for ring in rings)]
    owner = np.repeat(np.arange(len(drawn)), [len(line) for line in drawn])
    tree = shapely.STRtree(shapely.linestrings(np.concatenate(drawn), indices=owner))
    k, other = tree.query(shapely.points(ends[rows]), predicate="dwithin", distance=within)
    found = np.zeros(len(loose), dtype=bool)
    found[label[rows[k[other != rows[k] // 2]]]] = True
    return found


def _pairs_alone(
    ends: Points, label: Ints, loose: NDArray[np.bool_], lengths: NDArray[np.float64], tree: shapely.STRtree
) -> list[tuple[int, int, float]]:
    """Labels of two loose ends with no other end near, and how far they are apart [mm]."""
    rows = np.flatnonzero(loose[label])
    reach = np.maximum(BEAM, CLOSING_SHARE * lengths)[rows]
    k, there = tree.query(shapely.points(ends[rows]), predicate="dwithin", distance=ALONE * reach)
    away = np.hypot(*(ends[there] - ends[rows[k]]).T)
    order = np.lexsort((there, away, k))
    there, away = there[order], away[order]
    stops = np.cumsum(np.bincount(k, minlength=len(rows))).tolist()
    found = []
    for row, start, stop in zip(rows.tolist(), [0, *stops], stops, strict=False):
        near = there[start:stop]
        if len(near) < 2 or near[1] < row or not loose[label[near[1]]]:
            continue
        other, gap = int(near[1]), float(away[start + 1])
        closing = other // 2 == row // 2
        most = CLOSING_SHARE * lengths[row] if closing else min(BEAM, PAIR_SHARE * lengths[[row, other]].min())
        third = (
            np.hypot(*(ends[near[2:], None] - ends[[row, other]]).transpose(2, 0, 1)).min() if len(near) > 2 else np.inf
        )
        if gap <= most and third > ALONE * gap:
            found.append((int(label[row]), int(label[other]), gap))
    return found


def closed_loops(ends: Ends, pools: Sequence[object]) -> list[list[tuple[int, bool]]]:
    """Closed loops of lines of one pool, none of which meets any other line; each line with whether it is travelled backwards.

    Parameters
    ----------
    ends : Ends
    pools : sequence
        Lines of different pools are not edges of one outline.

    Examples
    --------
    >>> square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])
    >>> ends = join_ends([square[:3], square[2:]], 0.1, 1.0)
    >>> closed_loops(ends, ["a", "a"]), closed_loops(ends, ["a", "b"])
    ([[(0, False), (1, False)]], [])
    """
    node = ends.node
    degree = np.bincount(node.ravel(), minlength=len(ends.at))
    group = components(len(ends.at), node[:, 0], node[:, 1])[node[:, 0]]
    at_node: dict[int, list[int]] = {}
    for line, (a, b) in enumerate(node.tolist()):
        at_node.setdefault(a, []).append(line)
        at_node.setdefault(b, []).append(line)
    members: dict[int, list[int]] = {}
    for line, key in enumerate(group.tolist()):
        members.setdefault(key, []).append(line)
    found = []
    for rows in members.values():
        if (degree[node[rows]] != 2).any() or len({pools[row] for row in rows}) > 1:
            continue
        loop = [(rows[0], False)]
        home, tip = node[rows[0]].tolist()
        while tip != home:
            here = loop[-1][0]
            pair = at_node[tip]
            following = pair[1] if pair[0] == here else pair[0]
            back = bool(node[following, 0] != tip)
            loop.append((following, back))
            tip = int(node[following, 0] if back else node[following, 1])
        found.append(loop)
    return found


def open_chains(ends: Ends, wanted: Sequence[bool]) -> list[list[tuple[int, bool]]]:
    """Chains of wanted lines with two open ends, as the sides of a slot over an edge; each line with whether it is travelled backwards.

    Examples
    --------
    >>> sides = [np.array([[0.0, 9], [0, 0]]), np.array([[2.0, 0], [0, 0]]), np.array([[2.0, 0], [2, 9]])]
    >>> open_chains(join_ends(sides, 0.1, 9.0), [True] * 3)
    [[(0, False), (1, True), (2, False)]]
    """
    node = ends.node
    degree = np.bincount(node.ravel(), minlength=len(ends.at))
    at_node: dict[int, list[int]] = {}
    for line, (a, b) in enumerate(node.tolist()):
        at_node.setdefault(a, []).append(line)
        at_node.setdefault(b, []).append(line)
    found: list[list[tuple[int, bool]]] = []
    seen: set[int] = set()
    for line, (a, b) in enumerate(node.tolist()):
        if line in seen or not wanted[line] or min(degree[a], degree[b]) != 1:
            continue
        back = bool(degree[a] != 1)
        chain, tip = [(line, back)], a if back else b
        while degree[tip] == 2:
            here = chain[-1][0]
            pair = at_node[tip]
            following = pair[1] if pair[0] == here else pair[0]
            back = bool(node[following, 0] != tip)
            chain.append((following, back))
            tip = int(node[following, 0] if back else node[following, 1])
        seen |= {row for row, _ in chain}
        if degree[tip] == 1 and all(wanted[row] for row, _ in chain):
            found.append(chain)
    return found


def outline_of(loop: Sequence[tuple[int, bool]], lines: Sequence[Points], ends: Ends) -> Points:
    """Corners (n, 2) [mm] of a loop of lines; ends that meet become one point exactly."""
    starts = ends.at[ends.node[[line for line, _ in loop], [int(back) for _, back in loop]]]
    pieces = []
    for (line, back), start in zip(loop, starts[:, None], strict=True):
        points = lines[line][::-1] if back else lines[line]
        pieces += [start] if len(points) == 2 else [start, points[1:-1]]
    return np.concatenate(pieces)
