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

from wiggleroom.compare.approximate import Approximation
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.freespace.translations import OVERLAP_NOISE, edges_of_all, translation_directions
from wiggleroom.geometry.neighbours import ignored_matrix
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.translation_blocking import leaving
from wiggleroom.search.prepare import Prepared, Survey

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class TranslationEscape:
    """Bodies `who` (k,) that leave together, without limit, along `direction` (2,), a unit vector."""

    who: Ints
    direction: Floats


def translation_escape(
    ready: Survey | Prepared | Approximation, motion: Floats, ground: int, group: Ints, context: Context = UNLIMITED
) -> TranslationEscape | None:
    """The smallest set of bodies that leaves straight from where all are now, or None; parameters as for `translation_escapes`."""
    found = translation_escapes(ready, motion, ground, group, context=context)
    return min(found, key=lambda e: len(e.who), default=None)


def translation_escapes(
    ready: Survey | Prepared | Approximation,
    motion: Floats,
    ground: int,
    group: Ints,
    context: Context = UNLIMITED,
) -> list[TranslationEscape]:
    """Sets of bodies that leave straight from where all are now, the smallest one of every direction.

    Parameters
    ----------
    ready : Survey, Prepared or Approximation
    motion : (n, 3) float64 [mm, mm, rad]
        Where they are.
    ground : int
        The fixed body; all that are fixed belong to its group.
    group : (n,) int64
        Bodies of the same number are known not to leave each other.
    context : Context, optional
    """
    n, size = len(ready.bodies.fixed), ready.size
    geometry = placed(ready.bodies, motion)
    near = _near(geometry, size)
    edges, first = edges_of_all(geometry)
    group = np.unique(group, return_inverse=True)[1].ravel()
    never = ignored_matrix(ready.ignored, n)
    found: list[TranslationEscape] = []
    who = np.zeros(n, dtype=np.bool_)
    for d in translation_directions(edges):
        if context.stopped:
            break
        if leaving(edges, first, d, near, never, group, ground, size * OVERLAP_NOISE, who):
            found.append(TranslationEscape(np.flatnonzero(who), d))
    return found


def _near(geometry: NDArray[np.object_], size: float) -> NDArray[np.bool_]:
    """Pairs (n, n) that lie close to each other: they decide most graphs."""
    i, j = shapely.STRtree(geometry).query(geometry, predicate="dwithin", distance=0.01 * size)
    near = np.zeros((len(geometry), len(geometry)), dtype=np.bool_)
    near[i, j] = True
    return near
