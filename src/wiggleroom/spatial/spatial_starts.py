"""Beyond the nearest local optimum in space: climbs from places that random pulls lead to.

Source: multistart, Boender and Rinnooy Kan 1987.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.search.global_search import SearchEffort, effort
from wiggleroom.spatial.planes.spatial_objectives import Displacement, SumOfTerms
from wiggleroom.spatial.rigid import RigidBodies
from wiggleroom.spatial.spatial_search import SearchEnd, SpatialSearch
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]

BETTER = 1e-6
"""An end counts as better where it is so by this share."""
ONE_BODY = 0.5
"""Share of the random pulls that are at one body alone."""


@dataclass(frozen=True, eq=False)
class BestOfStarts:
    """The best end of several climbs.

    Parameters
    ----------
    end : SearchEnd
        Its path begins at rest.
    effort : SearchEffort or None
        How the ends compare; None where there was one climb alone, or nothing stops the motion.
    iterations, rounds : int
        What the climb to the best end took.
    seed : int or None
        Of the random pull that leads to where that climb began; None where it began at rest.
    """

    end: SearchEnd
    effort: SearchEffort | None
    iterations: int
    rounds: int
    seed: int | None = None


def best_of_starts(first: SpatialSearch, end: SearchEnd, seeds: Iterable[int]) -> BestOfStarts:
    """The best end of a climb that was made and of more, each from where a random pull leads.

    Parameters
    ----------
    first : SpatialSearch
        The climb from rest, done.
    end : SearchEnd
        Where it ended.
    seeds : iterable of int
        Of the random pulls of the further climbs. A climb that comes to no end does not count in the effort.
    """
    best = BestOfStarts(end, None, first.iterations, first.rounds)
    value = first.value(end)
    ends = [value]
    for seed in seeds:
        if not _held(end) or (first.stop is not None and first.stop.is_set()):
            break
        found = _climbed(first, seed)
        if found is None:
            continue
        reached = first.value(found.end)
        if not _held(found.end):
            return found
        ends.append(reached)
        if reached > value + BETTER * abs(value):
            best, value = found, reached
    return replace(best, effort=effort(ends, value)) if len(ends) > 1 else best


def _held(end: SearchEnd) -> bool:
    """True where the motion has an end."""
    return end.found.status is not SolverStatus.ESCAPING and not end.leaving and not end.turning


def _climbed(first: SpatialSearch, seed: int) -> BestOfStarts | None:
    """A climb from somewhere on the path of a random pull; None where it came to no end."""
    ready, rng = first.ready, np.random.default_rng(seed)
    pull = _random_pull(ready.grouping.bodies, rng)
    lead = SpatialSearch(ready, pull, first.stop, None, once=True).run().path
    near = np.abs(lead[:, :, :3]).max(axis=(1, 2)) <= ready.size
    last = int(rng.integers(1, max(2, int(near.sum()))))
    if len(lead) < 2 or not near[:last].all():
        return None
    lead = lead[: last + 1]
    climb = SpatialSearch(
        ready, first.objective, first.stop, first.tell, ready.grouping.pose_of(lead[-1]), first.solver, once=True
    )
    end = climb.run()
    if not end.good:
        return None
    whole = replace(end, path=np.concatenate([lead, end.path[1:]]))
    return BestOfStarts(whole, None, climb.iterations, climb.rounds, seed)


def _random_pull(bodies: RigidBodies, rng: np.random.Generator) -> SumOfTerms:
    """Pulls at random points of one body that moves, or of all."""
    moving = np.flatnonzero(bodies.moves)
    chosen = rng.choice(moving, 1) if rng.random() < ONE_BODY else moving
    terms = [
        Displacement(int(b), bodies.radius[b] * rng.normal(size=3), rng.normal(size=3), bodies.at[b]) for b in chosen
    ]
    return SumOfTerms(tuple(terms))
