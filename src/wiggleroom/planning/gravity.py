"""Which loose parts fall by their weight, and which to hold so that none does, in the plane and in space.

All loose parts sink in small steps. Each step is a linear program: it finds the largest loss of height, weighted by area or volume, that
distances between bodies allow. Every motion has a small cost, so that what would lose no height stays. Parts first settle by the clearance
that they have; those that still sink after many steps fall. There is no friction, and no momentum. Source: Whiting, Ochsendorf and Durand,
"Procedural modeling of structurally-sound masonry buildings", 2009, for equilibrium as a program over contacts; here is its dual.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.errors import InputError
from wiggleroom.planning.steps import Step

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

STEPS = 24
"""Number of steps in which parts sink. What comes to rest before the second half of them has settled."""
TRUST = 0.5
"""In a step corners go no further than about this multiple of the clearance."""
MARGIN = 0.1
"""Parts come no nearer to each other than this multiple of the clearance."""
MIN_DESCENT = 0.02
"""Cost of a motion, as a share of its length: slopes of one degree count as level."""
SETTLED = 0.05
"""A part that sinks by less than this multiple of the clearance in the second half of the steps is at rest."""
STATES_PER_PIECE = 3
"""Number of states at which each straight piece of a step is looked at."""


@dataclass(frozen=True, eq=False)
class Distances:
    """Distances of bodies from each other, linear in small changes.

    Parameters
    ----------
    value : (r,) float64 [mm]
    slope : (r, k f) sparse
        By the changes of the free bodies.
    by_planes : (r, e) sparse
        By how far planes that part two bodies are tilted and moved [mm]; e is 0 where none are.
    """

    value: Floats
    slope: sp.csr_matrix
    by_planes: sp.csr_matrix


class FallingBodies(Protocol):
    """Bodies of one assembly, as gravity asks for them.

    A change of a body is counted in [mm], f numbers of it: displacements, and turns by how far they take its furthest corner.

    Parameters
    ----------
    names : tuple of str
        Of the parts (n,).
    body_of : (n,) int64
    fixed : (m,) bool
    clearance : float [mm]
        Typical clearance.
    """

    names: tuple[str, ...]
    body_of: Ints
    fixed: Bools
    clearance: float

    def poses(self, motion: Floats) -> Any:
        """Poses of the bodies where a motion of the parts has taken them."""

    def key(self, poses: Any, here: Bools) -> bytes:
        """Poses of the bodies that are here, to be known again."""

    def places(self, poses: Any) -> Floats:
        """Centroids (m, d) [mm] of the bodies."""

    def weights(self, who: Ints) -> Floats:
        """Weights (k,) of some bodies."""

    def freedoms(self, who: Ints) -> Bools:
        """Which changes (k, f) they may make."""

    def distances(self, poses: Any, here: Bools, free: Ints, reach: float) -> Distances:
        """Distances below `reach` [mm] between the free bodies and all that are here."""

    def changed(self, poses: Any, free: Ints, change: Floats) -> Any:
        """Poses after a change (k, f) of the free bodies."""

    def stay_apart(self, poses: Any, later: Any, here: Bools, free: Ints) -> bool:
        """Whether the free bodies meet nothing between poses that are near each other."""


@dataclass(eq=False)
class Gravity:
    """Falling among the parts of one assembly.

    Parameters
    ----------
    bodies : FallingBodies
        One of them at least stands.
    direction : (2,) or (3,) float
        In which loose parts fall; any length but zero.

    Raises
    ------
    InputError
        If the direction is none.
    """

    bodies: FallingBodies
    direction: tuple[float, ...]
    _known: dict[bytes, Bools] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        self.direction = unit_direction(self.direction)

    def falling(self, motion: Floats, there: Bools, held: Bools, context: Context = UNLIMITED) -> Bools:
        """Parts (n,) that fall.

        Parameters
        ----------
        motion : (n, 3) float64 [mm, mm, rad], in space (n, 6)
            Where the parts are, about their reference points.
        there : (n,) bool
            Parts that have not left.
        held : (n,) bool
            Parts that are held; what is fixed stands anyway.
        context : Context, optional
        """
        bodies, body_of = self.bodies, self.bodies.body_of
        count = len(bodies.fixed)
        here = np.array([there[body_of == b].all() for b in range(count)])
        stands = bodies.fixed | np.array([held[body_of == b].any() for b in range(count)])
        free = np.flatnonzero(here & ~stands)
        out = np.zeros(len(there), dtype=np.bool_)
        if not len(free):
            return out
        begin = bodies.poses(motion)
        key = bodies.key(begin, here) + here.tobytes() + free.tobytes()
        if key not in self._known:
            self._known[key] = np.isin(body_of, free[self._sinking(begin, here, free, context)])
        return self._known[key]

    def to_hold(self, step: Step, context: Context = UNLIMITED) -> tuple[str, ...]:
        """Names of parts that somebody must hold during a step, besides those that move, so that nothing falls.

        Those that lie lowest are held first: others may rest on them.
        """
        names = np.array(self.bodies.names, dtype=object)
        return tuple(names[self._held(list(_states(step)), step.there, np.isin(names, step.parts), context)])

    def holding_cost(self, motion: Floats, there: Bools, leaving: Ints, context: Context = UNLIMITED) -> int:
        """How many parts somebody must hold once some have left from a state, so that nothing falls."""
        there = there.copy()
        there[leaving] = False
        return int(self._held([motion], there, np.zeros(len(there), dtype=np.bool_), context).sum())

    def _held(self, states: list[Floats], there: Bools, moving: Bools, context: Context) -> Bools:
        """Parts (n,) to hold so that in some states nothing falls; what moves is held anyway."""
        held = np.zeros(len(there), dtype=np.bool_)
        for motion in states:
            while (falls := self.falling(motion, there, held | moving, context)).any():
                held[self._lowest(motion, np.flatnonzero(falls))] = True
        for k in np.flatnonzero(held):  # what was held first may be held up by what came later
            without = held.copy()
            without[k] = False
            if not any(self.falling(m, there, without | moving, context).any() for m in states):
                held = without
        return held

    def _lowest(self, motion: Floats, who: Ints) -> int:
        """Which of some parts has the centroid of its body lowest."""
        heights = self.bodies.places(self.bodies.poses(motion))[self.bodies.body_of[who]] @ np.array(self.direction)
        return int(who[int(heights.argmax())])

    def _sinking(self, poses: Any, here: Bools, free: Ints, context: Context) -> Bools:
        """Which of the `free` bodies still sink after many steps."""
        down, weight = np.array(self.direction), self.bodies.weights(free)
        weight = weight / weight.sum()
        sunk = np.zeros((STEPS + 1, len(free)))
        trust = TRUST * self.bodies.clearance
        for k in range(STEPS):
            if context.stopped:
                return np.ones(len(free), dtype=np.bool_)
            change, poses, trust = self._sink(poses, here, free, weight, trust)
            sunk[k + 1] = sunk[k] + change[:, : len(down)] @ down
            if not change.any():
                return np.zeros(len(free), dtype=np.bool_)
        half = STEPS // 2
        return np.asarray(sunk[-1] - sunk[half] > SETTLED * self.bodies.clearance)

    def _sink(self, poses: Any, here: Bools, free: Ints, weight: Floats, trust: float) -> tuple[Floats, Any, float]:
        """One step, shorter where a longer one would meet something, the poses after it, and how long the next one may be."""
        most = TRUST * self.bodies.clearance
        while trust > 1e-3 * most:
            change = self._program(poses, here, free, weight, trust)
            if not change.any():
                return change, poses, trust
            later = self.bodies.changed(poses, free, change)
            if self.bodies.stay_apart(poses, later, here, free):
                return change, later, min(2 * trust, most)
            trust /= 4
        return np.zeros_like(change), poses, most

    def _program(self, poses: Any, here: Bools, free: Ints, weight: Floats, trust: float) -> Floats:
        """Change (k, f) [mm] by which the free bodies lose the most height."""
        from scipy.optimize import linprog  # slow to load

        near = self.bodies.distances(poses, here, free, 4 * trust)
        may = self.bodies.freedoms(free)
        planes = near.by_planes.shape[1]
        cost = np.zeros(may.shape)
        cost[:, : len(self.direction)] = -weight[:, None] * np.array(self.direction)
        effort = MIN_DESCENT * np.repeat(weight, may.shape[1])
        most = np.where(np.tile(may.ravel(), 2), trust, 0.0)
        # every change as the difference of two that are not negative, so that both ways cost effort
        found = linprog(
            np.concatenate([cost.ravel() + effort, effort - cost.ravel(), np.zeros(planes)]),
            A_ub=sp.hstack([-near.slope, near.slope, -near.by_planes], format="csr"),
            b_ub=np.maximum(near.value - MARGIN * self.bodies.clearance, 0.0),
            bounds=[*((0.0, x) for x in most.tolist()), *[(-2 * trust, 2 * trust)] * planes],
            method="highs",
        )
        if not found.success:
            return np.zeros(may.shape)
        moved = (found.x[: may.size] - found.x[may.size : 2 * may.size]).reshape(may.shape)
        moved[np.abs(moved) < 1e-6 * trust] = 0.0
        return np.asarray(moved)


def unit_direction(direction: Sequence[float]) -> tuple[float, ...]:
    """The direction in which parts fall, one long.

    Raises
    ------
    InputError
        If it is none.

    >>> unit_direction((0, -2))
    (0.0, -1.0)
    """
    length = float(np.linalg.norm(direction))
    if not 0 < length < np.inf:
        finding = f"gravity {tuple(direction)}: it must be a direction, as (0, -1)"
        raise InputError(finding)
    return tuple(x / length for x in direction)


def _states(step: Step) -> Iterator[Floats]:
    """States on the path of a step, from its beginning to its end."""
    yield step.path[0]
    for one, other in pairwise(step.path):
        for t in np.arange(1, STATES_PER_PIECE + 1) / STATES_PER_PIECE:
            yield one + t * (other - one)
