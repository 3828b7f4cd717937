"""From a drawing to an assembly: gap applied, roles set, everything checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, place
from wiggleroom.assembly.findings import examine_parts, opened_overlaps, overlap_findings
from wiggleroom.assembly.loops import placed_loops, polygons
from wiggleroom.assembly.statements import PartNames, unknown, with_roles
from wiggleroom.drawing.model import Drawing, Goal, Part, Pull, Region
from wiggleroom.drawing.strokes.chord_error import flattened_for
from wiggleroom.errors import InputError, OverlapError

FAR_REFERENCE = 1000.0
"""A reference point further from the middle of its outline than this multiple of the drawing's size is moved there."""

OUTSIDE = 0.1
"""A part pulled at a point further outside of it than this share of its size may be meant to be pulled elsewhere."""
LARGE_GAP = 0.1
"""A gap above this share of the smallest part is doubted."""
WIDE, NARROW = 5000.0, 5.0
"""A drawing wider or narrower than this [mm] is doubted."""
FAR = 0.02
"""A part is alone where the next one is further than this share of its own size, and than four gaps."""


def assemble(
    drawing: Drawing,
    *,
    gap: float | None = None,
    fix: Sequence[str] = (),
    goals: Sequence[Goal] = (),
    offset: Mapping[str, float] | None = None,
    overlapping: bool = False,
) -> Assembly:
    """Parts of a drawing in the plane as they are made, with their roles; see `wiggleroom.assemble`."""
    used_gap = float(drawing.gap if gap is None else gap)
    used, wrong = with_roles(flattened_for(drawing, used_gap), used_gap, fix, goals)
    names, offsets = {p.name: None for p in used.parts}, dict(offset or {})
    wrong += [f"offset: {unknown(name, names)}" for name in offsets if name not in names]
    parts = tuple(replace(p, offset=p.offset + offsets[p.name]) if p.name in offsets else p for p in used.parts)
    used = _with_near_references(replace(used, parts=parts))
    made, findings = examine_parts(used)
    overlaps = overlap_findings(used, made)
    if wrong or findings:
        raise InputError((*wrong, *findings, *overlaps))
    if overlaps and not overlapping:
        raise OverlapError(overlaps)
    return Assembly(made, used)


def _with_near_references(drawing: Drawing) -> Drawing:
    """The drawing with reference points that lie very far from their outlines moved into the middle of these, which is noted.

    About such a point the least turn is a long way: no path of few straight pieces would be left, and pulls would measure rounding.
    """
    if not drawing.parts or not all(_sound(part) for part in drawing.parts):
        return drawing  # the findings say what is wrong
    boxes = [np.concatenate([r.outer for r in part.regions]) for part in drawing.parts]
    middle = np.array([(b.min(axis=0) + b.max(axis=0)) / 2 for b in boxes])
    placed = [place(b, part.at) for b, part in zip(boxes, drawing.parts, strict=True)]
    size = float(np.ptp(np.concatenate(placed), axis=0).max())
    far = np.hypot(*middle.T) > FAR_REFERENCE * size
    if not far.any():
        return drawing
    moved: dict[tuple[int, float, float], tuple[Region, ...]] = {}
    parts, notes = [], []
    for part, m, away in zip(drawing.parts, middle, far.tolist(), strict=True):
        if not away:
            parts.append(part)
            continue
        key = id(part.regions), float(m[0]), float(m[1])
        if key not in moved:
            moved[key] = tuple(Region(r.outer - m, tuple(h - m for h in r.holes)) for r in part.regions)
        x, y = place(m[None], part.at)[0].tolist()
        parts.append(replace(part, regions=moved[key], at=(x, y, part.at[2])))
        notes.append(
            f'{drawing.source or "the drawing"}: part "{part.name}": its reference point lies {np.hypot(*m):.3g} mm from its outline; '
            "the middle of the outline takes its place"
        )
    return replace(drawing, parts=tuple(parts), notes=(*drawing.notes, *notes))


def _sound(part: Part) -> bool:
    """True where a part has outlines, and all of it is finite."""
    outlines = [np.asarray(r.outer) for r in part.regions]
    shaped = all(o.ndim == 2 and o.shape[1] == 2 and len(o) and np.isfinite(o).all() for o in outlines)
    return bool(outlines) and shaped and bool(np.isfinite(part.at).all())


def with_notes(assembly: Assembly) -> Assembly:
    """The same with notes on what looks odd: parts drawn into each other that the gap opens, a gap or a size that may not be meant."""
    drawing = assembly.drawing
    if not drawing.source or not drawing.parts:
        return assembly
    drawn = not drawing.source.lower().endswith(".json")  # outlines in an assembly file are meant
    lines = [f"{drawing.source}: {line}" for line in doubts(drawing, drawn=drawn)]
    opened = opened_overlaps(drawing) if drawn else ()
    return Assembly(assembly.parts, replace(drawing, notes=(*drawing.notes, *opened, *lines)))


def assembly_of(
    drawing: Drawing, *, gap: float | None, fix: Sequence[str], goals: Sequence[Goal], overlapping: bool = False
) -> Assembly:
    """Assembly in the plane of a drawing that was read, with notes; fixed parts may be given by a point, as "@12,30"."""
    known = PartNames(drawing)
    fixed = [known(name) for name in fix]
    if known.wrong:
        raise InputError(known.wrong)
    return with_notes(assemble(drawing, gap=gap, fix=fixed, goals=goals, overlapping=overlapping))


