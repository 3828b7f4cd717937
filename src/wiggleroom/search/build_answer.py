"""From the end of a search to an answer: the way checked, overlap measured, verdict given."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.model import Assembly
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import WiggleroomError
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.overlap import SAFE, overlaps
from wiggleroom.geometry.rigid_motions import about
from wiggleroom.search.answer import Answer, Contact
from wiggleroom.search.contact_forces import contacts
from wiggleroom.search.loop import FAR, ROUND, Found, Progress, Search
from wiggleroom.solve.kkt_conditions import conditions
from wiggleroom.verdict import Verdict

Floats = NDArray[np.float64]


def answer_of(search: Search, asked: tuple[Goal, ...], solver: str, began: float) -> Answer:
    """Check the way and the end of the best motion, and say how sure it is."""
    started = time.perf_counter()
    ready, found = search.ready, search.best
    if found is None:
        raise WiggleroomError("the search ended before its first round")
    search.tell(Progress("check", search.rounds, 0, found.value))
    way, safe = search.way(found), SAFE * ready.size
    motions, deepest = way.motions, overlaps(ready.bodies, found.motion, ready.barred).deepest
    verdict, value = _verdict(search, found, way.sure), found.value
    sure = way.sure
    if verdict is Verdict.STOPPED and way.certain < len(motions):  # back to where the way is certain
        motions, sure = motions[: way.certain], not len(way.strangers[0])
        value, deepest = search.objective.value(motions[-1]), overlaps(ready.bodies, motions[-1], ready.barred).deepest
    if deepest > safe:  # never report an overlap: back to the last way-point without one
        motions, deepest = _safe_part(search, motions, safe)
        verdict, value = Verdict.STOPPED, search.objective.value(motions[-1])
    if verdict is Verdict.STOPPED and value < search.objective.value(motions[0]):
        motions, value, deepest = (
            motions[:1],
            search.objective.value(motions[0]),
            0.0,
        )  # rest is better than what was reached
    leaves, turns = (
        unlimited(ready.assembly, ready.bodies, found.motion, ready.size) if verdict is Verdict.UNBOUNDED else ((), ())
    )
    held: tuple[Contact, ...] = ()
    if verdict in (Verdict.OPTIMAL, Verdict.STATIONARY):
        held = contacts(ready.assembly, found.program, found.solution.u, found.touch)
    seconds = {k: v for k, v in search.seconds.items() if k != "check"}
    seconds["check"] = search.seconds["check"] + time.perf_counter() - started
    seconds["total"] = time.perf_counter() - began
    return Answer(
        assembly=ready.assembly,
        goals=asked,
        verdict=verdict,
        objective=None if verdict is Verdict.UNBOUNDED else value,
        motion=part_motions(ready.assembly, ready.bodies, motions[-1:])[0],
        waypoints=part_motions(ready.assembly, ready.bodies, motions),
        contacts=held,
        path="checked" if sure else "not checked",
        collision_free=deepest <= safe,
        deepest_overlap=deepest,
        model="walls",
        solver=solver,
        rounds=search.rounds,
        iterations=search.iterations,
        seconds=seconds,
        leaves=leaves,
        turns=turns,
        trail=found,
    )


def part_motions(assembly: Assembly, bodies: Bodies, motions: Floats) -> Floats:
    """Motions (k, parts, 3) of the parts about their reference points, from those of the bodies (k, n, 3)."""
    who = bodies.body_of
    return about(motions[:, who], assembly.rest[:, :2] - bodies.rest[who, :2])


def _safe_part(search: Search, motions: Floats, safe: float) -> tuple[Floats, float]:
    """The way up to its last point without overlap, and the overlap there [mm]; rest has none."""
    ready = search.ready
    for k in range(len(motions) - 1, 0, -1):
        deepest = overlaps(ready.bodies, motions[k], ready.barred).deepest
        if deepest <= safe:
            return motions[: k + 1], deepest
    return motions[:1], 0.0


def _verdict(search: Search, found: Found, sure: bool) -> Verdict:
    if search.unlimited:  # said only where nothing was met on the way
        return Verdict.UNBOUNDED if sure else Verdict.STOPPED
    if found.solution.status in ("stopped", "failed"):
        return Verdict.STOPPED
    if not conditions(found.program, found.solution.u, found.solution.lam).hold(search.ready.size):
        return Verdict.STOPPED
    return Verdict.STATIONARY if search.branches_left or found.touch.virtual.any() else Verdict.OPTIMAL


def unlimited(
    assembly: Assembly, bodies: Bodies, motion: Floats, size: float
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the parts that move away, and of those that turn, without limit, from the motion (n, 3) of the bodies."""
    far = np.hypot(*motion[:, :2].T) > FAR * size / 2
    turned = (np.abs(motion[:, 2]) > ROUND / 2) & ~far
    return _names(assembly, bodies, far), _names(assembly, bodies, turned)


def _names(assembly: Assembly, bodies: Bodies, which: NDArray[np.bool_]) -> tuple[str, ...]:
    names: Sequence[str] = assembly.names
    return tuple(names[p] for b in np.flatnonzero(which) for p in bodies.members[b])
