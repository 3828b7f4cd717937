"""From a spatial drawing to an assembly: gap applied, roles set, everything checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.statements import statement_findings, with_roles
from wiggleroom.drawing.model import Drawing, Goal, MadeSolid, Part
from wiggleroom.errors import InputError, Stop, go_on
from wiggleroom.spatial.solids.joint_gap_solid import patched_solids, with_joint_gaps
from wiggleroom.spatial.solids.made_solids import made_solid
from wiggleroom.spatial.solids.mesh_pieces import CutsLeft, in_pieces, notches
from wiggleroom.spatial.solids.shell_thickness import shell_thickness
from wiggleroom.spatial.solids.spatial_file import read_spatial

_Key = tuple[int, float, float, tuple[float, ...]]


def assemble_spatial(
    drawing: Drawing,
    *,
    gap: float | None = None,
    fix: Sequence[str] = (),
    goals: Sequence[Goal] = (),
    inward: Mapping[str, float] | None = None,
    overlapping: bool = False,
    stop: Stop | None = None,
) -> Assembly:
    """Parts in space as they are made, with their roles; see `wiggleroom.assemble`.

    All faces of a part in `inward` (name to mm) lie that much further in than the gap says; further out where it is negative.
    """
    used_gap = float(drawing.gap if gap is None else gap)
    used, wrong = with_roles(drawing, used_gap, fix, goals)
    wrong += [f"{drawing.source}: {line}" if drawing.source else line for line in statement_findings(used)]
    if not 0 <= used_gap < np.inf:
        raise InputError(wrong)
    parts = used.parts
    plain: dict[_Key, MadeSolid] = {}
    for part in parts:
        go_on(stop)
        key = _solid_key(part, inward)
        if key not in plain:
            found, findings = made_solid(part, used_gap, key[2], stop)
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
            go_on(stop)
            own, findings = with_joint_gaps(part, solid, patched[part.name], used_gap, _solid_key(part, inward)[2])
            wrong += [_said(drawing, part, line) for line in findings]
            solid = own or solid
        made.append(solid)
    if wrong:
        raise InputError(wrong)
    if not overlapping:
        made = _in_pieces(used, made, stop)
    covers = tuple(
        f"{_said(drawing, part, 'is covered by')} {len(one.pieces)} pieces, at most {one.overshoot:.2g} mm larger than it is made"
        + (f", on 95 % of its surface {one.mostly:.2g}" if one.mostly < one.overshoot else "")
        + ": what moves here moves, and more may"
        for part, one in zip(parts, made, strict=True)
        if one.overshoot > 0
    )
    return assembly_of(replace(used, notes=tuple(dict.fromkeys((*used.notes, *covers)))), made)


def _in_pieces(drawing: Drawing, made: Sequence[MadeSolid], stop: Stop | None) -> list[MadeSolid]:
    """Solids, those that are not cut yet in convex pieces, each once."""
    users: dict[int, list[int]] = {}
    for k, one in enumerate(made):
        if not one.pieces:
            users.setdefault(id(one), []).append(k)
    found, left = list(made), CutsLeft()
    for who in sorted(users.values(), key=lambda who: notches(made[who[0]])):  # those that are cut soonest first
        whole = in_pieces(made[who[0]], partial(shell_thickness, drawing, made, who, stop), stop, left)
        for k in who:
            found[k] = whole
    return found


def assembly_of(drawing: Drawing, solids: Sequence[MadeSolid]) -> Assembly:
    """Parts with the roles that a drawing gives them, made of these solids; offsets are 0, as they are in the solids now."""
    made = zip(drawing.parts, solids, strict=True)
    return Assembly(tuple(replace(part, solid=solid, offset=0.0, outline_offsets=()) for part, solid in made), drawing)


def _solid_key(part: Part, inward: Mapping[str, float] | None) -> _Key:
    """Parts that agree in this are made alike but for gaps of joints: the solid, its offsets, and how much further in faces lie [mm]."""
    return id(part.solid), part.offset, (inward or {}).get(part.name, 0.0), part.outline_offsets


def _said(drawing: Drawing, part: Part, line: str) -> str:
    """A finding about a part, with the file and the part before it."""
    return f'{drawing.source or "assembly"}: part "{part.name}" {line}'


def read_spatial_assembly(
    path: str | Path,
    gap: float | None = None,
    fix: Sequence[str] = (),
    goals: Sequence[Goal] = (),
    overlapping: bool = False,
    stop: Stop | None = None,
) -> Assembly:
    """Assembly of a file of format wiggleroom/2; see `wiggleroom.read`."""
    return assemble_spatial(
        read_spatial(path, stop=stop), gap=gap, fix=fix, goals=goals, overlapping=overlapping, stop=stop
    )
