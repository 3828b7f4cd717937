"""The bodies nearest to a dragged one, with all others standing: a small problem whose motions are motions of the whole."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import breadth_first_order

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.freespace.cells.cells import Cells, concatenated, replaced, select
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.overlap import within_reach
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.live.warm_start import FIRST_BARRIER, State, WarmSearch
from wiggleroom.search.prepare import Prepared

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FAR = 1e3
"""Where all bodies are looked at, none goes further than this multiple of the drawing's size."""
REACH_SHARE = 0.5
"""Bodies that come within this share of the median radius of one that may move are looked at; none may go further than that."""


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
