"""Everything that is wrong with a drawing, all at once: one plain line per finding."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import shapely

from wiggleroom.assembly.gaps import apply_gap
from wiggleroom.assembly.loops import SAME, are_valid, chained, cleaned, placed_regions, region_rings, signed_areas
from wiggleroom.assembly.overlaps import overlaps_at_rest
from wiggleroom.assembly.statements import given_goals, missing_roles, numbers_text, statement_findings
from wiggleroom.drawing.limits import LARGEST
from wiggleroom.drawing.model import Drawing, Goal, Part, Points
from wiggleroom.drawing.strokes.chord_error import flattened_for
from wiggleroom.drawing.writers.glue_groups import collidable
from wiggleroom.errors import InputError, grouped

NO_AREA = 1e-12
"""An outline with less area than this is a line [square of its longer side]."""
NARROW = 1e3 * SAME
"""Outlines with less area are looked at: do corners that are none leave enough others [size of the part times its longer side]."""


def findings(drawing: Drawing) -> tuple[str, ...]:
    """List what is wrong with a drawing, as drawn and as made; empty where it can be used.

    Parameters
    ----------
    drawing : Drawing [mm]

    Returns
    -------
    tuple of str
        One plain line each: what, where, what would be right.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Region
    >>> line = Part("a", (Region(np.array([[0.0, 0.0], [1.0, 0.0]])),))
    >>> print(*findings(Drawing((line,), gap=-1.0)), sep="; ")
    gap is -1: it must be 0 or more; part "a" has 2 different corners: an outline needs at least 3
    """
    return examine(drawing)[1]


def examine(drawing: Drawing) -> tuple[tuple[Part, ...], tuple[str, ...]]:
    """Parts as made, and everything that is wrong; parts are all there only where nothing is."""
    parts, found = examine_parts(drawing)
    return parts, (*found, *overlap_findings(drawing, parts))


def examine_parts(drawing: Drawing) -> tuple[tuple[Part, ...], tuple[str, ...]]:
    """Parts as made, and everything that is wrong with each of them, whether or not they overlap."""
    sound, bad = sound_parts(drawing)
    found = _located(drawing, [*statement_findings(drawing), *bad])
    if not 0 <= drawing.gap < np.inf:
        return (), found
    names = {p.name for p in sound}
    joints = tuple(
        j for j in drawing.gaps if names.issuperset(j.parts) and j.parts[0] != j.parts[1] and 0 <= j.gap < np.inf
    )
    parts, gone = apply_gap(replace(drawing, parts=tuple(sound), gaps=joints))
    return parts, grouped((*found, *_located(drawing, gone)))


def _located(drawing: Drawing, lines: Sequence[str]) -> tuple[str, ...]:
    """Lines that begin with the file's name."""
    return tuple(f"{drawing.source}: {line}" if drawing.source else line for line in lines)


def role_findings(drawing: Drawing) -> tuple[str, ...]:
    """List what a question about motion lacks: a fixed part, a pull.

    Examples
    --------
    >>> print(*role_findings(Drawing(())), sep="; ")
    nothing is fixed: name the parts that stand with --fix NAME; nothing is pulled: say what moves with --pull NAME:+y
    """
    direction = "+y" if drawing.dimension == 2 else "+z"
    return _located(drawing, missing_roles([p.fixed for p in drawing.parts], drawing.goals, direction))


def question_findings(drawing: Drawing) -> tuple[str, ...]:
    """Everything that is wrong with a question about motion: what it lacks, and names and numbers that make no sense.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Pull
    >>> print(question_findings(Drawing((), goals=(Pull("a", (0.0, 1.0)),)))[-1])
    nothing is fixed: name the parts that stand with --fix NAME
    """
    return (*_located(drawing, statement_findings(drawing)), *role_findings(drawing))


def asked_goals(drawing: Drawing, goals: Goal | Sequence[Goal] | None) -> tuple[Goal, ...]:
    """Goals of a question, by default those of the drawing, once it is sure that they make sense.

    Raises
    ------
    InputError
        If nothing is fixed or pulled, or a goal names an unknown part.
    """
    asked = given_goals(goals, drawing.goals)
    findings = question_findings(replace(drawing, goals=asked))
    if findings:
        raise InputError(findings)
    return asked


