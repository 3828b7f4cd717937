"""Picture of a file as it was read: parts, and everything that is wrong, left out or assumed, where it is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.inventory import InventoryRow
from wiggleroom.assembly.overlaps import overlap_areas
from wiggleroom.drawing.model import Points, part_of
from wiggleroom.drawing.outlines.traced_outlines import Remark
from wiggleroom.report.pictures import frame, layout, palette
from wiggleroom.report.pictures.arrows import goal_mark
from wiggleroom.report.pictures.layout import View
from wiggleroom.report.pictures.picture import colours_of, drawn_parts
from wiggleroom.report.pictures.text import escape, wrap
from wiggleroom.report.results.answer_words import number, short

MAX_ROWS = 60
"""Rows of the list of parts."""
MAX_LINES = 24
"""Lines of notes."""
_WRONG = "#c1121f"
_STYLES = {
    "left out": ("left out", f'stroke="{palette.SUBDUED}" stroke-dasharray="5 4"'),
    "hole": ("taken as a hole", 'stroke="#00798c" stroke-width="1.6"'),
    "mended": ("mended", 'stroke="#7b2cbf" stroke-width="1.6"'),
    "open end": ("open end", f'stroke="{palette.FORCE}" stroke-width="2"'),
    "crossing": ("crossing", f'stroke="{_WRONG}" stroke-width="2"'),
    "overlap": ("overlap", f'stroke="{_WRONG}" fill="{_WRONG}" fill-opacity="0.6"'),
}
"""What each kind of remark is called, and how it is drawn."""
POINT_REMARKS = ("mended", "open end")
"""Remarks that are drawn as points."""
POINT_RADIUS = 5.0
"""Of these points [px]."""
MERGE_DISTANCE = 2.0
"""Marks of one kind nearer than this [px] are drawn once."""


def picture_of_reading(
    assembly: Assembly,
    rows: Sequence[InventoryRow],
    remarks: Sequence[Remark],
    findings: Sequence[str],
    *,
    command: str = "",
) -> str:
    """File as it was read, as an SVG picture with a table of its parts; also where it cannot be worked with.

    Parameters
    ----------
    assembly : Assembly
        Parts at rest, made as far as that was possible.
    rows : sequence of InventoryRow
    remarks : sequence of Remark
        Places of what is wrong, left out or assumed.
    findings : sequence of str
        What is wrong, one line each.
    command : str
        What made the picture.
    """
    marks = [*remarks, *_overlaps(assembly), *_crossings(assembly)]
    rest = assembly.rest
    points = [line for mark in marks for line in mark.lines]
    boxes = [layout.boxes(assembly, rest)] if assembly.parts else []
    boxes += [np.concatenate([line.min(axis=0), line.max(axis=0)])[None] for line in points if len(line)]
    box = layout.bounding_box(np.vstack(boxes)) if boxes else np.array([0.0, 0.0, 1.0, 1.0])
    title = f"{len(rows)} parts" if len(rows) != 1 else "1 part"
    said = [f"gap {number(assembly.gap)} mm"]
    said += [f"{len(findings)} faults" if len(findings) != 1 else "1 fault"] if findings else []
    canvas = layout.view(box, 0.0).canvas
    head, below = frame.header(title, said, canvas - 2 * palette.MARGIN)
    view = layout.view(box, below + palette.HEAD_SPACING)
    body: list[str] = []
    if assembly.parts:
        own = layout.boxes(assembly, rest)
        rooms = (own[:, 2:] - own[:, :2]).max(axis=1) * view.scale
        places = {name: k for k, name in enumerate(assembly.names)}
        goals = [(goal, places[name]) for goal in assembly.goals if (name := part_of(goal)) in places]
        arrows = [goal_mark(view, assembly, goal, rest, rest, rooms[k]) for goal, k in goals]
        pulled = {assembly.names[k] for _, k in goals}
        body = drawn_parts(view, assembly, rest, colours_of(assembly, pulled), arrows, float(np.median(rooms)))
    kinds = list(dict.fromkeys(mark.kind.split()[0] if mark.kind.startswith("mended") else mark.kind for mark in marks))
    for kind in kinds:
        body += _drawn(view, kind, [mark for mark in marks if mark.kind.startswith(kind)])
    legend = [(_swatch(kind), _STYLES[kind][0]) for kind in kinds]
    if any(part.fixed for part in assembly.parts):
        legend.insert(0, (frame.swatch(*palette.FIXED), "fixed"))
    foot, y = frame.footer(view, view.y + view.height + palette.HEAD_SPACING + 16, legend, command)
    lists, height = _lists(view, y, rows, findings, assembly.drawing.notes)
    return frame.document(view.canvas, height, title, said, command, [*head, *body, *foot, *lists])


def _overlaps(assembly: Assembly) -> list[Remark]:
    """Places where parts overlap at rest that may not."""
    found = []
    for area in overlap_areas(assembly.drawing, assembly.parts):
        polygons = [piece for piece in shapely.get_parts(area) if piece.geom_type == "Polygon"]
        lines = tuple(shapely.get_coordinates(piece.exterior) for piece in polygons)
        if lines:
            found.append(Remark("overlap", lines))
    return found


def _crossings(assembly: Assembly) -> list[Remark]:
    """Outlines that cross themselves."""
    from wiggleroom.assembly.assembly import rings_at

    bad = [ring for part in assembly.parts for ring in rings_at(part) if not shapely.Polygon(ring).is_valid]
    return [Remark("crossing", tuple(np.vstack([ring, ring[:1]]) for ring in bad))] if bad else []


def _drawn(view: View, kind: str, marks: Sequence[Remark]) -> list[str]:
    """All remarks of one kind."""
    lines = [view.pixels(line) for mark in marks for line in mark.lines]
    style = _STYLES[kind][1]
    plain = "" if "fill=" in style else ' fill="none"'
    if kind in POINT_REMARKS:
        points = np.vstack([line[:1] for line in lines])
        _, first = np.unique(np.round(points / MERGE_DISTANCE), axis=0, return_index=True)
        shapes = [
            f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{POINT_RADIUS:g}"/>' for x, y in points[np.sort(first)].tolist()
        ]
    else:
        closed = "z" if kind in ("hole", "overlap") else ""
        shapes = [f'<path d="{_data(line)}{closed}"/>' for line in lines if len(line) > 1]
        if kind in ("crossing", "overlap"):  # what is small must be seen, too
            middles = [
                line.mean(axis=0) for line in lines if len(line) and np.ptp(line, axis=0).max() < 2 * POINT_RADIUS
            ]
            shapes += [f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{2 * POINT_RADIUS:g}" fill="none"/>' for x, y in middles]
    return [f"<g{plain} {style}>" + "".join(shapes) + "</g>"] if shapes else []


def _data(line: Points) -> str:
    """Path data of a line [px], without corners that cannot be seen."""
    corners = shapely.get_coordinates(shapely.simplify(shapely.LineString(line), 0.05)).tolist()
    return "M" + " ".join(f"{x:.2f},{y:.2f}" for x, y in corners)


def _swatch(kind: str) -> str:
    style = _STYLES[kind][1]
    plain = "" if "fill=" in style else ' fill="none"'
    if kind in POINT_REMARKS:
        return f'<circle cx="8" cy="6" r="{POINT_RADIUS:g}"{plain} {style}/>'
    return f'<path d="M0.5,0.500h15v11h-15z"{plain} {style}/>'


def _lists(
    view: View, y: float, rows: Sequence[InventoryRow], findings: Sequence[str], notes: Sequence[str]
) -> tuple[list[str], float]:
    """What is wrong, what was assumed, and the table of parts, from `y` downwards, and where they end [px]."""
    found: list[str] = []
    size, room = palette.SMALL_SIZE + 1, view.canvas - 2 * palette.MARGIN
    for colour, lines in ((_WRONG, findings), (palette.INK, notes)):
        rest = len(lines) - MAX_LINES
        shown = [*lines[:MAX_LINES], *([f"... and {rest} more"] if rest > 0 else [])]
        for line in shown:
            for text in wrap(line.split(" "), " ", size, room, 4):
                y += size + 5
                found.append(_cell(palette.MARGIN, y, size, colour, text))
        y += 8 if lines else 0
    table: list[tuple[str, ...]] = [("part", "width mm", "height mm", "x mm", "y mm", "holes", "layer")]
    for row in rows[:MAX_ROWS]:
        lengths = (f"{value:.2f}" for value in (row.width, row.height, row.x, row.y))
        table.append((short(row.name), *lengths, str(row.holes), short(row.layer)))
    if len(rows) > MAX_ROWS:
        table.append((f"... and {len(rows) - MAX_ROWS} more", "", "", "", "", "", ""))
    columns = (0.0, 0.40, 0.52, 0.64, 0.76, 0.84, 0.87)
    for k, cells in enumerate(table if rows else []):
        y += size + 5
        for place, share, text in zip(range(len(cells)), columns, cells, strict=True):
            left = place in (0, len(cells) - 1)
            colour = palette.SUBDUED if k == 0 else palette.INK
            found.append(_cell(palette.MARGIN + share * room, y, size, colour, text, "" if left else "end"))
    return found, y + palette.MARGIN


def _cell(x: float, y: float, size: float, colour: str, text: str, anchor: str = "") -> str:
    to = f' text-anchor="{anchor}"' if anchor else ""
    return f'<text x="{x:.2f}" y="{y:.2f}" font-size="{size:g}" fill="{colour}"{to}>{escape(text)}</text>'
