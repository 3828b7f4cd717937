"""The disassembly sequence: which sets of parts leave, one after the other; each begins where the one before ended."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import Context
from wiggleroom.disassembly.closed_pairs import enclosed_links
from wiggleroom.disassembly.disassembly_stage import NO_BODIES, Stage
from wiggleroom.disassembly.enclosure import Enclosed, enclosed
from wiggleroom.disassembly.escape import next_stage
from wiggleroom.disassembly.escape_effort import EscapeEffort
from wiggleroom.disassembly.passages_by_gap import PassagesByGap
from wiggleroom.disassembly.remaining import displaced, without_parts
from wiggleroom.errors import FreeSpaceError, StoppedError, TouchingError
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.search.prepare import Survey, survey
from wiggleroom.verdict import Certainty, Separability

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
HoldingCost = Callable[[Floats, NDArray[np.bool_], Ints], int]
"""How many parts must be held: of a state (n, 3) of all parts, of those that are there (n,), once some leave (k,)."""


@dataclass(frozen=True, eq=False)
class Departure:
    """Parts that leave together, and the path to there.

    Parameters
    ----------
    parts : (k,) int64
    path : (k, n, 3) float64 [mm, mm, rad]
        Motions of all parts about their reference points, from where the departure before ended (the first from rest) to where `parts`
        are beyond all others; straight in between. Parts that left before stay where they were put, out of the game.
    there : (n,) bool
        Parts that had not left before.
    moves : (k - 1,) int64
        Number of the move that each piece of the path belongs to.
    """

    parts: Ints
    path: Floats
    there: NDArray[np.bool_]
    moves: Ints


@dataclass(frozen=True, eq=False)
class Disassembly:
    """How far an assembly could be taken apart.

    Parameters
    ----------
    departures : tuple of Departure
    last : Stage
        What became of the parts that are left.
    left : Assembly
        The parts that are left, at rest where they are in the end.
    around : Enclosed or None
        What lies in closed holes among them.
    questions, unanswered : int
        Largest motions that were searched in all stages, and how many of them found no end whose path is certain.
    states, turned : int
        States to which slides and turns of single bodies led, and those in which every body was turned both ways.
    together : tuple of names
        Parts that left with others from which they do not part.
    """

    departures: tuple[Departure, ...]
    last: Stage
    left: Assembly
    around: Enclosed | None = None
    questions: int = 0
    unanswered: int = 0
    states: int = 0
    turned: int = 0
    together: tuple[str, ...] = ()


@dataclass(eq=False)
class _Progress:
    """What has been found so far."""

    left: Assembly
    alive: Ints
    motion: Floats
    departures: list[Departure] = field(default_factory=list)
    questions: int = 0
    unanswered: int = 0
    states: int = 0
    turned: int = 0


def disassemble(
    assembly: Assembly,
    *,
    targets: tuple[str, ...] = (),
    effort: EscapeEffort | None = None,
    every: bool = True,
    holding_cost: HoldingCost | None = None,
    context: Context,
) -> Disassembly:
    """Take parts away one after the other, as long as some leave.

    Parameters
    ----------
    assembly : Assembly
        Something in it stands.
    targets : tuple of names
        It ends once these have left; what else leaves is taken away only where they cannot leave before.
    effort : EscapeEffort, optional
    every : bool
        False: it ends once anything has left.
    holding_cost : callable, optional
        How much trouble it makes that some parts leave from a state; of those that could leave straight, those with the least leave first.
    context : Context

    Raises
    ------
    FreeSpaceError
        If no free space was found round where two parts lie, and boxes of motions did not decide it either.
    TouchingError
        If two parts touch at rest.
    """
    names = np.array(assembly.names, dtype=object)
    wanted = set(targets)
    n = len(names)
    so_far = _Progress(assembly, np.arange(n), np.zeros((n, 3)))
    effort = effort or EscapeEffort()
    while True:
        left, alive = so_far.left, so_far.alive
        around = None
        try:
            surveyed = survey(left, context.stop)
            around = enclosed(surveyed.bodies, surveyed.geometry, surveyed.ignored, context)
            begin = enclosed_links(surveyed.bodies.fixed, around)
            if begin.all_tied:
                stage = Stage(Separability.INTERLOCKED, Certainty.PROVEN, NO_BODIES, None, begin.held)
                return _ended(so_far, stage, around)
            aims = np.unique([surveyed.bodies.body_of[k] for k, p in enumerate(alive) if names[p] in wanted])
            stage = next_stage(
                left,
                surveyed,
                begin,
                effort,
                aims.astype(np.int64),
                _of_bodies(holding_cost, so_far, surveyed),
                context,
            )
        except (FreeSpaceError, StoppedError, TouchingError) as why:
            if not isinstance(why, StoppedError) and not so_far.departures:
                raise
            # the others may have come to touch, or nearly, once some have left: then no more is known
            stage = Stage(Separability.UNKNOWN, Certainty.SEARCHED, NO_BODIES, None, NO_BODIES, whole=False)
        so_far.questions += stage.questions
        so_far.unanswered += stage.unanswered
        so_far.states += stage.states
        so_far.turned += stage.turned
        if stage.path is None:
            return _ended(so_far, stage, around)
        bodies = surveyed.bodies
        who = np.array([p for b in stage.who for p in bodies.members[b]])
        path = np.repeat(so_far.motion[None], len(stage.path), 0)
        path[:, alive] += of_parts(left, bodies, stage.path)
        there = np.zeros(n, dtype=np.bool_)
        there[alive] = True
        so_far.departures.append(Departure(np.sort(alive[who]), path, there, stage.moves))
        so_far.motion = path[-1]
        effort = replace(effort, passages=PassagesByGap(), exits=[])  # the others lie elsewhere now
        stay = np.setdiff1d(np.arange(len(alive)), who)
        so_far.left = without_parts(displaced(left, of_parts(left, bodies, stage.path)[-1]), who)
        so_far.alive = alive[stay]
        wanted -= set(names[alive[who]])
        among = bodies.body_of[stay]
        alone = len(np.unique(among)) < 2 or bool(bodies.fixed[among].all())
        if alone or not every or (targets and not wanted):
            end: Separability = Separability.INTERLOCKED if alone else Separability.COMES_APART
            return _ended(so_far, Stage(end, Certainty.PROVEN, NO_BODIES, None, NO_BODIES), around)


def _of_bodies(holding_cost: HoldingCost | None, so_far: _Progress, surveyed: Survey) -> Callable[[Ints], int] | None:
    """The burden of bodies that leave from where all are now."""
    if holding_cost is None:
        return None
    alive, members = so_far.alive, surveyed.bodies.members
    there = np.zeros(len(so_far.motion), dtype=np.bool_)
    there[alive] = True
    motion = so_far.motion
    return lambda who: holding_cost(motion, there, alive[[p for b in who for p in members[b]]])


def _ended(so_far: _Progress, stage: Stage, around: Enclosed | None) -> Disassembly:
    return Disassembly(
        tuple(so_far.departures), stage, so_far.left, around, so_far.questions, so_far.unanswered, so_far.states,
        so_far.turned,
    )  # fmt: skip
