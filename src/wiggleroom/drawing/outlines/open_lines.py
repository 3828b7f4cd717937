"""Outlines that open lines make: joined end to end, or as faces of the net that they form with closed ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.model import Points, Region
from wiggleroom.drawing.outlines.cuts import SMALL
from wiggleroom.drawing.outlines.joining import BEAM, closed_loops, join_ends, open_chains, outline_of
from wiggleroom.drawing.outlines.planar_faces import net_of
from wiggleroom.drawing.outlines.rings import clean_ring
from wiggleroom.drawing.outlines.sheet_frame import View, page_edge
from wiggleroom.drawing.outlines.stroke_outlines import of_stroke
from wiggleroom.drawing.outlines.traced_outlines import OpenLine, Outline, Remark, Traced
from wiggleroom.drawing.strokes.elements import Stroke
from wiggleroom.drawing.strokes.layers import is_cut

_NEAR_SHARE, _NEARLY = 0.01, 1.0
"""An open line whose ends are nearer to each other than this [share of its length, mm] was to be closed, perhaps."""
_CRUMB = 0.01
"""Faces that are smaller than this share of the one beside them, ..."""
_ALIKE = 0.02
"""... and whose size differs by no more than this share from that of another such face, are slots over an edge, ..."""
_SPLINTER = 1e-3
"""... and so are single ones smaller than this share."""

_GAP, _CLOSED_IN = 0.1, 0.6
"""A face between parts is waste where it is smaller than this share of two beside it, with which it shares this share of its edge."""


def joined_lines(found: Traced, lines: Sequence[OpenLine], size: float) -> list[OpenLine]:
    """Outlines that open lines make one after the other; returns the lines that make none."""
    if not lines:
        return []
    once = _distinct_lines(lines, size)
    if len(once) < len(lines):
        found.note(f"{len(lines) - len(once)} open lines are drawn twice; the copies are left out")
    lines = once
    found.open_lines = len(lines)
    corners = [line.corners for line in lines]
    rings = [ring for outline in found.outlines for ring in (outline.region.outer, *outline.region.holes)]
    ends = join_ends(corners, found.join, size, further=found.further, rings=rings)
    if ends.widest > 1e-6 * size:
        found.note(f"open ends were joined, at most {ends.widest:.3g} mm apart (--join sets how far)")
    used = set()
    for loop in closed_loops(ends, [line.stroke.pool for line in lines]):
        ring = outline_of(loop, corners, ends)
        first = min(edge for edge, _ in loop)
        used |= {edge for edge, _ in loop}
        if len(clean_ring(ring)) >= 3:
            found.outlines += of_stroke(found, replace(lines[first].stroke, fill=""), lines[first].row, [ring])
    cut = {
        id(line.stroke): line.stroke.hole or is_cut(line.stroke) for line in {id(x.stroke): x for x in lines}.values()
    }
    for chain in open_chains(ends, [cut[id(line.stroke)] for line in lines]):
        ring = np.vstack([corners[row][::-1] if back else corners[row] for row, back in chain])
        if len(clean_ring(ring)) >= 3:
            first = min(row for row, _ in chain)
            used |= {row for row, _ in chain}
            ring = np.vstack([ring, ring[:1]])
            found.outlines += of_stroke(found, replace(lines[first].stroke, fill=""), lines[first].row, [ring])
    return [line for row, line in enumerate(lines) if row not in used]


def _distinct_lines(lines: Sequence[OpenLine], size: float) -> list[OpenLine]:
    """Without open lines that were drawn before, in either sense."""
    count = np.array([len(line.corners) for line in lines])
    rounded = np.round(np.concatenate([line.corners for line in lines]) / (1e-8 * size)) + 0.0
    seen: dict[bytes, OpenLine] = {}
    for line, start, stop in zip(lines, (np.cumsum(count) - count).tolist(), np.cumsum(count).tolist(), strict=True):
        there = rounded[start:stop]
        seen.setdefault(min(there.tobytes(), there[::-1].tobytes()), line)
    return list(seen.values())


def net_of_lines(found: Traced, lines: Sequence[OpenLine], size: float, view: View | None) -> NDArray[np.object_]:
    """Closed outlines cut by lines, also that of the page, and faces of the lines themselves; returns lines that bound nothing."""
    page = page_edge(found, lines, view)
    found.outlines += [page] if page is not None else []
    corners = [line.corners for line in lines]
    rings = [ring for outline in found.outlines for ring in (outline.region.outer, *outline.region.holes)]
    ends = join_ends(corners, found.join, size, further=found.further, rings=rings)
    reached = _reached(found, corners, max(found.join, found.tolerance, BEAM if found.further else 0.0))
    rings = [ring for k in reached for ring in (found.outlines[k].region.outer, *found.outlines[k].region.holes)]
    net = net_of(corners, ends, rings, join=found.join, chord=found.tolerance, reach=BEAM if found.further else 0.0)
    by_owner, outside = _owners(found, reached, net.faces)
    replaced = {k for k, faces in by_owner.items() if len(faces) > 1}
    made: list[Outline] = []
    cut_out: list[shapely.Polygon] = []
    replaced_whole = 0
    tree = shapely.STRtree([shapely.LineString(points) for points in corners])
    enclosed = _enclosed(found, reached, replaced, net.faces, by_owner)
    for k in sorted(replaced):
        outline = found.outlines[k]
        left, slots = _without_slots([net.faces[f] for f in by_owner[k]])
        if slots:
            cut_out += slots
            replaced_whole += len(left) == 1
        own = _faces(left, outline.stroke, outline.row, outline.region)
        if slots and len(left) == 1:  # still one part, with its name
            own = [Outline(own[0].region, outline.stroke, outline.row)]
        made += [replace(face, enclosed=k in enclosed) for face in own]
    alone = []
    faces = np.array(net.faces, dtype=object)
    neighbours, _ = shapely.STRtree(faces).query(faces, predicate="intersects")
    shared = np.bincount(neighbours, minlength=len(net.faces)) > 1
    gaps = _gaps(faces, outside)
    if gaps:
        at = faces[gaps[0]].representative_point()
        found.note(
            f"{_many(len(gaps), 'small face')} beside outlines whose edges they share taken as waste, and left out "
            f"(the first at ({at.x:.6g}, {at.y:.6g}) mm); close them if they are parts"
        )
        found.remarks.append(Remark("left out", tuple(shapely.get_coordinates(faces[f].exterior) for f in gaps)))
        outside = [f for f in outside if f not in gaps]
    edges = [np.mean(net.faces[f].exterior.coords[:2], axis=0) for f in outside]
    nearest = tree.nearest(shapely.points(edges)).tolist() if outside else []
    for f, line in zip(outside, nearest, strict=True):
        row = lines[line]
        if shared[f]:
            made += _faces([net.faces[f]], row.stroke, row.row, None)
        else:  # nothing is cut: the outline of one part, whose ends overshoot
            ring = clean_ring(shapely.get_coordinates(net.faces[f].exterior))
            alone.append(Outline(Region(ring), replace(row.stroke, fill=""), row.row))
    found.divided = len(replaced) - replaced_whole
    found.outlines = [
        replace(outline, enclosed=k in enclosed) for k, outline in enumerate(found.outlines) if k not in replaced
    ]
    found.outlines += [*made, *alone]
    if cut_out:
        at = cut_out[0].representative_point()
        found.note(
            f"{len(cut_out)} small faces that open lines cut off the edge of an outline are slots, and fall out "
            f"(the first at ({at.x:.6g}, {at.y:.6g}) mm)"
        )
        found.remarks.append(Remark("left out", tuple(shapely.get_coordinates(face.exterior) for face in cut_out)))
    if net.slivers:
        found.note(f"{_many(net.slivers, 'sliver')} between lines, thinner than {found.join:.3g} mm, left out")
    return np.array(net.dangles, dtype=object)


def _reached(found: Traced, lines: Sequence[Points], within: float) -> list[int]:
    """Closed outlines that open lines reach, and that do not overlap each other: closed ones never split each other."""
    polygons = np.array([outline.polygon for outline in found.outlines], dtype=object)
    if not len(polygons):
        return []
    rings = shapely.boundary(polygons)
    _, near = shapely.STRtree(rings).query(
        [shapely.LineString(points) for points in lines], predicate="dwithin", distance=within
    )
    rows = np.unique(near)
    rows = rows[shapely.is_valid(polygons[rows])]
    first, second = shapely.STRtree(polygons[rows]).query(polygons[rows], predicate="overlaps")
    common = shapely.area(shapely.intersection(polygons[rows][first], polygons[rows][second]))
    slack = within * np.minimum(shapely.length(polygons[rows][first]), shapely.length(polygons[rows][second]))
    area = shapely.area(polygons[rows])
    large = area[first] * SMALL >= area[second]  # the other one is a slot across its edge
    crossing = set(first[(common > slack) & ~large].tolist())
    return [int(row) for k, row in enumerate(rows) if k not in crossing]


def _owners(
    found: Traced, reached: Sequence[int], faces: Sequence[shapely.Polygon]
) -> tuple[dict[int, list[int]], list[int]]:
    """Faces inside each closed outline, by the smallest around them, and those inside none; faces of holes are dropped."""
    points = [face.representative_point() for face in faces]
    owner: dict[int, list[int]] = {}
    if not reached:
        return owner, list(range(len(faces)))
    polygons = np.array([found.outlines[k].polygon for k in reached], dtype=object)
    area = shapely.area(polygons)
    held, holder = shapely.STRtree(polygons).query(points, predicate="within")
    smallest: dict[int, int] = {}
    for f, k in zip(held.tolist(), holder.tolist(), strict=True):
        if f not in smallest or area[k] < area[smallest[f]]:
            smallest[f] = k
    for f, k in smallest.items():
        holes = found.outlines[reached[k]].region.holes
        if not any(shapely.Polygon(hole).contains(points[f]) for hole in holes):
            owner.setdefault(reached[k], []).append(f)
    return owner, [f for f in range(len(faces)) if f not in smallest]


def _without_slots(faces: Sequence[shapely.Polygon]) -> tuple[list[shapely.Polygon], list[shapely.Polygon]]:
    """Faces of an outline without what falls out where lines cut slots over its edge, and these slots.

    A slot is small beside its only neighbour, and tiny or one of several that are alike; a part that was cut off is not.
    """
    all_faces = np.array(faces, dtype=object)
    area = shapely.area(all_faces)
    small = np.flatnonzero(area < _CRUMB * area.max())
    if not len(small):
        return list(faces), []
    first, second = shapely.STRtree(all_faces).query(all_faces[small], predicate="intersects")
    first = small[first]
    long = (first != second) & (shapely.length(shapely.intersection(all_faces[first], all_faces[second])) > 0)
    first, second = first[long], second[long]
    single = np.flatnonzero(np.bincount(first, minlength=len(faces)) == 1)
    beside = dict(zip(first.tolist(), second.tolist(), strict=True))
    single = np.array([k for k in single.tolist() if area[k] < _CRUMB * area[beside[k]]], dtype=int)
    size = np.column_stack([area, shapely.length(all_faces)])[single]
    near = (np.abs(size[:, None] - size) <= _ALIKE * size[:, None]).all(axis=2).sum(axis=1) > 1
    tiny = np.array([area[k] < _SPLINTER * area[beside[k]] for k in single.tolist()], dtype=bool)
    slots = set(single[near | tiny].tolist())
    return [face for k, face in enumerate(faces) if k not in slots], [faces[k] for k in sorted(slots)]


def _gaps(faces: NDArray[np.object_], outside: Sequence[int]) -> list[int]:
    """Faces in no outline that are no parts: splinters beside another one, and small ones between others.

    These are small beside at least two, one in a closed outline, that share most of their edge with them.
    """
    if not outside:
        return []
    area, edges = shapely.area(faces), shapely.boundary(faces)
    own = np.array(outside)
    first, second = shapely.STRtree(faces).query(faces[own], predicate="intersects")
    first = own[first]
    large = area[first] <= _GAP * area[second]
    first, second = first[large], second[large]
    shared = shapely.length(shapely.intersection(edges[first], edges[second]))
    first, second, shared = first[shared > 0], second[shared > 0], shared[shared > 0]
    total = np.bincount(first, shared, minlength=len(faces))
    closed = (total >= _CLOSED_IN * shapely.length(edges)) & (np.bincount(first, minlength=len(faces)) > 1)
    closed &= np.bincount(first, ~np.isin(second, own), minlength=len(faces)) > 0
    closed[first[area[first] < _SPLINTER * area[second]]] = True
    return np.flatnonzero(closed).tolist()


def _enclosed(
    found: Traced,
    reached: Sequence[int],
    replaced: set[int],
    faces: Sequence[shapely.Polygon],
    by_owner: dict[int, list[int]],
) -> set[int]:
    """Closed outlines that lie between faces of the one around them, each at least four times as large: slots over a cut."""
    inner = [(k, f) for k in reached for f in by_owner.get(k, [])]
    outer = [(k, f) for k in sorted(replaced) for f in by_owner[k]]
    if not outer:
        return set()
    around = np.array([found.outlines[k].polygon for k, _ in outer], dtype=object)
    own, pieces = (np.array([faces[f] for _, f in pairs], dtype=object) for pairs in (inner, outer))
    first, second = shapely.STRtree(pieces).query(own, predicate="intersects")
    other = np.array(
        [inner[i][0] != outer[j][0] for i, j in zip(first.tolist(), second.tolist(), strict=True)], dtype=bool
    )
    holds = other & shapely.covers(around[second], shapely.point_on_surface(own[first]))
    beside: dict[int, set[int]] = {}
    for i, j in zip(first[holds].tolist(), second[holds].tolist(), strict=True):
        beside.setdefault(inner[i][0], set()).add(j)
    area = shapely.area(pieces)
    return {
        k
        for k, rows in beside.items()
        if len(rows) > 1 and found.outlines[k].polygon.area <= SMALL * area[sorted(rows)].min()
    }


def _faces(faces: Sequence[shapely.Polygon], stroke: Stroke, row: int, region: Region | None) -> list[Outline]:
    """Faces as outlines, from the top left on; holes of the outline that they were cut from stay."""
    plain = replace(stroke, name="", label="", fill="", fixed=stroke.fixed and region is not None)
    order = sorted(faces, key=lambda face: (-round(face.bounds[3], 3), round(face.bounds[0], 3)))
    made = []
    for face in order:
        outer = clean_ring(shapely.get_coordinates(face.exterior))
        holes: tuple[Points, ...] = ()
        if region is not None and region.holes:
            inside = shapely.Polygon(outer)
            holes = tuple(hole for hole in region.holes if inside.contains(shapely.Polygon(hole)))
        made.append(Outline(Region(outer, holes), plain, row, face=region is not None, of_lines=region is None))
    return made


def say_dangles(found: Traced, lines: Sequence[OpenLine], dangles: NDArray[np.object_]) -> None:
    """Note open lines that bound no face, whole ones by name and ends of others by place."""
    if not len(dangles):
        return
    tree = shapely.STRtree([shapely.LineString(line.corners) for line in lines])
    owner = tree.nearest([line.interpolate(0.5, normalized=True) for line in dangles])
    unused = np.zeros(len(lines))
    np.add.at(unused, owner, [line.length for line in dangles])
    length = np.array([line.length for line in tree.geometries])
    whole = unused >= 0.99 * length
    by_stroke: dict[int, OpenLine] = {}
    for k in np.flatnonzero(whole).tolist():
        by_stroke.setdefault(lines[k].row, lines[k])
    if by_stroke:
        named = [_open_name(line) for line in list(by_stroke.values())[:3]]
        more = f" and {len(by_stroke) - 3} more" if len(by_stroke) > 3 else ""
        found.note(f"open paths are left out: {', '.join(named)}{more}; close them if they are parts")
    stubs = [line for line, k in zip(dangles, owner.tolist(), strict=True) if not whole[k]]
    if stubs:
        x, y = shapely.get_coordinates(stubs[0])[0]
        found.note(
            f"{_many(len(stubs), 'end')} of lines that bound nothing left out, the first near ({x:.6g}, {y:.6g}) mm"
        )
    _say_around(found, dangles)
    found.remarks.append(Remark("left out", tuple(shapely.get_coordinates(line) for line in dangles)))
    tips = [lines[k].corners[[0, -1]] for k in np.flatnonzero(whole).tolist()]
    found.remarks += [Remark("open end", (point[None],)) for pair in tips for point in pair]


def _say_around(found: Traced, dangles: NDArray[np.object_]) -> None:
    """Note open lines that run round outlines: these are holes, perhaps, of a part whose edge is not closed."""
    polygons = np.array([outline.polygon for outline in found.outlines], dtype=object)
    grid = max(found.tolerance * 1e-3, 1e-9)
    merged = shapely.line_merge(shapely.union_all(shapely.set_precision(dangles, grid)))
    for line in shapely.get_parts(merged):
        held = int(shapely.contains(line.convex_hull, polygons).sum()) if len(polygons) else 0
        if held < 2:
            continue
        start, end = shapely.get_coordinates(line)[[0, -1]]
        apart = float(np.hypot(*(start - end)))
        closing = f" (--join {1.1 * apart:.2g} closes it)" if apart < min(_NEAR_SHARE * line.length, _NEARLY) else ""
        found.note(
            f"open lines from ({start[0]:.6g}, {start[1]:.6g}) to ({end[0]:.6g}, {end[1]:.6g}) mm, {apart:.3g} mm apart, run round "
            f"{held} outlines, which are read without them; if they are the edge of a part, close it{closing}"
        )


def _open_name(line: OpenLine) -> str:
    """What a message calls an open path: where it begins, and how far its ends are apart."""
    (x, y), end = line.corners[0], line.corners[-1]
    apart = float(np.hypot(*(line.corners[0] - end)))
    size = float(np.ptp(line.corners, axis=0).max())
    gap = f", its ends {apart:.3g} mm apart (--join {1.1 * apart:.2g} closes it)" if apart < 0.1 * size else ""
    return f"{line.stroke} near ({x:.6g}, {y:.6g}) mm{gap}"


def _many(n: int, thing: str) -> str:
    return f"1 {thing}" if n == 1 else f"{n} {thing}s"
