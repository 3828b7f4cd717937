"""Plans: in which order and along which paths parts are taken apart, and, backwards, put together."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, require_planar
from wiggleroom.deadline import Deadline
from wiggleroom.disassembly.disassembly_sequence import disassemble
from wiggleroom.disassembly.interlock import with_ground
from wiggleroom.displayable import Drawable
from wiggleroom.errors import InputError, Stop
from wiggleroom.geometry.bodies import bodies
from wiggleroom.planning.gravity import Gravity
from wiggleroom.planning.path_improvement import improved_steps
from wiggleroom.planning.steps import Step, measured, steps_of
from wiggleroom.search.prepare import survey
from wiggleroom.search.progress import Progress, silent
from wiggleroom.verdict import Certainty, Separability

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Plan(Drawable):
    """How an assembly is taken apart, step by step; backwards it is how it is put together.

    Parameters
    ----------
    assembly : Assembly
    targets : tuple of names
        Parts that were to leave; empty where all were.
    verdict : Separability
        "comes apart" where all targets leave or, without targets, anything does; else what became of the parts that are left.
    certainty : Certainty
        A plan is proven: every step of it was checked for overlap. Without one: what shows that the parts stay.
    rest : Separability
        What became of the parts that are left.
    rest_certainty : Certainty
        What shows that.
    steps : tuple of Step
    level : tuple of int
        Moves up to the first removal, from there to the second, and so on: what is called the level of a burr. A move is one slide of one
        or more parts as one, or one motion that is no slide.
    remains : tuple of names
        Loose parts that were to leave and do not.
    states, turned : int
        How far the search went: states to which slides, and turns of single parts, led, and those in which every part was turned.
    questions, unanswered : int
        Largest motions that were searched, and how many of them found no end that is certain.
    whole : bool
        True where the states are all to which slides and such turns lead.
    seconds : float
    gravity : (2,) float64 or None
        Unit vector in which loose parts fall; None where that was not looked at.
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
    gravity: tuple[float, float] | None = None

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
        """Motions (k, n, 3) [mm, mm, rad] of all parts along the whole plan, from rest."""
        if not self.steps:
            return np.zeros((1, len(self.assembly.parts), 3))
        return np.concatenate([self.steps[0].path[:1], *(step.path[1:] for step in self.steps)])


def plan(
    assembly: Assembly,
    targets: Sequence[str] = (),
    *,
    gravity: tuple[float, float] | None = None,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
    seconds: float | None = None,
) -> Plan:
    """Plan how an assembly is taken apart: which parts leave, in which order, along which paths.

    Fixed parts stand; where none is fixed, the largest part stands.

    Parameters
    ----------
    assembly : Assembly
    targets : sequence of names, optional
        Only these are to leave; others leave only where they must.
    gravity : (x, y), optional
        Direction in which loose parts fall: every step then says whom to hold so that none does, and of the parts that could leave
        straight those leave first after which the fewest must be held.
    stop : optional
        Anything with `is_set()`; then the plan goes as far as was found.
    progress : callable, optional
        Told a `Progress` now and then.
    seconds : float, optional
        Time that it may take; then the same.

    Raises
    ------
    InputError
        If a target is unknown or fixed, there is only one body, or all are fixed; if gravity has no direction.
    TouchingError
        If two parts touch at rest.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = wr.plan(wr.patterns.chain(3, joint="finger", gap=0.02))
    >>> found.order, found.level
    ((('b3',), ('b2',)), (1, 1))
    """
    require_planar(assembly, "plan")
    began = time.perf_counter()
    limit = stop if seconds is None else Deadline(seconds, stop)
    standing = with_ground(assembly)
    targets = tuple(dict.fromkeys(targets))
    check_targets(standing, targets)
    weight = None if gravity is None else Gravity(standing, survey(standing), gravity)
    holding_cost = None if weight is None else partial(weight.holding_cost, stop=limit)
    done = disassemble(standing, targets=targets, holding_cost=holding_cost, stop=limit, tell=progress or silent)
    steps: tuple[Step, ...] = ()
    if done.departures:
        surveyed = survey(standing)
        steps = improved_steps(standing, surveyed, steps_of(standing, done.departures), limit)
        steps = tuple(measured(standing, surveyed, step) for step in steps)
        if weight is not None:
            steps = tuple(replace(step, falling=weight.to_hold(step, limit)) for step in steps)
    gone = {standing.names[k] for d in done.departures for k in d.parts}
    them = bodies(standing)
    fixed = {standing.names[k] for k in np.flatnonzero(them.fixed[them.body_of])}
    remains = tuple(n for n in targets or standing.names if n not in gone and n not in fixed)
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
