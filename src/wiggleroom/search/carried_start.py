"""Starts of rounds with the multipliers of the round before: near its central path, whatever walls are new."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.nonlinear_program import Program, build_program
from wiggleroom.search.incumbent import Start
from wiggleroom.solve.carried_multipliers import even_multipliers, pair_wrenches
from wiggleroom.solve.interior_point import barrier_unit
from wiggleroom.solve.solution import Solution


def carried_start(start: Start, program: Program, solution: Solution, fresh: NDArray[np.bool_]) -> Start:
    """A start at the inner point of a solution, with multipliers: walls of `fresh` pairs (P,) get the forces that the old ones had."""
    lam = solution.inner_lam
    if lam is None:
        return start
    forces = pair_wrenches(program.linearise(solution.inner), lam)
    renewed = build_program(program.bodies, start.cells, program.objective, length=program.length, like=program)
    at = renewed.linearise(renewed.variables(start.inner))
    given = np.full(renewed.rows, np.nan)
    given[~fresh[start.cells.pair]] = lam[~fresh[program.cells.pair]]
    multipliers = even_multipliers(at, solution.inner_mu * barrier_unit(at), forces, given)
    return replace(start, mu=solution.inner_mu, multipliers=multipliers)
