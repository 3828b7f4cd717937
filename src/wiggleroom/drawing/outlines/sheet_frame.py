"""The sheet that parts are cut from: a page whose edge closes the outer pieces, and frames round everything that are no part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.model import Region
from wiggleroom.drawing.outlines.joining import BEAM
from wiggleroom.drawing.outlines.naming import asked_for, place_of, rows_at
from wiggleroom.drawing.outlines.nesting import direct_parents
from wiggleroom.drawing.outlines.traced_outlines import OpenLine, Outline, Remark, Traced
from wiggleroom.drawing.strokes.colours import is_grey, is_light, name_of
from wiggleroom.drawing.strokes.elements import Stroke
from wiggleroom.drawing.strokes.layers import PAGE, has_own_name, is_cut, is_outside_layer, may_be_sheet, names_sheet
from wiggleroom.drawing.strokes.read_options import ReadOptions

View = tuple[float, float, float, float]

PAGE_TOLERANCE = 0.01
"""A rectangle that misses the page by less than this share of its size is the page."""
_RECTANGLE = 0.97
"""An outline that fills this share of the box round it is a rectangle, its corners perhaps rounded."""
_SAME_SIZE = 0.01
"""Frames of several sheets differ by no more than this share of their size."""
_COVERED = 0.3
"""Holes leave more of a panel than parts leave of a sheet: they cover less than this share of it."""
_THIN = 0.3
"""Walls thinner than this [mm] between holes are the lines of a laser rather than material."""
_OPENED, _SEVERAL = 0.5, 3
"""A part has holes that cover less than this share of it, a ring round another part one that covers more; so many parts are on a sheet."""
_MOST_FRAMES = 4
"""Frames inside each other."""
_NEARLY_CLOSED = 0.1
"""A line whose ends are nearer to each other than this share of its size closes itself, if anything."""
_LOOSE_ENDS = 4
"""Of so many ends on the page's edge one may end inside it on nothing."""


def page_edge(found: Traced, lines: Sequence[OpenLine], view: View | None) -> Outline | None:
    """Outline of the page where lines end on its edge though no line is drawn there: it is the edge of the board.

    Parameters
    ----------
    found : Traced
        With all closed outlines.
    lines : sequence of OpenLine
    view : (x, y, width, height) or None [mm]
        The page.
    """
    if view is None:
        return None
    x, y, width, height = view
    near = max(found.join, found.tolerance)
    page = shapely.box(x, y, x + width, y + height)
    drawn = [shapely.LineString(line.corners) for line in lines]
    rings = [shapely.LinearRing(outline.region.outer) for outline in found.outlines]
    if sum(shapely.area([outline.polygon for outline in found.outlines])) > page.area / 2:
        return None
    bare = page.exterior.difference(shapely.union_all([*drawn, *rings]).buffer(near))
    tips = shapely.points(np.vstack([line.corners[[0, -1]] for line in lines]))
    owner = np.repeat(np.arange(len(lines)), 2)
    crossings = shapely.intersection(np.array(drawn, dtype=object), page.exterior)
    beyond = ~shapely.covers(page.buffer(near), tips)
    tree = shapely.STRtree([*drawn, *rings])
    k, other = tree.query(tips, predicate="dwithin", distance=near)
    held = np.zeros(len(tips), dtype=bool)
    held[k[other != owner[k]]] = True
    # A line that goes on beyond the page belongs to something larger than the page.
    over = (shapely.distance(crossings, bare) <= 3 * near)[owner] & beyond & ~held
    at_edge = over | ((shapely.distance(tips, page.exterior) <= near) & (shapely.distance(tips, bare) <= 3 * near))
    through = [
        np.hypot(*(line.corners[0] - line.corners[-1])) > _NEARLY_CLOSED * np.ptp(line.corners, axis=0).max()
        for line in lines
    ]
    at_edge &= np.repeat(through, 2)  # else it is an outline that is almost closed
    count = int(at_edge.sum())
    into = ~shapely.covers(page.exterior.buffer(near), np.array(drawn, dtype=object))  # not along the edge alone
    if count < 2 or not into[owner[at_edge]].any() or _LOOSE_ENDS * int((~held & ~at_edge & ~beyond).sum()) > count:
        return None
    found.note(
        f"{count} lines end on the page's edge, which is taken as the edge of the board (--skip {PAGE} leaves it out)"
    )
    stroke = replace(lines[0].stroke, name=PAGE, label="", fill="", fixed=False, paths=())
    return Outline(Region(shapely.get_coordinates(page.exterior.normalize().reverse())[:-1]), stroke, lines[0].row)


