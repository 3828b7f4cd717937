"""Real contacts that hold the motion: point, normal and force."""

from __future__ import annotations

import numpy as np

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.geometry.relative_pose import turn
from wiggleroom.program import contact_functions as kernel
from wiggleroom.program.nonlinear_program import Program
from wiggleroom.search.active_set import ActiveSet
from wiggleroom.search.answer import Contact

MIN_FORCE_SHARE = 1e-5
"""Contacts with less than this share of the largest force are not reported."""


def contacts(
    assembly: Assembly, program: Program, u: np.ndarray, active: ActiveSet, unit: float = 1.0
) -> tuple[Contact, ...]:
    """Contacts at u (3F,) in assembly coordinates, strongest first; forces in this unit."""
    bodies, cells, shapes = program.bodies, program.cells, program.bodies.shapes
    pose, name = bodies.rest + program.motion(u), assembly.names
    order = np.argsort(-active.force, kind="stable")
    order = order[~active.virtual[order] & (active.force[order] >= MIN_FORCE_SHARE * active.force.max(initial=0.0))]
    row, pair = active.row[order], active.pair[order]
    of_a = cells.kind[row] == kernel.A_EDGE
    a, b, edge, corner = cells.a[pair], cells.b[pair], cells.edge[row], cells.corner[row]
    owner, other = np.where(of_a, a, b), np.where(of_a, b, a)
    point = pose[other, :2] + turn(shapes.corner[corner], pose[other, 2])
    normal = turn(shapes.normal[edge], pose[owner, 2]) * np.where(of_a, 1.0, -1.0)[:, None]
    one, two = np.where(of_a, edge, corner), np.where(of_a, corner, edge)
    bodies_of = zip(a.tolist(), b.tolist(), shapes.member[one].tolist(), shapes.member[two].tolist(), strict=True)
    names = [(name[bodies.members[i][m]], name[bodies.members[j][n]]) for i, j, m, n in bodies_of]
    what = zip(names, point.tolist(), normal.tolist(), (active.force[order] / unit).tolist(), strict=True)
    return tuple(Contact(who, (p[0], p[1]), (n[0], n[1]), force) for who, p, n, force in what)
