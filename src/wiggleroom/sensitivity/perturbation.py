"""The same question with outlines a little larger or smaller.

Walls are linear in the displacement of outlines, so pairs and free spaces of a prepared assembly are used again with
their walls moved. `objective_in_same_walls` solves the last program of an answer once more: what derivatives need.
`perturbed_objective` goes through the rounds of the search with the moved cells, from rest and from the end that a global search found:
for changes of any size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.offset_bodies import offset_bodies
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.maximise import witness
from wiggleroom.program.gap_sensitivity import carried
from wiggleroom.program.nonlinear_program import Program, build_program
from wiggleroom.program.objectives import Objective
from wiggleroom.search.answer import Answer
from wiggleroom.search.global_search import MAX_BODIES
from wiggleroom.search.incumbent import Incumbent, Start, start_at_rest
from wiggleroom.search.local_search import LocalSearch
from wiggleroom.search.moves import WITHOUT_BRANCHES
from wiggleroom.search.prepare import Prepared
from wiggleroom.sensitivity.found_motion import FoundMotion, endless, verdict_of
from wiggleroom.solve.interior_point import solve
from wiggleroom.solve.solution import Solution
from wiggleroom.verdict import SolverStatus, Verdict

Floats = NDArray[np.float64]

SAME_VALUE = 1e-3
"""Objectives that differ by less than this share are the same end."""
UNUSUAL_GAIN = 0.25
"""A perturbed objective that is larger by more than this share is worked out anew, its path audited."""
FINE_TOLERANCE = 1e-10
"""Relative tolerance of the objective of a program solved for a difference."""


@dataclass(frozen=True)
class PerturbedObjective:
    """Largest objective with other outlines.

    Parameters
    ----------
    value : float
        nan where there is none, infinity where nothing stops the motion.
    verdict : Verdict
        TOUCHING where parts do not fit beside each other at rest, NOT_MAKEABLE where parts are gone or fall to pieces; STOPPED: the
        largest safe motion that was found, none where no free space was found round rest.
    """

    value: float
    verdict: Verdict


@dataclass(frozen=True, eq=False)
class PerturbationBase:
    """The last program of an answer, solved as finely as its variations will be.

    Parameters
    ----------
    ready : Prepared
    program : Program
    solution : Solution
        Its multipliers are in units of the objective per `program.length`.
    inner : (n, 3) float64 [mm, mm, rad]
        Motion inside all rows where variations begin.
    value : float
        Objective.
    """

    ready: Prepared
    program: Program
    solution: Solution
    inner: Floats
    value: float


def is_searched(assembly: Assembly) -> bool:
    """True where a direct question does more than climb from rest: where few bodies move."""
    return sum(not p.fixed for p in assembly.parts) <= MAX_BODIES


def exceeds(found: FoundMotion, known: FoundMotion | None) -> bool:
    """Whether a motion is larger than the one that is known, if any is."""
    if known is None or found.objective is None:
        return known is None or known.objective is not None
    return known.objective is not None and found.objective > (1 + SAME_VALUE) * known.objective


def searched_answer(
    question: Assembly | Prepared, goals: Goal | Sequence[Goal] | None, context: Context = UNLIMITED
) -> Answer:
    """The largest motion as a direct question finds it, without a bound; in assemblies of many bodies that of a climb from rest."""
    few = is_searched(question if isinstance(question, Assembly) else question.assembly)
    answer = witness(question, goals, search=None if few else 0, context=context.silent)
    if not few or answer.objective is None or answer.warm_start is not None:
        return answer
    climb = witness(question, goals, context=context.silent)  # of the other one nothing is known to go on from
    return climb if climb.objective is None or climb.objective >= (1 - SAME_VALUE) * answer.objective else answer


def varied(assembly: Assembly, inward: Floats) -> Assembly:
    """The assembly, made anew with the outline of each part moved inward by `inward` (parts,) [mm]."""
    return assemble(
        assembly.drawing, offset={name: -float(x) for name, x in zip(assembly.names, inward, strict=True) if x}
    )


def ended(answer: Answer) -> Incumbent:
    """How the motion of an answer was found.

    Raises
    ------
    InputError
        If the motion has no end, or the search was cut short.
    """
    if not can_be_ranked(answer):
        raise endless(answer)
    found: Incumbent = answer.warm_start
    return found


def can_be_ranked(answer: Answer) -> bool:
    """True where the motion ends, with multipliers that say what each contact is worth."""
    found: Incumbent | None = answer.warm_start
    return found is not None and answer.objective is not None and found.solution.status is SolverStatus.CONVERGED


def base(ready: Prepared, found: Incumbent) -> PerturbationBase:
    """What variations start from: the last program of a search, solved to ten digits."""
    program, solution = found.program, found.solution
    finer = solve(program, solution.inner, mu=solution.inner_mu, tolerance=FINE_TOLERANCE)
    solution = finer if finer.status is SolverStatus.CONVERGED else solution
    value = program.objective.value(program.motion(solution.u))
    return PerturbationBase(ready, program, solution, program.motion(found.solution.inner), value)


def objective_in_same_walls(base: PerturbationBase, inward: Floats) -> float:
    """Objective in the walls of an answer when the outline of each part moves inward by `inward` (parts,) [mm].

    Meant for displacements far below the gap. nan where the walls do not do any more: no solution, parts overlap, or an edge is lost.
    """
    found = _in_same_walls(base, inward)
    return np.nan if found is None else _objective(*found)


def _objective(program: Program, solution: Solution) -> float:
    return program.objective.value(program.motion(solution.u))


def _in_same_walls(base: PerturbationBase, inward: Floats) -> tuple[Program, Solution] | None:
    """The last program of an answer with moved walls, solved; None where the walls do not do any more."""
    old = base.program
    try:
        bodies = offset_bodies(old.bodies, inward)
    except InputError:
        return None
    program = build_program(bodies, carried(old.cells, old.bodies, bodies), old.objective, length=old.length)
    solution = solve(program, program.variables(base.inner), mu=base.solution.inner_mu, tolerance=FINE_TOLERANCE)
    if solution.status is not SolverStatus.CONVERGED or _overlap(bodies, program.motion(solution.u), base.ready):
        return None
    return program, solution


def _overlap(bodies: Bodies, motion: Floats, ready: Prepared) -> bool:
    """True where bodies overlap at a motion (n, 3)."""
    return bool(overlaps(bodies, motion, ready.ignored).deepest > OVERLAP_TOLERANCE * ready.size)


def perturbed_objective(
    ready: Prepared,
    objective: Objective,
    goals: tuple[Goal, ...],
    inward: Floats,
    usual: float = np.inf,
    ends: tuple[PerturbationBase, ...] = (),
) -> PerturbedObjective:
    """Largest objective when the outline of each part moves inward by `inward` (parts,) [mm]; negative moves it out.

    The end of the motion is free of overlap by exact geometry. Other sides of corner contacts are not tried and the path
    from rest is not checked: one answer of `flex` for the middle of many perturbations does that. Where the moved cells do
    not lead to an optimum, or an outline loses an edge, everything is worked out anew; so too where it leads to much more than
    `usual`, the objective without perturbation: then the path may go through parts. `ends` are optima that are known without
    perturbation; the rounds begin there too, and the largest of all counts.
    """
    most = (1 + UNUSUAL_GAIN) * usual
    climbed = _climbed_from_rest(ready, objective, goals, inward, most)
    for end in ends if np.isfinite(climbed.value) else ():
        first = _in_same_walls(end, inward)
        if first is None:
            continue
        found = _gone_on(end, *first)
        beyond = found.value if found is not None and found.value <= most else _objective(*first)
        if beyond > climbed.value:
            climbed = PerturbedObjective(float(beyond), Verdict.OPTIMAL)
    return climbed


def _gone_on(end: PerturbationBase, program: Program, solution: Solution) -> Incumbent | None:
    """Where the rounds of the search lead from the end of an answer, solved in its moved walls; None where they come to no end."""
    inner = solution.inner
    if not (program.values(inner) > 0).all():  # where it began, outside the moved walls
        if not solution.path:
            return None
        inner = solution.path[-1]
    moved = replace(end.ready, bodies=program.bodies)
    start = Start(program.cells, program.motion(inner), mu=solution.inner_mu)
    return _converged(LocalSearch(moved, program.objective, solve, WITHOUT_BRANCHES), start)


def _converged(finder: LocalSearch, start: Start) -> Incumbent | None:
    """The optimum that a search comes to; None where that is none, or one where parts overlap."""
    found = finder.improve(start)
    if found is None or finder.unlimited or found.solution.status is not SolverStatus.CONVERGED:
        return None
    return None if _overlap(finder.ready.bodies, found.motion, finder.ready) else found


def _climbed_from_rest(
    ready: Prepared, objective: Objective, goals: tuple[Goal, ...], inward: Floats, most: float
) -> PerturbedObjective:
    """Where a climb with the moved cells ends, or one with all anew: where they lead to no optimum, or to more than `most`."""
    try:
        bodies = offset_bodies(ready.bodies, inward)
    except InputError:
        return perturbed_objective_anew(ready.assembly, goals, inward)
    if overlaps(bodies, np.zeros_like(bodies.rest), ready.ignored).deepest > 0:
        return PerturbedObjective(np.nan, Verdict.TOUCHING)
    moved = replace(ready, bodies=bodies, cells=carried(ready.cells, ready.bodies, bodies))
    found = _converged(LocalSearch(moved, objective, solve, WITHOUT_BRANCHES), start_at_rest(moved))
    if found is None or found.value > most:
        return perturbed_objective_anew(ready.assembly, goals, inward)
    return PerturbedObjective(found.value, Verdict.OPTIMAL)


def perturbed_objective_anew(assembly: Assembly, goals: tuple[Goal, ...], inward: Floats) -> PerturbedObjective:
    """The same as `perturbed_objective` by a climb from rest, its path audited, with pairs and free spaces worked out anew."""
    try:
        answer = witness(varied(assembly, inward), goals)
    except InputError as why:
        return PerturbedObjective(np.nan, verdict_of(why))
    if answer.objective is None:
        return PerturbedObjective(np.inf, Verdict.UNBOUNDED)
    return PerturbedObjective(answer.objective, answer.verdict)