def leave_out_frames(found: Traced, view: View | None, options: ReadOptions) -> None:
    """Without outlines that `--skip` names by a point, and without frames that are the sheet; said in notes."""
    points = [place for name in options.skip if (place := place_of(name))]
    if points and found.outlines:
        rows = {row for row in rows_at(points, [outline.polygon for outline in found.outlines]) if row is not None}
        _leave_out(found, rows)
        found.note(f"{len(rows)} {'outline' if len(rows) == 1 else 'outlines'} left out (--skip)")
    _say_cut_outs(found)
    for _ in range(_MOST_FRAMES):
        if options.only or len(found.outlines) < 2:
            return
        sheet = _Sheet(found, view, options)
        rows, why = sheet.frames()
        if not rows:
            sheet.doubt()
            return
        at = sheet.free_point(min(rows))
        what = "rectangle round everything is" if len(rows) == 1 else "rectangles round everything are"
        found.note(f"{len(rows)} {what} left out as the sheet ({why}); --solid {at} makes it a part")
        _doubt_size(found, max(rows, key=lambda row: found.outlines[row].polygon.area))
        _leave_out(found, rows)


def _doubt_size(found: Traced, row: int) -> None:
    """Note that the sides of a sheet are round in another unit, and neither in millimetres nor in inches."""
    sides = np.ptp(found.outlines[row].region.outer, axis=0)

    def are_round(scale: float, step: float) -> bool:
        steps = sides * scale / step
        return bool((np.abs(steps - np.round(steps)) <= _ROUND * steps).all() and (np.round(steps) >= 1).all())

    if are_round(1.0, 1.0) or are_round(1 / 25.4, 0.25):
        return
    for dpi in (96.0, 90.0, 72.0):
        if are_round(dpi / 25.4, 10.0):
            width, height = np.round(sides * dpi / 25.4)
            found.note(
                f"the sheet is {sides[0]:.6g} x {sides[1]:.6g} mm, but {width:g} x {height:g} pixels of 1/{dpi:g} inch; if those are mm, "
                f"everything is {dpi / 25.4:.4g} times as large; --unit says so"
            )
            return


def _say_cut_outs(found: Traced) -> None:
    """Note filled shapes whose holes all but touch each other: what they cut out may be the parts."""
    for outline in found.outlines:
        holes = np.array([shapely.Polygon(hole) for hole in outline.region.holes], dtype=object)
        if len(holes) < 2 or shapely.area(holes).sum() < _COVERED * outline.polygon.area:
            continue
        first, second = shapely.STRtree(holes).query(holes, predicate="dwithin", distance=_THIN)
        if (first != second).any():
            found.note(
                f"{outline.stroke}: its {len(holes)} holes leave walls thinner than {_THIN:g} mm; if what they cut out are the parts, "
                "draw these as outlines"
            )


def _leave_out(found: Traced, rows: set[int]) -> None:
    if rows:
        found.remarks.append(Remark("left out", tuple(found.outlines[row].region.outer for row in sorted(rows))))
        found.outlines = [outline for row, outline in enumerate(found.outlines) if row not in rows]


_ROUND = 1e-5
"""Sides that differ from round ones by no more than this share are round."""


@dataclass(frozen=True)
class _Evidence:
    """What speaks for a frame being the sheet.

    Parameters
    ----------
    page : bool
        It is as large as the page.
    own : str
        Its colour, layer or line type where nothing else has it.
    drawn_aside : bool
        Its line is one of those that are not cut: grey or dashed, where nothing else is.
    panels : bool
        Outlines inside have holes of their own, so that they are parts.
    all_open : bool
        All of them have, or several.
    covered : bool
        What is inside covers more of it than holes do of a panel.
    apart : bool
        Nothing inside touches it or each other, as parts of an assembly do.
    outside : bool
        What is inside is cut on the outside by its layer.
    """

    page: bool
    own: str
    drawn_aside: bool
    panels: bool
    all_open: bool
    covered: bool
    apart: bool
    outside: bool


