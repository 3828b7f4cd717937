"""Outlines that open lines make: joined end to end, or as faces of the net that they form with closed ones."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.model import Points, Region
from wiggleroom.drawing.outlines.cuts import SMALL
from wiggleroom.drawing.outlines.joining import BEAM, closed_loops, join_ends, open_chains, outline_of
from wiggleroom.drawing.outlines.naming import asked_for
from wiggleroom.drawing.outlines.planar_faces import net_of
from wiggleroom.drawing.outlines.rings import clean_ring
from wiggleroom.drawing.outlines.sheet_frame import View, page_edge
from wiggleroom.drawing.outlines.stroke_outlines import of_stroke
from wiggleroom.drawing.outlines.traced_outlines import OpenLine, Outline, Remark, Traced
from wiggleroom.drawing.strokes.elements import Stroke
from wiggleroom.drawing.strokes.layers import is_cut
from wiggleroom.drawing.strokes.read_options import ReadOptions

_NEAR_SHARE, _NEARLY = 0.01, 1.0
"""An open line whose ends are nearer to each other than this [share of its length, mm] was to be closed, perhaps."""
_SPLINTER = 1e-3
"""Faces smaller than this share of the only one beside them are splinters."""
_SET_IN, _FINGERS = 0.5, 3
"""A face that shares at least this share of its edge with one other is set into it; so many between parts are gaps of finger joints."""
_GAP, _CLOSED_IN = 0.1, 0.6
"""A face between parts is a gap where it is smaller than this share of two beside it, with which it shares this share of its edge."""
_CONVEX = 0.9
"""A gap that fills this share of its hull holds no parts together: a hole across the seam of two, and no key; ..."""
_WIDER = 0.01
"""... nor does one that is nowhere wider than at the seam, but for this share."""


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
        x, y = ends.where
        at = f", at ({x:.6g}, {y:.6g}) mm" if ends.widest > BEAM else ""
        found.note(f"open ends were joined, at most {ends.widest:.3g} mm apart{at} (--join sets how far)")
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


def net_of_lines(
    found: Traced, lines: Sequence[OpenLine], size: float, view: View | None, options: ReadOptions
) -> NDArray[np.object_]:
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
    replaced_whole = 0
    tree = shapely.STRtree([shapely.LineString(points) for points in corners])
    faces = np.array(net.faces, dtype=object)
    names, asked = asked_for(options.solid, faces)
    around = [outline.polygon for k, outline in enumerate(found.outlines) if k not in reached]
    nested = shapely.STRtree(around).query(shapely.point_on_surface(faces), predicate="within")[0]
    closed = [f for k in by_owner for f in by_owner[k]]
    waste, seams = (set(), set()) if "all" in names else _waste(faces, closed, nested.tolist())
    waste -= asked
    holes = {k for k, own in by_owner.items() if len(own) == 1 and own[0] in seams & waste}
    for k in sorted(replaced):
        outline = found.outlines[k]
        left = [f for f in by_owner[k] if f not in waste]
        replaced_whole += len(left) < 2
        own = _faces([faces[f] for f in left], outline.stroke, outline.row, outline.region)
        if len(left) == 1:  # still one part, with its name
            own = [Outline(own[0].region, outline.stroke, outline.row)]
        made += own
    alone = []
    neighbours, _ = shapely.STRtree(faces).query(faces, predicate="intersects")
    shared = np.bincount(neighbours, minlength=len(net.faces)) > 1
    outside = [f for f in outside if f not in waste]
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
    found.outlines = [outline for k, outline in enumerate(found.outlines) if k not in replaced | holes]
    found.outlines += [*made, *alone]
    waste -= {f for k in by_owner if k not in replaced | holes for f in by_owner[k]}
    if waste:
        at = faces[min(waste)].representative_point()
        found.note(
            f"{_many(len(waste), 'small face')} set into the edges of parts, or between them, taken as cut out (the first at "
            f"({at.x:.6g}, {at.y:.6g}) mm); --solid @x,y or all makes parts of them"
        )
        found.remarks.append(
            Remark("left out", tuple(shapely.get_coordinates(faces[f].exterior) for f in sorted(waste)))
        )
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


def _waste(faces: NDArray[np.object_], closed: Collection[int], nested: Collection[int]) -> tuple[set[int], set[int]]:
    """Faces of a net that are no parts: splinters, slots set into the edge of a part, gaps between parts; and those across seams.

    A slot takes, with all others there, at most `SMALL` of one other face, shares half of its edge with it round a corner (more than
    half where it meets further faces), and meets those in a straight line, so that it reaches into none. A gap is small beside two
    others, with which it shares most of its edge, where one of them is a closed outline, or slots between parts and holes across
    their seams show that parts of one box are drawn edge to edge.

    Parameters
    ----------
    faces : (n,) polygons [mm]
    closed, nested : collection of int
        Those in closed outlines of the net; those inside outlines that are not in it, which may be holes.

    Examples
    --------
    >>> panel = shapely.box(0, 0, 9, 9) - shapely.box(4, 8, 5, 9)
    >>> _waste(np.array([panel, shapely.box(4, 8, 5, 9)]), [0, 1], [])
    ({1}, set())
    """
    area, edges = shapely.area(faces), shapely.boundary(faces)
    rim = shapely.length(edges)
    first, second = shapely.STRtree(faces).query(faces, predicate="intersects")
    border = shapely.intersection(edges[first], edges[second])
    length = shapely.length(border)
    beside = (first != second) & (length > 1e-9 * rim[first])
    first, second, border, length = first[beside], second[beside], border[beside], length[beside]
    met = np.bincount(first, minlength=len(faces))
    splinters = first[(area[first] < _SPLINTER * area[second]) & (met[first] == 1)]
    bent = np.hypot(*np.ptp(shapely.bounds(border).reshape(-1, 2, 2), axis=1).T) < (1 - 1e-6) * length
    part = length / rim[first]
    into = bent & (np.bincount(first, bent, minlength=len(faces))[first] == 1)
    into &= (area[first] <= SMALL * area[second]) & (part < 1 - 1e-6)
    into &= part >= np.where(met[first] > 1, _SET_IN + 1e-6, _SET_IN - 1e-6)
    into &= ~np.isin(first, list(nested))
    taken = np.bincount(second[into], area[first[into]], minlength=len(faces))
    into &= taken[second] <= SMALL * area[second]
    slots = first[into]
    large = area[first] <= _GAP * area[second]
    gaps = np.bincount(first[large], part[large], minlength=len(faces)) >= _CLOSED_IN
    gaps &= np.bincount(first[large], minlength=len(faces)) > 1
    seams = (met == 2) & (np.bincount(first, part, minlength=len(faces)) > 1 - 1e-6)
    seams &= area <= SMALL * np.bincount(first, area[second], minlength=len(faces))
    seams[[f for f in np.flatnonzero(seams) if not _holds_nothing(faces[f], border[first == f])]] = False
    if (met[slots] > 1).sum() + seams.sum() < _FINGERS:
        seams[:] = False
        gaps &= np.bincount(first[large], np.isin(second[large], list(closed)), minlength=len(faces)) > 0
        gaps[list(closed)] = False
    gaps |= seams
    waste = {*splinters.tolist(), *slots.tolist(), *np.flatnonzero(gaps).tolist()}
    return waste, set(np.flatnonzero(seams).tolist())


def _holds_nothing(face: shapely.Polygon, borders: NDArray[np.object_]) -> bool:
    """Whether a face is no key between two others: it fills its hull, or is nowhere wider than where their seam meets it."""
    if face.area >= _CONVEX * face.convex_hull.area:
        return True
    ends = shapely.get_coordinates(shapely.intersection(*borders))
    if len(ends) < 2:
        return False
    along = ends[-1] - ends[0]
    reach = (shapely.get_coordinates(face) - ends[0]) @ along / (along @ along)
    return bool(reach.min() >= -_WIDER and reach.max() <= 1 + _WIDER)


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
