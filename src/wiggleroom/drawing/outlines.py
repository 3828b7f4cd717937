"""From strokes to closed outlines: curves flattened, faults mended, lines joined, faces of a net found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import shapely

from wiggleroom.drawing.elements import Artwork, Stroke
from wiggleroom.drawing.flatten import Curved
from wiggleroom.drawing.joining import JOIN_DISTANCE, JOIN_SHARE, join_ends, loops, outline_of
from wiggleroom.drawing.limits import FINEST, LARGEST, SMALLEST
from wiggleroom.drawing.model import Points, Region
from wiggleroom.drawing.nesting import regions_by_fill_rule
from wiggleroom.drawing.net import net_of
from wiggleroom.drawing.outline_repair import mend
from wiggleroom.drawing.pathdata import Subpath
from wiggleroom.drawing.rings import COINCIDENT_CORNERS, clean_ring
from wiggleroom.drawing.strokes import extent
from wiggleroom.errors import InputError

_COPY, _COPY_SHARE = 1e-3, 1e-5
"""Outlines nearer than this [mm, share of the drawing's size] are one drawn twice; a clearance is never so small."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A closed outline of material, with holes that its own path says.

    Parameters
    ----------
    region : Region [mm]
    stroke : Stroke
        What drew it, or the first of its edges.
    row : int
        Place of the stroke in the file.
    face : bool
        Whether it is a face of a net of lines.
    """

    region: Region
    stroke: Stroke
    row: int
    face: bool = False

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """What lies inside the outer outline."""
        return shapely.Polygon(self.region.outer)


@dataclass(frozen=True, eq=False)
class Remark:
    """Something about the drawing that has a place, for pictures of it.

    Parameters
    ----------
    kind : str
        One of "open end", "crossing", "overlap", "left out", "mended", "hole".
    lines : tuple of (n, 2) float64 [mm]
        Where: points or lines.
    """

    kind: str
    lines: tuple[Points, ...]


@dataclass(eq=False)
class Traced:
    """Outlines of a drawing, and what was found on the way; filled while it is traced.

    Parameters
    ----------
    outlines : list of Outline
        In drawing order.
    tolerance : float [mm]
        Chord error of curves.
    join : float [mm]
        Ends nearer than this were joined.
    notes, findings : list of str
    remarks : list of Remark
    open_lines : int
        How many lines are not closed.
    """

    file: str
    tolerance: float
    join: float
    outlines: list[Outline] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    findings: list[str] = field(default_factory=list)
    remarks: list[Remark] = field(default_factory=list)
    open_lines: int = 0

    def note(self, line: str) -> None:
        """Say something about the file."""
        self.notes.append(f"{self.file}: {line}")


@dataclass(frozen=True, eq=False)
class _Line:
    """An open path."""

    corners: Points
    stroke: Stroke
    row: int


def traced(artwork: Artwork, *, flatten: float | None, gap: float | None, join: float | None) -> Traced:
    """Outlines that the strokes of a drawing make.

    Parameters
    ----------
    artwork : Artwork
        Only strokes that are cut.
    flatten : float [mm], optional
        Chord error of curves; by default gap / 50, or 1e-4 of the median part size where the gap is 0.
    gap : float [mm], optional
    join : float [mm], optional
        Open ends nearer than this are joined; by default the smaller of 0.05 mm and a hundredth of the shortest line.

    Raises
    ------
    InputError
        If there is nothing to trace, or its size cannot be worked with.
    """
    paths = [(path, row) for row, stroke in enumerate(artwork.strokes) for path in stroke.paths]
    closed = [_is_closed(path) for path, _ in paths]
    tolerance, size = _chord_error(artwork, paths, closed, flatten, gap)
    lengths = [extent(path) for (path, _), is_closed in zip(paths, closed, strict=True) if not is_closed]
    real = [length for length in lengths if length > 1e-6 * size]
    within = join if join is not None else min([JOIN_DISTANCE, *(JOIN_SHARE * length for length in real)])
    found = Traced(artwork.file, tolerance, within)
    curved = Curved()
    for path, _ in paths:
        curved.add(path)
    corners = curved.corners(tolerance)
    rings: dict[int, list[Points]] = {}
    lines: list[_Line] = []
    short = 0
    for (_, row), points, is_closed in zip(paths, corners, closed, strict=True):
        if is_closed:
            rings.setdefault(row, []).append(points)
        elif float(np.ptp(points, axis=0).max()) > 1e-9 * size:
            lines.append(_Line(points, artwork.strokes[row], row))
        else:
            short += 1
    if short:
        found.note(f"{short} elements of no length are left out")
    for row, own in rings.items():
        found.outlines += _of_stroke(found, artwork.strokes[row], row, own)
    if lines:
        _open_lines(found, lines, size)
    found.outlines.sort(key=lambda outline: outline.row)
    _without_copies(found)
    return found


def _is_closed(path: Subpath) -> bool:
    ends = [path.start, *(segment.end for segment in path.segments)]
    size = max(abs(end - path.start) for end in ends)
    return path.closed or abs(ends[-1] - path.start) <= COINCIDENT_CORNERS * size


def _chord_error(
    artwork: Artwork,
    paths: Sequence[tuple[Subpath, int]],
    closed: Sequence[bool],
    flatten: float | None,
    gap: float | None,
) -> tuple[float, float]:
    """Chord error, and the longer side of the drawing [mm]; refused is one of nothing, or of a size that cannot be worked with."""
    if not paths:
        message = f"{artwork.file}: has no closed outline; every part must be closed"
        raise InputError(artwork.findings or [message])
    chosen = [pair for pair, is_closed in zip(paths, closed, strict=True) if is_closed] or list(paths)
    curved = Curved()
    for path, _ in chosen:
        curved.add(path)
    largest, size = curved.reach()
    finding = ""
    if not largest <= LARGEST:
        finding = f"{artwork.file}: has coordinates beyond {LARGEST:g} mm; move or scale the drawing"
    elif size < SMALLEST:
        finding = f"{artwork.file}: is {size:.3g} mm large; it must be at least {SMALLEST:g} mm"
    elif flatten and flatten < FINEST * size:
        finding = f"{artwork.file}: flatten is {flatten:g}; here it must be at least {FINEST * size:.3g} mm"
    if finding:
        raise InputError([*artwork.findings, finding])
    if flatten or gap:
        return max(flatten or (gap or 0.0) / 50, FINEST * size), size
    by_row: dict[int, list[Points]] = {}
    for (_, row), points in zip(chosen, curved.corners(1e-3 * size), strict=True):
        by_row.setdefault(row, []).append(points)
    median = float(np.median([np.ptp(np.vstack(rings), axis=0).max() for rings in by_row.values()]))
    return max(median * 1e-4, FINEST * size), size


def _of_stroke(found: Traced, stroke: Stroke, row: int, drawn: Sequence[Points]) -> list[Outline]:
    """Outlines of the closed subpaths of one stroke."""
    sound = [ring for ring in drawn if len(clean_ring(ring)) >= 3]
    if not sound:
        corners = max(len(clean_ring(ring)) for ring in drawn)
        found.findings.append(
            f"{found.file}: {stroke}: outline has {corners} corners; at least 3 that enclose an area are needed"
        )
        return []
    rings: list[Points] = []
    for ring in sound:
        mended = mend(ring[:-1] if (ring[0] == ring[-1]).all() else ring)
        rings += mended.rings
        for kind, at in mended.faults:
            found.remarks.append(Remark(f"mended {kind}", (np.array([at]),)))
    rings = _distinct_rings(rings)
    separate = not stroke.fill and len(rings) > 2 and not stroke.whole and _holes_touch(rings)
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
        seen.setdefault(clean_ring(ring)[np.lexsort(clean_ring(ring).T)].tobytes(), ring)
    return list(seen.values())


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


def _open_lines(found: Traced, lines: Sequence[_Line], size: float) -> None:
    """Outlines that open lines make one after the other, and faces that they cut."""
    once = _distinct_lines(lines, size)
    if len(once) < len(lines):
        found.note(f"{len(lines) - len(once)} open lines are drawn twice; the copies are left out")
    lines = once
    found.open_lines = len(lines)
    corners = [line.corners for line in lines]
    ends = join_ends(corners, found.join, size)
    if ends.widest > 1e-6 * size:
        found.note(f"open ends were joined, at most {ends.widest:.3g} mm apart (--join sets how far)")
    used = set()
    for way in loops(ends, [line.stroke.pool for line in lines]):
        ring = outline_of(way, corners, ends)
        first = min(edge for edge, _ in way)
        used |= {edge for edge, _ in way}
        if len(clean_ring(ring)) >= 3:
            found.outlines += _of_stroke(found, replace(lines[first].stroke, fill=""), lines[first].row, [ring])
    rest = [row for row in range(len(lines)) if row not in used]
    if rest:
        _net(found, [lines[row] for row in rest], size)


def _distinct_lines(lines: Sequence[_Line], size: float) -> list[_Line]:
    """Without open lines that were drawn before, in either sense."""
    seen: dict[bytes, _Line] = {}
    for line in lines:
        there, back = (np.round(points / (1e-8 * size)) + 0.0 for points in (line.corners, line.corners[::-1]))
        seen.setdefault(min(there.tobytes(), back.tobytes()), line)
    return list(seen.values())


def _net(found: Traced, lines: Sequence[_Line], size: float) -> None:
    """Closed outlines cut by lines, and faces of the lines themselves."""
    corners = [line.corners for line in lines]
    ends = join_ends(corners, found.join, size)
    reached = _reached(found, corners, max(found.join, found.tolerance))
    rings = [ring for k in reached for ring in (found.outlines[k].region.outer, *found.outlines[k].region.holes)]
    net = net_of(corners, ends, rings, join=found.join, chord=found.tolerance)
    by_owner, outside = _owners(found, reached, net.faces)
    replaced = {k for k, faces in by_owner.items() if len(faces) > 1}
    made: list[Outline] = []
    tree = shapely.STRtree([shapely.LineString(points) for points in corners])
    for k in sorted(replaced):
        outline = found.outlines[k]
        made += _faces([net.faces[f] for f in by_owner[k]], outline.stroke, outline.row, outline.region)
    alone = []
    faces = np.array(net.faces, dtype=object)
    neighbours, _ = shapely.STRtree(faces).query(faces, predicate="intersects")
    shared = np.bincount(neighbours, minlength=len(net.faces)) > 1
    nearest = tree.nearest([net.faces[f].exterior for f in outside]).tolist() if outside else []
    for f, line in zip(outside, nearest, strict=True):
        row = lines[line]
        if shared[f]:
            made += _faces([net.faces[f]], row.stroke, row.row, None)
        else:  # nothing is cut: the outline of one part, whose ends overshoot
            ring = clean_ring(shapely.get_coordinates(net.faces[f].exterior))
            alone.append(Outline(Region(ring), replace(row.stroke, fill=""), row.row))
    if made:
        cut = f"{_many(len(replaced), 'outline')} cut, " if replaced else ""
        found.note(f"{cut}{_many(len(made), 'face')} of open lines taken as parts")
    found.outlines = [outline for k, outline in enumerate(found.outlines) if k not in replaced]
    found.outlines += [*made, *alone]
    if net.slivers:
        found.note(f"{_many(net.slivers, 'sliver')} between lines, thinner than {found.join:.3g} mm, left out")
    _say_dangles(found, lines, tree, net.dangles)


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
    crossing = set(first[common > slack].tolist())
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
        made.append(Outline(Region(outer, holes), plain, row, face=True))
    return made


def _say_dangles(
    found: Traced, lines: Sequence[_Line], tree: shapely.STRtree, dangles: Sequence[shapely.Geometry]
) -> None:
    """Note open lines that bound no face, whole ones by name and ends of others by place."""
    if not dangles:
        return
    owner = tree.nearest([line.interpolate(0.5, normalized=True) for line in dangles])
    unused = np.zeros(len(lines))
    np.add.at(unused, owner, [line.length for line in dangles])
    length = np.array([line.length for line in tree.geometries])
    whole = unused >= 0.99 * length
    by_stroke: dict[int, _Line] = {}
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
    found.remarks.append(Remark("left out", tuple(shapely.get_coordinates(line) for line in dangles)))
    tips = [lines[k].corners[[0, -1]] for k in np.flatnonzero(whole).tolist()]
    found.remarks += [Remark("open end", (point[None],)) for pair in tips for point in pair]


def _open_name(line: _Line) -> str:
    """What a message calls an open path: where it begins, and how far its ends are apart."""
    (x, y), end = line.corners[0], line.corners[-1]
    apart = float(np.hypot(*(line.corners[0] - end)))
    size = float(np.ptp(line.corners, axis=0).max())
    gap = f", its ends {apart:.3g} mm apart (--join {1.1 * apart:.2g} closes it)" if apart < 0.1 * size else ""
    return f"{line.stroke} near ({x:.6g}, {y:.6g}) mm{gap}"


def _without_copies(found: Traced) -> None:
    """Drop outlines that were drawn before."""
    outlines = found.outlines
    if len(outlines) < 2:
        return
    polygons = np.array([outline.polygon for outline in outlines], dtype=object)
    boxes = shapely.bounds(polygons)
    slack = 2 * min(_COPY, _COPY_SHARE * float(np.ptp(boxes.reshape(-1, 2), axis=0).max()))
    marks = shapely.points(boxes[:, 0] + boxes[:, 2], boxes[:, 1] + boxes[:, 3])
    first, second = shapely.STRtree(marks).query(marks, predicate="dwithin", distance=4 * slack)
    copies: set[int] = set()
    for i, j in sorted(zip(first.tolist(), second.tolist(), strict=True)):
        if i >= j or i in copies or j in copies or np.abs(boxes[i] - boxes[j]).max() > slack:
            continue
        a, b = outlines[i], outlines[j]
        alike = a.stroke.hole == b.stroke.hole and len(a.region.holes) == len(b.region.holes)
        if alike and shapely.hausdorff_distance(polygons[i].exterior, polygons[j].exterior) <= slack:
            copies.add(i if b.stroke.fixed and not a.stroke.fixed else j)
    if copies:
        found.note(f"{len(copies)} lines or outlines are drawn twice; the copies are left out")
        found.outlines = [outline for k, outline in enumerate(outlines) if k not in copies]


def _many(n: int, thing: str) -> str:
    return f"1 {thing}" if n == 1 else f"{n} {thing}s"
