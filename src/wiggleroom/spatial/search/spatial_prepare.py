"""What stays the same from question to question in space: bodies and near pairs of pieces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, placed_surface
from wiggleroom.assembly.overlaps import CONTACT_TOLERANCE
from wiggleroom.drawing.model import Closer, Goal, Pull, Translation, Turn, Weight
from wiggleroom.errors import InputError, TouchingError
from wiggleroom.spatial.bodies.rigid import near_pieces
from wiggleroom.spatial.bodies.rotations import unit_vector
from wiggleroom.spatial.bodies.spatial_bodies import Grouping, grouped
from wiggleroom.spatial.overlaps.meeting_pairs import meeting_pairs
from wiggleroom.spatial.overlaps.swept_check import SweptCheck
from wiggleroom.spatial.planes.separating_plane_program import best_axis
from wiggleroom.spatial.planes.spatial_objectives import Displacement, Nearness, SquaredTravel, SumOfTerms, Term, Twist
from wiggleroom.spatial.solids.solid_angle import winding_numbers
from wiggleroom.spatial.solids.solid_boolean import solid_of, surface_of

Ints = NDArray[np.int64]

REACH = 3.0
"""Pieces closer than this multiple of the typical clearance are in the program from the start."""


@dataclass(frozen=True, eq=False)
class SpatialPrepared:
    """A spatial assembly made ready for questions.

    Parameters
    ----------
    assembly : Assembly
    grouping : Grouping
    clearance : float [mm]
        Typical clearance between neighbours.
    size : float [mm]
    pieces : (k, 4) int64
        Pairs of pieces in the program from the start.
    checker : SweptCheck
    """

    assembly: Assembly
    grouping: Grouping
    clearance: float
    size: float
    pieces: Ints
    checker: SweptCheck


def prepare_spatial(assembly: Assembly) -> SpatialPrepared:
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
    if not all(made.pieces for made in assembly.solids):
        message = f"{assembly.drawing.source or 'the assembly'}: was read with overlapping=True, for clearances alone; read it without"
        raise InputError(message)
    rest = bodies.rest
    first = near_pieces(bodies, rest, max(2 * assembly.gap, 1e-3 * size))
    apart = np.array([best_axis(bodies, rest, who, np.empty(3))[0] for who in first.tolist()])
    if len(apart) and apart.min() < CONTACT_TOLERANCE * size:
        k = int(apart.argmin())
        raise _touching(assembly, group, first[k], float(apart[k]))
    if assembly.overshoot:
        _refuse_enclosed(assembly)
    near = apart[apart > 0]
    clearance = assembly.gap or (float(np.median(near)) if len(near) else 1e-2 * size)
    pieces = near_pieces(bodies, rest, REACH * clearance)
    return SpatialPrepared(assembly, group, clearance, size, pieces, SweptCheck(assembly))


def _refuse_enclosed(assembly: Assembly) -> None:
    """Raise a TouchingError where a part lies inside the material of another: their shells do not meet there."""
    surfaces = [placed_surface(part, made.surface) for part, made in zip(assembly.parts, assembly.solids, strict=True)]
    low, high = (np.array([reach(s.vertices, axis=0) for s in surfaces]) for reach in (np.min, np.max))
    for pair in meeting_pairs(assembly, low, high):
        for outer, inner in ((surfaces[k] for k in order) for order in (pair, pair[::-1])):
            one_of_each = np.array([surface_of(one).vertices[0] for one in solid_of(inner).decompose()])
            if (winding_numbers(outer.vertices[outer.faces], one_of_each) > 0.5).any():
                one, other = (assembly.names[k] for k in pair)
                deep = float(np.ptp(inner.vertices, axis=0).min())
                raise TouchingError(_at_rest(assembly, one, other, f"overlap by {deep:.6g} mm"), (one, other), -deep)


def _touching(assembly: Assembly, group: Grouping, who: Ints, apart: float) -> TouchingError:
    """Error that names the two parts."""
    a, i, b, j = who.tolist()
    one, other = (assembly.names[group.bodies.owner[k][p]] for k, p in ((a, i), (b, j)))
    what = f"overlap by {-apart:.6g} mm" if apart < -CONTACT_TOLERANCE * assembly.size else "touch"
    return TouchingError(_at_rest(assembly, one, other, what), (one, other), apart)


def _at_rest(assembly: Assembly, one: str, other: str, what: str) -> str:
    """The line that says what two parts do at rest."""
    return (
        f'{assembly.drawing.source or "assembly"}: parts "{one}" and "{other}" {what} at rest at gap {assembly.gap:g}: '
        "ask for a larger gap, draw them apart, or glue or ignore them"
    )


def spatial_objective(ready: SpatialPrepared, goals: Sequence[Goal]) -> SumOfTerms:
    """What the program maximises for some goals."""
    assembly, group = ready.assembly, ready.grouping
    index = {name: k for k, name in enumerate(assembly.names)}
    terms: list[Term] = []
    for goal in goals:
        match goal:
            case Weight():
                unit = unit_vector(goal.direction)
                for k, (part, made) in enumerate(zip(assembly.parts, assembly.solids, strict=True)):
                    b = int(group.body_of[k])
                    if group.bodies.moves[b]:
                        pull = goal.weight * made.volume * part.density * unit
                        terms.append(Displacement(b, group.arm[k], pull, group.bodies.at[b]))
            case Translation():
                for k, b in enumerate(group.body_of.tolist()):
                    if group.bodies.moves[b]:
                        terms.append(SquaredTravel(b, group.arm[k], group.bodies.at[b], goal.weight))
            case Closer():
                terms += _nearness(ready, goal.weight)
            case Turn():
                terms.append(Twist(int(group.body_of[index[goal.part]]), unit_vector(goal.sense), goal.weight))
            case Pull():
                k = index[goal.part]
                b = int(group.body_of[k])
                rest = group.bodies.at[b]
                arm = group.arm[k] if goal.point is None else np.array(goal.point) - rest
                terms.append(Displacement(b, arm, goal.weight * unit_vector(goal.direction), rest))
    return SumOfTerms(tuple(terms))


def _nearness(ready: SpatialPrepared, weight: float) -> list[Term]:
    """Squared distances between the reference points of bodies that are near each other; where none are, of all."""
    bodies = ready.grouping.bodies
    pairs = np.unique(ready.pieces[:, [0, 2]], axis=0).tolist()
    if not pairs:
        moves = bodies.moves
        pairs = [(a, b) for a in range(len(moves)) for b in range(a + 1, len(moves)) if moves[a] or moves[b]]
    none, at = np.zeros((2, 3)), bodies.at
    return [Nearness(a, b, none, float(((at[b] - at[a]) ** 2).sum()), weight) for a, b in pairs]
