"""Parts in space as they are shown: their colours, and their surfaces where they have moved to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Surface
from wiggleroom.drawing.writers.glue_groups import body_numbers
from wiggleroom.spatial.bodies.rotations import exponential

Floats = NDArray[np.float64]
Colour = tuple[int, int, int]
"""Red, green and blue, 0 to 255."""
FIXED = (201, 196, 188)
"""Of parts that stand."""
COLOURS = ((79, 129, 189), (192, 124, 62), (110, 160, 90), (150, 110, 170), (200, 160, 60), (80, 160, 165))
"""Of loose bodies, one after the other."""


def part_colours(assembly: Assembly) -> list[Colour]:
    """Colours of the parts: grey what stands, one colour for what is glued together."""
    body_of = body_numbers(assembly.names, assembly.drawing.glue)
    still = {body for body, part in zip(body_of, assembly.parts, strict=True) if part.fixed}
    known: dict[int, Colour] = {}
    return [FIXED if body in still else known.setdefault(body, COLOURS[len(known) % len(COLOURS)]) for body in body_of]


def moved_surfaces(assembly: Assembly, motion: Floats) -> list[Surface]:
    """Surfaces of all parts in the world."""
    found = []
    turns = exponential(motion[:, 3:])
    for part, made, R, m, reference in zip(
        assembly.parts, assembly.solids, turns, motion, assembly.reference, strict=True
    ):
        world = made.surface.vertices @ part.R.T + part.at
        found.append(Surface((world - reference) @ R.T + reference + m[:3], made.surface.faces))
    return found
