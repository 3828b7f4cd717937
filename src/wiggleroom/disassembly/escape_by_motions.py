"""Bodies that leave along largest motions, which are searched from where all are and from states in which a body can be turned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.disassembly.closed_pairs import ClosedPairs
from wiggleroom.disassembly.disassembly_stage import NO_BODIES, Stage, leave_after_motion, leave_moving
from wiggleroom.disassembly.escape_search import (
    EXIT_TESTS,
    GoalSequence,
    answer_or_none,
    escape_path,
    search_for_escape,
)
from wiggleroom.disassembly.remaining import displaced
from wiggleroom.disassembly.slide_search import MoveSequence, SlideSearch, Tilt
from wiggleroom.disassembly.translation import TranslationEscape
from wiggleroom.drawing.model import Turn
from wiggleroom.errors import Stop, WiggleroomError
from wiggleroom.geometry.rigid_motions import of_bodies, of_parts
from wiggleroom.search.prepare import Prepared, Survey
from wiggleroom.search.prepare_walls import prepare_walls
from wiggleroom.search.progress import Progress
from wiggleroom.verdict import Certainty, PathState, Separability

Ints = NDArray[np.int64]

MAX_TILTS = 4
"""Largest turns are searched from at most this many states besides the first, in which a body can be turned."""


def escape_by_motions(
    assembly: Assembly,
    surveyed: Survey,
    simpler: Prepared,
    known: ClosedPairs,
    nearly: list[TranslationEscape],
    questions: int,
    exits: list[GoalSequence],
    slid: SlideSearch,
    stop: Stop | None,
    tell: Callable[[Progress], None],
) -> Stage:
    """Bodies that leave along largest motions and turns, or how far these showed that none do.

    Parameters
    ----------
    assembly : Assembly
        At rest where all parts are now.
    surveyed : Survey
        Of the assembly.
    simpler : Prepared
        Its bodies, or larger ones with fewer corners, with walls.
    known : ClosedPairs
        What is tied.
    nearly : list of TranslationEscape
        Sets that would leave straight if there were a little more room.
    questions : int
        Largest motions searched at most.
    exits : list of goals
        What leads apart is added.
    slid : SlideSearch
        What slides led to.
    stop, tell
        As for `flex`.
    """
    bodies = surveyed.bodies
    ground = int(np.flatnonzero(bodies.fixed)[0])
    still = MoveSequence(np.zeros((1, len(bodies.fixed), 3)), NO_BODIES)
    loose = slid.states > 1 and slid.whole and slid.on_lattice
    searched = search_for_escape(simpler, ground, known.group, nearly, stop, tell, questions, only_turns=loose)
    if searched.path is not None and searched.exit is not None:
        stage = leave_after_motion(assembly, surveyed, simpler, still, searched.path, searched.exit)
        if stage is not None:
            exits.append(searched.asked)
            return replace(stage, questions=searched.questions)
    count = searched.questions
    for tilt in slid.tilts[:MAX_TILTS]:
        asked, tilted = _from_tilt(assembly, surveyed, tilt, known.group, stop)
        count += asked
        if tilted is not None:
            return replace(tilted, questions=count)
    stopped = stop is not None and stop.is_set()
    # where all states of a lattice were visited and every body was turned in each, more places and open questions are no gap in that
    sure = slid.on_lattice and slid.turned == slid.states
    answered = sure or (searched.unanswered == 0 and not searched.more_places)
    whole = slid.whole and searched.whole and searched.path is None and answered and not stopped
    ended: Separability = Separability.INTERLOCKED if whole else Separability.UNKNOWN
    return Stage(ended, Certainty.SEARCHED, NO_BODIES, None, known.held, count, unanswered=searched.unanswered)


def _from_tilt(
    assembly: Assembly, surveyed: Survey, tilt: Tilt, group: Ints, stop: Stop | None
) -> tuple[int, Stage | None]:
    """How many largest turns were searched from a state in which a body can be turned, and what leaves along them."""
    bodies, before = surveyed.bodies, tilt.before
    ground = int(np.flatnonzero(bodies.fixed)[0])
    moved = displaced(assembly, of_parts(assembly, bodies, before.states)[-1])
    try:
        ready = prepare_walls(moved, stop=stop)
    except WiggleroomError:
        return 0, None
    name = assembly.names[bodies.members[tilt.who][0]]
    asked = 0
    for sense in ("ccw", "cw"):
        if stop is not None and stop.is_set():
            break
        answer = answer_or_none(ready, (Turn(name, sense),), None, stop)
        asked += 1
        if answer is None or answer.path != PathState.CHECKED:
            continue
        path = of_bodies(moved, ready.bodies, answer.waypoints)
        out = escape_path(ready, ground, group, path, EXIT_TESTS, stop)
        if out is None:
            continue
        stage = leave_moving(assembly, surveyed, before, *out)
        if stage is not None:
            return asked, stage
    return asked, None
