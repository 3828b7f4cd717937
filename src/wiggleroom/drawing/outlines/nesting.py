"""Which outlines are holes: the fill rule inside one path, and the nesting of outlines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.model import Points, Region
from wiggleroom.drawing.outlines.rings import clean_ring, signed_area


@dataclass(frozen=True, eq=False)
class PathRegions:
    """Material of one path.

    Parameters
    ----------
    regions : list of Region [mm]
    hidden : list of (n, 2) float64 [mm]
        Outlines that lie in the material by the fill rule, so that they bound nothing.
    """

    regions: list[Region]
    hidden: list[Points]


def regions_by_fill_rule(rings: Sequence[Points], *, even_odd: bool) -> PathRegions:
    """Material that a fill rule leaves inside the rings of one path.

    Parameters
    ----------
    rings : sequence of (n, 2) float64 [mm]
        Clean outlines in the sense in which they were drawn.
    even_odd : bool
        The fill rule; else non-zero.

    Raises
    ------
    ValueError
        With a plain reason and a point, where a ring crosses itself or another one. A single ring is passed on as it
        is, because the validation of the assembly looks at it.

    Examples
    --------
    >>> square = np.array([[0.0, 0], [9, 0], [9, 9], [0, 9]])
    >>> [len(region.holes) for region in regions_by_fill_rule([square, square / 3 + 1], even_odd=True).regions]
    [1]
    """
    if len(rings) == 1:
        return PathRegions([Region(clean_ring(rings[0]))], [])
    rings = sorted(rings, key=lambda ring: -abs(signed_area(ring)))
    polygons = np.array([shapely.Polygon(ring) for ring in rings])
    around = _around(polygons)
    turns = [1 if signed_area(ring) > 0 else -1 for ring in rings]
    outers: list[int] = []
    holes: dict[int, list[Points]] = {}
    hidden = []
    for i, holders in enumerate(around):
        outside = len(holders) if even_odd else sum(turns[j] for j in holders)
        inside = outside + (1 if even_odd else turns[i])
        full, was_full = (inside % 2 == 1, outside % 2 == 1) if even_odd else (inside != 0, outside != 0)
        if full and not was_full:
            outers.append(i)
            holes[i] = []
        elif was_full and not full:
            holes[max(set(holders) & set(outers))].append(clean_ring(rings[i], clockwise=True))
        else:
            hidden.append(rings[i])
    return PathRegions([Region(clean_ring(rings[i]), tuple(holes[i])) for i in outers], hidden)


def _around(polygons: NDArray[np.object_]) -> list[list[int]]:
    """For every polygon those that hold it, all in order of area, the largest first."""
    for polygon in polygons:
        _, _, at = shapely.is_valid_reason(polygon).partition("[")
        if at:
            x, y = (float(number) for number in at.rstrip("]").split()[:2])
            message = (
                f"an outline crosses itself at ({x:.6g}, {y:.6g}) mm; it must not where a path has several outlines"
            )
            raise ValueError(message)
    around: list[list[int]] = [[] for _ in polygons]
    first, second = shapely.STRtree(polygons).query(polygons)
    later = first > second
    inner, outer = first[later], second[later]
    covered = shapely.covers(polygons[outer], polygons[inner])
    crossing = ~covered & shapely.overlaps(polygons[outer], polygons[inner])
    for i, j in zip(inner[crossing].tolist(), outer[crossing].tolist(), strict=True):
        common = shapely.intersection(polygons[i], polygons[j])
        if common.area > 1e-9 * polygons[i].area:
            point = shapely.intersection(polygons[i].exterior, polygons[j].exterior).representative_point()
            message = f"two outlines cross at ({point.x:.6g}, {point.y:.6g}) mm; join them into one, or draw two paths"
            raise ValueError(message)
    for i, j in zip(inner[covered].tolist(), outer[covered].tolist(), strict=True):
        around[i].append(j)
    return [sorted(holders) for holders in around]


def hole_rows(
    outlines: NDArray[np.object_], parents: dict[int, int], solid: Sequence[bool], tolerance: float
) -> set[int]:
    """Outlines that are holes of the part around them.

    One inside a part is a hole if it contains another outline, or if it is empty; but not if it is solid or touches
    another outline inside that part, or the edge of the part: two holes that touch would be one.

    Parameters
    ----------
    outlines : (n,) polygons [mm]
    parents : dict of int
        For every outline inside another one, the smallest that holds it.
    solid : (n,) bool
        Outlines that are parts in any case.
    tolerance : float [mm]
        Outlines nearer than this touch.

    Examples
    --------
    >>> squares = np.array([shapely.box(-r, -r, r, r) for r in (9, 6, 3)])
    >>> hole_rows(squares, {1: 0, 2: 1}, [False] * 3, 1e-6)
    {1}
    """
    if not parents:
        return set()
    siblings: dict[int, list[int]] = {}
    for i, parent in parents.items():
        siblings.setdefault(parent, []).append(i)
    touching = set()
    for parent, rows in siblings.items():
        edges = shapely.boundary(np.append(outlines[rows], outlines[parent]))
        first, second = shapely.STRtree(edges).query(edges, predicate="dwithin", distance=tolerance)
        touching |= {rows[k] for k in first[first != second].tolist() if k < len(rows)}
    holes: set[int] = set()
    for i in np.argsort(-shapely.area(outlines), kind="stable").tolist():
        inside_part = i in parents and parents[i] not in holes
        if inside_part and not solid[i] and i not in touching:
            holes.add(i)
    return holes


def cut_nested(
    regions: Sequence[Region], parents: dict[int, int], holes: set[int], tolerance: float
) -> dict[int, list[Region]]:
    """Material of every part: outlines inside it cut out, where it has no hole there yet.

    Parameters
    ----------
    regions : sequence of Region [mm]
        Material as drawn.
    parents : dict of int
        For every outline inside another one, the smallest that holds it.
    holes : set of int
        Rows that are holes, not parts.
    tolerance : float [mm]
        Chord error of the outlines: two that overlap by no more than this only touch.

    Returns
    -------
    dict of lists of Region [mm]
        By row; the material directly around an inner outline has a hole of exactly that outline.

    Examples
    --------
    >>> square = np.array([[0.0, 0], [9, 0], [9, 9], [0, 9]])
    >>> cut = cut_nested([Region(square), Region(square / 3 + 1)], {1: 0}, set(), 1e-3)
    >>> cut[0][0].holes[0].tolist()
    [[1.0, 4.0], [4.0, 4.0], [4.0, 1.0], [1.0, 1.0]]
    """
    result = {i: [region] for i, region in enumerate(regions) if i not in holes}
    outlines = np.array([shapely.Polygon(region.outer) for region in regions])
    cuts: dict[int, list[int]] = {}
    for inner, outer in parents.items():
        if outer not in holes and not meets_hole(outlines[inner], regions[outer], tolerance):
            cuts.setdefault(outer, []).append(inner)
    for outer, inners in cuts.items():
        result[outer] = _cut(regions[outer], outlines[inners])
    return result


def direct_parents(outlines: NDArray[np.object_]) -> dict[int, int]:
    """For every outline inside another one, the smallest that holds it."""
    sound, area = shapely.is_valid(outlines), shapely.area(outlines)
    inner, outer = shapely.STRtree(outlines).query(outlines)
    box = shapely.bounds(outlines)
    slack = 1e-9 * np.ptp(box.reshape(-1, 2), axis=0).max()
    held = (box[inner, :2] >= box[outer, :2] - slack).all(axis=1)
    held &= (box[inner, 2:] <= box[outer, 2:] + slack).all(axis=1)
    held &= (area[inner] < area[outer]) & sound[inner] & sound[outer]
    inner, outer = inner[held], outer[held]
    rest = shapely.area(shapely.difference(outlines[inner], outlines[outer]))
    inside = rest <= 1e-9 * area[inner]
    parents: dict[int, int] = {}
    for i, j in zip(inner[inside].tolist(), outer[inside].tolist(), strict=True):
        if i not in parents or area[j] < area[parents[i]]:
            parents[i] = j
    return parents


def meets_hole(outline: shapely.Polygon, region: Region, tolerance: float) -> bool:
    """Tell whether a hole is there already; where it is too small, that is an overlap to report, not to cut."""
    holes = [shapely.Polygon(hole) for hole in region.holes]
    shared = sum(shapely.area(shapely.intersection(outline, holes))) if holes else 0.0
    return bool(shared > tolerance * outline.length + 1e-9 * outline.area)


def _cut(region: Region, inners: np.ndarray) -> list[Region]:
    """Cut holes of exactly the inner outlines; where these touch each other or an edge, take the difference."""
    edges = np.array([shapely.LinearRing(ring) for ring in (region.outer, *region.holes)])
    first, second = shapely.STRtree(inners).query(inners, predicate="intersects")
    apart = (first == second).all() and not shapely.intersects(edges[:, None], inners).any()
    if apart:
        new = (clean_ring(shapely.get_coordinates(inner), clockwise=True) for inner in inners)
        return [Region(region.outer, (*region.holes, *new))]
    rest = shapely.difference(shapely.Polygon(region.outer, region.holes), shapely.union_all(inners))
    least = 1e-9 * shapely.Polygon(region.outer).area
    pieces = [piece for piece in shapely.get_parts(rest) if piece.area > least]
    return [
        Region(
            clean_ring(shapely.get_coordinates(piece.exterior)),
            tuple(
                clean_ring(shapely.get_coordinates(hole), clockwise=True)
                for hole in piece.interiors
                if shapely.Polygon(hole).area > least
            ),
        )
        for piece in pieces
    ]
