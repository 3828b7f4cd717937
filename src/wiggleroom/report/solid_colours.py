"""Parts in space as they are shown: their colours, and their surfaces where they have moved to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.statements import glue_groups
from wiggleroom.drawing.model import Drawing
from wiggleroom.spatial.rotations import exponential
from wiggleroom.spatial.spatial_model import SpatialAssembly, Surface

Floats = NDArray[np.float64]
Colour = tuple[int, int, int]
"""Red, green and blue, 0 to 255."""
FIXED = (201, 196, 188)
COLOURS = ((79, 129, 189), (192, 124, 62), (110, 160, 90), (150, 110, 170), (200, 160, 60), (80, 160, 165))


def part_colours(assembly: SpatialAssembly) -> list[Colour]:
    """Colours of the parts: grey what stands, one colour for what is glued together."""
    glued = glue_groups(Drawing((), glue=assembly.drawing.glue))
    still = {glued.get(p.name, p.name) for p in assembly.parts if p.fixed}
    known: dict[int | str, Colour] = {}
    found = []
    for part in assembly.parts:
        body = glued.get(part.name, part.name)
        found.append(FIXED if body in still else known.setdefault(body, COLOURS[len(known) % len(COLOURS)]))
    return found


def moved_surfaces(assembly: SpatialAssembly, motion: Floats) -> list[Surface]:
    """Surfaces of all parts in the world."""
    found = []
    turns = exponential(motion[:, 3:])
    for part, made, R, m, reference in zip(
        assembly.parts, assembly.made, turns, motion, assembly.reference, strict=True
    ):
        world = made.surface.vertices @ part.R.T + part.at
        found.append(Surface((world - reference) @ R.T + reference + m[:3], made.surface.faces))
    return found
