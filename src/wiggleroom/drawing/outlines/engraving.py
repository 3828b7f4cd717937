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
from wiggleroom.drawing.strokes.read_options import ReadOptions

_SMALL, _SMALL_OUTSIDE = 0.25, 0.1
"""Letters are no larger than this share of the drawing; beside parts, where they would be parts themselves, than this one."""
_THIN, _THIN_OUTSIDE = 0.3, 2.0
"""The strokes of a letter are thinner than this share of its height, beside parts also than this [mm], ..."""
_BENT = 0.85
"""... its outline fills no more than this share of its hull, ..."""
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


def without_annotation(found: Traced, lines: Sequence[OpenLine], options: ReadOptions) -> list[OpenLine]:
    """Leave out lines in a colour in which letters are drawn and nothing that is larger and closed: dimensions, arrows, legends."""
    kept = list(lines)
    large = [outline.polygon for outline in found.outlines]
    if options.only or not lines:
        return kept
    drawn = np.array([shapely.LineString(line.corners) for line in lines], dtype=object)
    total = shapely.total_bounds([*large, *drawn])
    least = _SMALL_OUTSIDE * float((total[2:] - total[:2]).max())
    parts = {o.stroke.colour for o in found.outlines if np.ptp(o.region.outer, axis=0).max() > least}
    colours = {line.stroke.colour for line in lines}
    for colour in sorted(colours - parts if len(colours | parts) > 1 else ()):
        own = [o for o in found.outlines if o.stroke.colour == colour]
        mine = np.array([line.stroke.colour == colour for line in lines])
        glyphs = _glyphs(own, drawn[mine], least, options)
        word = _words(glyphs)
        if not any(glyphs.lines[k] for k in np.flatnonzero(word >= 0).tolist()):
            continue
        count = int(mine.sum()) + len(own)
        found.note(
            f"{count} lines in {name_of(colour)}, some of which are letters and none of which bounds a part, are taken as dimensions or "
            f"notes, and left out; --only {','.join(sorted(name_of(c) for c in colours | parts))} reads them"
        )
        found.remarks.append(Remark("left out", tuple(line.corners for line in kept if line.stroke.colour == colour)))
        found.outlines = [o for o in found.outlines if o.stroke.colour != colour]
        kept = [line for line in kept if line.stroke.colour != colour]
    return kept


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


def without_pictures(found: Traced, options: ReadOptions) -> None:
    """Leave out pictures: outlines inside parts in a colour or layer of their own, one of which holds another, which would fall out."""
    if options.only or options.skip or "all" in options.solid or "all" in options.hole or not found.outlines:
        return
    polygons = np.array([outline.polygon for outline in found.outlines], dtype=object)
    parents, area = direct_parents(polygons), shapely.area(polygons)
    styles = [(outline.stroke.colour or outline.stroke.fill, outline.stroke.layer) for outline in found.outlines]
    in_part = []  # whether what is around each is a part, not a hole in one
    for row in range(len(polygons)):
        depth, up = 0, row
        while up in parents:
            depth, up = depth + 1, parents[up]
        in_part.append(depth % 2 == 1)
    nested = {row for row, o in enumerate(found.outlines) if in_part[row] and o.region.holes}
    nested |= {row for i, j in parents.items() if in_part[j] and styles[i] == styles[j] for row in (i, j)}
    of_parts = {styles[row] for row in range(len(polygons)) if row not in parents}
    fitting = {styles[i] for i, j in parents.items() if in_part[j] and _fits(polygons[i], polygons[j])}
    names, asked = asked_for((*options.solid, *options.hole), polygons)
    gone: set[int] = set()
    for style in sorted({styles[row] for row in nested} - of_parts - fitting):
        rows = [row for row in range(len(polygons)) if styles[row] == style]
        few = len(nested & set(rows)) < _NESTED * len(rows)
        large = any(in_part[row] and area[row] > _PICTURE * area[parents[row]] for row in rows)
        if few or large or any(row in asked or _told(found.outlines[row].stroke, names) for row in rows):
            continue
        gone |= set(rows)
        colour = f"in {name_of(style[0])}" if style[0] else f"on layer {style[1]}"
        found.note(
            f"{len(rows)} outlines {colour} inside parts, one in another, are taken as an engraved picture, and left out; "
            "--solid all reads them"
        )
        found.remarks.append(Remark("left out", tuple(found.outlines[row].region.outer for row in rows)))
    found.outlines = [outline for row, outline in enumerate(found.outlines) if row not in gone]


def _fits(inner: shapely.Polygon, hole: shapely.Polygon) -> bool:
    """Whether an outline follows the hole that it lies in all round, as a part does in a hole of its own."""
    apart = shapely.hausdorff_distance(inner.exterior, hole.exterior)
    return bool(apart <= _FIT * np.sqrt(hole.area))
