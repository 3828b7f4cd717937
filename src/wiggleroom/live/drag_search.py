"""Drags: the search that brings a point of a part to a place, among all bodies or among the few that a push reaches first."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.live.neighbourhood import neighbourhood
from wiggleroom.live.warm_start import State, TimeBudget, WarmSearch, free_of_overlap, state_at_rest
from wiggleroom.program.objectives import Approach, Points
from wiggleroom.search.answer import Contact
from wiggleroom.search.contact_forces import contact_forces, contacts
from wiggleroom.search.prepare import Prepared
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]
Dragged = tuple[State, WarmSearch, bool]
"""Where a drag ended, the search, and whether nothing more can be gained."""

ARRIVAL_TOLERANCE = 1e-3
"""A grip this share of the clearance from its target has arrived."""


def dragged(ready: Prepared, term: Approach, state: State, whole: float, until: TimeBudget) -> Dragged:
    """Drag from a state, with all bodies free to move; `whole` [mm2] is the squared distance from rest to the target."""
    here = term.value(state.inner)  # what counts is what is gained from there
    enough = whole - here - (ARRIVAL_TOLERANCE * ready.clearance) ** 2
    search = WarmSearch(ready, replace(term, zero=here), state, until, enough)
    after, settled = search.reach()
    return after, search, settled


def dragged_among_few(
    ready: Prepared, term: Approach, aim: Floats, state: State, count: int, until: TimeBudget
) -> Dragged | None:
    """Drag with `count` bodies free to move, settled where no other could help; None where that is all, or others may be met."""
    near = neighbourhood(ready, state, int(term.points.body[0]), count)
    if near is None:
        return None
    body = int(np.searchsorted(near.body, term.points.body[0]))
    points = Points(np.array([body]), term.points.turned(state.inner))
    grip = aim + term.apart[0] + term.points.moved(state.inner)[0]
    local = Approach(points, (grip - aim)[None], term.weight)
    there, search, settled = dragged(
        near.ready, local, state_at_rest(near.ready), float((grip - aim) @ (grip - aim)), until
    )
    if near.left(search):
        return None
    after = near.whole(state, there)
    if not free_of_overlap(ready, after.motion, state.motion):
        return None
    short = float(np.hypot(*(grip + points.moved(there.motion)[0] - aim)))
    if settled and short > ARRIVAL_TOLERANCE * ready.clearance:
        held = holding_contacts(search, 1.0)
        settled = not near.held.intersection(name for contact in held for name in contact.parts)
    return after, search, settled


def holding_contacts(search: WarmSearch, unit: float) -> tuple[Contact, ...]:
    """Contacts that hold the best motion, forces in this unit."""
    found = search.best
    if found is None or found.solution.status is not SolverStatus.CONVERGED:
        return ()
    forces = contact_forces(found.program, found.solution.u, found.active)
    return contacts(search.ready.assembly, found.program, found.solution.u, forces, unit)
