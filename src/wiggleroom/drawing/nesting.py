"""Which outlines are holes: the fill rule inside one path, and parts drawn inside other parts."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import shapely

from wiggleroom.drawing.model import Points, Region
from wiggleroom.drawing.rings import clean_ring, signed_area


def regions_by_fill_rule(rings: Sequence[Points], *, even_odd: bool) -> list[Region]:
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
        With a plain reason and a point, where a ring crosses itself or another one. A single ring is passed on
        as it is, because the validation of the assembly looks at it.

    Examples
    --------
    >>> square = np.array([[0.0, 0], [9, 0], [9, 9], [0, 9]])
    >>> [len(region.holes) for region in regions_by_fill_rule([square, square / 3 + 1], even_odd=True)]
    [1]
    """
    if len(rings) == 1:
        return [Region(clean_ring(rings[0]))]
    rings = sorted(rings, key=lambda ring: -abs(signed_area(ring)))
    polygons = [shapely.Polygon(ring) for ring in rings]
    for polygon in polygons:
        _refuse_crossing(polygon)
    turns = [1 if signed_area(ring) > 0 else -1 for ring in rings]
    outers: list[int] = []
    holes: dict[int, list[Points]] = {}
    for i, inner in enumerate(polygons):
        around = [j for j in range(i) if _encloses(polygons[j], inner)]
        outside = len(around) if even_odd else sum(turns[j] for j in around)
        inside = outside + (1 if even_odd else turns[i])
        full, was_full = (inside % 2 == 1, outside % 2 == 1) if even_odd else (inside != 0, outside != 0)
        if full and not was_full:
            outers.append(i)
            holes[i] = []
        elif was_full and not full:
            holes[max(set(around) & set(outers))].append(clean_ring(rings[i], clockwise=True))
    return [Region(clean_ring(rings[i]), tuple(holes[i])) for i in outers]


def _refuse_crossing(polygon: shapely.Polygon) -> None:
    reason = shapely.is_valid_reason(polygon)
    if reason != "Valid Geometry":
        numbers = re.findall(r"[-+.\deE]+", reason.partition("[")[2])
        where = ", ".join(f"{float(number):.6g}" for number in numbers[:2])
        message = f"an outline crosses itself at ({where}) mm; it must not where a path has several outlines"
        raise ValueError(message)


def _encloses(outer: shapely.Polygon, inner: shapely.Polygon) -> bool:
    if not outer.intersects(inner) or outer.touches(inner):
        return False
    if outer.covers(inner):
        return True
    point = shapely.intersection(outer.exterior, inner.exterior).representative_point()
    message = f"two outlines cross at ({point.x:.6g}, {point.y:.6g}) mm; join them into one, or draw two paths"
    raise ValueError(message)


def cut_nested(parts: Sequence[Sequence[Region]], tolerance: float) -> list[list[Region]]:
    """Cut the outlines of parts that are drawn inside other parts out of those, where these have no hole yet.

    Parameters
    ----------
    parts : sequence of sequences of Region [mm]
        Material of every part as drawn.
    tolerance : float [mm]
        Chord error of the outlines: two that overlap by no more than this only touch.

    Returns
    -------
    list of lists of Region [mm]
        In the same order; the material directly around an inner part has a hole of exactly its outline.

    Examples
    --------
    >>> square = np.array([[0.0, 0], [9, 0], [9, 9], [0, 9]])
    >>> tray, tile = cut_nested([[Region(square)], [Region(square / 3 + 1)]], 1e-3)
    >>> tray[0].holes[0].tolist()
    [[1.0, 4.0], [4.0, 4.0], [4.0, 1.0], [1.0, 1.0]]
    """
    owners = [(i, j) for i, regions in enumerate(parts) for j in range(len(regions))]
    result = [list(regions) for regions in parts]
    outlines = np.array([shapely.Polygon(region.outer) for regions in parts for region in regions])
    cuts: dict[int, list[int]] = {}
    for inner, outer in _direct_parents(outlines).items():
        region = parts[owners[outer][0]][owners[outer][1]]
        if owners[inner][0] != owners[outer][0] and not _meets_hole(outlines[inner], region, tolerance):
            cuts.setdefault(outer, []).append(inner)
    replaced: dict[tuple[int, int], list[Region]] = {
        owners[outer]: _cut(parts[owners[outer][0]][owners[outer][1]], outlines[inners])
        for outer, inners in cuts.items()
    }
    for part in {i for i, _ in replaced}:
        result[part] = [piece for j, region in enumerate(parts[part]) for piece in replaced.get((part, j), [region])]
    return result


def _direct_parents(outlines: np.ndarray) -> dict[int, int]:
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


def _meets_hole(outline: shapely.Polygon, region: Region, tolerance: float) -> bool:
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
