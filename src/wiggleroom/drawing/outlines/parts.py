"""From the strokes of a drawing to its parts: cut lines chosen, outlines found, nested, named and glued."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import shapely

from wiggleroom.drawing.model import Drawing, Flattening, Part, Region
from wiggleroom.drawing.outlines.file_reading import Reading
from wiggleroom.drawing.outlines.naming import aliases_of, given_names, place_of, rows_at, texts_inside, unique_names
from wiggleroom.drawing.outlines.nesting import cut_nested, direct_parents, hole_rows, meets_hole
from wiggleroom.drawing.outlines.outlines import traced
from wiggleroom.drawing.outlines.rings import part_about_centroid
from wiggleroom.drawing.outlines.sheet_frame import leave_out_frames
from wiggleroom.drawing.outlines.traced_outlines import Outline, Remark, Traced
from wiggleroom.drawing.strokes.colours import is_light
from wiggleroom.drawing.strokes.elements import Artwork, Stroke
from wiggleroom.drawing.strokes.flatten import Curved
from wiggleroom.drawing.strokes.layers import PAGE, cut_strokes, has_own_name
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.errors import go_on

_TOUCH, _TOUCH_SHARE = 0.05, 1e-3
"""Inner outlines nearer than this [mm, share of the drawing's size] touch: they are pieces, not holes."""


def reading_of(artwork: Artwork, options: ReadOptions, *, flatten: float | None, gap: float | None) -> Reading:
    """Parts of a drawing, with everything that was assumed and all that is wrong.

    Parameters
    ----------
    artwork : Artwork
        What a reader found.
    options : ReadOptions
    flatten : float [mm], optional
        Chord error of curves at every gap; by default `chord_error` of the gap.
    gap : float [mm], optional

    Raises
    ------
    InputError
        If there is nothing to read, with one line per finding.
    """
    chosen, left_out = cut_strokes(artwork, options)
    view = None if options.only or PAGE in options.skip else artwork.view
    found = traced(chosen, flatten=flatten, gap=gap, join=options.join, view=view, stop=options.stop)
    found.notes[:0] = chosen.notes
    found.findings[:0] = chosen.findings
    found.remarks += _left_out(left_out, found.tolerance)
    _layer_holes(found)
    leave_out_frames(found, artwork.view, options)
    if not found.outlines:
        if not found.findings:
            drawn = f", but {found.open_lines} open" if found.open_lines else ""
            said = [note.partition(": ")[2] for note in found.notes if "left out" in note][-1:]
            why = f" ({said[0].split(';')[0]})" if said else ""
            found.findings.append(f"{artwork.file}: has no closed outline{drawn}; every part must be closed{why}")
        empty = Drawing((), gap=gap or 0.0, source=artwork.file, notes=tuple(found.notes))
        return Reading(empty, (), tuple(found.findings), tuple(found.remarks))
    go_on(options.stop)
    return _nested(artwork, found, options, gap)


def _parts(artwork: Artwork, options: ReadOptions, error: float) -> tuple[Part, ...]:
    """Parts of a drawing at a chord error [mm]."""
    return reading_of(artwork, options, flatten=error, gap=None).drawing.parts


def _nested(artwork: Artwork, found: Traced, options: ReadOptions, gap: float | None) -> Reading:
    """Parts from outlines: who is inside whom, names, roles."""
    outlines = found.outlines
    polygons = np.array([outline.polygon for outline in outlines], dtype=object)
    strokes = [outline.stroke for outline in outlines]
    inside, _ = texts_inside(polygons, artwork.texts)
    given = given_names(strokes, inside, [not outline.face for outline in outlines])
    parents = direct_parents(polygons)
    in_material = {i: p for i, p in parents.items() if not meets_hole(polygons[i], outlines[p].region, found.tolerance)}
    solid = _solid(found, options, given, inside, in_material, polygons)
    size = float(np.ptp(shapely.total_bounds(polygons).reshape(2, 2), axis=0).max())
    holes = hole_rows(polygons, in_material, solid, min(_TOUCH, _TOUCH_SHARE * size))
    kept = [row for row in range(len(outlines)) if row not in holes]
    texts, unnamed = texts_inside(polygons[kept], artwork.texts)  # a text in a hole names the part around it
    inside = [""] * len(outlines)
    for row, text in zip(kept, texts, strict=True):
        inside[row] = text
    material = cut_nested([outline.region for outline in outlines], parents, holes, found.tolerance)
    filled = [row for row, pieces in material.items() if not pieces]
    if filled:
        listed = ", ".join(str(strokes[row]) for row in filled[:3]) + (", ..." if len(filled) > 3 else "")
        found.note(f"outlines that others inside them fill are left out: {listed}")
        found.remarks.append(Remark("left out", tuple(outlines[row].region.outer for row in filled)))
    material = {row: pieces for row, pieces in material.items() if pieces}
    groups = _pieces(outlines, material)
    first = [rows[0] for rows in groups]
    final = given_names(
        [strokes[row] for row in first], [inside[row] for row in first], [not outlines[row].face for row in first]
    )
    names = unique_names(final)
    _say_nesting(found, names, first, in_material, holes)
    _say_pieces(found, outlines, groups)
    _say_mended(found)
    kinds = [*artwork.left_out, *([("text", unnamed)] if unnamed else [])]
    found.notes += [
        f"{artwork.file}: {count} {tag} elements are left out; only outlines are parts" for tag, count in kinds
    ]
    said = [("" if outlines[row].face else strokes[row].name, inside[row], given[row]) for row in first]
    parts = tuple(
        part_about_centroid(
            name, [piece for row in rows for piece in material[row]], fixed=strokes[rows[0]].fixed, aliases=others
        )
        for name, rows, others in zip(names, groups, aliases_of(names, said), strict=True)
    )
    drawing = Drawing(
        parts=parts,
        gap=gap or 0.0,
        glue=_glue([strokes[row] for row in first], names),
        source=artwork.file,
        notes=tuple(dict.fromkeys(found.notes)),
        flattening=None
        if found.at_no_gap is None
        else Flattening(
            found.tolerance, found.at_no_gap, found.finest, parts, partial(_parts, artwork, replace(options, stop=None))
        ),
    )
    layers = tuple(strokes[row].layer for row in first)
    return Reading(drawing, layers, tuple(found.findings), tuple(found.remarks))


def _left_out(strokes: Sequence[tuple[str, Stroke]], tolerance: float) -> list[Remark]:
    """Places of strokes that are not cut."""
    curved = Curved()
    for _, stroke in strokes:
        for path in stroke.paths:
            curved.add(path)
    return [Remark("left out", tuple(curved.corners(tolerance)))] if curved.loops else []


def _layer_holes(found: Traced) -> None:
    """Give outlines that are holes by their layer to the smallest outline around them."""
    holes = [outline for outline in found.outlines if outline.stroke.hole]
    if not holes:
        return
    others = [outline for outline in found.outlines if not outline.stroke.hole]
    tree = shapely.STRtree([outline.polygon for outline in others])
    cut: dict[int, list[Outline]] = {}
    for hole in holes:
        polygon = hole.polygon
        around = [
            k
            for k in tree.query(polygon).tolist()
            if others[k].polygon.area > polygon.area * (1 + 1e-6)
            and polygon.difference(others[k].polygon).area <= 1e-3 * polygon.area
        ]
        if around:
            cut.setdefault(min(around, key=lambda k: others[k].polygon.area), []).append(hole)
        else:
            reason = "is a hole by its layer, but lies in no part; it must lie inside an outline of another layer"
            found.findings.append(f"{found.file}: {hole.stroke}: {reason}")
    found.outlines = [
        Outline(
            Region(o.region.outer, (*o.region.holes, *(hole.region.outer[::-1] for hole in cut.get(k, [])))),
            o.stroke,
            o.row,
            o.face,
        )
        for k, o in enumerate(others)
    ]


def _solid(
    found: Traced,
    options: ReadOptions,
    given: Sequence[str],
    inside: Sequence[str],
    parents: dict[int, int],
    polygons: np.ndarray,
) -> list[bool]:
    """Which outlines inside others are parts whatever lies around them."""
    asked = {name.casefold() for name in options.solid}
    rows = set(rows_at([place for name in options.solid if (place := place_of(name))], polygons))
    result = []
    for i, outline in enumerate(found.outlines):
        stroke = outline.stroke
        parent = found.outlines[parents[i]].stroke if i in parents else None
        own = parent is not stroke
        white = is_light(stroke.fill) and parent is not None and parent.fill and not is_light(parent.fill)
        named = inside[i] and parent is not None and bool(given[parents[i]])
        filled = stroke.fill and not white and (stroke.styled or has_own_name(stroke))
        result.append(
            "all" in asked
            or i in rows
            or outline.face
            or bool(asked & {word.casefold() for word in (given[i], stroke.name) if word})
            or (own and bool(filled or stroke.label or named or stroke.fixed))
        )
    return result


def _pieces(outlines: Sequence[Outline], material: dict[int, list[Region]]) -> list[list[int]]:
    """Rows of outlines that are parts, those together that the file says are pieces of one part."""
    groups: dict[object, list[int]] = {}
    seen: Counter[object] = Counter()
    for row in sorted(material):
        stroke = outlines[row].stroke
        key: object = row
        if stroke.piece is not None:
            seen[stroke.piece] += 1
            key = (stroke.piece[0], stroke.piece[2], seen[stroke.piece])
        elif stroke.whole or (not outlines[row].face and (stroke.label or has_own_name(stroke))):
            key = ("stroke", id(stroke))
        groups.setdefault(key, []).append(row)
    return list(groups.values())


def _say_nesting(
    found: Traced,
    names: Sequence[str],
    first: Sequence[int],
    parents: dict[int, int],
    holes: set[int],
) -> None:
    """Note which outlines inside others were taken as holes, and which as parts."""
    called = dict(zip(first, names, strict=True))
    if holes:
        found.remarks.append(Remark("hole", tuple(found.outlines[i].region.outer for i in sorted(holes))))
        counts = Counter(called.get(parents[i], "?") for i in sorted(holes))
        listed = ", ".join(f"{n} in {name}" for name, n in counts.most_common(4)) + (", ..." if len(counts) > 4 else "")
        one = (
            "1 outline inside another is a hole"
            if len(holes) == 1
            else f"{len(holes)} outlines inside others are holes"
        )
        found.note(f"{one} ({listed}); --solid NAME, @x,y or all makes parts of them")
    filling = [called[i] for i in parents if i not in holes and i in called and parents[i] not in holes]
    if filling:
        listed = ", ".join(filling[:4]) + (", ..." if len(filling) > 4 else "")
        one = (
            "1 outline inside another is a part"
            if len(filling) == 1
            else f"{len(filling)} outlines inside others are parts"
        )
        found.note(f"{one} in a hole of the same form ({listed})")


def _say_pieces(found: Traced, outlines: Sequence[Outline], groups: Sequence[Sequence[int]]) -> None:
    """Note paths of several pieces: each is a part, unless a person gave the whole path a name."""
    strokes = {id(outline.stroke): outline.stroke for outline in outlines}
    counts = Counter(id(outlines[rows[0]].stroke) for rows in groups if not outlines[rows[0]].face)
    together = {id(outlines[rows[0]].stroke): len(rows) for rows in groups if len(rows) > 1}
    apart = {key: n for key, n in counts.items() if n > 1}
    for chosen, said in (
        (apart, "paths of several pieces: each piece is a part"),
        (together, "pieces of one path that has a name are one part; break the path apart if they are several"),
    ):
        many = [(strokes[key], n) for key, n in chosen.items() if not strokes[key].whole and not strokes[key].piece]
        listed = ", ".join(f"{stroke} {n}" for stroke, n in many[:3]) + (", ..." if len(many) > 3 else "")
        if many:
            found.note(f"{said} ({listed})")


def _say_mended(found: Traced) -> None:
    """Note tiny faults that were mended."""
    mended = [remark for remark in found.remarks if remark.kind.startswith("mended")]
    words = {"mended loop": "loop", "mended spike": "spike", "mended touch": "place where an outline touches itself"}
    for kind, n in Counter(remark.kind for remark in mended).items():
        x, y = next(remark.lines[0][0] for remark in mended if remark.kind == kind)
        plural = words[kind].replace("place", "places", 1) if " " in words[kind] else f"{words[kind]}s"
        found.note(f"mended: {n} {words[kind] if n == 1 else plural} of outlines, the first at ({x:.6g}, {y:.6g}) mm")


def _glue(strokes: Sequence[Stroke], names: Sequence[str]) -> tuple[tuple[str, ...], ...]:
    """Parts of one glue group move as one; of groups inside each other the outermost counts."""
    found: dict[int, list[str]] = {}
    for stroke, name in zip(strokes, names, strict=True):
        group = next((group for group in stroke.groups if group.glue), None)
        if group:
            found.setdefault(id(group), []).append(name)
    return tuple(tuple(members) for members in found.values() if len(members) > 1)
