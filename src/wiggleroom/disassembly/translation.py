"""Who leaves by plain translation: the blocking graph of every direction, exact to the end of the path.

Body b is blocked by a along a direction where, moved on and on, it would run into a: somewhere a point of b's boundary lies behind a point
of a's on the same line of travel. Bodies that nobody else blocks, themselves apart, leave together: a set that no arc of the graph leads
out of. Source: Wilson and Latombe, "Geometric reasoning about mechanical assembly", 1994; strongly connected components.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.disassembly.translation_blocking import leaving
from wiggleroom.errors import Stop
from wiggleroom.freespace.slices import edges_of
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.placed_bodies import placed

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

EVEN_DIRECTIONS = 24
"""Directions evenly round, besides those of edges."""
MAX_EDGE_DIRECTIONS = 48
"""At most this many directions of edges are tried, the longest edges first."""
OVERLAP_NOISE = 1e-10
"""An overlap below this share of the drawing's size counts as none."""


@dataclass(frozen=True, eq=False)
class TranslationEscape:
    """Bodies `who` (k,) that leave together, without limit, along `direction` (2,), a unit vector."""

    who: Ints
    direction: Floats


def translation_escape(
    bodies: Bodies,
    motion: Floats,
    ground: int,
    ignored: Ints,
    size: float,
    group: Ints,
    stop: Stop | None = None,
) -> TranslationEscape | None:
    """The smallest set of bodies that leaves straight from where all are now, or None; parameters as for `translation_escapes`."""
    found = translation_escapes(bodies, motion, ground, ignored, size, group, stop=stop)
    return min(found, key=lambda e: len(e.who), default=None)


def translation_escapes(
    bodies: Bodies,
    motion: Floats,
    ground: int,
    ignored: Ints,
    size: float,
    group: Ints,
    thinner: float = 0.0,
    stop: Stop | None = None,
) -> list[TranslationEscape]:
    """Sets of bodies that leave straight from where all are now, the smallest one of every direction.

    Parameters
    ----------
    bodies : Bodies
    motion : (n, 3) float64 [mm, mm, rad]
        Where they are.
    ground : int
        The fixed body; all that are fixed belong to its group.
    ignored : (k,) int64
        Keys a * n + b of pairs that never collide.
    size : float [mm]
        Of the drawing.
    group : (n,) int64
        Bodies of the same number are known not to leave each other.
    thinner : float [mm]
        As if every outline lay further inward by this: who would leave if there were a little more room.
    stop : optional
        Asked before every direction; then those found so far are given.
    """
    n = len(bodies.fixed)
    geometry = placed(bodies, motion)
    near = _near(geometry, size)
    if thinner > 0:
        geometry = shapely.buffer(geometry, -thinner, join_style="mitre")
    edges, first = _edges(geometry)
    group = np.unique(group, return_inverse=True)[1].ravel()
    never = np.zeros((n, n), dtype=np.bool_)
    never[ignored // n, ignored % n] = never[ignored % n, ignored // n] = True
    found: list[TranslationEscape] = []
    who = np.zeros(n, dtype=np.bool_)
    for d in _directions(edges):
        if stop is not None and stop.is_set():
            break
        if leaving(edges, first, d, near, never, group, ground, size * OVERLAP_NOISE, who):
            found.append(TranslationEscape(np.flatnonzero(who), d))
    return found


def _directions(edges: Floats) -> Floats:
    """Unit vectors (k, 2): a fan, and both ways along the longest edges."""
    fan = 2 * np.pi * np.arange(EVEN_DIRECTIONS) / EVEN_DIRECTIONS
    along = edges[:, 2:] - edges[:, :2]
    angle = np.arctan2(along[:, 1], along[:, 0]) % np.pi
    slot = np.round(angle / 1e-3).astype(np.int64)
    total = np.bincount(slot, weights=np.hypot(*along.T))
    longest = np.argsort(-total, kind="stable")[:MAX_EDGE_DIRECTIONS]
    exact = np.array([angle[np.flatnonzero(slot == s)[0]] for s in longest if total[s] > 0])
    angles = np.concatenate([fan, exact, exact + np.pi])
    return np.column_stack([np.cos(angles), np.sin(angles)])


def _edges(geometry: NDArray[np.object_]) -> tuple[Floats, Ints]:
    """Edges (m, 4) of all bodies one after the other, and where each begins (n + 1,)."""
    rows = [edges_of(material).reshape(-1, 4) for material in geometry]
    return np.concatenate([*rows, np.zeros((0, 4))]), np.cumsum([0, *map(len, rows)])


def _near(geometry: NDArray[np.object_], size: float) -> NDArray[np.bool_]:
    """Pairs (n, n) that lie close to each other: they decide most graphs."""
    i, j = shapely.STRtree(geometry).query(geometry, predicate="dwithin", distance=0.01 * size)
    near = np.zeros((len(geometry), len(geometry)), dtype=np.bool_)
    near[i, j] = True
    return near
