"""The free space of one pair: in words, as JSON, as a picture and as a page."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import place
from wiggleroom.compare.monte_carlo import SampledAccuracy, about_pivot
from wiggleroom.freespace.free_space import FreeSlices, FreeSpace
from wiggleroom.freespace.slices import Slice
from wiggleroom.report.free_space.stacked_slices import rings, slices_box, stack
from wiggleroom.report.pictures import frame, palette
from wiggleroom.report.pictures.axes import text
from wiggleroom.report.pictures.layout import View, round_down
from wiggleroom.report.pictures.names import common_font_size, label
from wiggleroom.report.pictures.part_paths import PartPaths, colour_attributes, spot, use
from wiggleroom.report.pictures.text import escape
from wiggleroom.report.results.answer_words import number, short
from wiggleroom.schema.free_space_schema import AuditEntry, CellEntry, SliceEntry, SpaceResult

if TYPE_CHECKING:
    from rich.console import Group

Floats = NDArray[np.float64]

SIDE_WIDTH = 430.0
"""Width of the text beside the stack of slices [px]."""
TILE_SIZE = 150.0
"""Side of the picture of one cell [px]."""
TILES_PER_ROW = 5
"""Slices that are drawn beside each other."""
MAX_CELLS = 12
"""Cells that are drawn."""


def space_headline(space: FreeSlices) -> str:
    """One line, such as "b2 turns -1.82° to 1.82° against b1, closed"."""
    a, b = (short(n) for n in space.parts)
    low, high = (number(math.degrees(x), 3) for x in space.angles)
    return f"{b} turns {low}° to {high}° against {a}, {'closed' if space.closed else 'open'}"


def space_facts(space: FreeSlices, judged: SampledAccuracy | None) -> list[str]:
    """Facts under the headline."""
    found = (
        [
            f"{len(space.cells.a)} cell{'s' * (len(space.cells.a) != 1)}, {space.rows} walls",
            f"cells cover {100 * space.coverage:.2f} %",
        ]
        if isinstance(space, FreeSpace)
        else []
    )
    found.append(f"volume {number(volume(space), 3)} mm² °")
    if not space.closed:
        found.append(f"looked at as far as {number(space.reach, 3)} mm")
    if judged is not None:
        found.append(f"{judged.samples} samples: {judged.unsafe} unsafe, {judged.lost} of {judged.free} free ones lost")
    return found


def volume(space: FreeSlices) -> float:
    """Volume of the space [mm2 deg]."""
    if isinstance(space, FreeSpace):  # slices in the middle of equal intervals
        return sum(s.area for s in space.slices) / len(space.slices) * math.degrees(space.angles[1] - space.angles[0])
    return float(np.trapezoid([s.area for s in space.slices], np.degrees([s.angle for s in space.slices])))


def space_result(
    space: FreeSpace, judged: SampledAccuracy | None, command: str, notes: Sequence[str] = ()
) -> SpaceResult:
    """Everything `space --json` says; lengths in mm, angles in degrees."""
    walls = np.diff(np.concatenate([[0], np.cumsum(space.cells.is_wall)])[space.cells.row])
    a, b = space.parts
    return SpaceResult(
        parts=(a, b),
        closed=bool(space.closed),
        reach=None if space.closed else float(space.reach),
        angles_deg=[math.degrees(x) for x in space.angles],
        volume=float(volume(space)),
        coverage=float(space.coverage),
        pivot=(float(space.pivot[0]), float(space.pivot[1])),
        cells=[
            CellEntry(int(n), (math.degrees(low), math.degrees(high)))
            for n, (low, high) in zip(walls, space.intervals.tolist(), strict=True)
        ],
        slices=[_slice(s) for s in space.slices],
        audit=None
        if judged is None
        else AuditEntry(judged.samples, judged.free, judged.accepted, judged.unsafe, judged.lost),
        notes=list(notes),
        command=command,
    )


def _slice(one: Slice) -> SliceEntry:
    polygons = shapely.get_parts(one.region)
    return SliceEntry(
        angle_deg=math.degrees(one.angle),
        area=float(one.area),
        holes=[shapely.get_coordinates(ring)[:-1].tolist() for p in polygons for ring in p.interiors],
        outlines=[shapely.get_coordinates(p.exterior)[:-1].tolist() for p in polygons],
    )


def space_table(space: FreeSpace, judged: SampledAccuracy | None) -> Group:
    """Page that `space` prints: headline, facts, some slices, the cells, and how they were judged."""
    from rich.console import Group
    from rich.text import Text

    from wiggleroom.report.results.table import columns, fixed

    slices, cells = columns("turn deg", "area mm2", "free x mm", "free y mm"), columns("cell", "walls", "turn deg")
    largest = max(s.area for s in space.slices)
    regions = about_pivot(space)
    for k in np.linspace(0, len(regions) - 1, min(len(regions), 9)).round().astype(int).tolist():
        x0, y0, x1, y1 = regions[k].bounds
        one = space.slices[k]
        turned = f"{math.degrees(one.angle):.3f}"
        slices.add_row(turned, fixed(one.area, largest), number(x1 - x0, 3), number(y1 - y0, 3))
    found = space_result(space, None, "").cells
    for k, cell in enumerate(found[:MAX_CELLS]):
        low, high = cell.angles_deg
        cells.add_row(str(k + 1), str(cell.walls), f"{low:.3f} to {high:.3f}")
    if len(found) > MAX_CELLS:
        cells.add_row(f"... and {len(found) - MAX_CELLS} more", "", "", style="dim")
    lines = [Text(f"judged:   {line}") for line in (_judged(judged) if judged else [])]
    facts = [Text(line) for line in space_facts(space, None)]
    return Group(Text(space_headline(space), style="bold"), *facts, Text(), slices, Text(), cells, Text(), *lines)


def _judged(judged: SampledAccuracy) -> list[str]:
    """Say what sampled truth says about the cells."""
    return [
        f"{judged.samples} random motions, {judged.free} of them free",
        f"{judged.unsafe} accepted although the parts overlap",
        f"{judged.lost} free ones not accepted",
    ]


def space_picture(
    space: FreeSpace, judged: SampledAccuracy | None = None, *, command: str = "", framed: bool = True
) -> str:
    """Free space as an SVG picture: the solid over (x, y, angle), the two parts beside it, and some slices.

    Parameters
    ----------
    framed : bool
        False: without title, facts and command, for a page that says them itself.
    """
    title, facts = space_headline(space), space_facts(space, judged)
    head, below = frame.header(title if framed else "", facts, 900.0)
    solid, wide, tall = stack(space, palette.MARGIN, below + 16)
    left = palette.MARGIN + wide + 20
    pair, pair_tall = _pair(space, left, below + 40)
    row = below + 16 + max(tall, pair_tall + 40) + 24
    canvas = max(left + SIDE_WIDTH, palette.MARGIN + TILES_PER_ROW * (TILE_SIZE + 24)) + palette.MARGIN
    tiles, bottom = _slices(space, palette.MARGIN, row)
    note = "motions of the point of the second part that the cross marks, in the axes of the first"
    bottom += 26
    foot = [text(palette.MARGIN, bottom, palette.TEXT_SIZE, palette.SUBDUED, note)]
    if command and framed:
        bottom += 24
        foot.append(text(palette.MARGIN, bottom, palette.SMALL_SIZE, palette.SUBDUED, command))
    body = [*head, solid, pair, tiles, *foot]
    return frame.document(canvas, bottom + 24, title, facts, command, body)


def _pair(space: FreeSpace, left: float, top: float) -> tuple[str, float]:
    """Both parts at rest in the axes of the first, and how tall that is [px]."""
    assembly = space.assembly
    rows = [assembly.names.index(n) for n in space.parts]
    parts, at_a = [assembly.parts[k] for k in rows], assembly.rest[rows[0]]
    turn = -float(at_a[2])
    c, s = math.cos(turn), math.sin(turn)
    poses = []
    for pose in assembly.rest[rows]:
        x, y = pose[:2] - at_a[:2]
        poses.append((c * x - s * y, s * x + c * y, float(pose[2]) + turn))
    corners = np.vstack([place(r.outer, pose) for p, pose in zip(parts, poses, strict=True) for r in p.regions])
    low, high = corners.min(axis=0), corners.max(axis=0)
    scale = min(SIDE_WIDTH / (high[0] - low[0]), 420.0 / (high[1] - low[1]))
    wide, tall = (high - low) * scale
    view = View(scale, float(low[0]), float(high[1]), left, top, wide, tall, 0.0)
    shapes, found, names = PartPaths(scale), [], []
    of = [shapes.of(p) for p in parts]
    size = common_font_size(
        [(short(p.name), shape) for p, shape in zip(parts, of, strict=True)], float(max(wide, tall)) / 2
    )
    pivot = view.pixels(np.array(poses[1][:2]) + space.pivot)
    mark = shapely.STRtree([shapely.Point(*pivot).buffer(14.0)])
    for part, shape, pose, colours in zip(parts, of, poses, (palette.FIXED, palette.PULLED), strict=True):
        where = spot(view, part, pose)
        style = f'{colour_attributes(colours)} fill-rule="evenodd"'
        found.append(f"<g {style}>{use(shape, where, escape(part.name))}</g>")
        names.append(label(short(part.name), shape, where, size, mark))
    x, y = pivot
    cross = (
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" fill="{palette.PAPER}" stroke="{palette.MOTION}" stroke-width="1.5"/>'
        f'<path d="M{x - 9:.1f},{y:.1f}h18M{x:.1f},{y - 9:.1f}v18" stroke="{palette.MOTION}" stroke-width="1.5"/>'
    )
    said_names = f'<g fill="{palette.INK}" text-anchor="middle">{"".join(names)}</g>'
    return f"<defs>{shapes.definitions}</defs>{''.join(found)}{said_names}{cross}", float(tall)


def _slices(space: FreeSpace, left: float, top: float) -> tuple[str, float]:
    """Some slices in a row, all to the same scale, and where the row ends [px]."""
    regions, angles = about_pivot(space), np.array([s.angle for s in space.slices])
    wanted = np.linspace(angles[0], angles[-1], TILES_PER_ROW)
    chosen = list(dict.fromkeys(int(np.abs(angles - w).argmin()) for w in wanted))
    low, high = slices_box(regions)
    scale = TILE_SIZE / float((high - low).max())
    high_px, found = float((high - low)[1]) * scale, []
    for j, k in enumerate(chosen):
        x = left + j * (TILE_SIZE + 24)
        points = "".join(_ring(ring, low, high, scale, x, top) for ring in rings(regions[k]))
        u, v = x - low[0] * scale, top + high[1] * scale
        found.append(
            f'<rect x="{x:.1f}" y="{top:.1f}" width="{(high - low)[0] * scale:.1f}" height="{high_px:.1f}" fill="none" '
            f'stroke="{palette.GRID}"/><path d="M{u - 5:.1f},{v:.1f}h10M{u:.1f},{v - 5:.1f}v10" stroke="{palette.SUBDUED}"/>'
            f'<path d="{points}" fill="{palette.PULLED[0]}" fill-opacity="0.6" fill-rule="evenodd" stroke="{palette.PULLED[1]}"/>'
        )
        said = f"{number(math.degrees(angles[k]), 3)}°"
        found.append(text(x, top + high_px + 20, palette.TEXT_SIZE, palette.SUBDUED, said))
    long = round_down(float((high - low).max()) / 3)
    y = top + high_px + 46
    found.append(
        f'<path d="M{left:.2f},{y - 5:.2f}v5h{long * scale:.2f}v-5" fill="none" stroke="{palette.INK}" stroke-width="1.5"/>'
    )
    found.append(text(left + long * scale + 8, y + 1, palette.TEXT_SIZE, palette.INK, f"{number(long)} mm"))
    return "".join(found), y


def _ring(points: Floats, low: Floats, high: Floats, scale: float, x: float, y: float) -> str:
    at = np.column_stack([x + (points[:, 0] - low[0]) * scale, y + (high[1] - points[:, 1]) * scale])
    return ("M" + "%.1f,%.1f " * len(at)) % tuple(at.ravel().tolist()) + "z"
