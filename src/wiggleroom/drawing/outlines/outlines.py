"""From strokes to closed outlines: curves flattened, faults mended, lines joined, faces of a net found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from wiggleroom.drawing.limits import FINEST, LARGEST, SMALLEST
from wiggleroom.drawing.model import Points, Region
from wiggleroom.drawing.outlines.engraving import without_engraved_styles, without_lettering
from wiggleroom.drawing.outlines.joining import JOIN_DISTANCE, JOIN_SHARE
from wiggleroom.drawing.outlines.open_lines import joined_lines, net_of_lines, say_dangles
from wiggleroom.drawing.outlines.rings import COINCIDENT_CORNERS, extents
from wiggleroom.drawing.outlines.stroke_outlines import of_stroke
from wiggleroom.drawing.outlines.traced_outlines import OpenLine, Remark, Traced
from wiggleroom.drawing.strokes.chord_error import NO_GAP_SHARE, chord_error
from wiggleroom.drawing.strokes.elements import NO_SIZE, Artwork
from wiggleroom.drawing.strokes.flatten import Curved
from wiggleroom.drawing.strokes.pathdata import Line, Subpath
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.drawing.strokes.strokes import longer_side
from wiggleroom.errors import InputError, go_on

_SPECK, _SPECK_SHARE = 0.02, 1e-4
"""Closed outlines smaller than this [mm, share of the drawing's size] are specks: no beam is so thin."""
_COPY, _COPY_SHARE = 1e-3, 1e-5
"""Outlines nearer than this [mm, share of the drawing's size] are one drawn twice; a clearance is never so small."""
_CROSSING_COPY = 10
"""Outlines that cross each other, as none with a clearance do, are one drawn twice up to so many times that distance."""
_LINE, _LINE_SHARE = 0.3, 5e-3
"""An outline thinner than this [mm, share of its length] is a line drawn with its thickness, no material."""


def traced(
    artwork: Artwork,
    *,
    flatten: float | None,
    gap: float | None,
    options: ReadOptions,
    view: tuple[float, float, float, float] | None = None,
) -> Traced:
    """Outlines that the strokes of a drawing make.

    Parameters
    ----------
    artwork : Artwork
        Only strokes that are cut.
    flatten : float [mm], optional
        Chord error of curves; by default `chord_error` of the gap.
    gap : float [mm], optional
    options : ReadOptions
        What was said about reading: what to leave out, what is a hole or solid, how near open ends are joined.
    view : (x, y, width, height), optional [mm]
        The page, whose edge is that of the board where lines end on it.

    Raises
    ------
    InputError
        If there is nothing to trace, or its size cannot be worked with.
    """
    join, stop = options.join, options.stop
    paths = [(path, row) for row, stroke in enumerate(artwork.strokes) for path in stroke.paths]
    closed = [_is_closed(path) for path, _ in paths]
    tolerance, at_no_gap, size = _chord_error(artwork, paths, closed, flatten, gap)
    lengths = [longer_side(path) for (path, _), is_closed in zip(paths, closed, strict=True) if not is_closed]
    real = [length for length in lengths if length > min(_SPECK, _SPECK_SHARE * size)]
    within = join if join is not None else min([JOIN_DISTANCE, *(JOIN_SHARE * length for length in real)])
    curved = Curved()
    for path, _ in paths:
        go_on(stop)
        curved.add(path)
    found = Traced(
        artwork.file, tolerance, within, at_no_gap if curved.bent else None, FINEST * size, further=join is None
    )
    corners = curved.corners(tolerance)
    rings: dict[int, list[Points]] = {}
    lines: list[OpenLine] = []
    specks: list[Points] = []
    short, speck = 1e-9 * size, min(_SPECK, _SPECK_SHARE * size)
    sizes = extents(corners).max(axis=1).tolist()
    for (_, row), points, is_closed, extent in zip(paths, corners, closed, sizes, strict=True):
        if extent <= (speck if is_closed else short):
            specks.append(points[:1])
        elif not is_closed:
            lines.append(OpenLine(points, artwork.strokes[row], row))
        elif (flat := _without_area(points, extent)) is None:
            rings.setdefault(row, []).append(points)
        else:
            lines += [OpenLine(line, artwork.strokes[row], row) for line in flat]
    count = len(specks) + dict(artwork.left_out).get(NO_SIZE, 0)
    if count:
        where = f", the first at ({specks[0][0, 0]:.6g}, {specks[0][0, 1]:.6g}) mm" if specks else ""
        many = "1 point or speck is" if count == 1 else f"{count} points and specks are"
        found.note(f"{many} left out{where}")
    if specks:
        found.remarks.append(Remark("left out", tuple(specks)))
    for row, own in rings.items():
        go_on(stop)
        found.outlines += of_stroke(found, artwork.strokes[row], row, own)
    lines = joined_lines(found, lines, size)
    lines = without_engraved_styles(found, options, lines)
    loose = net_of_lines(found, lines, size, view, options) if lines else np.empty(0, dtype=object)
    say_dangles(found, lines, without_lettering(found, loose, options))
    found.outlines.sort(key=lambda outline: outline.row)
    _without_copies(found)
    _without_thick_lines(found)
    return found


def _is_closed(path: Subpath) -> bool:
    ends = [path.start, *(segment.end for segment in path.segments)]
    size = max(abs(end - path.start) for end in ends)
    curved = not all(isinstance(segment, Line) for segment in path.segments)
    return (size > 0 or curved) and (path.closed or abs(ends[-1] - path.start) <= COINCIDENT_CORNERS * size)


def _without_area(points: Points, extent: float) -> list[Points] | None:
    """Lines of a closed outline that runs along them and back, enclosing nothing; None for any other."""
    x, y = (points - points[0]).T
    if abs(x[:-1] @ y[1:] - y[:-1] @ x[1:]) > 1e-8 * extent * extent:
        return None
    noded = shapely.unary_union(shapely.LineString(points), grid_size=1e-9 * extent)
    if len(shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))):
        return None  # a figure of eight
    return [shapely.get_coordinates(line) for line in shapely.get_parts(shapely.line_merge(noded))]


