"""The same question with outlines a little larger or smaller.

Walls are linear in the displacement of outlines, so pairs and free spaces of a prepared assembly are used again with
their walls moved. `follow` solves the last program of an answer once more: what derivatives need. `search` begins at
rest with the moved cells and goes through the rounds of the search: for changes of any size.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.analysis.answer import Answer
from wiggleroom.analysis.overlap import SAFE, overlaps
from wiggleroom.analysis.prepare import Prepared
from wiggleroom.analysis.search import FAR, Found, Progress, Search
from wiggleroom.errors import InputError
from wiggleroom.pairs.moved import moved
from wiggleroom.program.build import Program, build
from wiggleroom.program.gaps import carried
from wiggleroom.program.objectives import Objective
from wiggleroom.solve.interior_point import Solution, Stop, solve

Floats = NDArray[np.float64]

FINE = 1e-10
"""Share of the objective that a program solved for a difference may leave on the table."""


@dataclass(frozen=True)
class Varied:
    """Largest objective with other outlines.

    Parameters
    ----------
    value : float
        nan where there is none, infinity where nothing stops the motion.
    how : str
        "bounded", "unbounded", "touching" where parts do not fit beside each other at rest, or "failed".
    """

    value: float
    how: str


@dataclass(frozen=True, eq=False)
class Base:
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


def ended(answer: Answer) -> Found:
    """How the motion of an answer was found.

    Raises
    ------
    InputError
        If the motion has no end, or the search was cut short.
    """
    found = answer.trail
    if not isinstance(found, Found) or answer.objective is None or found.solution.status != "converged":
        why = "nothing stops the motion" if answer.objective is None else "the search for its motion was cut short"
        finding = f"{answer.assembly.drawing.source or 'the assembly'}: {why}, so no gap can be held against it"
        raise InputError(finding)
    return found


def base(ready: Prepared, found: Found) -> Base:
    """What variations start from: the last program of a search, solved to ten digits."""
    program, solution = found.program, found.solution
    finer = solve(program, solution.inner, mu=solution.inner_mu, tolerance=FINE)
    solution = finer if finer.status == "converged" else solution
    value = program.objective.value(program.motion(solution.u))
    return Base(ready, program, solution, program.motion(found.solution.inner), value)


def follow(base: Base, inward: Floats) -> float:
    """Objective in the walls of an answer when the outline of each part moves inward by `inward` (parts,) [mm].

    Meant for displacements far below the gap. nan where the walls do not do any more: no solution, or parts overlap.
    """
    old = base.program
    bodies = moved(old.bodies, inward)
    program = build(bodies, carried(old.cells, old.bodies, bodies), old.objective, length=old.length)
    solution = solve(program, program.variables(base.inner), mu=base.solution.inner_mu, tolerance=FINE)
    motion = program.motion(solution.u)
    overlapping = overlaps(bodies, motion, base.ready.barred).deepest > SAFE * base.ready.size
    return np.nan if solution.status != "converged" or overlapping else program.objective.value(motion)


def search(ready: Prepared, objective: Objective, inward: Floats, stop: Stop | None = None) -> Varied:
    """Largest objective when the outline of each part moves inward by `inward` (parts,) [mm]; negative moves it out.

    The end of the motion is free of overlap by exact geometry. Other sides of corner contacts are not tried and the way
    from rest is not checked: one answer of `flex` for the middle of many variations does that.

    Raises
    ------
    InputError
        If an outline would lose an edge.
    """
    bodies = moved(ready.bodies, inward)
    if overlaps(bodies, np.zeros_like(bodies.rest), ready.barred).deepest > 0:
        return Varied(np.nan, "touching")
    varied = replace(ready, bodies=bodies, cells=carried(ready.cells, ready.bodies, bodies))
    finder = Search(varied, objective, solve, stop, _silent, thorough=False)
    finder.run()
    found = finder.best
    if finder.unlimited:
        return Varied(np.inf, "unbounded")
    if found is None or found.solution.status != "converged":
        return Varied(np.nan, "failed")
    deepest = overlaps(bodies, found.motion, ready.barred).deepest
    good = deepest <= SAFE * ready.size
    return Varied(found.value if good else np.nan, "bounded" if good else "failed")


def _silent(_: Progress) -> None:
    """Tell nobody."""
