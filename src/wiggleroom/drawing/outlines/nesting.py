"""Which outlines are holes: the fill rule inside one path, and the nesting of outlines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.model import Points, Region
from wiggleroom.drawing.outlines.rings import clean_ring, signed_area

WALL_LENGTH = 10.0
"""A wall too thin to stand is longer round than this many times the thickness; what is shorter is the tip of a corner."""
FILM = 1e-7
"""What is thinner than this share of the least wall is rounding."""


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


def cut_nested(
    regions: Sequence[Region],
    inside: dict[int, int],
    cuts: set[int],
    across: Mapping[int, Sequence[int]],
    touch: float,
) -> dict[int, list[Region]]:
    """Material of every part: what lies inside it or cuts across its edge taken out.

    Parameters
    ----------
    regions : sequence of Region [mm]
        Material as drawn.
    inside : dict of int
        For every outline inside another one, the smallest that holds it; where that has no hole there yet.
    cuts : set of int
        Rows that are cuts, not parts.
    across : dict of sequences of int
        By row of a part, the cuts that cross its edge.
    touch : float [mm]
        Walls between two cuts, or a cut and the edge, that are thinner than this are gone.

    Returns
    -------
    dict of lists of Region [mm]
        By row; the material directly around an inner outline has a hole of exactly that outline.

    Examples
    --------
    >>> square = np.array([[0.0, 0], [9, 0], [9, 9], [0, 9]])
    >>> cut = cut_nested([Region(square), Region(square / 3 + 1)], {1: 0}, set(), {}, 1e-3)
    >>> cut[0][0].holes[0].tolist()
    [[1.0, 4.0], [4.0, 4.0], [4.0, 1.0], [1.0, 1.0]]
    """
    result = {i: [_opened(region, touch)] for i, region in enumerate(regions) if i not in cuts}
    outlines = np.array([shapely.Polygon(region.outer) for region in regions])
    inner_rows: dict[int, list[int]] = {}
    for inner, outer in inside.items():
        if outer not in cuts:
            inner_rows.setdefault(outer, []).append(inner)
    for row in sorted({*inner_rows, *across}):
        rows = list(dict.fromkeys((*inner_rows.get(row, ()), *across.get(row, ()))))
        gone = outlines[[k for k in rows if k in cuts]]
        result[row] = _cut(result[row][0], outlines[rows], gone, touch)
    return result


def _opened(region: Region, touch: float) -> Region:
    """The same with holes that a path has a hair inside its edge open to it, where that leaves one piece."""
    edge = shapely.LinearRing(region.outer)
    near = [hole for hole in region.holes if shapely.dwithin(edge, shapely.LinearRing(hole), touch)]
    material = shapely.Polygon(region.outer, region.holes)
    if not near or not material.is_valid:
        return region
    rest = _without_walls(material, shapely.union_all([shapely.Polygon(hole) for hole in near]), touch)
    return _as_region(rest) if rest is not material and rest.geom_type == "Polygon" else region


def _as_region(polygon: shapely.Polygon) -> Region:
    outer, *holes = (shapely.get_coordinates(ring) for ring in shapely.get_rings(polygon))
    return Region(clean_ring(outer), tuple(clean_ring(hole, clockwise=True) for hole in holes))


def direct_parents(outlines: NDArray[np.object_]) -> dict[int, int]:
    """For every outline inside another one, the smallest that holds it."""
    sound, area = shapely.is_valid(outlines), shapely.area(outlines)
    inner, outer = shapely.STRtree(outlines).query(outlines)
    box = shapely.bounds(outlines)
    slack = 1e-9 * np.ptp(box.reshape(-1, 2), axis=0).max() if len(box) else 0.0
    held = (box[inner, :2] >= box[outer, :2] - slack).all(axis=1)
    held &= (box[inner, 2:] <= box[outer, 2:] + slack).all(axis=1)
    held &= (area[inner] < area[outer]) & sound[inner] & sound[outer]
    inner, outer = inner[held], outer[held]
    shapely.prepare(outlines)
    inside = shapely.contains_properly(outlines[outer], outlines[inner])
    open_ = np.flatnonzero(~inside & shapely.intersects(outlines[outer], outlines[inner]))  # edges that touch, perhaps
    rest = shapely.area(shapely.difference(outlines[inner[open_]], outlines[outer[open_]]))
    inside[open_] = rest <= 1e-9 * area[inner[open_]]
    parents: dict[int, int] = {}
    for i, j in zip(inner[inside].tolist(), outer[inside].tolist(), strict=True):
        if i not in parents or area[j] < area[parents[i]]:
            parents[i] = j
    return parents


def shares_in_material(
    outlines: NDArray[np.object_], parents: dict[int, int], regions: Sequence[Region], tolerance: float
) -> dict[int, float]:
    """Of outlines that meet a hole which the path around them has, the share of each that lies in material.

    Parameters
    ----------
    outlines : (n,) polygons [mm]
    parents : dict of int
        For every outline inside another one, the smallest that holds it.
    regions : sequence of Region [mm]
        Material of each path.
    tolerance : float [mm]
        Chord error of the outlines: two that overlap by no more than this only touch.
    """
    found: dict[int, float] = {}
    children: dict[int, list[int]] = {}
    for inner, outer in parents.items():
        if regions[outer].holes:
            children.setdefault(outer, []).append(inner)
    for outer, rows in children.items():
        holes = np.array([shapely.Polygon(hole) for hole in regions[outer].holes])
        first, second = shapely.STRtree(holes).query(outlines[rows], predicate="intersects")
        shared = np.bincount(
            first, shapely.area(shapely.intersection(outlines[rows][first], holes[second])), minlength=len(rows)
        )
        for row, common in zip(rows, shared.tolist(), strict=True):
            outline = outlines[row]
            if common > tolerance * outline.length + 1e-9 * outline.area:
                found[row] = 1 - common / outline.area
    return found


def _cut(region: Region, inners: NDArray[np.object_], gone: NDArray[np.object_], touch: float) -> list[Region]:
    """Cut holes of exactly the inner outlines; where these touch each other or an edge, take the difference.

    `gone` are those of the inner outlines that are cuts.
    """
    edges = np.array([shapely.LinearRing(ring) for ring in (region.outer, *region.holes)])
    tree = shapely.STRtree(inners)
    reach = touch if len(gone) else 0.0
    first, second = tree.query(inners, predicate="dwithin", distance=reach)
    near = np.zeros(len(inners), dtype=bool)
    near[first[first != second]] = True
    near[tree.query(edges, predicate="dwithin", distance=reach)[1]] = True
    alone = [clean_ring(shapely.get_coordinates(inner), clockwise=True) for inner in inners[~near]]
    if not near.any():
        return [Region(region.outer, (*region.holes, *alone))]
    material = shapely.Polygon(region.outer, region.holes)
    if not material.is_valid:
        return [region]
    rest = shapely.difference(material, shapely.union_all(inners[near]))
    if len(gone):
        rest = _without_walls(rest, shapely.union_all(gone), touch)
    least = 1e-9 * shapely.Polygon(region.outer).area
    pieces = shapely.get_parts(rest)
    pieces = pieces[shapely.area(pieces) > least]
    own, holder = shapely.STRtree(pieces).query(shapely.point_on_surface(inners[~near]), predicate="within")
    made = []
    for k, piece in enumerate(pieces):
        outer, *holes = shapely.get_rings(piece)
        areas = shapely.area(shapely.polygons(np.array(holes, dtype=object)))
        large = (hole for hole, area in zip(holes, areas, strict=True) if area > least)
        drawn = [clean_ring(shapely.get_coordinates(hole), clockwise=True) for hole in large]
        drawn += [alone[row] for row in own[holder == k].tolist()]
        made.append(Region(clean_ring(shapely.get_coordinates(outer)), tuple(drawn)))
    return made


def _without_walls(rest: shapely.Geometry, gone: shapely.Geometry, touch: float) -> shapely.Geometry:
    """Material without walls beside cuts that are thinner than `touch`: a notch drawn a hair inside the edge is open."""
    core = shapely.buffer(rest, -touch / 2, join_style="mitre")
    thick = shapely.buffer(core, touch / 2, join_style="mitre")
    thin = shapely.get_parts(shapely.difference(rest, thick))
    wall = shapely.length(thin) > WALL_LENGTH * touch
    wall &= shapely.area(thin) > FILM * touch * shapely.length(thin)
    wall &= shapely.dwithin(thin, gone, 1e-3 * touch)
    if not wall.any():
        return rest
    return shapely.difference(rest, shapely.union_all(shapely.buffer(thin[wall], FILM * touch, join_style="mitre")))
