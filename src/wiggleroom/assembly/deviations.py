"""Drawings as they come out of the workshop: parts, outlines and joints off from where they should be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wiggleroom.assembly.statements import unknown
from wiggleroom.drawing.model import Drawing, JointGap, Part, Tolerance
from wiggleroom.errors import InputError


def deviated(drawing: Drawing, deviations: Sequence[tuple[Tolerance, float]]) -> Drawing:
    """Drawing in which each tolerance's part, outline or joint is off by so much [mm] from its nominal.

    Positive is out of the material for parts and outlines, and wider for the gap of a joint.

    Raises
    ------
    InputError
        If a part or an outline is not there.

    Examples
    --------
    >>> import numpy as np
    >>> from wiggleroom.drawing.model import Region
    >>> square = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]))
    >>> grown = deviated(Drawing((Part("a", (square,)),)), [(Tolerance(("a",), 0.1, 0.1, outline=1), 0.1)])
    >>> grown.parts[0].outline_offsets
    (0.1,)
    """
    parts = {part.name: part for part in drawing.parts}
    findings = [f"tolerance: {unknown(name, parts)}" for t, _ in deviations for name in t.parts if name not in parts]
    findings += [
        f'tolerance: part "{t.parts[0]}" has {_count(parts[t.parts[0]])} outlines, not {t.outline}'
        for t, _ in deviations
        if t.outline is not None and t.parts[0] in parts and t.outline > _count(parts[t.parts[0]])
    ]
    if findings:
        raise InputError(findings)
    gaps = {frozenset(joint.parts): joint for joint in drawing.gaps}
    for tolerance, off in deviations:
        name = tolerance.parts[0]
        if len(tolerance.parts) == 2:
            pair = frozenset(tolerance.parts)
            own = gaps[pair].gap if pair in gaps else drawing.gap
            nominal = own if tolerance.nominal is None else tolerance.nominal
            gaps[pair] = JointGap(tolerance.parts, max(nominal + off, 0.0))
        elif tolerance.outline is not None:
            parts[name] = _outline_moved(parts[name], tolerance.outline, (tolerance.nominal or 0.0) + off)
        else:
            nominal = parts[name].offset if tolerance.nominal is None else tolerance.nominal
            parts[name] = replace(parts[name], offset=nominal + off)
    return replace(drawing, parts=tuple(parts.values()), gaps=tuple(gaps.values()))


def _count(part: Part) -> int:
    return sum(1 + len(region.holes) for region in part.regions)


def _outline_moved(part: Part, number: int, outward: float) -> Part:
    """The part with one of its outlines moved out of the material."""
    offsets = list(part.outline_offsets or (0.0,) * _count(part))
    offsets[number - 1] += outward
    return replace(part, outline_offsets=tuple(offsets))
