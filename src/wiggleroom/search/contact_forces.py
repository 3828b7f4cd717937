"""Real contacts that hold the motion: point, normal and force.

Where edges lie flat on each other a wall may hold beyond the end of its edge: its force and those of its pair are then shared out anew
among the places where corners do touch edges, if these can carry the same force and torque.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.geometry.relative_pose import rotated
from wiggleroom.geometry.row_kinds import A_EDGE
from wiggleroom.geometry.touching_corners import touching_corners
from wiggleroom.program.nonlinear_program import Program
from wiggleroom.search.active_set import EDGE_END_TOLERANCE, ActiveSet
from wiggleroom.search.answer import Contact
from wiggleroom.solve.nonnegative_least_squares import nonnegative_least_squares

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MIN_FORCE_SHARE = 1e-5
"""Contacts with less than this share of the largest force are not reported."""
TOUCHING_DISTANCE = 1e-5
"""A corner no further than this from an edge touches it, in units of the clearance."""
BALANCE_TOLERANCE = 1e-5
"""Share of a pair's force that may be left over when it is shared out anew."""


@dataclass(frozen=True, eq=False)
class ContactForces:
    """Forces of corners on edges.

    Parameters
    ----------
    pair : (k,) int64
        Pairs of the program.
    kind, edge, corner : (k,) int64
        Edge and corner as rows of `BodyShapes`; kind as in `contact_functions`.
    force : (k,) float64
        Objective per mm.
    whole : bool
        False where some force is held by walls that nothing touches, or was shared out to corners that touch edges at their very ends.
    """

    pair: Ints
    kind: Ints
    edge: Ints
    corner: Ints
    force: Floats
    whole: bool


def contact_forces(program: Program, u: Floats, active: ActiveSet) -> ContactForces:
    """Forces of the real contacts at u (3F,); those of pairs with virtual walls are shared out anew where that can be done."""
    cells, real = program.cells, ~active.virtual
    keep, whole = real.copy(), True
    found = [(np.zeros(0, dtype=np.int64),) * 4 + (np.zeros(0),)]
    if not real.all():
        at = program.linearise(u)
        pairs = np.unique(active.pair[~real])
        corners = touching_corners(
            program.bodies, cells.a[pairs], cells.b[pairs], at.g[pairs], TOUCHING_DISTANCE * program.length, EDGE_END_TOLERANCE
        )  # fmt: skip
        order = np.argsort(active.pair, kind="stable")
        first, end = (np.searchsorted(active.pair[order], pairs, side) for side in ("left", "right"))
        for k, pair in enumerate(pairs.tolist()):
            mine, some = order[first[k] : end[k]], slice(*corners.row[k : k + 2].tolist())
            wrench = active.force[mine] @ at.d[active.row[mine]] * program.length  # rows count in units of that length
            lever = np.array([1.0, 1.0, 1.0 / program.bodies.radius[cells.b[pair]]])
            shared = _shared_out(corners.place[some], corners.d[some] * lever, wrench * lever)
            whole = whole and shared is not None and shared[2]
            if shared is not None:
                keep[mine] = False
                row = some.start + shared[0]
                found.append(
                    (np.full(len(row), pair), corners.kind[row], corners.edge[row], corners.corner[row], shared[1])
                )
    row = active.row[keep]
    found.append((active.pair[keep], cells.kind[row], cells.edge[row], cells.corner[row], active.force[keep]))
    pair, kind, edge, corner, force = (np.concatenate(column) for column in zip(*found, strict=True))
    return ContactForces(pair, kind, edge, corner, force, whole)


def _shared_out(place: Floats, d: Floats, wrench: Floats) -> tuple[Ints, Floats, bool] | None:
    """Which of some corners, and their forces (k,), carry the force and torque of a pair; None where those that touch cannot.

    The third value tells whether no corner that touches an edge at its end is needed for that.
    """
    inside = (place > EDGE_END_TOLERANCE) & (place < 1 - EDGE_END_TOLERANCE)
    for some in (np.flatnonzero(inside), np.arange(len(place))):
        if not len(some):
            continue
        force, left = nonnegative_least_squares(d[some], wrench)
        if left <= BALANCE_TOLERANCE * np.linalg.norm(wrench):
            return some, force, bool(inside[some].all())
    return None


def contacts(
    assembly: Assembly, program: Program, u: Floats, held: ContactForces, unit: float = 1.0
) -> tuple[Contact, ...]:
    """Contacts at u (3F,) in assembly coordinates, strongest first; forces in this unit."""
    bodies, cells, shapes = program.bodies, program.cells, program.bodies.shapes
    pose, name = bodies.rest + program.motion(u), assembly.names
    order = np.argsort(-held.force, kind="stable")
    order = order[held.force[order] >= max(MIN_FORCE_SHARE * held.force.max(initial=0.0), np.finfo(float).tiny)]
    pair, of_a = held.pair[order], held.kind[order] == A_EDGE
    a, b, edge, corner = cells.a[pair], cells.b[pair], held.edge[order], held.corner[order]
    owner, other = np.where(of_a, a, b), np.where(of_a, b, a)
    point = pose[other, :2] + rotated(shapes.corner[corner], pose[other, 2])
    normal = rotated(shapes.normal[edge], pose[owner, 2]) * np.where(of_a, 1.0, -1.0)[:, None]
    one, two = np.where(of_a, edge, corner), np.where(of_a, corner, edge)
    bodies_of = zip(a.tolist(), b.tolist(), shapes.member[one].tolist(), shapes.member[two].tolist(), strict=True)
    names = [(name[bodies.members[i][m]], name[bodies.members[j][n]]) for i, j, m, n in bodies_of]
    what = zip(names, point.tolist(), normal.tolist(), (held.force[order] / unit).tolist(), strict=True)
    return tuple(Contact(who, (p[0], p[1]), (n[0], n[1]), force) for who, p, n, force in what)
