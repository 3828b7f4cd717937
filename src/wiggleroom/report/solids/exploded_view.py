"""Where parts in space stand in an exploded view."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, corners_at
from wiggleroom.drawing.writers.glue_groups import body_numbers

Floats = NDArray[np.float64]

CONCENTRIC = 0.02
"""Bodies whose centres are nearer to each other than this share of the assembly's diagonal stand one in another."""


def exploded_offsets(assembly: Assembly) -> Floats:
    """How far each part (n, 3) [mm] is set aside in a view that doubles all distances from the middle; what is glued stays together.

    Of bodies with one centre, like the sticks of a burr, the largest stays there and the others leave along their longest axes.
    Other views take a multiple of it.
    """
    body = np.array(body_numbers(assembly.names, assembly.drawing.glue))
    vertices = [corners_at(part) for part in assembly.parts]
    corners = [np.vstack([vertices[i] for i in np.flatnonzero(body == b)]) for b in range(body.max() + 1)]
    everything = np.vstack(vertices)
    middle = (everything.min(axis=0) + everything.max(axis=0)) / 2
    centre = np.array([assembly.reference[body == b].mean(axis=0) for b in range(len(corners))])
    near = CONCENTRIC * float(np.linalg.norm(np.ptp(everything, axis=0)))
    return (centre - middle + _leaving(corners, centre, near, everything))[body]


def _leaving(corners: list[Floats], centre: Floats, near: float, everything: Floats) -> Floats:
    """Further offsets (m, 3) [mm] of bodies that stand in a larger one: along their longest axes, to and fro in turn."""
    found = np.zeros_like(centre)
    sizes = np.array([np.linalg.norm(np.ptp(one, axis=0)) for one in corners])
    inside: dict[int, int] = {}  # bodies that have left one already
    order = np.argsort(-sizes, kind="stable").tolist()
    for place, b in enumerate(order):
        outer = next((a for a in order[:place] if np.linalg.norm(centre[a] - centre[b]) < near), None)
        if outer is None:
            continue
        axis = np.linalg.svd(corners[b] - corners[b].mean(axis=0), full_matrices=False)[2][0]
        axis *= np.sign(axis[np.abs(axis).argmax()])
        far = float(np.ptp(everything @ axis) + np.ptp(corners[b] @ axis)) / 2
        turn = inside[outer] = inside.get(outer, 0) + 1
        found[b] = axis * far * ((turn + 1) // 2) * (1 if turn % 2 else -1)
    return found
