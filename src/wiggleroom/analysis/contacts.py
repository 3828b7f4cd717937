"""Real contacts that hold the motion: point, normal and force."""

from __future__ import annotations

import numpy as np

from wiggleroom.analysis.answer import Contact
from wiggleroom.analysis.touch import Touch
from wiggleroom.assembly.model import Assembly
from wiggleroom.program import kernel
from wiggleroom.program.build import Program

WEAK = 1e-5
"""Contacts with less than this share of the largest force are not reported."""


def contacts(assembly: Assembly, program: Program, u: np.ndarray, touch: Touch) -> tuple[Contact, ...]:
    """Contacts at u (3F,) in assembly coordinates, strongest first."""
    bodies, cells, shapes = program.bodies, program.cells, program.bodies.shapes
    pose = bodies.rest + program.motion(u)
    turned, name = (np.cos(pose[:, 2]), np.sin(pose[:, 2])), assembly.names
    out = []
    virtual = touch.virtual
    for k in np.argsort(-touch.force, kind="stable"):
        if virtual[k] or touch.force[k] < WEAK * touch.force.max():
            continue
        row, pair = touch.row[k], touch.pair[k]
        a, b = int(cells.a[pair]), int(cells.b[pair])
        edge, corner = cells.edge[row], cells.corner[row]
        owner, other = (a, b) if cells.kind[row] == kernel.A_EDGE else (b, a)
        c, s = turned
        x, y = shapes.corner[corner]
        point = (pose[other, 0] + c[other] * x - s[other] * y, pose[other, 1] + s[other] * x + c[other] * y)
        nx, ny = shapes.normal[edge]
        names = (
            name[bodies.members[owner][shapes.member[edge]]],
            name[bodies.members[other][shapes.member[corner]]],
        )
        normal = (c[owner] * nx - s[owner] * ny, s[owner] * nx + c[owner] * ny)
        if owner == b:
            names, normal = names[::-1], (-normal[0], -normal[1])
        out.append(
            Contact(
                names, (float(point[0]), float(point[1])), (float(normal[0]), float(normal[1])), float(touch.force[k])
            )
        )
    return tuple(out)
