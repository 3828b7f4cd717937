"""Letters and pictures that are drawn as outlines: they are engraved, and neither parts nor holes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.outlines.connected_components import components
from wiggleroom.drawing.outlines.naming import asked_for
from wiggleroom.drawing.outlines.nesting import direct_parents
from wiggleroom.drawing.outlines.traced_outlines import OpenLine, Outline, Remark, Traced
from wiggleroom.drawing.strokes.colours import name_of
from wiggleroom.drawing.strokes.elements import Stroke
from wiggleroom.drawing.strokes.layers import says_cut
from wiggleroom.drawing.strokes.read_options import ReadOptions

_SMALL, _SMALL_OUTSIDE = 0.25, 0.1
"""Letters are no larger than this share of the drawing; beside parts, where they would be parts themselves, than this one."""
_THIN, _THIN_OUTSIDE = 0.3, 2.0
"""The strokes of a letter are thinner than this share of its height, beside parts also than this [mm], ..."""
_BENT = 0.85
"""... its outline fills no more than this share of its hull, ..."""
_BAYS, _BAY = 8, 1e-3
"""... it has no more than so many bays larger than this share of it, where a gear has one between any two teeth, ..."""
_COUNTERS, _COUNTER = 3, 0.03
"""... and it holds no more than so many outlines, as B, 8 and % do, which take at least this share of it."""
_INK = 1.5
"""A letter of single lines is longer than this many times its height."""
_APART = 0.7
"""Letters of a word are no further apart than this share of their height, ..."""
_HEIGHTS, _STEMS = 2.0, 1.6
"""... their heights and the thickness of their strokes differ by no more than these factors, ..."""
_LETTERS, _KINDS = 3, 0.25
"""... there are at least so many, and among them at least this share differs, as the holes of a row do not."""
_ALIKE = 0.03
"""Letters whose areas and lengths differ by less than this share are the same."""
_MARK_HEIGHT, _MARK_STEM = 1.6, 1.4
"""A dot, a dash or an I beside a word is no higher and no thicker than so many times its letters."""
_RECTANGLE = 0.97
"""An outline that fills this share of the box round it is a rectangle."""
_FONT_HEIGHT, _FONT_STEM = 1.5, 1.4
"""A single letter is like those of a word elsewhere where height and thickness of its strokes differ by no more than these factors."""
_PICTURE, _NESTED = 0.5, 0.3
"""An outline of a picture takes no more than this share of the part that it is on, and at least this share of them are in each other."""
_MOSTLY = 0.5
"""A colour is lettering where at least this share of its outlines are letters."""
_JOINED, _ON_PARTS = 0.2, 0.95
"""Lines are scored where no more than this share of their ends meet other lines, and this share of their length lies on parts."""
_RED = ("#ff0000", "#ed1c24")
"""Lines that lasers cut where other lines are of other colours."""
_FIT = 0.05
"""An outline that lies nowhere further from the hole round it than this share of the hole's width is a part in it."""


@dataclass(frozen=True, eq=False)
class _Glyphs:
    """What may be letters: small outlines with those inside them, and small pieces of open lines.

    Parameters
    ----------
    shapes : (n,) geometries [mm]
    rows : list of tuple of int
        Of each, its outline and those inside; nothing for lines.
    lines : list of tuple of int
        Of each, its open lines; nothing for outlines.
    height : (n,) float64 [mm]
    stem : (n,) float64 [mm]
        Thickness of its strokes; NaN for lines.
    ink, length : (n,) float64
        Area [mm2] of an outline, length [mm] of lines; length of all boundaries [mm].
    bent : (n,) bool
        Whether it has the form of a letter, and not only of a dot or a dash.
    ring : (n,) bool
        Whether it has that of an O or a D.
    counters : (n,) bool
        Whether something lies inside that would fall out if it were cut.
    inside : (n,) bool
        Whether it lies in another outline.
    near : pair of (m,) int
        Pairs of those that are near each other, both ways.
    """

    shapes: NDArray[np.object_]
    rows: list[tuple[int, ...]]
    lines: list[tuple[int, ...]]
    height: NDArray[np.float64]
    stem: NDArray[np.float64]
    ink: NDArray[np.float64]
    length: NDArray[np.float64]
    bent: NDArray[np.bool_]
    ring: NDArray[np.bool_]
    counters: NDArray[np.bool_]
    inside: NDArray[np.bool_]
    near: tuple[NDArray[np.int64], NDArray[np.int64]]


