"""Where parts in space stand in an exploded view."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.glue_groups import body_numbers
from wiggleroom.spatial.spatial_model import SpatialAssembly

Floats = NDArray[np.float64]


def exploded_offsets(assembly: SpatialAssembly) -> Floats:
    """How far each part (n, 3) [mm] is set aside in a view that doubles all distances from the middle; what is glued stays together.

    Other views take a multiple of it.
    """
    reference = assembly.reference
    corners = np.vstack([m.surface.vertices @ p.R.T + p.at for p, m in zip(assembly.parts, assembly.made, strict=True)])
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    body = np.array(body_numbers(assembly.names, assembly.drawing.glue))
    centre = np.array([reference[body == b].mean(axis=0) for b in body])
    return centre - middle
