"""Drags: the search that brings a point of a part to a place, among all bodies or among the few that a push reaches first.

With all others standing, these few are a small problem whose motions are motions of the whole.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import breadth_first_order

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.freespace.cells.cells import Cells, concatenated, replaced, select
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.overlap import within_reach
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.live.warm_start import (
    FIRST_BARRIER,
    State,
    TimeBudget,
    WarmSearch,
    free_of_overlap,
    state_at,
    state_at_rest,
)
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

FAR = 1e3
"""Where all bodies are looked at, none goes further than this multiple of the drawing's size."""
REACH_SHARE = 0.5
"""Bodies that come within this share of the median radius of one that may move are looked at; none may go further than that."""


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


@dataclass(frozen=True, eq=False)
class Neighbourhood:
    """Some bodies of an assembly where a state has taken them; few of them may move.

    Parameters
    ----------
    ready : Prepared
        Of these bodies alone, at rest where the state has them.
    body : (k,) int64
        Which bodies of the assembly they are, ascending.
    pair : (p,) int64
        Which pairs of the state's cells their cells are.
    held : frozenset of names
        Parts that stand here although they are free in the assembly.
    reach : float [mm]
        No body that moves by less than this can meet one that is not here.
    """

    ready: Prepared
    body: Ints
    pair: Ints
    held: frozenset[str]
    reach: float

    def whole(self, state: State, local: State) -> State:
        """Return the state of the whole assembly after `local`, a state of this neighbourhood."""
        cells, first = local.cells, len(self.pair)
        there = replace(cells, a=self.body[cells.a], b=self.body[cells.b])
        all_cells = replaced(state.cells, self.pair, select(there, np.arange(first)))
        if len(cells.a) > first:
            all_cells = concatenated(all_cells, select(there, np.arange(first, len(cells.a))))
        inner, motion = state.inner.copy(), state.inner.copy()
        inner[self.body] += local.inner
        motion[self.body] += local.motion
        return replace(state, cells=all_cells, inner=inner, motion=motion, mu=FIRST_BARRIER, near=False, ended=None)

    def left(self, search: WarmSearch) -> bool:
        """True where a body went so far that it may have met one that is not here."""
        if search.best is None:
            return False
        points = [(segment.program, u) for segment in search.best.path for u in segment.points]
        gone = [np.hypot(*program.motion(u)[:, :2].T).max() for program, u in points]
        return max([*gone, float(np.hypot(*search.best.motion[:, :2].T).max())]) > self.reach


def neighbourhood(
    ready: Prepared, state: State, body: int, count: int | None, pinned: frozenset[int] = frozenset()
) -> Neighbourhood | None:
    """Return the `count` free bodies nearest to one by contacts, or all, and what stands round them; None where that would be all.

    Bodies that are pinned stand.
    """
    bodies = ready.bodies
    n, pose = len(bodies.fixed), bodies.rest + state.inner
    movable = np.flatnonzero(~bodies.fixed) if count is None else _nearest(ready, state.cells, body, count)
    movable = movable[~np.isin(movable, list(pinned))]
    if len(movable) >= int((~bodies.fixed).sum()):
        return None
    reach = FAR * ready.size if count is None else REACH_SHARE * float(np.median(bodies.radius))
    who = within_reach(pose[:, :2], bodies.radius, movable, reach)
    moves = np.zeros(n, dtype=bool)
    moves[movable] = True
    local = np.full(n, -1)
    local[who] = np.arange(len(who))
    assembly, here = _standing(ready, state.inner, who, moves)
    cells = state.cells
    pair = np.flatnonzero((local[cells.a] >= 0) & (local[cells.b] >= 0) & (moves[cells.a] | moves[cells.b]))
    some = select(cells, pair)
    some = replace(some, a=local[some.a], b=local[some.b])

    def keys(old: Ints) -> Ints:
        a, b = local[old // n], local[old % n]
        kept = (a >= 0) & (b >= 0)
        return a[kept] * len(who) + b[kept]

    small = Prepared(
        assembly, here, keys(ready.ignored), ready.clearance, ready.size, some, keys(ready.corners), model=ready.model
    )
    still = [p for b in who[~moves[who] & ~bodies.fixed[who]] if b not in pinned for p in bodies.members[b]]
    return Neighbourhood(small, who, pair, frozenset(ready.assembly.parts[p].name for p in still), reach)


def _nearest(ready: Prepared, cells: Cells, body: int, count: int) -> Ints:
    """Free bodies in the order in which a push from `body` comes to them, at most `count`."""
    n, fixed = len(ready.bodies.fixed), ready.bodies.fixed
    a = np.concatenate([cells.a, ready.corners // n])
    b = np.concatenate([cells.b, ready.corners % n])
    both = ~fixed[a] & ~fixed[b]
    graph = sp.csr_matrix((np.ones(both.sum(), dtype=np.int8), (a[both], b[both])), shape=(n, n))
    return breadth_first_order(graph, body, directed=False, return_predecessors=False)[:count].astype(np.int64)


def _standing(ready: Prepared, inner: Floats, who: Ints, moves: NDArray[np.bool_]) -> tuple[Assembly, Bodies]:
    """Return the parts of some bodies where a motion has taken them, and these bodies; all but some are fixed."""
    bodies, assembly = ready.bodies, ready.assembly
    at = assembly.rest + of_parts(assembly, bodies, inner[None])[0]
    order = [p for b in who for p in bodies.members[b]]
    parts = tuple(
        replace(assembly.parts[p], at=tuple(at[p].tolist()), fixed=not moves[bodies.body_of[p]]) for p in order
    )
    names = {part.name for part in parts}
    drawing = replace(
        assembly.drawing,
        parts=parts,
        glue=tuple(group for group in assembly.drawing.glue if names.issuperset(group)),
        ignore=tuple(pair for pair in assembly.drawing.ignore if names.issuperset(pair)),
        gaps=(),
        goals=(),
    )
    count = [len(bodies.members[b]) for b in who]
    first = np.cumsum([0, *count])
    members = tuple(tuple(range(first[k], first[k + 1])) for k in range(len(who)))
    here = Bodies(
        bodies.shapes,
        bodies.shape[who],
        (bodies.rest + inner)[who],
        ~moves[who],
        np.repeat(np.arange(len(who)), count),
        members,
    )
    return Assembly(parts, drawing), here
