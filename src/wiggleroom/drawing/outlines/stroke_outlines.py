"""Outlines that the closed subpaths of one stroke make."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from wiggleroom.drawing.model import Points, Region
from wiggleroom.drawing.outlines.cuts import SMALL, WITHIN
from wiggleroom.drawing.outlines.nesting import regions_by_fill_rule
from wiggleroom.drawing.outlines.outline_repair import mend
from wiggleroom.drawing.outlines.rings import clean_ring
from wiggleroom.drawing.outlines.traced_outlines import Outline, Remark, Traced
from wiggleroom.drawing.strokes.elements import Stroke


def of_stroke(found: Traced, stroke: Stroke, row: int, drawn: Sequence[Points]) -> list[Outline]:
    """Outlines of the closed subpaths of one stroke."""
    sound = [ring for ring in drawn if len(clean_ring(ring)) >= 3]
    if not sound:
        found.note(f"{stroke} encloses nothing and is left out")
        return []
    rings: list[Points] = []
    for ring in sound:
        mended = mend(ring[:-1] if (ring[0] == ring[-1]).all() else ring)
        rings += mended.rings
        for kind, at in mended.faults:
            found.remarks.append(Remark(f"mended {kind}", (np.array([at]),)))
    rings = _distinct_rings(rings)
    lines = (not stroke.fill or not stroke.styled) and not stroke.whole
    separate = (
        lines and len(rings) > 1 and (_cross(rings) or (not stroke.fill and len(rings) > 2 and _holes_touch(rings)))
    )
    try:
        if separate:
            regions = [Region(clean_ring(ring)) for ring in rings]
        else:
            result = regions_by_fill_rule(rings, even_odd=stroke.even_odd or not stroke.fill)
            regions = result.regions
            if result.hidden:
                found.note(
                    f"{stroke}: {len(result.hidden)} of its outlines lie in its fill and bound nothing (fill rule nonzero); "
                    "they are left out"
                )
                found.remarks.append(Remark("left out", tuple(result.hidden)))
    except ValueError as error:
        found.findings.append(f"{found.file}: {stroke}: {error}")
        found.remarks.append(Remark("crossing", tuple(rings)))
        return []
    return [Outline(region, stroke, row) for region in regions]


def _distinct_rings(rings: list[Points]) -> list[Points]:
    """Without rings of one path that were drawn before, to the last bit."""
    if len(rings) < 2:
        return rings
    seen: dict[bytes, Points] = {}
    for ring in rings:
        corners = clean_ring(ring)
        seen.setdefault(corners[np.lexsort(corners.T)].tobytes(), ring)
    return list(seen.values())


def _cross(rings: Sequence[Points]) -> bool:
    """Whether outlines of one path cross each other as cuts do: a slot over an edge, two slots inside."""
    polygons = np.array([shapely.Polygon(ring) for ring in rings])
    if not shapely.is_valid(polygons).all():
        return False
    first, second = shapely.STRtree(polygons).query(polygons, predicate="overlaps")
    area = shapely.area(polygons)
    share = shapely.area(shapely.intersection(polygons[first], polygons[second])) / area[first]
    pairs = (share > 1e-9) & (area[first] <= area[second])
    first, second, share = first[pairs], second[pairs], share[pairs]
    clear = (area[first] <= SMALL * area[second]) & (share >= WITHIN)
    inner, outer = shapely.STRtree(polygons).query(polygons, predicate="covered_by")
    held: dict[int, set[int]] = {}
    for i, j in zip(inner.tolist(), outer.tolist(), strict=True):
        if i != j:
            held.setdefault(i, set()).add(j)
    pairs = zip(first.tolist(), second.tolist(), strict=True)
    around = [bool(held.get(i, set()) & held.get(j, set())) for i, j in pairs]
    return len(first) > 0 and bool((clear | np.array(around, dtype=bool)).all())


def _holes_touch(rings: Sequence[Points]) -> bool:
    """Whether outlines inside another one of the same path touch each other: pieces, not holes."""
    polygons = np.array([shapely.Polygon(ring) for ring in rings])
    if not shapely.is_valid(polygons).all():
        return False
    first, second = shapely.STRtree(polygons).query(polygons, predicate="contains")
    inner = np.unique(second[first != second])
    if len(inner) < 2:
        return False
    edges = shapely.boundary(polygons[inner])
    a, b = shapely.STRtree(edges).query(edges, predicate="intersects")
    return bool((a != b).any())
