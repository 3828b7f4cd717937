"""Which loose parts fall by their weight, and which to hold so that none does.

All loose parts sink in small steps. Each step is a linear program: it finds the largest loss of height, weighted by area, that distances
of corners from edges allow. Every motion has a small cost, so that what would lose no height stays. Parts first settle by the clearance
that they have; those that still sink after many steps fall. There is no friction, and no momentum. Source: Whiting, Ochsendorf and Durand,
"Procedural modeling of structurally-sound masonry buildings", 2009, for equilibrium as a program over contacts; here is its dual.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.disassembly.clearance_program import ClearanceProblem, MovingBodies
from wiggleroom.errors import InputError, Stop
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.rigid_motions import of_bodies
from wiggleroom.planning.steps import Step
from wiggleroom.search.prepare import Survey

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


@dataclass(eq=False)
class Gravity:
    """Falling among the parts of one assembly.

    Parameters
    ----------
    assembly : Assembly
        Something in it stands.
    surveyed : Survey
        Of the assembly.
    direction : (x, y)
        In which loose parts fall; any length but zero.

    Raises
    ------
    InputError
        If the direction is none.
    """

    assembly: Assembly
    surveyed: Survey
    direction: tuple[float, float]
    _known: dict[bytes, Bools] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        length = float(np.hypot(*self.direction))
        if not 0 < length < np.inf:
            finding = f"gravity {self.direction}: it must be a direction, as (0, -1)"
            raise InputError(finding)
        self.direction = (self.direction[0] / length, self.direction[1] / length)

    def falling(self, motion: Floats, there: Bools, held: Bools, stop: Stop | None = None) -> Bools:
        """Parts (n,) that fall.

        Parameters
        ----------
        motion : (n, 3) float64 [mm, mm, rad]
            Where the parts are, about their reference points.
        there : (n,) bool
            Parts that have not left.
        held : (n,) bool
            Parts that are held; what is fixed stands anyway.
        stop : optional
            Asked before every step; then those that sink still count as falling.
        """
        bodies = self.surveyed.bodies
        here = np.array([there[list(m)].all() for m in bodies.members])
        stands = bodies.fixed | np.array([held[list(m)].any() for m in bodies.members])
        free = np.flatnonzero(here & ~stands)
        out = np.zeros(len(there), dtype=np.bool_)
        if not len(free):
            return out
        begin = of_bodies(self.assembly, bodies, motion[None])[0]
        key = np.round(begin[here], 9).tobytes() + here.tobytes() + free.tobytes()
        if key not in self._known:
            self._known[key] = np.isin(bodies.body_of, free[self._sinking(begin, here, free, stop)])
        return self._known[key]

    def to_hold(self, step: Step, stop: Stop | None = None) -> tuple[str, ...]:
        """Names of parts that somebody must hold during a step, besides those that move, so that nothing falls.

        Those that lie lowest are held first: others may rest on them.
        """
        names = np.array(self.assembly.names, dtype=object)
        return tuple(names[self._held(list(_states(step)), step.there, np.isin(names, step.parts), stop)])

    def holding_cost(self, motion: Floats, there: Bools, leaving: Ints, stop: Stop | None = None) -> int:
        """How many parts somebody must hold once some have left from a state, so that nothing falls."""
        there = there.copy()
        there[leaving] = False
        return int(self._held([motion], there, np.zeros(len(there), dtype=np.bool_), stop).sum())

    def _held(self, states: list[Floats], there: Bools, moving: Bools, stop: Stop | None) -> Bools:
        """Parts (n,) to hold so that in some states nothing falls; what moves is held anyway."""
        held = np.zeros(len(there), dtype=np.bool_)
        for motion in states:
            while (falls := self.falling(motion, there, held | moving, stop)).any():
                held[self._lowest(motion, np.flatnonzero(falls))] = True
        for k in np.flatnonzero(held):  # what was held first may be held up by what came later
            without = held.copy()
            without[k] = False
            if not any(self.falling(m, there, without | moving, stop).any() for m in states):
                held = without
        return held

    def _lowest(self, motion: Floats, who: Ints) -> int:
        """Which of some parts has the centroid of its body lowest."""
        bodies = self.surveyed.bodies
        at = bodies.rest + of_bodies(self.assembly, bodies, motion[None])[0]
        heights = at[bodies.body_of[who], :2] @ np.array(self.direction)
        return int(who[int(heights.argmax())])

    def _sinking(self, motion: Floats, there: Bools, free: Ints, stop: Stop | None) -> Bools:
        """Which of the `free` bodies still sink after many steps."""
        surveyed, down = self.surveyed, np.array(self.direction)
        weight = shapely.area(placed(surveyed.bodies, None, free)[free])
        problem = ClearanceProblem(
            surveyed.bodies,
            there,
            surveyed.ignored,
            surveyed.clearance,
            surveyed.size,
            MovingBodies(free, as_one=False),
        )
        sunk = np.zeros((STEPS + 1, len(free)))
        trust = TRUST * surveyed.clearance
        for k in range(STEPS):
            if stop is not None and stop.is_set():
                return np.ones(len(free), dtype=np.bool_)
            change, trust = self._sink(problem, motion, weight / weight.sum(), trust)
            motion = motion + change
            sunk[k + 1] = sunk[k] + change[free, :2] @ down
            if not change.any():
                return np.zeros(len(free), dtype=np.bool_)
        half = STEPS // 2
        return np.asarray(sunk[-1] - sunk[half] > SETTLED * surveyed.clearance)

    def _sink(self, problem: ClearanceProblem, motion: Floats, weight: Floats, trust: float) -> tuple[Floats, float]:
        """One step, shorter where a longer one would meet something, and how long the next one may be."""
        most = TRUST * problem.clearance
        while trust > 1e-3 * most:
            change = _program(problem, motion, weight, np.array(self.direction), trust)
            if not change.any():
                return change, trust
            if problem.least(np.stack([motion, motion + change])) > 0:
                return change, min(2 * trust, most)
            trust /= 4
        return np.zeros_like(motion), most


def _program(problem: ClearanceProblem, motion: Floats, weight: Floats, down: Floats, trust: float) -> Floats:
    """Motion (n, 3) [mm, mm, rad] of all bodies by which the free ones lose the most height."""
    from scipy.optimize import linprog  # slow to load
    from scipy.sparse import coo_array

    bodies, free = problem.bodies, problem.moving.who
    lever = bodies.radius[free]
    count = 3 * len(free)
    near = problem.near(bodies.rest + motion, 4 * trust)
    mine = problem.moving.numbers(len(motion))[near.who]
    r, side = np.nonzero(mine >= 0)
    slope = -near.gradient[r, side] / np.column_stack([np.ones((len(r), 2)), bodies.radius[near.who[r, side]]])
    column = 3 * mine[r, side][:, None] + np.arange(3)
    limit = np.maximum(near.distance - MARGIN * problem.clearance, 0.0)
    rows = coo_array((slope.ravel(), (np.repeat(r, 3), column.ravel())), shape=(len(limit), count)).tocsr()
    cost = np.zeros((len(free), 3))
    cost[:, :2] = -weight[:, None] * down
    effort = MIN_DESCENT * np.repeat(weight, 3)
    # every change as the difference of two that are not negative, so that both ways cost effort
    found = linprog(
        np.concatenate([cost.ravel() + effort, effort - cost.ravel()]),
        A_ub=np.hstack([rows.toarray(), -rows.toarray()]),
        b_ub=limit,
        bounds=(0.0, trust),
        method="highs",
    )
    change = np.zeros_like(motion)
    if found.success:
        moved = (found.x[:count] - found.x[count:]).reshape(-1, 3)
        moved[np.abs(moved) < 1e-6 * trust] = 0.0
        change[free] = np.column_stack([moved[:, :2], moved[:, 2] / lever])
    return change


def _states(step: Step) -> Iterator[Floats]:
    """States on the path of a step, from its beginning to its end."""
    yield step.path[0]
    for one, other in pairwise(step.path):
        for t in np.arange(1, STATES_PER_PIECE + 1) / STATES_PER_PIECE:
            yield one + t * (other - one)
