"""Loose edges joined to closed outlines.

Edges that follow each other in the file, end to start, and all close are taken as they were drawn: one part after the
other. Where that does not work out, because neighbours share an edge that is drawn once or because edges come in any
order, the outlines are the faces of the plane graph that the edges make.
"""

from __future__ import annotations

import cmath
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.pathdata import Subpath
from wiggleroom.drawing.strokes import backward, point_on, trace

Ints = NDArray[np.int64]

_TIE = 1e-9
"""Edges that leave a point within this angle [rad] of each other lie on one another."""

Way = tuple[int, bool]
"""An edge by its number, and whether it is travelled backwards."""


@dataclass
class Joined:
    """What became of the edges of one pool.

    Parameters
    ----------
    loops : list of (numbers of edges, Subpath)
        Closed outlines.
    opened : list of numbers of edges
        Chains that do not close.
    overlapping : list of complex [mm]
        Points from which two edges lead the same way, so that nobody can say which outline is meant.
    repeated : int
        Edges that were drawn twice.
    """

    loops: list[tuple[list[int], Subpath]] = field(default_factory=list)
    opened: list[list[int]] = field(default_factory=list)
    overlapping: list[complex] = field(default_factory=list)
    repeated: int = 0


def joined(edges: Sequence[Subpath], tolerance: float) -> Joined:
    """Closed outlines that edges make, where ends within `tolerance` [mm] of each other meet.

    Parameters
    ----------
    edges : sequence of Subpath [mm]
        Open strokes in drawing order.
    tolerance : float [mm]

    Examples
    --------
    >>> from wiggleroom.drawing.pathdata import Line
    >>> corners = [0j, 4 + 0j, 4 + 3j, 3j]
    >>> sides = [Subpath(a, [Line(b)], False) for a, b in zip(corners, corners[1:] + corners[:1])]
    >>> found = joined([backward(sides[2]), sides[0], sides[3], sides[1]], 1e-6)
    >>> [len(loop.segments) for _, loop in found.loops]
    [4]
    """
    result = Joined()
    nodes, at = _nodes(edges, tolerance)
    for group in _components(nodes):
        sequence = _in_sequence(group, nodes, edges, tolerance)
        ways = sequence if sequence is not None else _faces(group, nodes, edges, tolerance, result)
        for way in ways:
            result.loops.append(([edge for edge, _ in way], _outline(way, nodes, at, edges)))
    return result


def _nodes(edges: Sequence[Subpath], tolerance: float) -> tuple[Ints, list[complex]]:
    """Number the ends: (n, 2) start and end of every edge, and where each numbered point lies."""
    ends = np.array([(edge.start, edge.segments[-1].end) for edge in edges]).ravel()
    points = shapely.points(ends.real, ends.imag)
    first, second = shapely.STRtree(points).query(points, predicate="dwithin", distance=tolerance)
    label = np.arange(len(ends))
    while True:  # every end takes the lowest number in reach until nothing changes
        lower = label.copy()
        np.minimum.at(lower, first, label[second])
        if (lower == label).all():
            break
        label = lower[lower]
    return label.reshape(-1, 2), ends.tolist()


def _components(nodes: Ints) -> list[list[int]]:
    """Numbers of edges that hang together, in drawing order."""
    label = np.arange(nodes.max() + 1)
    while True:
        lower = label.copy()
        low = label[nodes].min(axis=1)
        np.minimum.at(lower, nodes[:, 0], low)
        np.minimum.at(lower, nodes[:, 1], low)
        lower = lower[lower]
        if (lower == label).all():
            break
        label = lower
    groups: dict[int, list[int]] = {}
    for i, key in enumerate(label[nodes[:, 0]].tolist()):
        groups.setdefault(key, []).append(i)
    return list(groups.values())


def _in_sequence(
    group: Sequence[int], nodes: Ints, edges: Sequence[Subpath], tolerance: float
) -> list[list[Way]] | None:
    """Loops of edges that follow each other in the file, or None unless every edge is in one."""
    loops: list[list[Way]] = []
    i = 0
    while i < len(group):
        first = group[i]
        home, tip = nodes[first]
        turned = i + 1 < len(group) and home != tip and tip not in nodes[group[i + 1]] and home in nodes[group[i + 1]]
        if turned:
            home, tip = tip, home
        loop: list[Way] = [(first, bool(turned))]
        i += 1
        while tip != home:
            if i == len(group) or tip not in nodes[group[i]]:
                return None
            edge = group[i]
            back = bool(nodes[edge][0] != tip)
            loop.append((edge, back))
            tip = nodes[edge][0] if back else nodes[edge][1]
            i += 1
        if len(loop) == 2 and _same(edges[loop[0][0]], edges[loop[1][0]], tolerance):
            return None
        loops.append(loop)
    return loops


