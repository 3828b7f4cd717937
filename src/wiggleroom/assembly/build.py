"""From a drawing to an assembly: gap applied, roles set, everything checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

from wiggleroom.assembly.findings import examine
from wiggleroom.assembly.model import Assembly
from wiggleroom.assembly.statements import unknown
from wiggleroom.drawing.model import Drawing, Goal
from wiggleroom.errors import InputError


def assemble(
    drawing: Drawing,
    *,
    gap: float | None = None,
    fix: Sequence[str] = (),
    goals: Sequence[Goal] = (),
    offset: Mapping[str, float] | None = None,
) -> Assembly:
    """Parts as they are made, with their roles.

    Parameters
    ----------
    drawing : Drawing [mm]
    gap : float, optional [mm]
        In place of the drawing's.
    fix : sequence of names
        Parts that stand, besides those the drawing fixes.
    goals : sequence of Pull, Turn or W
        In place of the drawing's, where there are any.
    offset : mapping of names to float, optional [mm]
        Added to the offsets of single parts.

    Raises
    ------
    InputError
        With everything that is wrong, one line each.

    Examples
    --------
    >>> import numpy as np
    >>> from wiggleroom.drawing.model import Part, Region
    >>> square = Region(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]))
    >>> assemble(Drawing((Part("a", (square,)),)), gap=0.5, fix=["a"]).parts[0].fixed
    True
    """
    names = {p.name: None for p in drawing.parts}
    offsets = dict(offset or {})
    wrong = [f"fix: {unknown(name, names)}" for name in fix if name not in names]
    wrong += [f"offset: {unknown(name, names)}" for name in offsets if name not in names]
    parts = tuple(
        replace(p, fixed=p.fixed or p.name in fix, offset=p.offset + offsets.get(p.name, 0.0))
        if p.name in fix or p.name in offsets
        else p
        for p in drawing.parts
    )
    used = replace(
        drawing,
        parts=parts,
        gap=float(drawing.gap if gap is None else gap),
        goals=tuple(goals) or drawing.goals,
    )
    made, findings = examine(used)
    if wrong or findings:
        raise InputError((*wrong, *findings))
    return Assembly(made, used)


def read(
    path: str | PathLike[str],
    gap: float | None = None,
    unit: str | None = None,
    flatten: float | None = None,
    fix: Sequence[str] = (),
    goals: Sequence[Goal] = (),
) -> Assembly:
    """Assembly from a file: `wiggleroom.drawing.read_drawing`, then `assemble`.

    Parameters
    ----------
    path : str or path
        Assembly file (.json) or drawing (.svg, .dxf).
    gap : float, optional [mm]
        In place of the file's.
    unit : str, optional
        In place of the file's: mm, cm, m, in or px.
    flatten : float, optional [mm]
        Largest distance between a curve and the straight edges that replace it.
    fix, goals
        As for `assemble`.

    Raises
    ------
    InputError
        With everything that is wrong, one line each.
    """
    from wiggleroom.drawing import read_drawing

    return assemble(read_drawing(Path(path), unit=unit, flatten=flatten, gap=gap), gap=gap, fix=fix, goals=goals)
