"""Plans: in which order and along which paths parts are taken apart, and, backwards, put together."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import Context
from wiggleroom.disassembly.ground import with_ground
from wiggleroom.displayable import Drawable
from wiggleroom.errors import InputError
from wiggleroom.planning.gravity import Gravity
from wiggleroom.planning.plan_geometry import PlanGeometry
from wiggleroom.planning.steps import Step, steps_of
from wiggleroom.verdict import Certainty, Separability

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Plan(Drawable):
    """A disassembly step by step; backwards it is the assembly.

    Parameters
    ----------
    assembly : Assembly
    targets : tuple of names
        Parts to remove; empty for all.
    verdict : Separability
        "comes apart" if all targets leave or, without targets, anything does; else the verdict on the remaining parts.
    certainty : Certainty
        A plan is proven: every step was checked for overlap. Without one, the certainty of the verdict.
    rest : Separability
        Verdict on the remaining parts.
    rest_certainty : Certainty
        Certainty of that verdict.
    steps : tuple of Step
    level : tuple of int
        Moves up to the first removal, from there to the second, and so on: the level of a burr. A move is one slide of one or more parts
        as one, or one motion that is no slide.
    remains : tuple of names
        Loose parts that should leave and do not.
    states, turned : int
        Extent of the search: states reached by slides and by turns of single parts, and those in which every part was turned.
    questions, unanswered : int
        Numbers of searched largest motions, and of those without a certain end.
    whole : bool
        True if these are all states that slides and such turns reach.
    seconds : float
    gravity : (2,) or (3,) float or None
        Unit vector in which loose parts fall; None without gravity.
    """

    assembly: Assembly
    targets: tuple[str, ...]
    verdict: Separability
    certainty: Certainty
    rest: Separability
    rest_certainty: Certainty
    steps: tuple[Step, ...]
    level: tuple[int, ...]
    remains: tuple[str, ...]
    states: int
    turned: int
    questions: int
    unanswered: int
    whole: bool
    seconds: float
    gravity: tuple[float, ...] | None = None

    @property
    def moves(self) -> int:
        """Moves of the whole plan."""
        return sum(step.moves for step in self.steps)

    @property
    def order(self) -> tuple[tuple[str, ...], ...]:
        """Names of the parts that leave together, in the order of leaving."""
        return tuple(step.leaves for step in self.steps if step.leaves)

    @property
    def path(self) -> Floats:
        """Motions (k, n, 3) [mm, mm, rad] of all parts along the whole plan, from rest; in space (k, n, 6)."""
        if not self.steps:
            return np.zeros((1, len(self.assembly.parts), 3 * (self.assembly.dimension - 1)))
        return np.concatenate([self.steps[0].path[:1], *(step.path[1:] for step in self.steps)])


def plan(
    assembly: Assembly,
    targets: Sequence[str],
    geometry_of: Callable[[Assembly], PlanGeometry],
    gravity: tuple[float, ...] | None,
    context: Context,
) -> Plan:
    """Plan how an assembly is taken apart; see `wiggleroom.plan`.

    Parameters
    ----------
    assembly : Assembly
    targets : sequence of names
    geometry_of : callable
        What plans ask of an assembly in which something stands.
    gravity : (x, y) or (x, y, z), optional
    context : Context
    """
    began = time.perf_counter()
    targets = tuple(dict.fromkeys(targets))
    standing = with_ground(assembly)
    check_targets(standing, targets)
    geometry = geometry_of(standing)
    weight = None if gravity is None else Gravity(geometry.falling(), gravity)
    done = geometry.taken_apart(targets, weight, context)
    steps = tuple[Step, ...]()
    if done.departures:
        steps = tuple(map(geometry.measured, geometry.fitted(steps_of(standing, done.departures), context)))
    if weight is not None:
        steps = tuple(replace(step, falling=weight.to_hold(step, context)) for step in steps)
    gone = {standing.names[k] for d in done.departures for k in d.parts}
    bodies = geometry.falling()
    fixed = {standing.names[k] for k in np.flatnonzero(bodies.fixed[bodies.body_of])}
    loose = [name for name in targets or standing.names if name not in fixed]
    remains = tuple(name for name in loose if name not in gone or name in done.together)
    missed = bool(remains) if targets else not gone
    return Plan(
        assembly=assembly,
        targets=targets,
        verdict=done.last.ended if missed else Separability.COMES_APART,
        certainty=done.last.certainty if missed else Certainty.PROVEN,
        rest=done.last.ended,
        rest_certainty=done.last.certainty,
        steps=steps,
        level=level(steps),
        remains=remains,
        states=done.states,
        turned=done.turned,
        questions=done.questions,
        unanswered=done.unanswered,
        whole=done.last.whole,
        seconds=time.perf_counter() - began,
        gravity=None if weight is None else weight.direction,
    )


def level(steps: Sequence[Step]) -> tuple[int, ...]:
    """Moves up to each removal."""
    counts, count = [], 0
    for step in steps:
        count += step.moves
        if step.leaves:
            counts.append(count)
            count = 0
    return tuple(counts)


def check_targets(assembly: Assembly, targets: Sequence[str]) -> None:
    """Check that all targets are loose parts; raises InputError."""
    fixed = {p.name for p in assembly.parts if p.fixed}
    source = assembly.drawing.source or "the assembly"
    wrong = [f'{source}: target "{n}": there is no such part' for n in targets if n not in assembly.names]
    wrong += [f'{source}: target "{n}" stands, so it cannot leave; name a loose part' for n in targets if n in fixed]
    if wrong:
        raise InputError(wrong)
