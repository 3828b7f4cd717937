"""Largest motions followed from gap to gap (continuation): the end at one gap is where the search at the next begins."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from wiggleroom.drawing.model import Goal
from wiggleroom.live.prepared_designs import GapDesign
from wiggleroom.live.warm_start import State, free_of_overlap, pushed
from wiggleroom.program.gap_sensitivity import carried

MAX_CARRIED_GROWTH = 0.1
"""A largest motion is followed to parts larger by up to this share of the clearance."""
RETREAT_SHARES = (0.01, 0.05, 0.15)
"""Shares of its motion that it is taken back by besides, one after the other: into the room of all joints."""
MAX_WARM_STARTS = 3
"""At most this many ends of earlier requests are tried, the nearest first."""
MAX_KEPT_ENDS = 16
"""Number of ends of largest motions that are kept as starts for others."""


@dataclass(frozen=True, eq=False)
class KnownEnd:
    """Where a largest motion ended, in which design; its outlines may have been refined where they touch."""

    goals: tuple[Goal, ...]
    design: GapDesign
    state: State


class KnownEnds:
    """Ends of the last largest motions."""

    def __init__(self) -> None:
        self._ends: list[KnownEnd] = []

    def keep(self, goals: tuple[Goal, ...], design: GapDesign, state: State) -> None:
        """Keep an end, in place of an older one of the same design and goals."""
        others = [e for e in self._ends if e.goals != goals or e.design.assembly is not design.assembly]
        self._ends = [*others, KnownEnd(goals, design, state)][-MAX_KEPT_ENDS:]

    def at(self, goals: tuple[Goal, ...], design: GapDesign) -> KnownEnd | None:
        """The end of these goals in this very design."""
        found = [e for e in self._ends if e.goals == goals and e.design.assembly is design.assembly]
        return found[-1] if found else None

    def near(self, goals: tuple[Goal, ...], design: GapDesign) -> State | None:
        """State to begin at: the end of the same goals at the nearest gap, or at a smaller one."""
        if design.assembly.drawing.gaps:
            return None
        same = [e for e in self._ends if e.goals == goals and e.design.roles == design.roles]
        same.sort(key=lambda e: float(np.abs(e.design.inward - design.inward).max()))
        for end in same[:MAX_WARM_STARTS]:
            growth = float(np.abs(end.design.inward - design.inward).max())
            state = kept(end.state, end.design, design)
            if state is None and growth < MAX_CARRIED_GROWTH * design.ready.clearance:
                state = _followed(end.state, end.design, design)
            if state is not None:
                return replace(state, near=True)
        return None


def kept(state: State, old: GapDesign, new: GapDesign) -> State | None:
    """The state in another design, where all parts are as small or smaller; else None."""
    if old.roles != new.roles or not (old.inward <= new.inward + 1e-12).all():
        return None
    return _in_design(state, old, new)


def _followed(end: State, old: GapDesign, new: GapDesign) -> State | None:
    """The state in a design where some parts are a little larger; None where they do not fit there."""
    there = _in_design(end, old, new)
    if there is None:
        return None
    less = 2 * float((old.inward - new.inward).max()) / old.ready.clearance  # motions shrink like the gap
    for aside in RETREAT_SHARES:
        state = pushed(new.ready, replace(there, inner=max(1 - less - aside, 0.0) * there.inner, linked=False))
        if state is not None and free_of_overlap(new.ready, state.inner):  # the old motion is one of smaller parts
            return replace(state, motion=state.inner)
    return None


def _in_design(state: State, old: GapDesign, new: GapDesign) -> State | None:
    """The state with its cells carried to the outlines of another design; None where these have other corners."""
    one, other = old.ready.bodies, new.ready.bodies
    if one is other:
        return state
    if not np.array_equal(np.diff(one.shapes.first)[one.shape], np.diff(other.shapes.first)[other.shape]):
        return None
    return replace(state, cells=carried(state.cells, one, other))