class _Sheet:
    """Outlines of a drawing, and which of them are frames round the others."""

    def __init__(self, found: Traced, view: View | None, options: ReadOptions) -> None:
        self.found, self.view = found, view
        self.polygons: NDArray[np.object_] = np.array([outline.polygon for outline in found.outlines], dtype=object)
        self.bounds = shapely.bounds(self.polygons)
        self.area = shapely.area(self.polygons)
        self.parents = direct_parents(self.polygons)
        asked, at = asked_for(options.solid, self.polygons)
        self.asked = {
            row
            for row, outline in enumerate(found.outlines)
            if "all" in asked or row in at or asked & {outline.stroke.name.casefold(), outline.stroke.label.casefold()}
        }
        self.inside: dict[int, list[int]] = {}
        for inner, outer in self.parents.items():
            self.inside.setdefault(outer, []).append(inner)
        self.frame_rows = self._rows_round_everything()

    def frames(self) -> tuple[set[int], str]:
        """Rows of frames that are the sheet, and why; none where they may be parts."""
        background = {row for row in range(len(self.polygons)) if self._is_background(row)}
        if background:
            return background, "as large as the page, without a line to cut"
        rows = self.frame_rows
        if not rows:
            return set(), ""
        strokes = [self.found.outlines[row].stroke for row in rows]
        inner = self._with_inner(rows)
        others = set().union(*(_words(o.stroke) for k, o in enumerate(self.found.outlines) if k not in rows | inner))
        own = [sorted(_words(stroke) - others) for stroke in strokes]
        sheet = next((word for said in own for word in said if names_sheet(word)), "")
        if sheet:
            return rows, f'called "{sheet}"'
        seen = self._evidence(inner or rows)
        cut = all(is_cut(self.found.outlines[k].stroke) for row in inner or rows for k in self.inside[row])
        if not cut and self._is_box_of_one(rows):
            return rows, "the box of what is in it"
        if cut or not seen.apart:
            return set(), ""
        perhaps = next((word for said in own for word in said if may_be_sheet(word)), "")
        if perhaps and (inner or self._count(rows) > 1) and (seen.page or seen.panels or seen.covered):
            return rows, f'called "{perhaps}"'
        if any(stroke.label or has_own_name(stroke) or is_outside_layer(stroke.layer) for stroke in strokes):
            return set(), ""
        if seen.outside:
            return rows, "what is in it is cut on the outside by its layer"
        size = "as large as the page" if seen.page else ""
        if seen.page and seen.drawn_aside:
            return rows, f"{size}, {seen.own}"
        if (seen.page or seen.own) and seen.panels:
            return rows, ", ".join(filter(None, (size, seen.own, "what is in it has holes")))
        if seen.page and seen.own and seen.covered:
            return rows, f"{size}, {seen.own}"
        if len(rows) > 1 and seen.panels:
            return rows, "all of one size, what is in them has holes"
        if seen.panels and seen.all_open:
            return rows, "what is in it has holes"
        return set(), ""

    def doubt(self) -> None:
        """Note where a rectangle round everything is a part though it may be the sheet."""
        rows = self.frame_rows
        if not rows or self._count(rows) < 2:
            return
        seen = self._evidence(rows)
        inner = [self.found.outlines[k].stroke for row in rows for k in self.inside[row]]
        parts = any(stroke.label or stroke.fill or stroke.fixed for stroke in inner)
        if seen.apart and (seen.covered or seen.panels) and not parts and not rows & self.asked:
            at = self.free_point(min(rows))
            self.found.note(
                f"the rectangle round everything is taken as a part, what is in it as holes; --skip {at} if it is the sheet"
            )

    def free_point(self, row: int) -> str:
        """A point in a frame outside all that lies in it, as options take it."""
        rest = self.polygons[row].difference(shapely.union_all(self.polygons[self.inside.get(row, [])]))
        point = (
            sorted(shapely.get_parts(rest), key=shapely.area)[-1].representative_point() if rest.area else rest.centroid
        )
        return f"@{point.x:.4g},{point.y:.4g}"

    def _is_rectangle(self, row: int) -> bool:
        outline = self.found.outlines[row]
        low, high = self.bounds[row].reshape(2, 2)
        may_be = not (outline.face or outline.region.holes or outline.stroke.hole or outline.stroke.fixed)
        return may_be and row not in self.asked and self.area[row] >= _RECTANGLE * float(np.prod(high - low))

    def _is_page(self, row: int) -> bool:
        if self.view is None:
            return False
        x, y, width, height = self.view
        apart = np.abs(self.bounds[row] - np.array([x, y, x + width, y + height]))
        return bool((apart <= PAGE_TOLERANCE * np.array([width, height, width, height])).all())

    def _is_background(self, row: int) -> bool:
        """Whether a rectangle is as large as the page or larger, and no line to cut."""
        stroke = self.found.outlines[row].stroke
        if self.view is None or not self._is_rectangle(row) or stroke.label:
            return False
        if stroke.colour and stroke.colour != stroke.fill and not is_light(stroke.colour):
            return False
        x, y, width, height = self.view
        low, high = self.bounds[row].reshape(2, 2)
        slack = PAGE_TOLERANCE * np.array([width, height])
        covers = (low <= np.array([x, y]) + slack).all() and (high >= np.array([x + width, y + height]) - slack).all()
        lined = any(o.stroke.colour for k, o in enumerate(self.found.outlines) if k != row)
        return bool(covers) and (not stroke.fill or is_light(stroke.fill) or lined)

    def _rows_round_everything(self) -> set[int]:
        """Rectangles of one size, each round something, with nothing outside of them."""
        tops = [row for row in range(len(self.polygons)) if row not in self.parents]
        rows = {row for row in tops if self.inside.get(row) and self._is_rectangle(row)}
        if not rows or len(rows) < len(tops):
            return set()
        sizes = np.ptp(self.bounds[sorted(rows)].reshape(-1, 2, 2), axis=1)
        return rows if (np.ptp(sizes, axis=0) <= _SAME_SIZE * sizes.max(axis=0)).all() else set()

    def _is_box_of_one(self, rows: set[int]) -> bool:
        """Whether one outline alone lies in a frame and touches all its sides: as a part, the frame would fall into its corners."""
        row = min(rows)
        if len(rows) > 1 or len(self.inside[row]) > 1 or self._is_rectangle(self.inside[row][0]):
            return False
        apart = np.abs(self.bounds[row] - self.bounds[self.inside[row][0]])
        return bool((apart <= BEAM).all())

    def _with_inner(self, rows: set[int]) -> set[int]:
        """The innermost of further frames inside a single one, where they are called so; else none."""
        found: set[int] = set()
        while len(self.inside.get(min(found or rows), [])) == 1 and len(rows) == 1:
            child = self.inside[min(found or rows)][0]
            called = any(names_sheet(word) or may_be_sheet(word) for word in _words(self.found.outlines[child].stroke))
            if not (called and self._is_rectangle(child) and self.inside.get(child)):
                break
            found = {child}
        return found

    def _count(self, rows: set[int]) -> int:
        return sum(len(self.inside[row]) for row in rows)

    def _evidence(self, rows: set[int]) -> _Evidence:
        outlines = self.found.outlines
        inner = [row for frame in rows for row in self.inside[frame]]
        opened = [row for row in inner if 0 < self.area[self.inside.get(row, [])].sum() < _OPENED * self.area[row]]
        covered = float(self.area[inner].sum() / self.area[sorted(rows)].sum())
        edges = shapely.boundary(self.polygons[[*inner, *sorted(rows)]])
        near = 2 * max(self.found.join, self.found.tolerance)
        first, second = shapely.STRtree(edges).query(edges, predicate="dwithin", distance=near)
        strokes, rest = (
            [outlines[row].stroke for row in rows],
            [o.stroke for k, o in enumerate(outlines) if k not in rows],
        )
        layer: set[str] = (
            {s.layer for s in strokes} - {""} if not {s.layer for s in strokes} & {s.layer for s in rest} else set()
        )
        colour: set[str] = (
            {s.colour for s in strokes} if not {s.colour for s in strokes} & {s.colour for s in rest} else set()
        )
        dashed = bool(strokes[0].line_type) and strokes[0].line_type not in {s.line_type for s in rest}
        own = (
            f"on layer {sorted(layer)[0]} alone"
            if layer
            else f"alone {name_of(sorted(colour)[0])}"
            if colour and all(colour)
            else ""
        )
        return _Evidence(
            page=any(map(self._is_page, rows)),
            own=f"drawn alone as {strokes[0].line_type}" if dashed else own,
            drawn_aside=dashed or bool(colour and all(is_grey(c) or is_light(c) for c in colour)),
            panels=len(inner) > 1 and covered >= _COVERED and bool(opened),
            all_open=len(opened) == len(inner) or len(opened) >= _SEVERAL,
            covered=len(inner) > 1 and covered >= _COVERED,
            apart=bool((first == second).all()),
            outside=all(is_outside_layer(outlines[row].stroke.layer) for row in inner)
            and not any(is_outside_layer(stroke.layer) for stroke in strokes),
        )


def _words(stroke: Stroke) -> set[str]:
    """Everything that a stroke is called by people: its label, id, layer, groups and classes."""
    marks = [mark for group in stroke.groups for mark in (group.name, *group.marks)]
    return {word for word in (stroke.label, stroke.name, stroke.layer, *stroke.marks, *marks) if word}
