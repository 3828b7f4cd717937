"""Everything that is wrong with a drawing, all at once: one plain line per finding."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from wiggleroom.assembly.gaps import apply_gap
from wiggleroom.assembly.outline_findings import sound_parts
from wiggleroom.assembly.overlaps import overlaps_at_rest
from wiggleroom.assembly.statements import given_goals, missing_roles, statement_findings
from wiggleroom.drawing.model import Drawing, Goal, Part
from wiggleroom.drawing.strokes.chord_error import flattened_for
from wiggleroom.drawing.writers.glue_groups import collidable
from wiggleroom.errors import InputError, grouped


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
    return _located(drawing, missing_roles([p.fixed for p in drawing.parts], drawing.goals, "+y"))


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
