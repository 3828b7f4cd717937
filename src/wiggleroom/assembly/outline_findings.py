"""Outlines as drawn that no one can work with: too few corners, no area, crossing themselves."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import shapely

from wiggleroom.assembly.loops import SAME, are_valid, chained, cleaned, placed_regions, region_rings, signed_areas
from wiggleroom.assembly.statements import numbers_text
from wiggleroom.drawing.limits import LARGEST
from wiggleroom.drawing.model import Drawing, Part, Points

NO_AREA = 1e-12
"""An outline with less area than this is a line [square of its longer side]."""
NARROW = 1e3 * SAME
"""Outlines with less area are looked at: do corners that are none leave enough others [size of the part times its longer side]."""


def sound_parts(drawing: Drawing) -> tuple[list[Part], list[str]]:
    """Parts whose outlines can be worked with, and what is wrong with the others; shared outlines count once."""
    by_shape: dict[tuple[int, ...], list[Part]] = {}
    found: list[str] = []
    places = np.array([(*part.at, part.offset) for part in drawing.parts], dtype=float).reshape(-1, 4)
    fine = np.isfinite(places).all(axis=1) & (np.abs(places[:, :3]) <= LARGEST).all(axis=1)
    for part, right in zip(drawing.parts, fine.tolist(), strict=True):
        trouble = [] if right else _part_numbers(part)
        found += [f'part "{part.name}" {t}' for t in trouble]
        if not trouble:
            by_shape.setdefault(tuple(map(id, part.regions)), []).append(part)
    shapes = list(by_shape.values())
    for look in (_useless, _crossing):
        troubles = look([parts[0] for parts in shapes])
        found += [f"{_who(shapes[k])} {trouble}" for k, trouble in troubles.items()]
        shapes = [parts for k, parts in enumerate(shapes) if k not in troubles]
    good = {id(p) for parts in shapes for p in parts}
    return [p for p in drawing.parts if id(p) in good], found


def _who(parts: Sequence[Part]) -> str:
    more = f" (and {len(parts) - 1} more of this shape)" if len(parts) > 1 else ""
    return f'part "{parts[0].name}"{more}'


def _part_numbers(part: Part) -> list[str]:
    found = []
    if not np.isfinite(part.at).all() or max(map(abs, part.at)) > LARGEST:
        found.append(f"lies at {numbers_text(part.at)}: a place is finite and at most {LARGEST:g} mm away")
    if not np.isfinite(part.offset):
        found.append(f"has offset {part.offset:g}: it must be a finite number")
    return found


def _useless(parts: Sequence[Part]) -> dict[int, str]:
    """Say which outlines are none, by index of the part: no corners, no numbers, no area."""
    found = {k: "has no outline: give it one" for k, part in enumerate(parts) if not part.regions}
    rings, owner = [], []
    for k, part in enumerate(parts):
        for ring in region_rings(part.regions)[0]:
            if len(ring) < 3:
                found.setdefault(k, _flaw(ring))
            else:
                rings.append(ring)
                owner.append(k)
    if rings:
        loops = chained(rings)
        with np.errstate(over="ignore", invalid="ignore"):
            extent = np.maximum.reduceat(loops.points, loops.starts) - np.minimum.reduceat(loops.points, loops.starts)
            area, long = np.abs(signed_areas(loops)), extent.max(axis=1)
            thick = area > NO_AREA * long**2
        near = np.logical_and.reduceat((np.abs(loops.points) <= LARGEST).all(axis=1), loops.starts)
        for r in np.flatnonzero(~(thick & near)):
            flaw = _flaw(rings[r])
            if flaw:
                found.setdefault(owner[r], flaw)
        size = np.zeros(len(parts))
        with np.errstate(over="ignore", invalid="ignore"):
            np.maximum.at(size, owner, long)
            narrow = thick & near & (area <= NARROW * size[owner] * long)
        for r in np.flatnonzero(narrow):
            if cleaned(chained([rings[r]]), size[[owner[r]]]).counts[0] < 3:
                found.setdefault(owner[r], "has an outline or a hole below a billionth of its size: leave that out")
    return found


def _flaw(ring: Points) -> str:
    """Say what makes one outline useless; empty for a bow tie, whose area may be 0 as well."""
    if not (np.abs(ring) <= LARGEST).all():
        return f"has a corner that is not a number or beyond {LARGEST:g} mm: check the numbers and the unit"
    different = len(np.unique(ring, axis=0))
    if different < 3:
        return f"has {different} different corners: an outline needs at least 3"
    spread = shapely.convex_hull(shapely.multipoints(ring)).area
    if spread <= NO_AREA * np.ptp(ring, axis=0).max() ** 2:
        return "has an outline without area: its corners lie on one line"
    return ""


def _crossing(parts: Sequence[Part]) -> dict[int, str]:
    """Tell what is wrong with the way an outline runs, and where, by index of the part."""
    if not parts:
        return {}
    shapes, owner = placed_regions(parts)
    found: dict[int, str] = {}
    for k in np.flatnonzero(~are_valid(shapes)):
        found.setdefault(int(owner[k]), _reason(str(shapely.is_valid_reason(shapes[k]))))
    return found


def _reason(reason: str) -> str:
    """GEOS's reason in plain words."""
    match = re.fullmatch(r"(.*)\[(\S+) (\S+)\]", reason)
    if match is None:
        return f"has an outline that cannot be used: {reason.lower()}"
    what, x, y = match.groups()
    once = "an outline runs once round its part"
    words = {
        "Self-intersection": ("crosses itself", once),
        "Ring Self-intersection": ("touches itself", once),
        "Hole lies outside shell": ("has a hole outside its outline", "holes lie inside"),
        "Holes are nested": ("has a hole inside a hole", "holes lie apart"),
        "Interior is disconnected": ("is cut in two by its holes", "make the pieces parts of their own"),
    }
    wrong, right = words.get(what, (what.lower(), once))
    return f"{wrong} at ({float(x):.6g}, {float(y):.6g}): {right}"
