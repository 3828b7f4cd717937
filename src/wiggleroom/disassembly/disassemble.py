"""The parts of a drawing taken away one after the other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import Context
from wiggleroom.disassembly.closed_pairs import enclosed_links
from wiggleroom.disassembly.disassembly_sequence import NO_BODIES, Disassembly, Stage, Stages
from wiggleroom.disassembly.enclosure import enclosed
from wiggleroom.disassembly.escape import next_stage
from wiggleroom.disassembly.escape_effort import EscapeEffort
from wiggleroom.disassembly.passages_by_gap import PassagesByGap
from wiggleroom.disassembly.remaining import displaced, only
from wiggleroom.errors import FreeSpaceError, StoppedError, TouchingError
from wiggleroom.geometry.bodies import bodies
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.search.prepare import Survey, survey
from wiggleroom.verdict import Certainty, Separability

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
HoldingCost = Callable[[Floats, NDArray[np.bool_], Ints], int]
"""How many parts must be held: of a state (n, 3) of all parts, of those that are there (n,), once some leave (k,)."""


def disassemble(
    assembly: Assembly,
    *,
    targets: tuple[str, ...] = (),
    effort: EscapeEffort | None = None,
    every: bool = True,
    holding_cost: HoldingCost | None = None,
    returning: bool = False,
    context: Context,
) -> Disassembly:
    """Take parts of a drawing away one after the other, as long as some leave.

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
    returning : bool
        True: those that did not leave are at rest again after each departure.
    context : Context

    Raises
    ------
    FreeSpaceError
        If no free space was found round where two parts lie, and boxes of motions did not decide it either.
    TouchingError
        If two parts touch at rest.
    """
    look = _PlanarStages(assembly, frozenset(targets), effort or EscapeEffort(), holding_cost, context)
    stages = Stages(look.left, look.next, lambda before, path: before + path)
    n = len(assembly.names)
    done = Disassembly(assembly.names, stages, np.zeros((n, 3)), returning)
    done.last = done.take_apart(np.arange(n), targets=targets, every=every)
    return done


@dataclass(eq=False)
class _PlanarStages:
    """The next parts of a drawing that leave."""

    assembly: Assembly
    targets: frozenset[str]
    effort: EscapeEffort
    holding_cost: HoldingCost | None
    context: Context

    def left(self, alive: Ints, motion: Floats) -> Assembly | None:
        """Some parts where they are; None where some have left and one body is left, or all are fixed."""
        if len(alive) == len(motion):
            return self.assembly
        left = only(displaced(self.assembly, motion), alive)
        fixed = bodies(left).fixed
        return None if len(fixed) < 2 or fixed.all() else left

    def next(self, left: Assembly, alive: Ints, motion: Floats) -> Stage:
        """The next of these parts that leave."""
        begins = len(alive) == len(self.assembly.names)
        if not begins:
            self.effort = replace(self.effort, passages=PassagesByGap(), exits=[])  # the others lie elsewhere now
        try:
            surveyed = survey(left, self.context.stop)
            around = enclosed(surveyed.bodies, surveyed.geometry, surveyed.ignored, self.context)
            begin = enclosed_links(surveyed.bodies.fixed, around)
            if begin.all_tied:
                return Stage(
                    Separability.INTERLOCKED, Certainty.PROVEN, NO_BODIES, None, begin.held, reach=around.far.max()
                )
            wanted = [surveyed.bodies.body_of[k] for k, name in enumerate(left.names) if name in self.targets]
            aims, cost = np.unique(wanted).astype(np.int64), self._cost(alive, motion, surveyed)
            stage = next_stage(left, surveyed, begin, self.effort, aims, cost, self.context)
        except (FreeSpaceError, StoppedError, TouchingError) as why:
            if begins and not isinstance(why, StoppedError):
                raise
            # the others may have come to touch, or nearly, once some have left: then no more is known
            return Stage(Separability.UNKNOWN, Certainty.SEARCHED, NO_BODIES, None, NO_BODIES, whole=False)
        if stage.path is None:
            return replace(stage, reach=around.far.max())
        who = np.sort([p for b in stage.who for p in surveyed.bodies.members[b]])
        return replace(stage, who=who, path=of_parts(left, surveyed.bodies, stage.path))

    def _cost(self, alive: Ints, motion: Floats, surveyed: Survey) -> Callable[[Ints], int] | None:
        """The burden of bodies that leave from where all are now."""
        cost, members = self.holding_cost, surveyed.bodies.members
        if cost is None:
            return None
        there = np.isin(np.arange(len(motion)), alive)
        return lambda who: cost(motion, there, alive[[p for b in who for p in members[b]]])
