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
ALONE = 3.0
"""Another end is near if it is nearer than so many times their distance."""
LOOP_SHARE, LOOP_GAP = 0.03, 0.5
"""Lines whose nearest ends make one loop are closed over gaps of this share of it together, each of several no wider than that [mm]."""
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
    where : (x, y) [mm]
        One of the two ends there.
    """

    node: Ints
    at: Points
    widest: float
    where: tuple[float, float] = (0.0, 0.0)


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
        the shorter of their lines; those of lines that make one loop so up to `LOOP_SHARE` of it, several up to `LOOP_GAP`.
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
    widest, where = 0.0, 0
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
        widest, where = max((widest, where), (float(apart[k]), int(first[k])))
    if further and loose.any():
        drawn = [*lines, *(np.vstack([ring, ring[:1]]) for ring in rings)]
        owner = np.repeat(np.arange(len(drawn)), [len(line) for line in drawn])
        around = shapely.STRtree(shapely.linestrings(np.concatenate(drawn), indices=owner))
        loose &= ~_on_lines(ends, label, loose, around, COINCIDENCE_TOLERANCE * size)
        for a, b, gap in _pairs_alone(ends, label, loose, np.repeat(sizes, 2), tree):
            loose[label[[a, b]]] = False
            merged[merged == merged[label[a]]] = merged[label[b]]
            widest, where = max((widest, where), (gap, a))
        for a, b, gap in _gaps_of_loops(ends, merged[label], loose[label], lines, around):
            merged[merged == merged[label[a]]] = merged[label[b]]
            widest, where = max((widest, where), (gap, a))
    label = merged[label]
    kept, node = np.unique(label, return_inverse=True)
    at = np.empty((len(kept), 2))
    at[node[::-1]] = ends[::-1]  # the first end of each place says where it lies
    order = np.argsort(np.unique(node, return_index=True)[1], kind="stable")
    rank = np.empty(len(kept), dtype=np.int64)
    rank[order] = np.arange(len(kept))
    return Ends(rank[node].reshape(-1, 2), at[order], widest, (float(ends[where, 0]), float(ends[where, 1])))


def _on_lines(
    ends: Points, label: Ints, loose: NDArray[np.bool_], drawn: shapely.STRtree, within: float
) -> NDArray[np.bool_]:
    """Labels of loose ends that lie on a closed outline or on another line."""
    rows = np.flatnonzero(loose[label])
    k, other = drawn.query(shapely.points(ends[rows]), predicate="dwithin", distance=within)
    found = np.zeros(len(loose), dtype=bool)
    found[label[rows[k[other != rows[k] // 2]]]] = True
    return found


def _pairs_alone(
    ends: Points, label: Ints, loose: NDArray[np.bool_], lengths: NDArray[np.float64], tree: shapely.STRtree
) -> list[tuple[int, int, float]]:
    """Pairs of loose ends of two lines with no other end near, and how far they are apart [mm]."""
    rows = np.flatnonzero(loose[label])
    k, there = tree.query(shapely.points(ends[rows]), predicate="dwithin", distance=ALONE * BEAM)
    away = np.hypot(*(ends[there] - ends[rows[k]]).T)
    order = np.lexsort((there, away, k))
    there, away = there[order], away[order]
    stops = np.cumsum(np.bincount(k, minlength=len(rows))).tolist()
    found = []
    for row, start, stop in zip(rows.tolist(), [0, *stops], stops, strict=False):
        near = there[start:stop]
        if len(near) < 2 or near[1] < row or not loose[label[near[1]]] or near[1] // 2 == row // 2:
            continue
        other, gap = int(near[1]), float(away[start + 1])
        third = (
            np.hypot(*(ends[near[2:], None] - ends[[row, other]]).transpose(2, 0, 1)).min() if len(near) > 2 else np.inf
        )
        if gap <= min(BEAM, PAIR_SHARE * lengths[[row, other]].min()) and third > ALONE * gap:
            found.append((row, other, gap))
    return found


def _gaps_of_loops(
    ends: Points, label: Ints, loose: NDArray[np.bool_], lines: Sequence[Points], drawn: shapely.STRtree
) -> list[tuple[int, int, float]]:
    """Pairs of loose ends, each the nearest of the other, that close chains of lines to loops, and how far they are apart [mm].

    No loose end of other lines is near, nor any other line nearer than half the gap, so that there is one way to close them.
    """
    size = label.max() + 1
    chain = components(size, label[::2], label[1::2])[label]
    free = np.bincount(chain, loose, minlength=size)
    plain = (free == 2) & (np.bincount(chain, np.bincount(label)[label] > 2, minlength=size) == 0)
    rows = np.flatnonzero(loose & plain[chain])
    if not len(rows):
        return []
    drawn_length = shapely.length(drawn.geometries[: len(lines)])
    length = np.bincount(chain[::2], drawn_length, minlength=size)
    points = shapely.points(ends[rows])
    i, j = shapely.STRtree(points).query(
        points, predicate="dwithin", distance=np.maximum(LOOP_GAP, LOOP_SHARE * length[chain[rows]])
    )
    i, j = rows[i], rows[j]
    apart = np.hypot(*(ends[i] - ends[j]).T)
    may = (i != j) & (apart <= np.where(chain[i] == chain[j], LOOP_SHARE * length[chain[i]], LOOP_GAP))
    nearest: dict[int, tuple[int, float]] = {}
    for k in np.lexsort((j, apart)):
        if may[k]:
            nearest.setdefault(int(i[k]), (int(j[k]), float(apart[k])))
    pairs = [(a, b, gap) for a, (b, gap) in nearest.items() if a < b and nearest.get(b, (-1, 0.0))[0] == a]
    first = [a for a, _, _ in pairs]
    loop = components(size, chain[first], chain[[b for _, b, _ in pairs]])[chain]
    gaps = np.bincount(loop[first], [gap for *_, gap in pairs], minlength=size)
    closed = 2 * np.bincount(loop[first], minlength=size) == np.bincount(loop, loose, minlength=size)
    closed &= gaps <= LOOP_SHARE * np.bincount(loop[::2], drawn_length, minlength=size)
    free_ends = np.flatnonzero(loose)
    near = shapely.STRtree(shapely.points(ends[free_ends]))
    for a, b, gap in pairs:
        around = free_ends[near.query(shapely.points(ends[[a, b]]), predicate="dwithin", distance=ALONE * gap)[1]]
        beside = drawn.query(shapely.points(ends[[a, b]]), predicate="dwithin", distance=gap / 2)[1]
        own = beside < len(lines)
        closed[loop[a]] &= bool(
            own.all() and (loop[2 * beside[own]] == loop[a]).all() and (loop[around] == loop[a]).all()
        )
    return [(a, b, gap) for a, b, gap in pairs if closed[loop[a]]]


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
    """Corners (n, 2) [mm] of a loop of lines; ends that meet become one point exactly, those further apart than a beam are bridged."""
    rows, backward = np.array(loop, dtype=int).T
    starts = ends.at[ends.node[rows, backward]]
    stops = ends.at[ends.node[rows, 1 - backward]]
    turned = [lines[line][::-1] if back else lines[line] for line, back in loop]
    first = np.hypot(*(np.array([points[0] for points in turned]) - starts).T) <= BEAM
    last = np.array([len(points) for points in turned])
    last = last - (np.hypot(*(np.array([points[-1] for points in turned]) - stops).T) <= BEAM)
    pieces = []
    for points, start, low, high in zip(turned, starts[:, None], first.tolist(), last.tolist(), strict=True):
        pieces += [start] if low >= high else [start, points[low:high]]
    return np.concatenate(pieces)
