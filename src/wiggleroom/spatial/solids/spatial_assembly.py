"""From a spatial drawing to an assembly: gap applied, roles set, everything checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from wiggleroom.assembly.statements import goal_findings, unknown
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError
from wiggleroom.spatial.solids.joint_gap_solid import patched_solids, with_joint_gaps
from wiggleroom.spatial.solids.made_solids import made_solid
from wiggleroom.spatial.solids.spatial_file import read_spatial
from wiggleroom.spatial.solids.spatial_model import MadeSolid, SpatialAssembly, SpatialDrawing, SpatialPart


def assemble_spatial(
    drawing: SpatialDrawing,
    *,
    gap: float | None = None,
    fix: Sequence[str] = (),
    goals: Sequence[Goal] = (),
    inward: Mapping[str, float] | None = None,
) -> SpatialAssembly:
    """Parts as they are made, with their roles.

    Parameters
    ----------
    drawing : SpatialDrawing [mm]
    gap : float, optional [mm]
        In place of the drawing's.
    fix : sequence of names
        Parts that stand, besides those the drawing fixes.
    goals : sequence of Pull, Turn or Weight
        In place of the drawing's, where there are any.
    inward : mapping of names to float, optional [mm]
        How much further in than the gap says all faces of a part lie; negative: further out.

    Raises
    ------
    InputError
        With everything that is wrong, one line each.
    """
    names = {p.name: None for p in drawing.parts}
    wrong = [f"fix: {unknown(name, names)}" for name in fix if name not in names]
    used_gap = drawing.gap if gap is None else gap
    if not 0 <= used_gap < np.inf:
        message = f"gap is {used_gap:g}: it must be 0 or more"
        raise InputError(message)
    parts = tuple(replace(p, fixed=p.fixed or p.name in fix) for p in drawing.parts)
    used = replace(drawing, parts=parts, gap=used_gap, goals=tuple(goals) or drawing.goals)
    wrong += spatial_goal_findings(used, used.goals) + _joint_findings(used)
    plain: dict[tuple[int, float, float], MadeSolid] = {}
    for part in parts:
        key = _solid_key(part, inward)
        if key not in plain:
            found, findings = made_solid(part, used_gap, key[2])
            wrong += [_said(drawing, part, line) for line in findings]
            if found is not None:
                plain[key] = found
    if wrong:
        raise InputError(wrong)
    patched, findings = patched_solids(used)
    wrong += [f"{drawing.source or 'assembly'}: {line}" for line in findings]
    made: list[MadeSolid] = []
    for part in parts:
        solid = plain[_solid_key(part, inward)]
        if part.name in patched:
            own, findings = with_joint_gaps(part, solid, patched[part.name], used_gap, _solid_key(part, inward)[2])
            wrong += [_said(drawing, part, line) for line in findings]
            solid = own or solid
        made.append(solid)
    if wrong:
        raise InputError(wrong)
    return SpatialAssembly(used, tuple(made))


def _solid_key(part: SpatialPart, inward: Mapping[str, float] | None) -> tuple[int, float, float]:
    """Parts that agree in this are made alike but for gaps of joints: the solid, its offset, and how much further in its faces lie [mm]."""
    return id(part.solid), part.offset, (inward or {}).get(part.name, 0.0)


def _said(drawing: SpatialDrawing, part: SpatialPart, line: str) -> str:
    """A finding about a part, with the file and the part before it."""
    return f'{drawing.source or "assembly"}: part "{part.name}" {line}'


def _joint_findings(drawing: SpatialDrawing) -> list[str]:
    """What is wrong with gaps of single joints: unknown parts, sizes that make no sense."""
    names = {p.name: None for p in drawing.parts}
    found = [f"gaps: {unknown(name, names)}" for joint in drawing.gaps for name in joint.parts if name not in names]
    for joint in drawing.gaps:
        if joint.parts[0] == joint.parts[1]:
            found.append(f'gaps: "{joint.parts[0]}" is named twice: a joint lies between two parts')
        if not 0 <= joint.gap < np.inf:
            found.append(f"gap of {joint.parts[0]} and {joint.parts[1]} is {joint.gap:g}: it must be 0 or more")
    return found


def spatial_goal_findings(drawing: SpatialDrawing, goals: Sequence[Goal]) -> list[str]:
    """What is wrong with goals: unknown parts, parts that stand, numbers that make no sense."""
    return goal_findings(goals, {p.name: p.fixed for p in drawing.parts}, drawing.glue, 3)


def read_spatial_assembly(
    path: str | Path, gap: float | None = None, fix: Sequence[str] = (), goals: Sequence[Goal] = ()
) -> SpatialAssembly:
    """Assembly of a file of format wiggleroom/2; see `wiggleroom.read`."""
    return assemble_spatial(read_spatial(path), gap=gap, fix=fix, goals=goals)
