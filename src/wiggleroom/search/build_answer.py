"""From the end of a search to an answer: the path checked, overlap measured, verdict given."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import WiggleroomError
from wiggleroom.freespace.cells.cells import Cells
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import Nearness
from wiggleroom.search.answer import Answer, Contact, Period
from wiggleroom.search.contact_forces import ContactForces, contact_forces, contacts
from wiggleroom.search.incumbent import Incumbent
from wiggleroom.search.local_search import ESCAPE_DISTANCE, FULL_TURN, LocalSearch
from wiggleroom.search.moves import branches_left_open
from wiggleroom.search.path_check import CheckedPath
from wiggleroom.search.periodic_motion import PeriodicMotion
from wiggleroom.search.progress import Progress
from wiggleroom.search.recession import recession_direction, turns_for_ever
from wiggleroom.solve.kkt_conditions import conditions
from wiggleroom.verdict import PathState, SolverStatus, Verdict

Floats = NDArray[np.float64]


END_TOLERANCE = 1e-6
"""A path that is certain up to this share of the objective before its end has arrived: an end may lie in a wall by rounding."""


def answer_of(
    search: LocalSearch, asked: tuple[Goal, ...], solver: str, began: float, repeats: PeriodicMotion | None = None
) -> Answer:
    """Check the path and the end of the best motion, and say how sure it is; or that it `repeats`, where a period is known."""
    started = time.perf_counter()
    ready, found = search.ready, search.best
    if found is None:
        raise WiggleroomError("the search ended before its first round")
    search.tell(Progress("check", search.rounds, 0, found.value))
    checked, safe = search.checked_path(found), OVERLAP_TOLERANCE * ready.size
    value, count = found.value, len(checked.points)
    if not checked.sure:  # back to the last waypoint up to which the path is certain
        count = max(checked.certain, 1)
        value = search.objective.value(checked.motion(count - 1))
    arrived = value >= found.value - END_TOLERANCE * max(abs(found.value), ready.clearance)
    forces = contact_forces(found.program, found.solution.u, found.active)
    verdict = _verdict(search, found, forces, checked.sure or arrived)
    deepest = overlaps(ready.bodies, checked.motion(count - 1), ready.ignored).deepest
    if deepest > safe:  # never report an overlap: back to the last waypoint without one
        count, deepest = _safe_part(search, checked, count, safe)
        verdict, value = Verdict.STOPPED, search.objective.value(checked.motion(count - 1))
    first = search.objective.value(checked.motion(0))
    at_rest = (verdict is Verdict.STOPPED and value < first) or (verdict.ends and value <= first)
    if at_rest:  # where it began is better than what was reached, or as good
        count, value, deepest = 1, first, 0.0
        if verdict.ends and not _best_at_rest(search):
            verdict = Verdict.STOPPED
        if isinstance(search.objective, Nearness) and first >= search.objective.most:
            verdict = Verdict.OPTIMAL  # neighbours are as near as they come, wherever the search went
    leaves: tuple[str, ...] = ()
    turns: tuple[str, ...] = ()
    waypoints, period = repeats.waypoints if repeats else checked.waypoints(ready, count), None
    if repeats is not None:
        verdict, deepest = Verdict.UNBOUNDED, 0.0
        turns = _names(ready.assembly, ready.bodies, repeats.turn != 0)
        period = Period(repeats.gain, repeats.turn[ready.bodies.body_of], repeats.first)
    elif verdict is Verdict.UNBOUNDED:
        leaves, turns = unlimited(ready.assembly, ready.bodies, found.motion, ready.size)
    held: tuple[Contact, ...] = ()
    if verdict.ends and not at_rest:
        held = contacts(ready.assembly, found.program, found.solution.u, forces)
    seconds = {k: v for k, v in search.seconds.items() if k != "check"}
    seconds["check"] = search.seconds["check"] + time.perf_counter() - started
    seconds["total"] = time.perf_counter() - began
    return Answer(
        assembly=ready.assembly,
        goals=asked,
        verdict=verdict,
        objective=None if verdict is Verdict.UNBOUNDED else value,
        motion=waypoints[-1],
        waypoints=waypoints,
        contacts=held,
        path=PathState.of(checked.certain > 0 or repeats is not None),
        collision_free=deepest <= safe,
        deepest_overlap=deepest,
        model="walls",
        solver=solver,
        rounds=search.rounds,
        iterations=search.iterations,
        seconds=seconds,
        leaves=leaves,
        turns=turns,
        period=period,
        warm_start=found if isinstance(found.program.cells, Cells) else None,  # stopped before there were cells
    )


def _best_at_rest(search: LocalSearch) -> bool:
    """True where the optimality conditions hold at rest, where nothing touches."""
    ready = search.ready
    program = build_program(ready.bodies, ready.cells, search.objective, length=ready.clearance)
    rest = program.variables(np.zeros((len(ready.bodies.fixed), 3)))
    return conditions(program, rest, np.zeros(program.rows)).hold(ready.size)


def _safe_part(search: LocalSearch, path: CheckedPath, count: int, safe: float) -> tuple[int, float]:
    """Number of waypoints, of the first so many, up to the last without overlap, and the overlap there [mm]; rest has none."""
    ready = search.ready
    for k in range(count - 1, 0, -1):
        deepest = overlaps(ready.bodies, path.motion(k), ready.ignored).deepest
        if deepest <= safe:
            return k + 1, deepest
    return 1, 0.0


def _verdict(search: LocalSearch, found: Incumbent, forces: ContactForces, sure: bool) -> Verdict:
    if not sure:
        return Verdict.STOPPED
    if search.unlimited:
        ready, goal, motion = search.ready, search.objective, found.motion
        endless = recession_direction(ready, goal, motion) is not None or turns_for_ever(ready, goal, motion)
        return Verdict.UNBOUNDED if endless else Verdict.STOPPED
    if not search.ended or found.solution.status in (SolverStatus.STOPPED, SolverStatus.FAILED):
        return Verdict.STOPPED
    if not conditions(found.program, found.solution.u, found.solution.lam).hold(search.ready.size):
        return Verdict.STOPPED
    return Verdict.OPTIMAL if forces.whole and not branches_left_open(found) else Verdict.STATIONARY


def unlimited(
    assembly: Assembly, bodies: Bodies, motion: Floats, size: float
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the parts that move away, and of those that turn, without limit, from the motion (n, 3) of the bodies."""
    far = np.hypot(*motion[:, :2].T) > ESCAPE_DISTANCE * size / 2
    turned = (np.abs(motion[:, 2]) > FULL_TURN / 2) & ~far
    return _names(assembly, bodies, far), _names(assembly, bodies, turned)


def _names(assembly: Assembly, bodies: Bodies, which: NDArray[np.bool_]) -> tuple[str, ...]:
    names: Sequence[str] = assembly.names
    return tuple(names[p] for b in np.flatnonzero(which) for p in bodies.members[b])