def _chord_error(
    artwork: Artwork,
    paths: Sequence[tuple[Subpath, int]],
    closed: Sequence[bool],
    flatten: float | None,
    gap: float | None,
) -> tuple[float, float | None, float]:
    """Chord error, that without a gap (None where it was given) and the longer side of the drawing [mm].

    Refused is one of nothing, or of a size that cannot be worked with.
    """
    if not paths:
        kinds = " and ".join(f"{count} {kind}" for kind, count in artwork.left_out)
        right = (
            f", only {kinds}; draw the boundary of every part as a closed line"
            if kinds
            else "; every part must be closed"
        )
        message = f"{artwork.file}: has no closed outline{right}"
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
    if flatten:
        return max(flatten, FINEST * size), None, size
    by_row: dict[int, list[Points]] = {}
    coarse = curved.corners(1e-3 * size)
    large = extents(coarse).max(axis=1) > min(_SPECK, _SPECK_SHARE * size)
    for (_, row), points, is_large in zip(chosen, coarse, large.tolist(), strict=True):
        if is_large:
            by_row.setdefault(row, []).append(points)
    whole = [rings[0] if len(rings) == 1 else np.vstack(rings) for rings in by_row.values()]
    median = float(np.median(extents(whole).max(axis=1))) if whole else size
    at_no_gap = max(median * NO_GAP_SHARE, FINEST * size)
    return chord_error(gap or 0.0, at_no_gap, FINEST * size), at_no_gap, size


def _without_thick_lines(found: Traced) -> None:
    """Outlines as thin as a line are the edges of a line that is drawn with its thickness: rings become what they run round."""
    drawn = found.outlines
    if not drawn:
        return
    material = np.array([outline.polygon for outline in drawn], dtype=object)
    inks = [
        shapely.Polygon(o.region.outer, o.region.holes) if o.region.holes else material[k] for k, o in enumerate(drawn)
    ]
    wide = 2 * shapely.area(inks) / np.maximum(shapely.length(inks), 1e-300)
    long = np.ptp(shapely.bounds(material).reshape(-1, 2, 2), axis=1).max(axis=1)
    thin = (wide <= _LINE) & (wide <= _LINE_SHARE * long)
    rings = [k for k in np.flatnonzero(thin).tolist() if len(drawn[k].region.holes) == 1]
    for k in rings:
        line = replace(drawn[k].stroke, colour=drawn[k].stroke.colour or drawn[k].stroke.fill, fill="")
        drawn[k] = replace(drawn[k], region=Region(drawn[k].region.outer), stroke=line)
    if rings:
        found.note(f"{len(rings)} outlines drawn with the thickness of their line: the outer edge is read")
    thin = np.flatnonzero(thin & ~np.isin(np.arange(len(drawn)), rings))
    inner, _ = shapely.STRtree(material).query(material[thin], predicate="within")
    alone = np.bincount(inner, minlength=len(thin)) == 1
    gone = set(thin[alone].tolist())
    if not gone or len(gone) == len(drawn):
        return
    x, y = drawn[min(gone)].region.outer[0]
    many = (
        "1 outline is as thin as a line, and" if len(gone) == 1 else f"{len(gone)} outlines are as thin as a line, and"
    )
    found.note(f"{many} left out, the first at ({x:.6g}, {y:.6g}) mm")
    found.remarks.append(Remark("left out", tuple(drawn[row].region.outer for row in sorted(gone))))
    found.outlines = [outline for row, outline in enumerate(drawn) if row not in gone]


def _without_copies(found: Traced) -> None:
    """Drop outlines that were drawn before."""
    outlines = found.outlines
    if len(outlines) < 2:
        return
    polygons = np.array([outline.polygon for outline in outlines], dtype=object)
    boxes = shapely.bounds(polygons)
    slack = 2 * min(_COPY, _COPY_SHARE * float(np.ptp(boxes.reshape(-1, 2), axis=0).max()))
    most = _CROSSING_COPY * slack
    marks = shapely.points(boxes[:, 0] + boxes[:, 2], boxes[:, 1] + boxes[:, 3])
    first, second = shapely.STRtree(marks).query(marks, predicate="dwithin", distance=4 * most)
    near = (first < second) & (np.abs(boxes[first] - boxes[second]).max(axis=1) <= most)
    copies: set[int] = set()
    for i, j in sorted(zip(first[near].tolist(), second[near].tolist(), strict=True)):
        if i in copies or j in copies:
            continue
        a, b = outlines[i], outlines[j]
        if a.stroke.hole != b.stroke.hole or len(a.region.holes) != len(b.region.holes):
            continue
        apart = shapely.hausdorff_distance(polygons[i].exterior, polygons[j].exterior)
        if apart <= slack or (apart <= most and shapely.overlaps(polygons[i], polygons[j])):
            copies.add(i if b.stroke.fixed and not a.stroke.fixed else j)
    if copies:
        found.note(f"{len(copies)} lines or outlines are drawn twice; the copies are left out")
        found.outlines = [outline for k, outline in enumerate(outlines) if k not in copies]
