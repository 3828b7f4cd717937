"""From the shapes of a drawing to its parts: closed outlines flattened, named, nested and glued."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from wiggleroom.drawing.elements import Shape
from wiggleroom.drawing.limits import FINEST, LARGEST, SMALLEST
from wiggleroom.drawing.model import Drawing, Points, Region
from wiggleroom.drawing.nesting import cut_nested, regions_by_fill_rule
from wiggleroom.drawing.outlines import Outlines
from wiggleroom.drawing.rings import clean_ring, part_about_centroid
from wiggleroom.errors import InputError

Closed = list[tuple[Shape, range]]
"""Shapes that have closed subpaths, and which of the rings are theirs."""


def drawing_of(
    file: str,
    shapes: Sequence[Shape],
    findings: Sequence[str],
    *,
    notes: Sequence[str],
    left_out: Counter[str],
    flatten: float | None,
    gap: float | None,
) -> Drawing:
    """Drawing whose parts are the closed ones among `shapes`.

    Parameters
    ----------
    file : str
        Its name, for messages.
    shapes : sequence of Shape
        In drawing order.
    findings : sequence of str
        What is wrong so far; more may be found here.
    notes : sequence of str
    left_out : counts by kind of element
    flatten : float [mm], optional
        Chord error of curves; by default gap / 50, or 1e-4 of the median part size where the gap is 0.
    gap : float [mm], optional

    Raises
    ------
    InputError
        With one line per finding.
    """
    found = list(findings)
    outlines, closed, opened = _closed(shapes)
    size = _checked_size(file, outlines, opened, flatten, found)
    tolerance = max(flatten or (gap or 0.0) / 50 or _median_size(outlines, closed, size) * 1e-4, FINEST * size)
    rings = outlines.rings(tolerance)
    regions = [_regions(file, shape, [rings[i] for i in rows], found) for shape, rows in closed]
    if found:
        raise InputError(found)
    drawn = [shape for shape, _ in closed]
    names = _names(drawn)
    material = zip(names, cut_nested(regions, tolerance), drawn, strict=True)
    return Drawing(
        parts=tuple(part_about_centroid(name, pieces, fixed=shape.fixed) for name, pieces, shape in material),
        gap=gap or 0.0,
        glue=_glue(drawn, names),
        source=file,
        notes=(*notes, *_left_out(file, opened, left_out)),
    )


def _closed(shapes: Sequence[Shape]) -> tuple[Outlines, Closed, list[Shape]]:
    """Collect the closed subpaths of all shapes, the shapes that have any, and those that have open ones."""
    outlines, closed, opened = Outlines(), [], []
    for shape in shapes:
        before = len(outlines.loops)
        taken = [outlines.add(subpath, shape.matrix) for subpath in shape.subpaths]
        if any(taken):
            closed.append((shape, range(before, len(outlines.loops))))
        if not all(taken):
            opened.append(shape)
    return outlines, closed, opened


def _checked_size(
    file: str, outlines: Outlines, opened: list[Shape], flatten: float | None, findings: list[str]
) -> float:
    """Longer side of the drawing [mm]; refused is one of nothing, or of a size that cannot be worked with."""
    if not outlines.loops:
        if not findings:
            drawn = f", but {len(opened)} open" if opened else ""
            findings.append(f"{file}: has no closed outline{drawn}; every part must be closed")
        raise InputError(findings)
    largest, size = outlines.reach()
    if not largest <= LARGEST:
        findings.append(f"{file}: has coordinates beyond {LARGEST:g} mm; move or scale the drawing")
    elif size < SMALLEST:
        findings.append(f"{file}: is {size:.3g} mm large; it must be at least {SMALLEST:g} mm")
    elif flatten and flatten < FINEST * size:
        findings.append(f"{file}: flatten is {flatten:g}; here it must be at least {FINEST * size:.3g} mm")
    else:
        return size
    raise InputError(findings)


def _median_size(outlines: Outlines, closed: Closed, size: float) -> float:
    """Median over the shapes of the longer side of the box round each [mm]."""
    rings = outlines.rings(1e-3 * size)
    return float(np.median([np.ptp(np.vstack([rings[i] for i in rows]), axis=0).max() for _, rows in closed]))


def _regions(file: str, shape: Shape, rings: list[Points], findings: list[str]) -> list[Region]:
    sound = [ring for ring in rings if len(clean_ring(ring)) >= 3]
    if not sound:
        corners = max(len(clean_ring(ring)) for ring in rings)
        findings.append(f"{file}: {shape}: outline has {corners} corners; at least 3 that enclose an area are needed")
        return []
    try:
        return regions_by_fill_rule(sound, even_odd=shape.even_odd)
    except ValueError as error:
        findings.append(f"{file}: {shape}: {error}")
        return []


def _names(shapes: list[Shape]) -> list[str]:
    """Own id or label, else that of the nearest group that holds no other part, else the position: p1, p2, ..."""
    members = Counter(group for shape in shapes for group in shape.groups)
    given = [
        shape.name or next((g.name for g in reversed(shape.groups) if g.name and members[g] == 1), "")
        for shape in shapes
    ]
    taken = set(given)
    seen: Counter[str] = Counter()
    names = []
    for i, name in enumerate(given):
        wanted = name or f"p{i + 1}"
        seen[wanted] += 1
        if seen[wanted] > 1 or (not name and wanted in taken):
            wanted = next(w for k in range(2, len(given) + 3) if (w := f"{wanted}-{k}") not in taken)
            taken.add(wanted)
        names.append(wanted)
    return names


def _glue(shapes: list[Shape], names: list[str]) -> tuple[tuple[str, ...], ...]:
    """Parts of one glue group move as one; of groups inside each other the outermost counts."""
    found: dict[int, list[str]] = {}
    for shape, name in zip(shapes, names, strict=True):
        group = next((group for group in shape.groups if group.glue), None)
        if group:
            found.setdefault(id(group), []).append(name)
    return tuple(tuple(members) for members in found.values() if len(members) > 1)


def _left_out(file: str, opened: list[Shape], others: Counter[str]) -> list[str]:
    notes = []
    if opened:
        named = ", ".join(map(str, opened[:3])) + (", ..." if len(opened) > 3 else "")
        notes.append(f"{file}: open paths are left out: {named}; close them if they are parts")
    notes += [f"{file}: {count} {tag} elements are left out; only outlines are parts" for tag, count in others.items()]
    return notes
