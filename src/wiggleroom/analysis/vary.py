"""The same question with outlines a little larger or smaller, followed from an answer that is there.

Walls are linear in the displacement of outlines, so the program of the answer is solved again with its walls moved, and
no free space is worked out. What was not visible in that program shows in the checks: parts that overlap, or a wall that
stops the motion although nothing touches there. Then the question is searched from rest, with the outlines as they are.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.analysis.answer import Answer
from wiggleroom.analysis.overlap import SAFE, overlaps
from wiggleroom.analysis.prepare import Prepared
from wiggleroom.analysis.search import FAR, Found, Progress, Search
from wiggleroom.analysis.touch import touching
from wiggleroom.errors import InputError
from wiggleroom.pairs.moved import moved
from wiggleroom.pairs.shapes import Bodies
from wiggleroom.program.build import Program, build
from wiggleroom.program.gaps import carried
from wiggleroom.solve.interior_point import Solution, Stop, solve

Floats = NDArray[np.float64]

FINE = 1e-10
"""Share of the objective that a program solved for a difference may leave on the table."""
UNREAL = 0.02
"""A motion held by walls that nothing touches with more than this share of all force is searched anew."""


@dataclass(frozen=True, eq=False)
class Base:
    """What variations start from.

    Parameters
    ----------
    ready : Prepared
    program : Program
        The last one of the search.
    starts : tuple of (n, 3) float64 [mm, mm, rad]
        Motions inside its rows, from the end of the way to its beginning.
    mu : float
        Complementarity to begin with.
    value : float
        Objective, solved as finely as the variations will be.
    lam : (R,) float64
        Its multipliers.
    u : (3F,) float64
        Its solution.
    """

    ready: Prepared
    program: Program
    starts: tuple[Floats, ...]
    mu: float
    value: float
    lam: Floats
    u: Floats


@dataclass(frozen=True)
class Varied:
    """Objective for outlines that moved.

    Parameters
    ----------
    value : float
        nan where the parts do not fit beside each other, infinity where nothing stops the motion.
    how : str
        "followed" in the walls of the answer, or "searched" from rest because these did not do.
    """

    value: float
    how: str


def base(ready: Prepared, answer: Answer, *, fine: bool = True) -> Base:
    """What an answer's variations start from; with `fine` its last program is solved to ten digits.

    Raises
    ------
    InputError
        If the motion has no end, or the search was cut short.
    """
    found = answer.trail
    if not isinstance(found, Found) or answer.objective is None or found.solution.status != "converged":
        why = "nothing stops the motion" if answer.objective is None else "its search was cut short"
        finding = f"{answer.assembly.drawing.source or 'the assembly'}: {why}, so no gap can be blamed for it"
        raise InputError(finding)
    program, solution = found.program, found.solution
    if fine:
        polished = solve(program, solution.inner, mu=solution.inner_mu, tolerance=FINE)
        if polished.status == "converged":
            solution = replace(polished, inner=solution.inner, inner_mu=solution.inner_mu)
    points = [solution.inner, *(u for u in found.solution.way[::-1]), found.begin]
    starts = tuple(program.motion(u) for u in points)
    value = program.objective.value(program.motion(solution.u))
    return Base(ready, program, starts, solution.inner_mu, value, solution.lam, solution.u)


def vary(base: Base, inward: Floats, *, search: bool = True, stop: Stop | None = None) -> Varied:
    """Largest objective when the outline of each part moves inward by `inward` (parts,) [mm].

    Parameters
    ----------
    base : Base
    inward : (parts,) float64 [mm]
        Negative moves an outline out.
    search : bool
        Search from rest where the walls of the answer do not do; else report what they say.
    stop : optional
        Asked every iteration.
    """
    old = base.program
    bodies = moved(base.ready.bodies, inward)
    program = build(bodies, carried(old.cells, old.bodies, bodies), old.objective, length=old.length)
    start = _inside(base, program)
    if start is not None:
        solution = solve(
            program, start, mu=base.mu, tolerance=FINE, horizon=FAR * base.ready.size, stop=stop
        )  # fmt: skip
        if not search or _holds(base, program, solution):
            return Varied(program.objective.value(program.motion(solution.u)), "followed")
    return _searched(base, bodies, stop)


def _inside(base: Base, program: Program) -> Floats | None:
    """Where to begin: the last motion on the way that is well inside all rows, else any inside; None where there is none."""
    found = None
    for motion in base.starts:
        u = program.variables(motion)
        least = program.values(u).min(initial=np.inf)
        if least > 1e-3:
            return u
        if least > 0 and found is None:
            found = u
    return found


def _holds(base: Base, program: Program, solution: Solution) -> bool:
    """True where the walls of the answer still say what the parts do: real contacts, no overlap."""
    if solution.status != "converged":
        return False
    touch = touching(program, solution.u, solution.lam)
    before = touching(base.program, base.u, base.lam)
    allowed = max(UNREAL * touch.force.sum(), 2 * before.force[before.virtual].sum())
    if touch.force[touch.virtual].sum() > allowed:
        return False
    ready = base.ready
    return overlaps(program.bodies, program.motion(solution.u), ready.barred).deepest <= SAFE * ready.size


def _searched(base: Base, bodies: Bodies, stop: Stop | None) -> Varied:
    """The whole search, from rest."""
    ready = base.ready
    if overlaps(bodies, np.zeros_like(bodies.rest), ready.barred).deepest > 0:
        return Varied(np.nan, "searched")
    cells = carried(ready.cells, ready.bodies, bodies)
    looser = replace(ready, bodies=bodies, cells=cells)
    search = Search(looser, base.program.objective, solve, stop, _silent)
    search.run()
    if search.unlimited:
        return Varied(np.inf, "searched")
    return Varied(search.best.value if search.best else np.nan, "searched")


def _silent(_: Progress) -> None:
    """Tell nobody."""
