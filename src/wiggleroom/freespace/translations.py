"""Straight paths without end: the directions that are tried, and the edges that stop them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace.slices import edges_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

EVEN_DIRECTIONS = 24
"""Directions evenly round, besides those of edges."""
MAX_EDGE_DIRECTIONS = 48
"""At most this many directions of edges are tried, the longest edges first."""
OVERLAP_NOISE = 1e-10
"""An overlap below this share of the drawing's size counts as none."""


def translation_directions(edges: Floats) -> Floats:
    """Unit vectors (k, 2): a fan, and both ways along the longest of some edges (m, 4).

    Examples
    --------
    >>> len(translation_directions(np.array([[0.0, 0.0, 3.0, 1.0], [3.0, 1.0, 6.0, 2.0]])))
    26
    """
    fan = 2 * np.pi * np.arange(EVEN_DIRECTIONS) / EVEN_DIRECTIONS
    along = edges[:, 2:] - edges[:, :2]
    angle = np.arctan2(along[:, 1], along[:, 0]) % np.pi
    slot = np.round(angle / 1e-3).astype(np.int64)
    total = np.bincount(slot, weights=np.hypot(*along.T))
    longest = np.argsort(-total, kind="stable")[:MAX_EDGE_DIRECTIONS]
    exact = np.array([angle[np.flatnonzero(slot == s)[0]] for s in longest if total[s] > 0])
    angles = np.concatenate([fan, exact, exact + np.pi])
    return np.column_stack([np.cos(angles), np.sin(angles)])


def edges_of_all(geometry: NDArray[np.object_]) -> tuple[Floats, Ints]:
    """Edges (m, 4) of all bodies one after the other, and where each begins (n + 1,)."""
    rows = [edges_of(material).reshape(-1, 4) for material in geometry]
    return np.concatenate([*rows, np.zeros((0, 4))]), np.cumsum([0, *map(len, rows)])
