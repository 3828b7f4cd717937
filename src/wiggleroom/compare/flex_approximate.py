"""How far it can move, with a model that approximates: the paper's hulls, or half-planes."""

from __future__ import annotations

import time
from collections.abc import Callable

from wiggleroom.compare.approximate import Approximation, answer_from
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError, Stop
from wiggleroom.freespace.models.pair_models import HalfPlane
from wiggleroom.program.objectives import objective
from wiggleroom.search.answer import Answer
from wiggleroom.search.progress import Progress
from wiggleroom.solve import solver_named


def flex_approximate(
    ready: Approximation,
    asked: tuple[Goal, ...],
    solver: str,
    stop: Stop | None,
    tell: Callable[[Progress], None],
    spent: float,
) -> Answer:
    """The answer of a model; `spent` seconds went into making it ready."""
    began = time.perf_counter()
    goal = objective(ready.assembly, ready.bodies, asked, ready.near)
    if isinstance(ready.model, HalfPlane):
        if solver != "interior-point":
            finding = f'solver "{solver}": half-planes make linear programs; leave the solver out'
            raise InputError(finding)
        from wiggleroom.compare.flex_halfplane import flex_half_planes
        from wiggleroom.solve.linear_programming import linear_solver

        solver = linear_solver()
        end = flex_half_planes(ready, goal, ready.model.iterated, stop, tell)
    else:
        from wiggleroom.compare.flex_hull import flex_hull

        end = flex_hull(ready, goal, solver_named(solver), stop, tell)
    seconds = {"freespace": spent, "solve": time.perf_counter() - began}
    return answer_from(ready, asked, solver, end, seconds)