def doubts(drawing: Drawing, *, drawn: bool = True) -> tuple[str, ...]:
    """One line for each number that looks as if something else was meant.

    Parameters
    ----------
    drawing : Drawing [mm]
        Sound, as from an assembly.
    drawn : bool
        False: outlines come from numbers that are meant; only the gap and points of pulls are doubted.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Part, Region
    >>> square = Region(np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]]))
    >>> two = tuple(Part(name, (square,), at=(x, 0.0, 0.0)) for name, x in (("a", 0.0), ("b", 25.0)))
    >>> print(*doubts(Drawing(two, gap=4.0)), sep="; ")
    the gap of 4 mm is large beside part "a", 20 mm wide: is it in mm?
    >>> print(*doubts(Drawing(two)), sep="; ")
    these look like parts on a cutting sheet: 2 of 2 touch nothing; wiggleroom assemble puts a sheet's parts together
    """
    loops, region, owner = placed_loops(drawing.parts)
    low = np.full((len(drawing.parts), 2), np.inf)
    high = -low
    np.minimum.at(low, owner[region], np.minimum.reduceat(loops.points, loops.starts))
    np.maximum.at(high, owner[region], np.maximum.reduceat(loops.points, loops.starts))
    sizes = (high - low).min(axis=1)
    if not drawn:
        return (*_gap_doubts(drawing, sizes), *_point_doubts(drawing, low, high))
    return (
        *_size_doubts(float((high.max(axis=0) - low.min(axis=0)).max())),
        *_gap_doubts(drawing, sizes),
        *_sheet_doubts(drawing, polygons(loops, region), owner, (high - low).max(axis=1)),
    )


def _size_doubts(size: float) -> list[str]:
    if size > WIDE:
        return [f"the drawing is {size / 1000:.4g} m wide: is its unit right? --unit says another"]
    if size < NARROW:
        return [f"the drawing is {size:.3g} mm wide: is its unit right? --unit says another"]
    return []


def _gap_doubts(drawing: Drawing, sizes: NDArray[np.float64]) -> list[str]:
    least = int(np.argmin(sizes))
    if drawing.gap <= LARGE_GAP * sizes[least]:
        return []
    name, wide = drawing.parts[least].name, float(sizes[least])
    return [f'the gap of {drawing.gap:.4g} mm is large beside part "{name}", {wide:.4g} mm wide: is it in mm?']


def _point_doubts(drawing: Drawing, low: NDArray[np.float64], high: NDArray[np.float64]) -> list[str]:
    """Parts pulled at a reference point that lies far outside: their turn moves it more than any of their own points."""
    pulled = {goal.part for goal in drawing.goals if isinstance(goal, Pull) and goal.point is None}
    lines = []
    for k, part in enumerate(drawing.parts):
        if part.name not in pulled:
            continue
        x, y, _ = part.at
        aside = float(np.hypot(*np.maximum(np.maximum(low[k] - (x, y), (x, y) - high[k]), 0.0)))
        if aside > OUTSIDE * float((high[k] - low[k]).max()):
            middle = (low[k] + high[k]) / 2
            lines.append(
                f'"{part.name}" is pulled at its reference point ({x:.4g}, {y:.4g}), {aside:.4g} mm outside of it; '
                f"a pull at a point of its own says how far it goes: @{middle[0]:.4g},{middle[1]:.4g}"
            )
    return lines


def _sheet_doubts(
    drawing: Drawing, shapes: NDArray[np.object_], owner: NDArray[np.int64], sizes: NDArray[np.float64]
) -> list[str]:
    """Most parts near nothing, and none of these inside another one's hull."""
    count = len(drawing.parts)
    if count < 2:
        return []
    room = np.maximum(FAR * sizes, 4 * drawing.gap)
    hulls = shapely.convex_hull(shapes)
    tree = shapely.STRtree(hulls)
    i, j = tree.query(shapely.box(*_grown(shapely.bounds(shapes), room[owner])))
    i, j = i[owner[i] != owner[j]], j[owner[i] != owner[j]]
    shapely.prepare(shapes)
    near = shapely.dwithin(shapes[i], shapes[j], room[owner[i]])
    near |= shapely.intersects(hulls[i], shapes[j]) | shapely.intersects(shapes[i], hulls[j])
    together = np.zeros(count, dtype=bool)
    together[owner[i[near]]] = True
    together[owner[j[near]]] = True
    names, glued = [part.name for part in drawing.parts], {name for group in drawing.glue for name in group}
    together |= np.array([name in glued for name in names])
    alone = int(count - together.sum())
    if 2 * alone < count or alone < 2:
        return []
    return [
        f"these look like parts on a cutting sheet: {alone} of {count} touch nothing; "
        "wiggleroom assemble puts a sheet's parts together"
    ]


def _grown(bounds: NDArray[np.float64], room: NDArray[np.float64]) -> NDArray[np.float64]:
    """Boxes (n, 4) larger by `room` (n,) on all sides, as rows of left, bottom, right, top (4, n)."""
    return (bounds + np.column_stack([-room, -room, room, room])).T
