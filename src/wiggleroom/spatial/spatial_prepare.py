"""What stays the same from question to question in space: bodies and near pairs of pieces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.overlaps import CONTACT_TOLERANCE
from wiggleroom.drawing.model import Goal, Pull, Turn, Weight
from wiggleroom.errors import InputError, TouchingError
from wiggleroom.spatial.overlaps.swept_check import SweptCheck
from wiggleroom.spatial.planes.separating_plane_program import best_axis
from wiggleroom.spatial.planes.spatial_objectives import Displacement, SumOfTerms, Twist
from wiggleroom.spatial.rigid import near_pieces
from wiggleroom.spatial.rotations import unit_vector
from wiggleroom.spatial.solids.spatial_model import SpatialAssembly
from wiggleroom.spatial.spatial_bodies import Grouping, grouped

Ints = NDArray[np.int64]

REACH = 3.0
"""Pieces closer than this multiple of the typical clearance are in the program from the start."""


@dataclass(frozen=True, eq=False)
class SpatialPrepared:
    """A spatial assembly made ready for questions.

    Parameters
    ----------
    assembly : SpatialAssembly
    grouping : Grouping
    clearance : float [mm]
        Typical clearance between neighbours.
    size : float [mm]
    pieces : (k, 4) int64
        Pairs of pieces in the program from the start.
    checker : SweptCheck
    """

    assembly: SpatialAssembly
    grouping: Grouping
    clearance: float
    size: float
    pieces: Ints
    checker: SweptCheck


def prepare_spatial(assembly: SpatialAssembly) -> SpatialPrepared:
    """Bodies and near pairs of pieces of an assembly.

    Raises
    ------
    TouchingError
        If two parts touch or overlap after the gap is applied.
    InputError
        If nothing can move.
    """
    group, size = grouped(assembly), assembly.size
    bodies = group.bodies
    if not bodies.moves.any():
        finding = f"{assembly.drawing.source or 'the assembly'}: every part is fixed; at least one must be free to move"
        raise InputError(finding)
    first = near_pieces(bodies, bodies.rest, max(2 * assembly.gap, 1e-3 * size))
    apart = np.array([best_axis(bodies, bodies.rest, who, np.empty(3))[0] for who in first.tolist()])
    if len(apart) and apart.min() < CONTACT_TOLERANCE * size:
        k = int(apart.argmin())
        raise _touching(assembly, group, first[k], float(apart[k]))
    near = apart[apart > 0]
    clearance = assembly.gap or (float(np.median(near)) if len(near) else 1e-2 * size)
    pieces = near_pieces(bodies, bodies.rest, REACH * clearance)
    return SpatialPrepared(assembly, group, clearance, size, pieces, SweptCheck(assembly))


def _touching(assembly: SpatialAssembly, group: Grouping, who: Ints, apart: float) -> TouchingError:
    """Error that names the two parts."""
    a, i, b, j = who.tolist()
    one, other = (assembly.names[group.bodies.owner[k][p]] for k, p in ((a, i), (b, j)))
    what = f"overlap by {-apart:.6g} mm" if apart < -CONTACT_TOLERANCE * assembly.size else "touch"
    finding = (
        f'{assembly.drawing.source or "assembly"}: parts "{one}" and "{other}" {what} at rest at gap {assembly.gap:g}: '
        "ask for a larger gap, draw them apart, or glue or ignore them"
    )
    return TouchingError(finding, (one, other), apart)


def spatial_objective(ready: SpatialPrepared, goals: Sequence[Goal]) -> SumOfTerms:
    """What the program maximises for some goals."""
    assembly, group = ready.assembly, ready.grouping
    index = {name: k for k, name in enumerate(assembly.names)}
    terms: list[Displacement | Twist] = []
    for goal in goals:
        match goal:
            case Weight():
                unit = unit_vector(goal.direction)
                for k, (part, made) in enumerate(zip(assembly.parts, assembly.made, strict=True)):
                    b = int(group.body_of[k])
                    if group.bodies.moves[b]:
                        pull = goal.weight * made.volume * part.density * unit
                        terms.append(Displacement(b, group.arm[k], pull, group.bodies.at[b]))
            case Turn():
                terms.append(Twist(int(group.body_of[index[goal.part]]), unit_vector(goal.sense), goal.weight))
            case Pull():
                k = index[goal.part]
                b = int(group.body_of[k])
                rest = group.bodies.at[b]
                arm = group.arm[k] if goal.point is None else np.array(goal.point) - rest
                terms.append(Displacement(b, arm, goal.weight * unit_vector(goal.direction), rest))
    return SumOfTerms(tuple(terms))