def without_lettering(found: Traced, lines: NDArray[np.object_], options: ReadOptions) -> NDArray[np.object_]:
    """Leave out outlines that are letters, and return the lines that bound nothing without those of letters.

    A word is a row of at least three small, thin, bent outlines of one height and thickness that are not all alike. Inside a part it
    is engraved where a letter of the drawing holds an island, which would fall out if it were cut; else it may be cut with a stencil's
    letters, and stays. Outside of all parts it is a legend, and single lines are engraved anywhere.
    """
    if options.only or "all" in options.solid or "all" in options.hole:
        return lines
    if not found.outlines:
        return lines
    total = shapely.total_bounds([*(outline.polygon for outline in found.outlines), *lines])
    glyphs = _glyphs(found.outlines, lines, _SMALL_OUTSIDE * float((total[2:] - total[:2]).max()), options)
    word = _words(glyphs)
    members = np.flatnonzero(word >= 0)
    if not len(members):
        return lines
    inside = {k: bool(glyphs.inside[word == k].any()) for k in np.unique(word[members]).tolist()}
    islands = bool((glyphs.counters[members] & glyphs.inside[members]).any())
    lined = {int(word[k]) for k in members.tolist() if glyphs.lines[k]}
    chosen = [k for k in members.tolist() if islands or int(word[k]) in lined or not inside[int(word[k])]]
    stencil = len(members) - len(chosen)
    if stencil:
        found.note(
            f"{stencil} outlines in parts look like letters, and none holds an island; they are cut, --skip leaves them out"
        )
    if not chosen:
        return lines
    chosen = _with_their_font(glyphs, chosen)
    rows = {row for k in chosen for row in glyphs.rows[k]}
    if len(rows) == len(found.outlines):
        return lines  # nothing but letters: they are the parts
    used = {row for k in chosen for row in glyphs.lines[k]}
    first = shapely.bounds(glyphs.shapes[chosen[0]])
    found.note(
        f"{len(chosen)} letters drawn as outlines or lines are taken as engraved, and left out (the first at "
        f"({first[0]:.6g}, {first[1]:.6g}) mm); --solid all reads them"
    )
    found.remarks.append(
        Remark(
            "left out",
            (
                *(found.outlines[row].region.outer for row in sorted(rows)),
                *(shapely.get_coordinates(lines[row]) for row in sorted(used)),
            ),
        )
    )
    found.outlines = [outline for row, outline in enumerate(found.outlines) if row not in rows]
    return lines[[row for row in range(len(lines)) if row not in used]]


def _has_large_face(lines: NDArray[np.object_], least: float) -> bool:
    """Whether lines bound a face larger than `least` [mm] among themselves."""
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.union_all(lines))))
    return bool((np.ptp(shapely.bounds(faces).reshape(-1, 2, 2), axis=1) > least).any())


