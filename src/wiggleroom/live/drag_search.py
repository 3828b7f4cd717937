"""Drags: the search that brings a point of a part to a place, among all bodies or among the few that a push reaches first."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.audit.path_audit import audit_path
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.live.neighbourhood import neighbourhood
from wiggleroom.live.warm_start import State, TimeBudget, WarmSearch, free_of_overlap, state_at, state_at_rest
from wiggleroom.program.objectives import Approach, Points
from wiggleroom.search.answer import Contact
from wiggleroom.search.contact_forces import contact_forces, contacts
from wiggleroom.search.prepare import Prepared
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Dragged = tuple[State, WarmSearch | None, bool]
"""Where a drag ended, the search, and whether nothing more can be gained."""

STAY_WEIGHT = 1e4
"""Weight of the dragged body's place against those of the others that go back."""
BACK_TOLERANCE = 0.02
"""Bodies that are this share of the clearance from where they were stay there; the dragged one goes no further by their return."""
BACK_ROUNDS = 3
"""Others go straight back and are pulled back this many times in turn, at most."""
WAYS: tuple[tuple[int, ...], ...] = ((), (2,), (0, 2), (1, 2), (0,), (1,))
"""Coordinates in which a body goes back first: none for all at once."""
LEAST_GAIN = 0.05
"""Others stay where they are if going back makes their way shorter by less than this share."""
ARRIVAL_TOLERANCE = 1e-3
"""A grip this share of the clearance from its target has arrived."""


def dragged(
    ready: Prepared, term: Approach, state: State, whole: float, until: TimeBudget, enough: float | None = None
) -> Dragged:
    """Drag from a state, with all bodies free to move; `whole` [mm2] is the squared distance from rest to the target."""
    here = term.value(state.inner)  # what counts is what is gained from there
    if enough is None:
        enough = whole - here - (ARRIVAL_TOLERANCE * ready.clearance) ** 2
    search = WarmSearch(ready, replace(term, zero=here), state, until, enough)
    after, settled = search.reach()
    return after, search, settled


def dragged_among_few(
    ready: Prepared,
    term: Approach,
    aim: Floats,
    state: State,
    count: int | None,
    until: TimeBudget,
    pinned: frozenset[int] = frozenset(),
) -> Dragged | None:
    """Drag with `count` bodies free to move, or all but the pinned ones, settled where no other could help.

    None where these are all bodies, or others may be met.
    """
    near = neighbourhood(ready, state, int(term.points.body[0]), count, pinned)
    if near is None:
        return None
    body = int(np.searchsorted(near.body, term.points.body[0]))
    points = Points(np.array([body]), term.points.turned(state.inner))
    grip = aim + term.apart[0] + term.points.moved(state.inner)[0]
    local = Approach(points, (grip - aim)[None], term.weight)
    there, search, settled = dragged(
        near.ready, local, state_at_rest(near.ready), float((grip - aim) @ (grip - aim)), until
    )
    assert search is not None
    if near.left(search):
        return None
    after = near.whole(state, there)
    if pinned:  # they stand where they are seen, not at the point inside all cells
        motion = after.motion.copy()
        motion[list(pinned)] = state.motion[list(pinned)]
        after = replace(after, motion=motion)
    if not free_of_overlap(ready, after.motion, state.motion):
        return None
    short = float(np.hypot(*(grip + points.moved(there.motion)[0] - aim)))
    if settled and short > ARRIVAL_TOLERANCE * ready.clearance:
        held = holding_contacts(search, 1.0)
        settled = not near.held.intersection(name for contact in held for name in contact.parts)
    return after, search, settled


def others_back(
    ready: Prepared, before: State, origin: State, body: int, pinned: frozenset[int], until: TimeBudget
) -> State | None:
    """The state after all free bodies but one went back towards another state; None where that makes their way hardly shorter."""
    bodies, state, began = ready.bodies, before, origin.motion
    others = np.array([k for k in np.flatnonzero(~bodies.fixed) if k != body and k not in pinned], dtype=np.int64)
    tiny = BACK_TOLERANCE * ready.clearance
    gone = _corner_distance(bodies.radius, state.motion - began)
    if not len(others) or gone[others].max() <= tiny:
        return None
    for _ in range(BACK_ROUNDS):
        near = _corner_distance(bodies.radius, state.motion - began)
        state = _straight_back(ready, state, origin, others[near[others] > tiny], until)
        near = _corner_distance(bodies.radius, state.motion - began)
        if near[others].max() <= tiny or pinned or until.is_set():  # the search would move what is not fixed
            break
        state = _pulled_back(ready, state, began, body, others, until)
    moved = _corner_distance(bodies.radius, state.motion - before.motion)[body]
    now = _corner_distance(bodies.radius, state.motion - began)
    better = float(now[others].sum()) < (1 - LEAST_GAIN) * float(gone[others].sum())
    return state if better and moved <= tiny and not until.interrupt.is_set() else None


def _straight_back(ready: Prepared, state: State, origin: State, gone: Ints, until: TimeBudget) -> State:
    """The state after bodies went straight back to where another state has them, all at once or one by one, where that way is free."""

    def free(there: Floats, here: Floats) -> bool:
        """Whether the way there is free, straight, or first in some coordinates and then in the others."""
        for first in WAYS:
            between = here.copy()
            between[:, first] = there[:, first]
            way = np.array([here, between, there] if first else [here, there])
            if audit_path(ready.outlines, of_parts(ready.assembly, ready.bodies, way)).free:
                return True
        return False

    began = origin.motion
    motion = state.motion.copy()
    motion[gone] = began[gone]
    if not free(motion, state.motion):
        motion = state.motion.copy()
        far = _corner_distance(ready.bodies.radius, motion - began)
        for one in gone[np.argsort(-far[gone], kind="stable")]:
            if until.is_set():
                break
            ahead = motion.copy()
            ahead[one] = began[one]
            if free(ahead, motion):
                motion = ahead
    back = (motion != state.motion).any(axis=1)
    inner = np.where(back[:, None], origin.inner, state.inner)
    after = state_at(ready, motion, inner) if back.any() else None
    return state if after is None else replace(after, linked=state.linked)


def _pulled_back(ready: Prepared, state: State, began: Floats, body: int, others: Ints, until: TimeBudget) -> State:
    """The state after a search that pulls all others towards a motion (n, 3) and holds one body where it is."""
    arm = np.zeros((2 * (len(others) + 1), 2))
    arm[1::2, 0] = ready.bodies.radius[[body, *others]]
    points = Points(np.repeat([body, *others], 2), arm)
    there = began.copy()
    there[body] = state.motion[body]
    weight = np.ones(len(arm))
    weight[:2] = STAY_WEIGHT
    return dragged(ready, Approach(points, -points.moved(there), weight), state, 0.0, until, enough=np.inf)[0]


def _corner_distance(radius: Floats, motion: Floats) -> Floats:
    """How far (n,) a point at the radius of each body goes at most [mm]."""
    return np.asarray(np.hypot(motion[:, 0], motion[:, 1]) + radius * np.abs(motion[:, 2]))


def holding_contacts(search: WarmSearch, unit: float) -> tuple[Contact, ...]:
    """Contacts that hold the best motion, forces in this unit."""
    found = search.best
    if found is None or found.solution.status is not SolverStatus.CONVERGED:
        return ()
    forces = contact_forces(found.program, found.solution.u, found.active)
    return contacts(search.ready.assembly, found.program, found.solution.u, forces, unit)
