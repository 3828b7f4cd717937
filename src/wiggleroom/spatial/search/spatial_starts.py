"""Beyond the nearest local optimum in space: climbs from places that random pulls lead to.

Source: multistart, Boender and Rinnooy Kan 1987.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.search.global_search import SearchEffort, effort
from wiggleroom.spatial.bodies.rigid import RigidBodies
from wiggleroom.spatial.planes.spatial_objectives import Displacement, SumOfTerms
from wiggleroom.spatial.search.spatial_prepare import SpatialPrepared
from wiggleroom.spatial.search.spatial_search import SearchEnd, SpatialSearch
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]

BETTER = 1e-6
"""An end counts as better where it is so by this share."""
ONE_BODY = 0.5
"""Share of the random pulls that are at one body alone."""


DEFAULT_STARTS, FEW_BODIES = 6, 6
"""Climbs beside the one from rest where none are asked for: with at most so many free bodies, and as long as work is left."""
NEAR = 0.07
"""These begin at most this share of the assembly's size away from rest."""
WORK_BUDGET = 1e5
"""Work that these climbs may take, in iterations times rows of the program; or what the climb from rest took, if that is more."""


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
    lead : (k, n, 6) float64 [mm, rad]
        Path from rest to half way through that climb, where parts have room still; rest alone where the climb began there.
    """

    end: SearchEnd
    effort: SearchEffort | None
    iterations: int
    rounds: int
    lead: Floats


def best_of_starts(first: SpatialSearch, end: SearchEnd, leads: Iterable[Floats], *, once: bool) -> BestOfStarts:
    """The best end of a climb that was made and of more, each from the end of a path.

    Parameters
    ----------
    first : SpatialSearch
        The climb from rest, done.
    end : SearchEnd
        Where it ended.
    leads : iterable of (k, n, 6) float64 [mm, rad]
        Free paths from rest to where the further climbs begin. A climb that comes to no end does not count in the effort.
    once : bool
        Whether these climb in one way only, see `SpatialSearch`.
    """
    best = BestOfStarts(end, None, first.iterations, first.rounds, end.path[:1])
    value = first.value(end)
    ends = [value]
    if not is_held(end):
        return best
    for lead in leads:
        found = _climbed(first, lead, once)
        if found is None:
            continue
        reached = first.value(found.end)
        if not is_held(found.end):
            return found
        ends.append(reached)
        if reached > value + BETTER * abs(value):
            best, value = found, reached
    return replace(best, effort=effort(ends, value)) if len(ends) > 1 else best


def is_held(end: SearchEnd) -> bool:
    """True where the motion has an end."""
    return end.found.status is not SolverStatus.ESCAPING and not end.leaving and not end.turning


def random_leads(first: SpatialSearch, starts: int | None) -> Iterator[Floats]:
    """Paths (k, n, 6) from rest to somewhere on those of random pulls, from as many pulls as asked for, until it is asked to stop.

    By default a few, of assemblies of few free bodies, as long as the work of the climbs is within a budget. These stay near rest: what a
    part can do once it was taken out of its place is left to `check`, and to starts that are asked for.
    """
    ready = first.ready
    few = int(ready.grouping.bodies.moves.sum()) <= FEW_BODIES
    limit = max(WORK_BUDGET, first.work) + first.work if starts is None else np.inf
    for seed in range((DEFAULT_STARTS if few else 0) if starts is None else starts):
        if first.work > limit or first.context.stopped:
            return
        rng = np.random.default_rng(seed)
        pull = SpatialSearch(ready, _random_pull(ready.grouping.bodies, rng), first.context.silent, once=True)
        path = pull.run().path
        first.work += pull.work
        near = np.abs(path[:, :, :3]).max(axis=(1, 2)) <= (NEAR if starts is None else 1.0) * ready.size
        last = int(rng.integers(1, max(2, int(near.sum()))))
        if len(path) > 1 and near[:last].all():
            yield path[: last + 1]


def is_free(ready: SpatialPrepared, path: Floats) -> bool:
    """True where no two parts overlap anywhere along a path (k, n, 6)."""
    return not any(ready.checker.overlaps(*piece) for piece in itertools.pairwise(path))


def _climbed(first: SpatialSearch, lead: Floats, once: bool) -> BestOfStarts | None:
    """A climb from the end of a path; None where it came to no end."""
    begin = first.ready.grouping.pose_of(lead[-1])
    climb = SpatialSearch(first.ready, first.objective, first.context, begin, first.solver, once)
    end = climb.run()
    first.work += climb.work
    if not end.good:
        return None
    whole = replace(end, path=np.concatenate([lead, end.path[1:]]))
    half = len(lead) + len(end.path) // 2
    return BestOfStarts(whole, None, climb.iterations, climb.rounds, whole.path[:half])


def _random_pull(bodies: RigidBodies, rng: np.random.Generator) -> SumOfTerms:
    """Pulls at random points of one body that moves, or of all."""
    moving = np.flatnonzero(bodies.moves)
    chosen = rng.choice(moving, 1) if rng.random() < ONE_BODY else moving
    terms = [
        Displacement(int(b), bodies.radius[b] * rng.normal(size=3), rng.normal(size=3), bodies.at[b]) for b in chosen
    ]
    return SumOfTerms(tuple(terms))
