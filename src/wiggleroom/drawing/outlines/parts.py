"""From the strokes of a drawing to its parts: cut lines chosen, outlines found, nested, named and glued."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import shapely

from wiggleroom.drawing.model import Drawing, Flattening, Part, Region
from wiggleroom.drawing.outlines.cuts import SMALL, Claims, Cuts, crossings, cuts_of
from wiggleroom.drawing.outlines.engraving import without_engraved_styles
from wiggleroom.drawing.outlines.file_reading import Reading
from wiggleroom.drawing.outlines.naming import aliases_of, asked_for, given_names, texts_inside, unique_names
from wiggleroom.drawing.outlines.nesting import cut_nested, direct_parents, shares_in_material
from wiggleroom.drawing.outlines.outlines import traced
from wiggleroom.drawing.outlines.rings import clean_ring, part_about_centroid
from wiggleroom.drawing.outlines.sheet_frame import leave_out_frames
from wiggleroom.drawing.outlines.traced_outlines import Outline, Remark, Traced
from wiggleroom.drawing.strokes.colours import is_light
from wiggleroom.drawing.strokes.elements import NO_SIZE, Artwork, Stroke
from wiggleroom.drawing.strokes.flatten import Curved
from wiggleroom.drawing.strokes.layers import PAGE, cut_by, cut_strokes, has_own_name, is_outline_name, is_own_label
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.errors import go_on

_TOUCH, _TOUCH_SHARE = 0.05, 1e-3
"""Outlines nearer than this [mm, share of the drawing's size] touch, and walls of a part beside a cut that are thinner are gone."""
_HAIR = 2e-4
"""Overlaps thinner than this share of the distance below which outlines touch are rounding."""
_ROUNDING = 1e-10
"""Overlaps thinner than this share of the drawing's size are none."""
_SAME = 1e-9
"""Areas that differ by less than this share are the same."""
_CRUMB = 0.01
"""What a cut leaves loose of a part falls out where it is smaller than this share of the largest piece."""

_LETTER = 1e-3
"""Parts smaller than this share of the largest one are letters, marks or scraps, perhaps."""


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
    found = traced(chosen, flatten=flatten, gap=gap, options=options, view=view)
    found.notes[:0] = chosen.notes
    found.findings[:0] = chosen.findings
    found.remarks += _left_out(left_out, found.tolerance)
    _layer_holes(found)
    leave_out_frames(found, artwork.view, options)
    without_engraved_styles(found, options)
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
    lies = shares_in_material(polygons, parents, [outline.region for outline in outlines], found.tolerance)
    in_material = {i: p for i, p in parents.items() if i not in lies}
    touch = _touch(polygons)
    crossing = crossings(polygons, parents, lies)
    around = {i: max(over, key=over.__getitem__) for i, over in crossing.of.items()} | in_material
    claims = _claims(found, options, given, inside, around, polygons)
    cuts = cuts_of(polygons, parents, in_material, crossing, claims, touch)
    holes = cuts.rows
    kept = [row for row in range(len(outlines)) if row not in holes]
    texts, unnamed = texts_inside(polygons[kept], artwork.texts)  # a text in a hole names the part around it
    inside = [""] * len(outlines)
    for row, text in zip(kept, texts, strict=True):
        inside[row] = text
    material = cut_nested([outline.region for outline in outlines], in_material, holes, cuts.across, touch)
    filled = [row for row, pieces in material.items() if not pieces]
    if filled:
        listed = ", ".join(str(strokes[row]) for row in filled[:3]) + (", ..." if len(filled) > 3 else "")
        found.note(f"outlines that others inside them fill are left out: {listed}")
        found.remarks.append(Remark("left out", tuple(outlines[row].region.outer for row in filled)))
    material = {row: pieces for row, pieces in material.items() if pieces}
    scraps = _scraps(polygons, in_material, cuts, claims, material)
    if scraps:
        x, y = polygons[scraps[0]].representative_point().coords[0]
        found.note(
            f"{'1 scrap' if len(scraps) == 1 else f'{len(scraps)} scraps'} in holes left out, the first at ({x:.6g}, {y:.6g}) mm; "
            "--solid NAME, @x,y or all makes parts of them"
        )
        found.remarks.append(Remark("left out", tuple(outlines[row].region.outer for row in scraps)))
    material = {row: pieces for row, pieces in material.items() if row not in scraps}
    _say_loose(found, cuts, claims)
    divided = _divided(found, material, in_material, cuts)
    groups = _pieces(outlines, material)
    bodies: list[tuple[list[int], list[Region]]] = []
    for rows in groups:
        if rows[0] in divided:
            bodies += [(rows, [region]) for region in material[rows[0]]]
        else:
            bodies.append((rows, [region for row in rows for region in material[row]]))
    bodies = _without_hair(found, bodies, touch)
    first = [rows[0] for rows, _ in bodies]
    final = given_names(
        [strokes[row] for row in first], [inside[row] for row in first], [not outlines[row].face for row in first]
    )
    names = unique_names(final)
    _say_faces(found, first)
    _say_nesting(found, names, first, in_material, cuts)
    _say_divided(found, dict(reversed([*zip(first, names, strict=True)])), divided, claims, given)
    _say_pieces(found, outlines, groups)
    _say_mended(found)
    _say_tiny(found, names, bodies)
    kinds = [*((tag, n) for tag, n in artwork.left_out if tag != NO_SIZE), *([("text", unnamed)] if unnamed else [])]
    found.notes += [
        f"{artwork.file}: {count} {tag} elements are left out; only outlines are parts" for tag, count in kinds
    ]
    said = [("" if outlines[row].face else strokes[row].name, inside[row], given[row]) for row in first]
    parts = tuple(
        part_about_centroid(name, regions, fixed=strokes[rows[0]].fixed, aliases=others)
        for name, (rows, regions), others in zip(names, bodies, aliases_of(names, said), strict=True)
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


def _touch(polygons: np.ndarray) -> float:
    """Distance below which outlines touch [mm]."""
    size = float(np.ptp(shapely.total_bounds(polygons).reshape(2, 2), axis=0).max())
    return min(_TOUCH, _TOUCH_SHARE * size)


def _layer_holes(found: Traced) -> None:
    """Give holes by their layer that touch nothing to the smallest outline around them; others stay, to be cut later."""
    rows = [k for k, outline in enumerate(found.outlines) if outline.stroke.hole]
    if not rows:
        return
    holes = np.array([found.outlines[k].polygon for k in rows], dtype=object)
    others = [k for k, outline in enumerate(found.outlines) if not outline.stroke.hole]
    parts = np.array([found.outlines[k].polygon for k in others], dtype=object)
    if not others:
        return
    touch = _touch(np.concatenate([holes, parts]))
    rims, area = shapely.boundary(holes), shapely.area(parts)
    first, _ = shapely.STRtree(rims).query(rims, predicate="dwithin", distance=touch)
    alone = (np.bincount(first, minlength=len(holes)) == 1) & shapely.is_valid(holes)
    drawn = [(found.outlines[k].region.outer, *found.outlines[k].region.holes) for k in others]
    edges = np.array([shapely.MultiLineString([shapely.LinearRing(ring) for ring in rings]) for rings in drawn])
    near, other = shapely.STRtree(edges).query(rims, predicate="dwithin", distance=touch)
    fits = alone[near] & shapely.is_valid(parts[other])
    rest = shapely.area(shapely.difference(parts[other[fits]], holes[near[fits]]))
    fits[fits] = rest <= _SAME * area[other[fits]]  # a part in the hole, which touches it or has its form
    alone[near[~fits]] = False
    fitted = set(zip(near[fits].tolist(), other[fits].tolist(), strict=True))
    smallest: dict[int, int] = {}
    for h, k in zip(*shapely.STRtree(parts).query(holes, predicate="within").tolist(), strict=True):
        if (h, k) in fitted:
            continue
        if alone[h] and (h not in smallest or area[k] < area[smallest[h]]):
            smallest[h] = k
    for h, k in zip(*shapely.STRtree(holes).query(holes, predicate="within").tolist(), strict=True):
        if h != k and h in smallest and holes[k].area < (1 - _SAME) * area[smallest[h]]:
            del smallest[h]  # in another hole, where there is no material
    cut: dict[int, list[np.ndarray]] = {}
    for h, k in smallest.items():
        cut.setdefault(others[k], []).append(found.outlines[rows[h]].region.outer[::-1])
    given = {rows[h] for h in smallest}
    found.outlines = [
        Outline(Region(o.region.outer, (*o.region.holes, *cut[k])), o.stroke, o.row, o.face) if k in cut else o
        for k, o in enumerate(found.outlines)
        if k not in given
    ]


def _claims(
    found: Traced,
    options: ReadOptions,
    given: Sequence[str],
    inside: Sequence[str],
    around: dict[int, int],
    polygons: np.ndarray,
) -> Claims:
    """What the file and the options say about each outline: a part whatever lies around it, or a cut."""
    solid_names, solid_rows = asked_for(options.solid, polygons)
    hole_names, hole_rows = asked_for(options.hole, polygons)
    claims = Claims([], [], [], [], [], [])
    unknown = hole_names - {"all"}
    inner = [(around[i], o.stroke.label) for i, o in enumerate(found.outlines) if i in around and o.stroke.label]
    kinds = {parent for (parent, _), n in Counter(inner).items() if n > 1}  # labels in these are no names: "M4", "M4"
    kinds |= {i for i in {*around.values()} if is_outline_name(found.outlines[i].stroke.label)}  # nor in an "Outline"
    hollow = _hollow(found.outlines, around, polygons)
    for i, outline in enumerate(found.outlines):
        stroke = outline.stroke
        parent = found.outlines[around[i]].stroke if i in around else None
        own = parent is not stroke
        white = is_light(stroke.fill) and parent is not None and not is_light(parent.fill)
        # One label on an outline and on what is in it says nothing, nor does a text in both.
        named = inside[i] and parent is not None and given[around[i]] not in ("", given[i])
        filled = stroke.fill and not white and i not in hollow and (stroke.styled or has_own_name(stroke))
        labelled = is_own_label(stroke.label) and around.get(i) not in kinds
        labelled = labelled and (parent is None or stroke.label != parent.label)
        words = {word.casefold() for word in (given[i], stroke.name) if word}
        marks = {word.casefold() for word in (stroke.label, stroke.name, stroke.layer, *_group_marks(stroke)) if word}
        unknown -= words | marks
        told = stroke.piece is not None or stroke.whole
        chosen = bool(hole_names & words) or i in hole_rows
        claims.solid.append(
            "all" in solid_names or i in solid_rows or bool(solid_names & words) or told or (own and stroke.fixed)
        )
        claims.marked.append(own and not outline.face and bool(filled or labelled or named))
        claims.cut.append(
            "option" if chosen
            else "layer" if stroke.hole
            else "all" if not outline.face and ("all" in hole_names or hole_names & marks)
            else cut_by(stroke) if not told and not outline.face
            else ""
        )  # fmt: skip
        claims.named.append(own and not outline.face and has_own_name(stroke))
        claims.face.append(outline.face)
        claims.style.append((stroke.colour, bool(stroke.fill), stroke.line_type))
    if unknown:
        listed = ", ".join(sorted(unknown))
        found.findings.append(
            f"{found.file}: --hole {listed}: no outline is called so; name one, or a point in it as @x,y"
        )
    return claims


def _scraps(
    polygons: np.ndarray, parents: dict[int, int], cuts: Cuts, claims: Claims, rows: Collection[int]
) -> list[int]:
    """Outlines without a name in holes that are tiny beside the part around: a hole in the seat of a nut, not a piece of a puzzle."""
    area = shapely.area(polygons)
    found = []
    for row in rows:
        hole = parents.get(row, -1)
        around = parents.get(hole, -1)
        tiny = hole in cuts.rows and around >= 0 and area[row] < _LETTER * area[around]
        if tiny and not (claims.is_part(row) or claims.named[row] or claims.face[row]):
            found.append(row)
    return found


def _hollow(outlines: Sequence[Outline], around: dict[int, int], polygons: np.ndarray) -> set[int]:
    """Small outlines without a name in filled parts, in colours that stand inside parts alone: colours of holes."""
    strokes = [outline.stroke for outline in outlines]
    outside = {stroke.fill for i, stroke in enumerate(strokes) if i not in around}
    inner = [
        i
        for i, parent in around.items()
        if strokes[i].fill and strokes[i].fill not in outside and strokes[parent].fill and not strokes[i].fixed
        and not strokes[i].label and not has_own_name(strokes[i])
    ]  # fmt: skip
    taken: Counter[int] = Counter()
    for i in inner:
        taken[around[i]] += polygons[i].area
    return {i for i in inner if taken[around[i]] <= SMALL * polygons[around[i]].area}


def _group_marks(stroke: Stroke) -> list[str]:
    return [mark for group in stroke.groups for mark in (group.name, *group.marks)]


def _called(given: str, polygon: shapely.Polygon) -> str:
    """What an option may call an outline: its name, or a point in it."""
    if given:
        return given
    point = polygon.representative_point()
    return f"@{point.x:.6g},{point.y:.6g}"


def _say_loose(found: Traced, cuts: Cuts, claims: Claims) -> None:
    """Refuse outlines that should be holes and lie in no part."""
    for said, reason in (
        (
            "layer",
            "by its layer, but lies in no part; it must lie inside an outline of another layer or across its edge",
        ),
        ("option", "by --hole, but lies in no part; leave the option out, or --skip the outline"),
    ):
        rows = [i for i in cuts.loose if claims.cut[i] == said]
        if rows:
            more = f" (and {len(rows) - 1} more)" if len(rows) > 1 else ""
            found.findings.append(f"{found.file}: {found.outlines[rows[0]].stroke}{more}: is a hole {reason}")


def _divided(
    found: Traced,
    material: dict[int, list[Region]],
    inside: dict[int, int],
    cuts: Cuts,
) -> dict[int, list[int]]:
    """Rows of parts that cuts divide, and the cuts: each piece is a part."""
    children: dict[int, list[int]] = {}
    for i in sorted(cuts.joined):
        children.setdefault(inside[i], []).append(i)
    divided: dict[int, list[int]] = {}
    for row in sorted({*children, *cuts.across}):
        if len(material.get(row, ())) < 2:
            continue
        areas = np.array([shapely.Polygon(region.outer, region.holes).area for region in material[row]])
        large = areas > _CRUMB * areas.max()
        crumbs = [region.outer for region, kept in zip(material[row], large, strict=True) if not kept]
        if crumbs:
            found.note(f"{found.outlines[row].stroke}: {len(crumbs)} loose bits beside cuts are left out")
            found.remarks.append(Remark("left out", tuple(crumbs)))
        material[row] = [region for region, kept in zip(material[row], large, strict=True) if kept]
        if len(material[row]) > 1:
            divided[row] = [*children.get(row, ()), *cuts.across.get(row, ())]
    return divided


def _say_divided(
    found: Traced, called: dict[int, str], divided: dict[int, list[int]], claims: Claims, given: Sequence[str]
) -> None:
    """Note parts that cuts divide; where nothing says that they are cuts, ask."""
    for row, rows in divided.items():
        asked = [_called(given[i], found.outlines[i].polygon) for i in rows if not claims.cut[i]]
        if not asked:
            found.note(f"cuts divide {called[row]}; each piece is a part")
            continue
        listed = ",".join(asked[:4]) + (", ..." if len(asked) > 4 else "")
        found.findings.append(
            f"{found.file}: {listed} would cut part {called[row]} in pieces; --hole {listed} says so, and each piece is a part; "
            f"--solid {asked[0]} makes a part of it"
        )


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


def _say_faces(found: Traced, first: Sequence[int]) -> None:
    """Note parts that open lines bound or cut."""
    faces = sum(found.outlines[row].face or found.outlines[row].of_lines for row in first)
    if faces:
        cut = f"{'1 outline' if found.divided == 1 else f'{found.divided} outlines'} cut, " if found.divided else ""
        found.note(f"{cut}{'1 face' if faces == 1 else f'{faces} faces'} of open lines taken as parts")


def _say_nesting(
    found: Traced,
    names: Sequence[str],
    first: Sequence[int],
    parents: dict[int, int],
    cuts: Cuts,
) -> None:
    """Note which outlines inside others were taken as holes, and which as parts."""
    called = dict(reversed([*zip(first, names, strict=True)]))
    if cuts.rows:
        found.remarks.append(Remark("hole", tuple(found.outlines[i].region.outer for i in sorted(cuts.rows))))
    over = {i: j for j, rows in cuts.across.items() for i in rows}
    for rows, one, many in (
        (
            sorted(cuts.rows - over.keys()),
            "1 outline inside another is a hole",
            "outlines inside others are holes",
        ),
        (sorted(over), "1 outline across the edge of a part cuts it", "outlines across the edges of parts cut them"),
    ):
        if not rows:
            continue
        counts = Counter(called.get(over.get(i, parents.get(i, -1)), "") for i in rows)
        shown = [f"{n} in {name}" for name, n in counts.most_common() if name]
        listed = ", ".join(shown[:4]) + (", ..." if len(shown) > 4 else "")
        joined = len(cuts.joined.intersection(rows))
        united = "; it touches the edge" if joined and len(rows) == 1 else ""
        united = united or (f"; {joined} of them touch each other or the edge" if joined else "")
        said = one if len(rows) == 1 else f"{len(rows)} {many}"
        found.note(f"{said}{f' ({listed})' if listed else ''}{united}; --solid NAME, @x,y or all makes parts of them")
    if cuts.kept:
        listed = ", ".join(called.get(i, "?") for i in cuts.kept[:4]) + (", ..." if len(cuts.kept) > 4 else "")
        said = (
            "1 outline inside another is a part, as it touches the edge"
            if len(cuts.kept) == 1
            else f"{len(cuts.kept)} outlines inside others are parts, as they touch each other or the edge"
        )
        found.note(f"{said} ({listed}); --hole NAME, @x,y or all makes holes of them")
    islands = [called[i] for i in parents if i in called and i not in cuts.rows and parents[i] in cuts.rows]
    if islands:
        listed = ", ".join(islands[:4]) + (", ..." if len(islands) > 4 else "")
        said = "1 part lies in a hole" if len(islands) == 1 else f"{len(islands)} parts lie in holes"
        found.note(f"{said} of another ({listed})")
    filling = [
        called[i]
        for i in parents
        if i not in cuts.rows and i in called and parents[i] not in cuts.rows and i not in cuts.kept
    ]
    if filling:
        listed = ", ".join(filling[:4]) + (", ..." if len(filling) > 4 else "")
        one = (
            "1 outline inside another is a part"
            if len(filling) == 1
            else f"{len(filling)} outlines inside others are parts"
        )
        found.note(f"{one} in a hole of the same form ({listed})")


def _without_hair(
    found: Traced, bodies: list[tuple[list[int], list[Region]]], touch: float
) -> list[tuple[list[int], list[Region]]]:
    """Parts without overlaps that rounding of the file's numbers made: the larger part gives way."""
    regions = [(k, n) for k, (_, own) in enumerate(bodies) for n in range(len(own))]
    shapes = np.array([shapely.Polygon(bodies[k][1][n].outer, bodies[k][1][n].holes) for k, n in regions], dtype=object)
    sound = np.flatnonzero(shapely.is_valid(shapes))
    shapely.prepare(shapes)
    first, second = shapely.STRtree(shapes[sound]).query(shapes[sound], predicate="intersects")
    first, second = sound[first], sound[second]
    owner, area = np.array([k for k, _ in regions]), shapely.area(shapes)
    order = (owner[first] != owner[second]) & (
        (area[first] > area[second]) | ((area[first] == area[second]) & (first < second))
    )
    first, second = first[order], second[order]
    meet = ~shapely.touches(shapes[first], shapes[second])
    first, second = first[meet], second[meet]
    common = shapely.intersection(shapes[first], shapes[second])
    width = 2 * shapely.area(common) / np.maximum(shapely.length(common), 1e-300)
    thin = (width > _ROUNDING * touch / _TOUCH_SHARE) & (width <= _HAIR * touch)
    if not thin.any():
        return bodies
    result = [(rows, list(own)) for rows, own in bodies]
    most = 0.0
    for i in np.unique(first[thin]).tolist():
        others = second[thin & (first == i)]
        rest = shapely.get_parts(shapely.difference(shapes[i], shapely.union_all(shapes[others])))
        rest = rest[shapely.area(rest) > 0.5 * area[i]]
        if len(rest) == 1:
            k, n = regions[i]
            rings = [
                rest[0].exterior,
                *(hole for hole in rest[0].interiors if shapely.Polygon(hole).area > 1e-9 * area[i]),
            ]
            outer, *holes = (clean_ring(shapely.get_coordinates(ring), clockwise=j > 0) for j, ring in enumerate(rings))
            result[k][1][n] = Region(outer, tuple(holes))
            most = max(most, float(width[thin & (first == i)].max()))
    found.note(f"parts that overlap by {most:.2g} mm or less are taken to touch")
    return result


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


def _say_tiny(found: Traced, names: Sequence[str], bodies: Sequence[tuple[list[int], list[Region]]]) -> None:
    """Note parts that are tiny beside the largest one: letters that are drawn as outlines, perhaps, or scraps."""
    areas = np.array([sum(shapely.Polygon(region.outer).area for region in own) for _, own in bodies])
    tiny = [name for name, area in zip(names, areas, strict=True) if area < _LETTER * areas.max()]
    if tiny:
        many = "1 part is" if len(tiny) == 1 else f"{len(tiny)} parts are"
        listed = ", ".join(tiny[:3]) + (", ..." if len(tiny) > 3 else "")
        found.note(
            f"{many} tiny beside the largest one ({listed}); letters, marks and scraps are left out with --skip, "
            "by a point in each, or by their layer or colour"
        )


def _glue(strokes: Sequence[Stroke], names: Sequence[str]) -> tuple[tuple[str, ...], ...]:
    """Parts of one glue group move as one; of groups inside each other the outermost counts."""
    found: dict[int, list[str]] = {}
    for stroke, name in zip(strokes, names, strict=True):
        group = next((group for group in stroke.groups if group.glue), None)
        if group:
            found.setdefault(id(group), []).append(name)
    return tuple(tuple(members) for members in found.values() if len(members) > 1)