def _faces(
    group: Sequence[int], nodes: Ints, edges: Sequence[Subpath], tolerance: float, result: Joined
) -> list[list[Way]]:
    """Bounded faces of the plane graph; what bounds none is left open."""
    kept = _distinct(group, nodes, edges, tolerance)
    result.repeated += len(group) - len(kept)
    while True:
        used = _without_ends(kept, nodes)
        ways, overlapping = _traced(used, nodes, edges)
        both = Counter(edge for way in ways for edge in {e for e, _ in way if (e, True) in way and (e, False) in way})
        if not both or overlapping:
            break
        kept = [edge for edge in used if edge not in both]  # an edge with one face on both sides is no outline
    result.overlapping += overlapping
    if overlapping:
        return []
    missing = sorted(set(_distinct(group, nodes, edges, tolerance)) - set(used))
    if missing:
        result.opened += [[missing[i] for i in chain] for chain in _components(nodes[missing])]
    return [way for way in ways if _area(way, edges) > 0]


def _distinct(group: Sequence[int], nodes: Ints, edges: Sequence[Subpath], tolerance: float) -> list[int]:
    """Without edges that were drawn before."""
    seen: dict[tuple[int, int], list[int]] = {}
    kept = []
    for edge in group:
        alike = seen.setdefault((int(nodes[edge].min()), int(nodes[edge].max())), [])
        if not any(_same(edges[edge], edges[other], tolerance) for other in alike):
            alike.append(edge)
            kept.append(edge)
    return kept


def _same(a: Subpath, b: Subpath, tolerance: float) -> bool:
    """Whether two strokes between the same ends lie on one another; they may have been cut up differently."""
    forth = trace(b)
    if abs(a.start - forth[0]) > abs(a.start - forth[-1]):
        forth = forth[::-1]
    mine = trace(a)
    if len(mine) == len(forth):
        return max(abs(p - q) for p, q in zip(mine, forth, strict=True)) <= 2 * tolerance
    lines = [shapely.LineString([(p.real, p.imag) for p in points]) for points in (mine, forth)]
    return bool(lines[0].hausdorff_distance(lines[1]) <= 2 * tolerance)


def _without_ends(group: Sequence[int], nodes: Ints) -> list[int]:
    """Without edges that lead nowhere, again and again."""
    kept = list(group)
    while True:
        degree = Counter(nodes[kept].ravel().tolist())
        left = [edge for edge in kept if min(degree[n] for n in nodes[edge].tolist()) > 1]
        if len(left) == len(kept):
            return kept
        kept = left


def _traced(group: Sequence[int], nodes: Ints, edges: Sequence[Subpath]) -> tuple[list[list[Way]], list[complex]]:
    """All faces, each with its inside on the left (the outer ones run clockwise), and where edges lie on others."""
    leaving: dict[int, list[Way]] = {}
    for edge in group:
        leaving.setdefault(int(nodes[edge][0]), []).append((edge, False))
        leaving.setdefault(int(nodes[edge][1]), []).append((edge, True))
    after: dict[Way, Way] = {}
    overlapping = []
    for ways in leaving.values():
        reach = 1e-2 * min(_length(edges[edge]) for edge, _ in ways)
        angles = {way: _direction(way, edges, reach) for way in ways}
        order = sorted(ways, key=lambda way: angles[way])
        for way, following in zip(order, order[1:] + order[:1], strict=True):
            step = (angles[following] - angles[way]) % (2 * math.pi)
            if len(order) > 1 and min(step, 2 * math.pi - step) < _TIE:
                edge, back = way
                overlapping.append(edges[edge].segments[-1].end if back else edges[edge].start)
            edge, back = following
            after[edge, not back] = way  # coming in by `following`, the face on the left leaves by the next clockwise
    faces, waiting = [], dict.fromkeys(after)
    while waiting:
        way = next(iter(waiting))
        face = []
        while way in waiting:
            del waiting[way]
            face.append(way)
            way = after[way]
        faces.append(face)
    return faces, overlapping


def _direction(way: Way, edges: Sequence[Subpath], reach: float) -> float:
    """Angle in which an edge leaves its start, looked at a little way along so that tangent curves differ."""
    edge, back = way
    path = backward(edges[edge]) if back else edges[edge]
    first = path.segments[0]
    length = _length(Subpath(path.start, [first], False))
    there = point_on(path.start, first, min(1.0, reach / length if length else 1.0))
    return cmath.phase(there - path.start)


def _length(path: Subpath) -> float:
    points = trace(path)
    return sum(abs(b - a) for a, b in pairwise(points))


def _area(way: Sequence[Way], edges: Sequence[Subpath]) -> float:
    """Area inside a way, positive where it runs counter-clockwise; curves by enough chords to tell its sign."""
    points: list[complex] = []
    for edge, back in way:
        points += trace(backward(edges[edge]) if back else edges[edge], 16)[:-1]
    total = sum(((a - points[0]).conjugate() * (b - points[0])).imag for a, b in pairwise(points))
    return total / 2


def _outline(way: Sequence[Way], nodes: Ints, at: Sequence[complex], edges: Sequence[Subpath]) -> Subpath:
    """One closed stroke; ends that meet become one point exactly."""
    segments = []
    start = at[nodes[way[0][0]][1 if way[0][1] else 0]]
    for edge, back in way:
        path = backward(edges[edge]) if back else edges[edge]
        last = path.segments[-1]
        end = at[nodes[edge][0 if back else 1]]
        segments += [*path.segments[:-1], last._replace(end=end)]
    return Subpath(start, segments, True)
