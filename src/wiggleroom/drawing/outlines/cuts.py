"""Which outlines are parts and which are cuts: holes inside a part, slots and notches across its edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.outlines.connected_components import components

SMALL = 0.25
"""A cut that nothing names takes at most this share of the part around or under it."""
WITHIN = 0.2
"""At least this share of a cut that nothing names lies in the part whose edge it crosses: a circle at a corner has a quarter."""
BESIDE = 0.05
"""An outline with more than this share over a second part lies over both: a key, perhaps."""

FULL = 0.9
"""An outline that lies in a hole with more than this share is no further cut there, but a part pressed in."""
MOVED = 1e-3
"""An outline whose area differs by no more than this share from one that it nearly fills is the same one, drawn beside itself."""
LEAST = 1e-6
"""Outlines that share less than this of the smaller one only touch."""
TILE_SIZES = 0.02
"""Sizes of tiles differ by no more than this share, ..."""
TILE_SIDE = 0.15
"""... each shares at least this share of its outline with another one, and none of that size is a hole beside them."""


@dataclass(frozen=True, eq=False)
class Claims:
    """What a file and its reader say about each outline, one entry an outline.

    Parameters
    ----------
    solid : list of bool
        It is a part: by an option, as it stands or is moved, or as a face of a net.
    marked : list of bool
        It looks like a part: filled, labelled, named by a text.
    cut : list of str
        It is a cut, and who says so: "option", "all", "layer", or a name as `cut_by` knows them; or nothing.
    named : list of bool
        A person gave it a name of its own.
    face : list of bool
        It is a face of a net of lines, so that nothing lies around or under it.
    style : list
        Outlines of one style are drawn with the same line.
    """

    solid: list[bool]
    marked: list[bool]
    cut: list[str]
    named: list[bool]
    face: list[bool]
    style: list[object]

    def is_part(self, row: int) -> bool:
        """Whether an outline is a part wherever it lies."""
        cut = self.cut[row]
        return cut != "option" and (self.solid[row] or (self.marked[row] and not cut))


@dataclass(frozen=True, eq=False)
class EdgeCrossings:
    """Pairs of outlines of which one crosses the edge of the other.

    Parameters
    ----------
    of : dict
        By row, the larger outlines whose edge it crosses, and which share of it lies in their material.
    both : dict
        By row, all outlines that it crosses.
    alike : set of int
        Outlines that nearly fill another one of their size, across its edge: a part pressed into a hole, perhaps.
    """

    of: dict[int, dict[int, float]]
    both: dict[int, set[int]]
    alike: set[int]


@dataclass(frozen=True, eq=False)
class Cuts:
    """Outlines that are cuts.

    Parameters
    ----------
    rows : set of int
        All of them.
    across : dict of lists
        By row of a part, the cuts that cross its edge.
    joined : set of int
        Cuts inside a part that touch or cross each other or its edge.
    loose : list of int
        Outlines that should be cuts, but lie in no part.
    kept : list of int
        Outlines inside a part that touch its edge or each other, and were taken as parts.
    """

    rows: set[int]
    across: dict[int, list[int]]
    joined: set[int]
    loose: list[int]
    kept: list[int]


def crossings(outlines: NDArray[np.object_], parents: dict[int, int], lies: dict[int, float]) -> EdgeCrossings:
    """Outlines that cross the edges of others.

    Parameters
    ----------
    outlines : (n,) polygons [mm]
    parents : dict of int
        For every outline inside another one, the smallest that holds it.
    lies : dict of float
        Of outlines that meet a hole of the path of their parent, the share that lies in material.

    Examples
    --------
    >>> pair = np.array([shapely.box(0, 0, 9, 9), shapely.box(4, 8, 5, 10)])
    >>> crossings(pair, {}, {}).of
    {1: {0: 0.5}}
    """
    of: dict[int, dict[int, float]] = {}
    both: dict[int, set[int]] = {}
    alike: set[int] = set()
    for row, share in lies.items():
        if 0 < share < 1:
            of.setdefault(row, {})[parents[row]] = share
    sound, area = shapely.is_valid(outlines), shapely.area(outlines)
    edges = shapely.boundary(outlines)
    shapely.prepare(edges)
    first, second = shapely.STRtree(edges).query(edges)
    order = (area[first] < area[second]) | ((area[first] == area[second]) & (first > second))
    order &= sound[first] & sound[second] & (first != second)
    first, second = first[order], second[order]
    meet = shapely.intersects(edges[second], edges[first])
    first, second = first[meet], second[meet]
    common = shapely.area(shapely.intersection(outlines[first], outlines[second]))
    share, outside = common / area[first], area[first] - common
    crossing = (share > LEAST) & (outside > 1e-9 * area[first])
    for i, j, shared in zip(first[crossing].tolist(), second[crossing].tolist(), share[crossing].tolist(), strict=True):
        of.setdefault(i, {})[j] = shared
        if shared > FULL and FULL * area[j] < area[i] < (1 - MOVED) * area[j]:
            alike |= {i, j}
        both.setdefault(i, set()).add(j)
        both.setdefault(j, set()).add(i)
    return EdgeCrossings(of, both, alike)


def cuts_of(
    outlines: NDArray[np.object_],
    parents: dict[int, int],
    in_material: dict[int, int],
    crossing: EdgeCrossings,
    claims: Claims,
    touch: float,
) -> Cuts:
    """Which outlines are cuts.

    From the largest to the smallest: an outline inside a part is a hole; inside a hole, a part. One that crosses the edge of
    a part is a cut where the file says so, or where it is small, drawn with the same line, without a name of its own and
    over no second part.

    Parameters
    ----------
    outlines : (n,) polygons [mm]
    parents, in_material : dict of int
        For every outline inside another one, the smallest that holds it; without those that meet a hole of its path.
    crossing : EdgeCrossings
    claims : Claims
    touch : float [mm]
        Outlines nearer than this touch.

    Examples
    --------
    >>> squares = np.array([shapely.box(-r, -r, r, r) for r in (9, 6, 3)])
    >>> plain = Claims([False] * 3, [False] * 3, [""] * 3, [False] * 3, [False] * 3, [0] * 3)
    >>> nest = {1: 0, 2: 1}
    >>> cuts_of(squares, nest, nest, EdgeCrossings({}, {}, set()), plain, 1e-6).rows
    {1}
    """
    area = shapely.area(outlines)
    joined, pieces = _touching(outlines, area, in_material, crossing, claims, touch)
    cut: set[int] = set()
    loose: list[int] = []
    host: dict[int, int] = {}  # the part that a cut was taken from

    def clear(i: int, j: int, share: float) -> bool:
        """Whether an outline that nothing names is a cut across the edge of another one."""
        alike = not claims.named[i] and claims.style[i] == claims.style[j]
        return bool(alike and area[i] <= SMALL * area[j] and share >= WITHIN)

    for i in np.argsort(-area, kind="stable").tolist():
        parent, said = in_material.get(i), claims.cut[i]
        over = crossing.of.get(i, {})
        inside_part = parent is not None and parent not in cut
        if claims.is_part(i):
            continue
        if said == "name" and parent in cut and not over:
            continue  # a part in a hole, whatever its layer is called
        if said and not (said == "all" and claims.solid[i]):
            chosen = said in ("layer", "option")
            if claims.face[i] or parent is not None or over or i in parents or (chosen and i in crossing.both):
                cut.add(i)
                host[i] = parent if inside_part and parent is not None else max(over, key=over.__getitem__, default=i)
            elif chosen:
                loose.append(i)
        elif inside_part:
            if i not in pieces:
                cut.add(i)
                host[i] = parent  # type: ignore[assignment]
        elif over:
            lies = {j: share for j, share in over.items() if j not in cut and share > BESIDE}
            gone = [host[j] for j, share in over.items() if j in cut and host[j] != j and share <= FULL]
            under = next(iter(lies), gone[0] if gone else None)
            if under is not None and len(lies) < 2 and clear(i, under, lies.get(under, 1.0)):
                cut.add(i)
                host[i] = under
    across: dict[int, list[int]] = {}
    for i in sorted(cut):
        over = crossing.of.get(i, {})
        by_name = claims.cut[i] in ("option", "layer")
        for j in [*over, *(sorted(crossing.both.get(i, set()) - over.keys()) if by_name else ())]:
            # A hole of a tray under the edge of a piece in it does not cut the piece.
            nested = not claims.cut[i] and i in in_material and host[i] != j and not clear(i, j, over.get(j, 0.0))
            if j not in cut and not nested:
                across.setdefault(j, []).append(i)
    kept = [i for i in sorted(pieces) if i not in cut and not claims.is_part(i) and in_material[i] not in cut]
    return Cuts(cut, across, joined & cut, loose, kept)


def _are_tiles(outlines: NDArray[np.object_], touch: float) -> bool:
    """Whether outlines are of one size and share whole sides, as pieces of a puzzle do and slots do not."""
    if len(outlines) < 2:
        return False
    area, edges = shapely.area(outlines), shapely.boundary(outlines)
    if np.ptp(area) > TILE_SIZES * area.max():
        return False
    first, second = shapely.STRtree(edges).query(edges, predicate="dwithin", distance=touch)
    first, second = first[first != second], second[first != second]
    shared = shapely.length(shapely.intersection(edges[first], shapely.buffer(edges[second], touch)))
    longest = np.zeros(len(outlines))
    np.maximum.at(longest, first, shared)
    return bool((longest >= TILE_SIDE * shapely.length(edges)).all())


def _touching(
    outlines: NDArray[np.object_],
    area: NDArray[np.float64],
    in_material: dict[int, int],
    crossing: EdgeCrossings,
    claims: Claims,
    touch: float,
) -> tuple[set[int], set[int]]:
    """Outlines inside a part that touch each other or its edge, and those among them that are parts.

    Those that cross each other are one hole; so are small ones without names of their own. Others fit together as parts do.
    """
    siblings: dict[int, list[int]] = {}
    for i, parent in in_material.items():
        siblings.setdefault(parent, []).append(i)
    touching: set[int] = set()
    pieces: set[int] = set()
    for parent, rows in siblings.items():
        edges = shapely.boundary(np.append(outlines[rows], outlines[parent]))
        first, second = shapely.STRtree(edges).query(edges, predicate="dwithin", distance=touch)
        apart = first != second
        first, second = first[apart], second[apart]
        touching |= {rows[k] for k in first.tolist() if k < len(rows)}
        inner = (first < len(rows)) & (second < len(rows))
        label = components(len(rows), first[inner], second[inner])
        clusters: dict[int, list[int]] = {}
        for row, key in zip(rows, label.tolist(), strict=True):
            if row in touching:
                clusters.setdefault(key, []).append(row)
        for members in clusters.values():
            inside = set(members)
            open_ = [row for row in members if not claims.cut[row]]
            small = area[open_].sum() <= SMALL * area[parent]
            named = any(claims.named[row] or claims.is_part(row) for row in open_)
            lone = area[[row for row in rows if row not in touching]]
            like = (np.abs(lone[:, None] - area[open_]) <= TILE_SIZES * area[open_]).any()
            tiles = not like and _are_tiles(outlines[[row for row in open_ if not claims.face[row]]], touch)
            named = named or tiles
            for row in open_:
                crosses = crossing.both.get(row, set()) & inside
                if row in crossing.alike or (not crosses and (named or not small)):
                    pieces.add(row)
    return touching, pieces