def without_engraved_styles(
    found: Traced, options: ReadOptions, lines: Sequence[OpenLine] | None = None
) -> list[OpenLine]:
    """Leave out the outlines of a colour that is engraved or scored, and return the lines without those of it.

    A colour is decided as a whole; what bounds a part is cut. Another one is engraved where it is lettering; where it is only
    straight lines on parts that join nothing; or, once the net of lines is known (`lines` is None), where it is a picture:
    outlines in parts that hold others, which would fall out. Pieces that fit the hole around them, and red lines, are cut.
    """
    kept = list(lines or ())
    if options.only or options.skip or "all" in options.solid or "all" in options.hole or not (found.outlines or kept):
        return kept
    layered = lines is None
    styles = [_style(outline.stroke, layered) for outline in found.outlines]
    of_lines = [_style(line.stroke, layered) for line in kept]
    if len({*styles, *of_lines}) < 2:
        return kept
    polygons = np.array([outline.polygon for outline in found.outlines], dtype=object)
    drawn = np.array([shapely.LineString(line.corners) for line in kept], dtype=object)
    total = shapely.total_bounds([*polygons, *drawn])
    least = _SMALL_OUTSIDE * float((total[2:] - total[:2]).max())
    parents = direct_parents(polygons)
    names, asked = asked_for((*options.solid, *options.hole), polygons)
    told = {row for row, o in enumerate(found.outlines) if row in asked or _told(o.stroke, names)}
    large = np.ptp(shapely.bounds(polygons).reshape(-1, 2, 2), axis=1).max(axis=1, initial=0.0) > least
    several = sum(row not in parents for row in range(len(polygons))) > 1  # else it may be a sheet with parts
    bounding = {
        styles[row] for row in range(len(polygons)) if large[row] and not ((layered or several) and row in parents)
    }
    if not (layered or bounding):
        bounding = {style for style in {*of_lines} if _has_large_face(drawn[[o == style for o in of_lines]], least)}
    pictures = _pictures(found.outlines, polygons, parents, styles, told, several) if layered else set()
    scores = _scores(kept, drawn, polygons, of_lines, bounding) if several else set()
    gone: set[_Style] = set()
    for style in sorted({*styles, *of_lines} - bounding if layered or bounding else ()):
        own = [row for row, other in enumerate(styles) if other == style]
        mine = [row for row, other in enumerate(of_lines) if other == style]
        if told.intersection(own) or says_cut(style[1]):
            continue
        what = (
            "with letters among them, none of which bounds a part: taken as dimensions or notes"
            if _are_letters(found.outlines, own, drawn[mine], least, options)
            else "inside parts, one in another: taken as an engraved picture"
            if style in pictures
            else "on parts, which bound none: taken as scored"
            if style in scores
            else ""
        )
        if not what:
            continue
        gone.add(style)
        colour = f"in {name_of(style[0])}" if style[0] else f"on layer {style[1]}"
        kind = "line" if mine else "outline"
        count = len(own) + len(mine)
        many = f"1 {kind}" if count == 1 else f"{count} {kind}s"
        only = ",".join(name_of(c) for c in sorted({c for c, _ in {*styles, *of_lines}}) if c) if mine else ""
        remedy = f"--only {only} reads them" if only else "--solid all reads them"
        found.note(f"{many} {colour} {what}, and left out; {remedy}")
        rest = (*(found.outlines[row].region.outer for row in own), *(kept[row].corners for row in mine))
        found.remarks.append(Remark("left out", rest))
    found.outlines = [outline for outline, style in zip(found.outlines, styles, strict=True) if style not in gone]
    return [line for line, style in zip(kept, of_lines, strict=True) if style not in gone]


_Style = tuple[str, str]


def _style(stroke: Stroke, layered: bool) -> _Style:
    """Colour of a stroke, and its layer where those count."""
    return stroke.colour or stroke.fill, stroke.layer if layered else ""


def _are_letters(
    outlines: Sequence[Outline], own: Sequence[int], drawn: NDArray[np.object_], least: float, options: ReadOptions
) -> bool:
    """Whether outlines and lines of one style are lettering: lines among which are letters, or outlines most of which are."""
    if any(np.ptp(outlines[row].region.outer, axis=0).max() > least for row in own):
        return False
    glyphs = _glyphs([outlines[row] for row in own], drawn, least, options)
    letters = np.flatnonzero(_words(glyphs) >= 0).tolist()
    rows = {row for k in letters for row in glyphs.rows[k]}
    return any(glyphs.lines[k] for k in letters) or (len(rows) >= _MOSTLY * len(own) > 0 and not len(drawn))


def _pictures(
    outlines: Sequence[Outline],
    polygons: NDArray[np.object_],
    parents: dict[int, int],
    styles: Sequence[_Style],
    told: set[int],
    several: bool,
) -> set[_Style]:
    """Styles all of whose outlines lie in parts, and many of which hold others, which would fall out."""
    area = shapely.area(polygons)
    depth: dict[int, int] = {}
    for row in np.argsort(-area, kind="stable").tolist():
        depth[row] = depth[parents[row]] + 1 if row in parents else 0
    in_part = [depth[row] % 2 == 1 for row in range(len(polygons))]  # not in a hole of one
    inner: dict[int, list[int]] = {}
    for row, around in parents.items():
        inner.setdefault(around, []).append(row)
    nested = {row for row, o in enumerate(outlines) if in_part[row] and o.region.holes}
    fitting: set[_Style] = set()
    for row, rows in inner.items():
        if not in_part[row]:
            continue
        if told.intersection(rows) or any(_fits(polygons[k], polygons[row]) for k in rows):
            fitting.add(styles[row])
            fitting |= {styles[k] for k in rows}
        alike = [k for k in rows if styles[k] == styles[row]]
        nested |= {row, *alike} if several or alike else set()
    found = set()
    inside = {*styles} - {style for row, style in enumerate(styles) if row not in parents}
    for style in ({styles[row] for row in nested} & inside) - fitting:
        rows = [row for row, other in enumerate(styles) if other == style]
        large = any(in_part[row] and area[row] > _PICTURE * area[parents[row]] for row in rows)
        if not large and len(nested & set(rows)) >= _NESTED * len(rows):
            found.add(style)
    pictured = {colour for colour, _ in found if colour}
    return found | {style for style in inside - fitting if style[0] in pictured}


