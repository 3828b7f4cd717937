"""Whether parts overlap at a motion, by booleans of their solids: shares nothing with the program."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Surface
from wiggleroom.spatial.bodies.rotations import exponential
from wiggleroom.spatial.overlaps.common_solid import least_width
from wiggleroom.spatial.solids.solid_boolean import solid_of, surface_of

Floats = NDArray[np.float64]


def free_pairs(assembly: Assembly) -> set[tuple[int, int]]:
    """Pairs of parts that may overlap: ignored, glued together, or both fixed."""
    index = {name: k for k, name in enumerate(assembly.names)}
    found = {(min(i, j), max(i, j)) for one, other in assembly.drawing.ignore if (i := index[one], j := index[other])}
    together = {k: frozenset((k,)) for k in index.values()}
    for names in assembly.drawing.glue:
        joined = frozenset().union(*(together[index[name]] for name in names))
        together |= dict.fromkeys(joined, joined)
    still = frozenset(k for k, p in enumerate(assembly.parts) if p.fixed)
    for group in {*together.values(), still}:
        found |= {(min(i, j), max(i, j)) for i in group for j in group if i != j}
    return found


def deepest_overlap(assembly: Assembly, motion: Floats) -> float:
    """Depth of the deepest overlap of two parts [mm] at a motion (n, 6) [mm, rad] of the parts; 0 where none overlap.

    The depth is the least width of the common solid across one of its faces.
    """
    import shapely

    R = exponential(motion[:, 3:])
    at = assembly.reference + motion[:, :3]
    placed = []
    for part, made, r, t, reference in zip(assembly.parts, assembly.solids, R, at, assembly.reference, strict=True):
        world = made.surface.vertices @ part.R.T + part.at
        placed.append(Surface((world - reference) @ r.T + t, made.surface.faces))
    low = np.array([s.vertices.min(axis=0) for s in placed])
    high = np.array([s.vertices.max(axis=0) for s in placed])
    flat = shapely.box(*low[:, :2].T, *high[:, :2].T)
    i, j = shapely.STRtree(flat).query(flat)
    keep = (i < j) & (low[i, 2] <= high[j, 2]) & (low[j, 2] <= high[i, 2])
    allowed = free_pairs(assembly)
    solids: dict[int, object] = {}
    deepest = 0.0
    for a, b in zip(i[keep].tolist(), j[keep].tolist(), strict=True):
        if (a, b) in allowed:
            continue
        one, other = (solids.setdefault(k, solid_of(placed[k])) for k in (a, b))
        common = one ^ other  # type: ignore[operator]
        if common.volume() > 0:
            deepest = max(deepest, *(least_width(surface_of(piece))[0] for piece in common.decompose()))
    return deepest
