"""Contacts of a solution: where pieces touch, along which normal, and with which force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.search.answer import Contact
from wiggleroom.spatial.bodies.spatial_bodies import Grouping
from wiggleroom.spatial.planes.separating_plane_program import SeparatingPlaneProgram
from wiggleroom.spatial.planes.separating_plane_solver import SeparatingPlaneSolution

WEAK = 1e-5
"""Contacts with less than this share of the largest force are not reported."""
NOISE = 1e-7
"""Neither are those with less than this share of the load: where locks alone hold a part, the solver leaves forces that hold nothing."""


@dataclass(frozen=True, eq=False)
class HeldMotion:
    """How a motion is held: the last program, its solution, and which part every piece belongs to."""

    grouping: Grouping
    program: SeparatingPlaneProgram
    found: SeparatingPlaneSolution


def spatial_contacts(assembly: Assembly, held: HeldMotion) -> tuple[Contact, ...]:
    """Contacts in assembly coordinates, strongest first.

    The corners of one piece that touch the plane, weighted by their multipliers, have the point of contact as their mean; it lies in that
    piece, and as the plane holds no moment, the other piece's mean is the same point.
    """
    P, found = held.program, held.found
    lam, pose = found.lam, found.point.pose
    contacts = []
    total = np.add.reduceat(lam, P.row[:-1]) if P.planes else np.zeros(0)
    load = np.abs(P.objective.gradient(pose)).max(initial=0.0)
    least = max(WEAK * total.max(initial=0.0), NOISE * load)
    pair = np.repeat(np.arange(len(P.a)), np.diff(P.plane))
    for k in np.flatnonzero(total > least).tolist():
        a, b = int(P.a[pair[k]]), int(P.b[pair[k]])
        first, last = int(P.row[k] + P.own[k]), int(P.row[k + 1])
        force = float(lam[first:last].sum())
        if force <= least:
            continue
        corner = lam[first:last] @ P.V[first:last] / force
        point = pose.T[b] + pose.R[b] @ corner
        normal = pose.R[a] @ found.point.n[k]
        _, pi, _, pj = P.pieces[k].tolist()
        names = tuple(
            assembly.names[int(held.grouping.bodies.owner[body][piece])] for body, piece in ((a, pi), (b, pj))
        )
        contacts.append(Contact((names[0], names[1]), tuple(point.tolist()), tuple(normal.tolist()), force))
    return tuple(sorted(contacts, key=lambda c: -c.force))