def _scores(
    lines: Sequence[OpenLine],
    drawn: NDArray[np.object_],
    polygons: NDArray[np.object_],
    styles: Sequence[_Style],
    bounding: set[_Style],
) -> set[_Style]:
    """Styles of lines on parts that no other line of the drawing continues."""
    if not len(drawn):
        return set()
    sheet = shapely.union_all(shapely.make_valid(polygons))
    ends = shapely.points(np.array([line.corners[k] for line in lines for k in (0, -1)]))
    near = 1e-4 * float(np.ptp(shapely.total_bounds(polygons).reshape(2, 2), axis=0).max())
    first, second = shapely.STRtree(ends).query(ends, predicate="dwithin", distance=near)
    joined = np.unique(first[first // 2 != second // 2])
    met = np.bincount(joined // 2, minlength=len(lines))
    inside = shapely.length(shapely.intersection(drawn, shapely.buffer(sheet, near)))
    length = shapely.length(drawn)
    found = set()
    for style in set(styles) - bounding:
        rows = np.array([other == style for other in styles])
        straight = met[rows].sum() <= _JOINED * 2 * rows.sum()
        red = style[0] in _RED and not any(other[0] in _RED for other in bounding)
        if straight and not red and style[0] and inside[rows].sum() >= _ON_PARTS * length[rows].sum():
            found.add(style)
    return found


def _glyphs(
    outlines: Sequence[Outline], drawn: NDArray[np.object_], most_outside: float, options: ReadOptions
) -> _Glyphs:
    """What may be letters, by size and by what the file says."""
    polygons = np.array([outline.polygon for outline in outlines], dtype=object)
    most = _SMALL / _SMALL_OUTSIDE * most_outside
    box = shapely.bounds(polygons).reshape(-1, 4)
    height = (box[:, 2:] - box[:, :2]).max(axis=1)
    names, asked = asked_for((*options.solid, *options.hole), polygons)
    told = np.array([row in asked or _told(o.stroke, names) for row, o in enumerate(outlines)], dtype=bool)
    told |= np.array([o.stroke.tag.casefold() in ("circle", "ellipse") for o in outlines], dtype=bool)
    small = (height <= most) & ~told & shapely.is_valid(polygons)
    inner, outer = shapely.STRtree(polygons).query(polygons, predicate="within")
    apart = inner != outer
    inner, outer = inner[apart], outer[apart]
    n = len(polygons)
    own = [[shapely.Polygon(hole) for hole in o.region.holes] for o in outlines]
    area, length = shapely.area(polygons), shapely.length(polygons)
    holds = np.bincount(outer, minlength=n) + [len(holes) for holes in own]
    held_area = np.bincount(outer, area[inner], minlength=n) + [sum(hole.area for hole in holes) for holes in own]
    held_length = np.bincount(outer, length[inner], minlength=n) + [sum(hole.length for hole in holes) for holes in own]
    ink, edge = area - held_area, length + held_length
    stem = 2 * ink / edge
    fill = area / np.maximum(shapely.area(shapely.convex_hull(polygons)), 1e-300)
    few = small & (holds <= _COUNTERS) & (ink > 0)
    few &= (holds == 0) | (held_area >= _COUNTER * area)
    few[few] = _bays(polygons[few]) <= _BAYS
    bent = few & (stem <= _THIN * height) & (fill <= _BENT)
    ring = few & (stem <= _THIN * height) & (holds > 0)
    counter = np.zeros(n, dtype=bool)
    counter[inner[(bent | ring)[outer]]] = True
    may_be = np.flatnonzero(few & ~counter)
    large = ~few | told
    around = np.zeros(n, dtype=bool)
    around[inner[large[outer]]] = True
    inside_of: dict[int, list[int]] = {}
    for i, j in zip(inner.tolist(), outer.tolist(), strict=True):
        inside_of.setdefault(j, []).append(i)
    bent, ring = (form & (around | (stem <= _THIN_OUTSIDE)) for form in (bent, ring))
    may_be = may_be[around[may_be] | (height[may_be] <= most_outside)]
    pieces = _pieces_of_lines(drawn, polygons, may_be, most_outside)
    of_lines = {row for _, rows in pieces for row in rows}
    may_be = np.array([row for row in may_be.tolist() if row not in of_lines], dtype=int)
    lined = [shapely.union_all([*drawn[list(own)], *shapely.boundary(polygons[list(rows)])]) for own, rows in pieces]
    shapes = np.array([*polygons[may_be], *lined], dtype=object)
    boxes = shapely.bounds(shapes).reshape(-1, 4)[len(may_be) :]
    line_height, line_length = (boxes[:, 2:] - boxes[:, :2]).max(axis=1), shapely.length(shapes[len(may_be) :])
    within = np.zeros(len(pieces), dtype=bool)
    if len(pieces) and large.any():
        k, _ = shapely.STRtree(polygons[large]).query(shapes[len(may_be) :], predicate="within")
        within[k] = True
    tall = np.concatenate([height[may_be], line_height])
    return _Glyphs(
        shapes,
        [*((row, *inside_of.get(row, ())) for row in may_be.tolist()), *(rows for _, rows in pieces)],
        [*(() for _ in may_be), *(own for own, _ in pieces)],
        tall,
        np.concatenate([stem[may_be], np.full(len(pieces), np.nan)]),
        np.concatenate([ink[may_be], line_length]),
        np.concatenate([edge[may_be], line_length]),
        np.concatenate([bent[may_be], line_length >= _INK * line_height]),
        np.concatenate([ring[may_be], np.zeros(len(pieces), dtype=bool)]),
        np.concatenate([holds[may_be] > 0, np.zeros(len(pieces), dtype=bool)]),
        np.concatenate([around[may_be], within]),
        _near(shapes, tall),
    )


def _bays(polygons: NDArray[np.object_]) -> NDArray[np.int64]:
    """How many bays each outline has: pieces of its hull that it leaves empty."""
    hulls, area = shapely.convex_hull(polygons), shapely.area(polygons)
    bent = np.flatnonzero(shapely.area(hulls) - area > _BAY * area)  # the others, often circles, have none
    bays, owner = shapely.get_parts(shapely.difference(hulls[bent], polygons[bent]), return_index=True)
    owner = bent[owner]
    return np.bincount(owner[shapely.area(bays) > _BAY * area[owner]], minlength=len(polygons))


def _near(shapes: NDArray[np.object_], height: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of shapes that are no further apart than letters of a word, both ways."""
    if not len(shapes):
        return np.empty(0, dtype=int), np.empty(0, dtype=int)
    first, second = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=_APART * height)
    apart = first != second
    first, second = first[apart], second[apart]
    return np.concatenate([first, second]), np.concatenate([second, first])


def _told(stroke: Stroke, names: set[str]) -> bool:
    """Whether the file or an option says that a stroke is a part or a hole."""
    said = stroke.label or stroke.fixed or stroke.hole or stroke.whole or stroke.piece
    return bool(said) or stroke.name.casefold() in names


def _pieces_of_lines(
    drawn: NDArray[np.object_], polygons: NDArray[np.object_], may_be: NDArray[np.int64], most: float
) -> list[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Lines and outlines that touch each other, together no larger than `most` [mm], each with a line at least."""
    if not len(drawn):
        return []
    n, touch = len(drawn), 1e-6 * most
    shapes = np.concatenate([drawn, shapely.boundary(polygons[may_be])])
    first, second = shapely.STRtree(shapes).query(shapes[:n], predicate="dwithin", distance=touch)
    label = components(len(shapes), first, second)
    box = shapely.bounds(shapes)
    order = np.argsort(label, kind="stable")
    starts = np.flatnonzero(np.diff(label[order], prepend=-1))
    low, high = np.minimum.reduceat(box[order, :2], starts), np.maximum.reduceat(box[order, 2:], starts)
    size = (high - low).max(axis=1)
    groups = [
        rows for rows, s in zip(np.split(order, starts[1:]), size, strict=True) if 0 < s <= most and (rows < n).any()
    ]
    return [(tuple(rows[rows < n].tolist()), tuple(may_be[rows[rows >= n] - n].tolist())) for rows in groups]


def _words(glyphs: _Glyphs) -> NDArray[np.int64]:
    """Number of the word that each belongs to, or -1."""
    n, height, stem = len(glyphs.shapes), glyphs.height, glyphs.stem
    word = np.full(n, -1)
    first, second = glyphs.near
    alike = _within(height[first], height[second], _HEIGHTS) & _within(stem[first], stem[second], _STEMS)
    letter = glyphs.bent | glyphs.ring
    both = alike & letter[first] & letter[second]
    label = components(n, first[both], second[both])
    beside = _beside(glyphs)
    letters: dict[int, list[int]] = {}
    for k in np.flatnonzero(letter).tolist():
        letters.setdefault(int(label[k]), []).append(k)
    for key, rows in letters.items():
        if glyphs.bent[rows].any() and _kinds(glyphs, rows) >= max(2, _KINDS * len(rows)):
            members = _with_marks(glyphs, beside, rows)
            if len(members) >= _LETTERS:
                word[members] = key
    return word


def _beside(glyphs: _Glyphs) -> dict[int, list[int]]:
    """What is near each."""
    beside: dict[int, list[int]] = {}
    for i, j in zip(*(side.tolist() for side in glyphs.near), strict=True):
        beside.setdefault(i, []).append(j)
    return beside


def _with_marks(glyphs: _Glyphs, beside: dict[int, list[int]], rows: Sequence[int]) -> list[int]:
    """Letters with all beside them that is no higher and no thicker: dots, dashes, O and I."""
    high = float(glyphs.height[list(rows)].max())
    stems = glyphs.stem[list(rows)]
    thick = float(np.nanmedian(stems)) if np.isfinite(stems).any() else np.inf
    fits = (glyphs.height <= _MARK_HEIGHT * high) & ~(glyphs.stem > _MARK_STEM * thick)
    if thick == np.inf:  # letters of single lines: of outlines only those that are no holes beside them
        lined = np.isnan(glyphs.stem)
        box = shapely.area(shapely.envelope(glyphs.shapes))
        fits &= lined | ((glyphs.height * _MARK_HEIGHT >= high) & (glyphs.ink < _RECTANGLE * box))
    members, new = set(rows), set(rows)
    while new:
        new = {j for i in new for j in beside.get(i, ()) if fits[j]} - members
        members |= new
    return sorted(members)


def _within(one: NDArray[np.float64], other: NDArray[np.float64], factor: float) -> NDArray[np.bool_]:
    """Whether sizes differ by no more than a factor; those of nothing differ from none."""
    return ~((one > factor * other) | (other > factor * one))


def _kinds(glyphs: _Glyphs, rows: Sequence[int]) -> int:
    """How many different letters there are."""
    measures = np.log(np.column_stack([glyphs.ink[rows], glyphs.length[rows]]))
    first, second = np.nonzero((np.abs(measures[:, None] - measures) < _ALIKE).all(axis=2))
    return len(np.unique(components(len(rows), first, second)))


def _with_their_font(glyphs: _Glyphs, chosen: Sequence[int]) -> list[int]:
    """Letters of words with single letters of their height and thickness, and marks beside these."""
    rest = np.setdiff1d(np.flatnonzero(glyphs.bent & np.isfinite(glyphs.stem)), chosen)
    known = np.array([k for k in chosen if glyphs.bent[k] and np.isfinite(glyphs.stem[k])], dtype=int)
    if not len(rest) or not len(known):
        return list(chosen)
    high = _within(glyphs.height[rest][:, None], glyphs.height[known], _FONT_HEIGHT)
    thick = _within(glyphs.stem[rest][:, None], glyphs.stem[known], _FONT_STEM)
    beside = _beside(glyphs)
    found = np.union1d(chosen, rest[(high & thick).any(axis=1)])
    first, second = (np.searchsorted(found, side[np.isin(glyphs.near, found).all(axis=0)]) for side in glyphs.near)
    label = components(len(found), first, second)
    return sorted({j for key in np.unique(label) for j in _with_marks(glyphs, beside, found[label == key].tolist())})


def _fits(inner: shapely.Polygon, hole: shapely.Polygon) -> bool:
    """Whether an outline follows the hole that it lies in all round, as a part does in a hole of its own."""
    apart = shapely.hausdorff_distance(inner.exterior, hole.exterior)
    return bool(apart <= _FIT * np.sqrt(hole.area))