def opened_overlaps(drawing: Drawing) -> tuple[str, ...]:
    """Note parts that overlap as drawn, where the gap opens that.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Region
    >>> square = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]))
    >>> opened_overlaps(Drawing((Part("a", (square,)), Part("b", (square,), at=(1.99, 0.0, 0.0))), gap=0.1))
    ('parts "a" and "b" overlap by 0.01 mm as drawn; the gap of 0.1 opens that',)
    """
    pairs = free_overlaps(drawing, drawing.parts) if drawing.gap > 0 else []
    lines = [
        f'parts "{a}" and "{b}" overlap by {depth:.3g} mm as drawn; the gap of {drawing.gap:g} opens that'
        for a, b, depth in pairs
        if depth > _ROUNDING * drawing.gap
    ]
    more = [f"{len(lines) - _MAX_LINES} more pairs overlap as drawn; the gap opens that"]
    return _located(drawing, lines if len(lines) <= _MAX_LINES else [*lines[:_MAX_LINES], *more])


_ROUNDING = 0.041
"""Parts that share a curve may overlap by its chord error, a fiftieth of the gap on either side."""
_MAX_LINES = 5
"""Lines on overlaps that the gap opens."""


def overlap_findings(drawing: Drawing, parts: Sequence[Part]) -> tuple[str, ...]:
    """One line per pair of parts, as made, that overlaps at rest and may not; a part that lies over many has one line."""
    pairs = free_overlaps(drawing, parts)
    drawn = bool(drawing.source) and not drawing.source.lower().endswith(".json")
    size = {part.name: float(np.prod(np.ptp(np.vstack([r.outer for r in part.regions]), axis=0))) for part in parts}
    often = Counter(name for a, b, _ in pairs for name in (a, b))
    groups: dict[str, list[tuple[str, float]]] = {}
    for a, b, depth in pairs:
        hub, other = (b, a) if often[b] > often[a] else (a, b)
        groups.setdefault(hub, []).append((other, depth))
    found = []
    for a, others in groups.items():
        if len(others) > _MAX_LINES:
            listed = ", ".join(f'"{name}"' for name, _ in others[:3])
            b, depth = others[0][0], max(depth for _, depth in others)
            what = f'part "{a}" overlaps {len(others)} others ({listed}, ...) by up to {depth:.6g} mm at gap {drawing.gap:g}'
            small = drawn and all(size[name] < size[a] for name, _ in others)
            right = (
                _ways_out(a, b, size, drawn).replace(f"--hole {b}", "--hole all")
                if small
                else _ways_out(a, b, size, drawn)
            )
            found.append(f"{what}: {right}, and so on")
            continue
        for b, depth in others:
            what = f'parts "{a}" and "{b}" overlap by {depth:.6g} mm at gap {drawing.gap:g}'
            found.append(f"{what}: {_ways_out(a, b, size, drawn)}")
    return _located(drawing, found)


def _ways_out(a: str, b: str, size: Mapping[str, float], drawn: bool) -> str:
    """What would be right where two parts overlap."""
    hole = f"--hole {min(a, b, key=size.__getitem__)} if it is cut out, " if drawn else ""
    return f"draw them apart, ask for a larger gap, {hole}or --glue {a},{b} or --ignore {a},{b}"


def free_overlaps(drawing: Drawing, parts: Sequence[Part]) -> list[tuple[str, str, float]]:
    """Names of parts that overlap at rest and are neither glued nor ignored, and how deep [mm]."""
    collide = collidable(drawing.glue, drawing.ignore)
    found = [(parts[i].name, parts[j].name, depth) for i, j, depth in overlaps_at_rest(parts)]
    return [(a, b, depth) for a, b, depth in found if collide(a, b)]


def overlap_depth(drawing: Drawing, *, gap: float, offset: Mapping[str, float]) -> float | None:
    """Deepest overlap [mm] at rest of parts that may not overlap, 0 where none does; None where parts cannot be made.

    Parameters
    ----------
    drawing : Drawing [mm]
        Sound, as from an assembly.
    gap : float [mm]
        In place of the drawing's.
    offset : mapping of names to float [mm]
        Added to the offsets of parts: how far their outlines lie further out.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Region
    >>> square = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]))
    >>> two = Drawing((Part("a", (square,)), Part("b", (square,), at=(2.5, 0.0, 0.0))))
    >>> overlap_depth(two, gap=0.0, offset={"a": 0.5, "b": 0.5})
    0.5
    """
    drawing = flattened_for(drawing, gap)
    parts = tuple(replace(p, offset=p.offset + offset.get(p.name, 0.0)) for p in drawing.parts)
    used = replace(drawing, parts=parts, gap=gap)
    made, gone = apply_gap(used)
    return None if gone else max((depth for *_, depth in free_overlaps(used, made)), default=0.0)


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
