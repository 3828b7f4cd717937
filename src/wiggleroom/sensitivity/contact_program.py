"""The program in which corners that touch hold a motion, in place of walls that nothing touches.

Where a turn ends because a part jams, its cell ends at that angle too, and the end of the angle may carry the force, or the line of an edge
beyond its end. Neither moves with the gaps as the parts do.
"""

from __future__ import annotations

from functools import reduce

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace.cells.cells import Cells, concatenated, replaced
from wiggleroom.geometry.row_kinds import HIGH_TURN, LOW_TURN
from wiggleroom.geometry.touching_corners import TouchingCorners, touching_corners
from wiggleroom.program.nonlinear_program import Program, build_program
from wiggleroom.search.active_set import EDGE_END_TOLERANCE, touching
from wiggleroom.search.contact_forces import BALANCE_TOLERANCE, TOUCHING_DISTANCE
from wiggleroom.solve.nonnegative_least_squares import nonnegative_least_squares

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LEAST_SHARE = 1e-3
"""A corner that can carry this share of what its pair holds is one of those that hold."""


def on_contacts(program: Program, u: Floats, lam: Floats) -> tuple[Program, Floats]:
    """A program with the same solution u (3F,), and multipliers `lam` (R,) of its rows.

    Pairs with force on walls that nothing touches, or on the end of a cell's angle, are held by the corners that touch inside edges, where
    these can carry the same force and torque; all that can take part in that do.
    """
    active = touching(program, u, lam)
    cells, at = program.cells, program.linearise(u)
    pairs = np.unique(active.pair[active.virtual])
    corners = touching_corners(
        program.bodies, cells.a[pairs], cells.b[pairs], at.g[pairs], TOUCHING_DISTANCE * program.length, 0.0
    )
    inside = (corners.place > EDGE_END_TOLERANCE) & (corners.place < 1 - EDGE_END_TOLERANCE)
    held: list[int] = []
    found: list[Cells] = []
    forces: dict[int, Floats] = {}
    for k, pair in enumerate(pairs.tolist()):
        mine = active.row[active.pair == pair]
        wrench = lam[mine] @ at.d[mine]
        lever = np.array([1.0, 1.0, 1.0 / program.bodies.radius[cells.b[pair]]])
        some = corners.row[k] + np.flatnonzero(inside[slice(*corners.row[k : k + 2])])
        force = _shared_by_all(corners.d[some] / program.length * lever, wrench * lever)
        if force is None:
            continue
        some, force = some[force > 0], force[force > 0]
        idle = np.setdiff1d(np.arange(*cells.row[pair : pair + 2]), mine)
        idle = idle[cells.is_wall[idle]]
        held.append(pair)
        found.append(_held_by(program, pair, corners, some, idle))
        forces[pair] = np.concatenate([force, np.zeros(len(idle) + 2)])
    if not held:
        return program, lam
    split = np.split(lam, cells.row[1:-1])
    both = np.concatenate([forces.get(p, own) for p, own in enumerate(split)])
    made = replaced(cells, np.array(held), reduce(concatenated, found))
    return build_program(program.bodies, made, program.objective, length=program.length, like=program), both


def _shared_by_all(d: Floats, wrench: Floats) -> Floats | None:
    """Forces (k,) of corners with derivatives `d` (k, 3) that add up to a wrench (3,), positive where they can be; None if none do."""
    if not len(d):
        return None
    size = np.linalg.norm(wrench)
    least = LEAST_SHARE * size / np.linalg.norm(d, axis=1)
    found = []
    for part in (*np.diag(least), np.zeros(len(d))):
        force, left = nonnegative_least_squares(d, wrench - part @ d)
        if left <= BALANCE_TOLERANCE * size:
            found.append(part + force)
    return np.mean(found, axis=0) if found else None


def _held_by(program: Program, pair: int, corners: TouchingCorners, some: Ints, idle: Ints) -> Cells:
    """The cell of a pair with walls of some corners that touch, and its own ones that hold nothing; it may turn a little further."""
    cells = program.cells
    a, b = cells.a[pair : pair + 1], cells.b[pair : pair + 1]
    further = program.length / np.minimum(program.bodies.radius[a], program.bodies.radius[b])
    kind = np.concatenate([corners.kind[some], cells.kind[idle], [LOW_TURN, HIGH_TURN]]).astype(np.int8)
    edge, corner = (
        np.concatenate([new[some], old[idle], [0, 0]]).astype(np.int32)
        for new, old in ((corners.edge, cells.edge), (corners.corner, cells.corner))
    )
    ends = cells.ends[pair] + further * np.array([-1.0, 1.0])
    return Cells(a, b, np.array([0, len(kind)]), kind, edge, corner, ends[None], cells.seed[pair : pair + 1])
