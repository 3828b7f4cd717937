"""Bodies that touch and are locked by their contacts alone: how far they get at most, proven for motions of any size.

Contacts that are valid for finite motions say n . (motion of the point as the edge sees it) >= -room. To first order in the motions y
of the bodies (shifts, and turns about one point, lengths in units of their spread) these are rows B y >= -e, and what is left out
is of second order. For each unknown y_k positive forces f with B^T f = e_k or -e_k, which linear programs find, bound it:
|y_k| <= sum(f) e. With M the largest such sum, and e(r) = room + r room + bend r^2 where |y| = r,

    |y| = r and M e(r) < r

contradict each other. So a motion, which is continuous and begins at 0, never gets as far as r. Locked to first order alone would not
do: without the rooms and the curvature one could not tell a lock from a hook shorter than the play of its neighbours.

Source: Rimon and Burdick 1998 for the immobility of bodies by contacts of first and second order; the bound here is elementary.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.form_closure.finite_contacts import FiniteContacts, finite_contacts

if TYPE_CHECKING:
    from scipy import sparse

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_AT_ONCE = 40
"""Groups of bodies whose contacts are looked at together, at most: every one needs six linear programs."""
MAX_SUM = 1e7
"""Forces that must add up to more prove nothing that rounding leaves."""


@dataclass(frozen=True, eq=False)
class ClosureBound:
    """Which bodies their contacts lock.

    Parameters
    ----------
    group : (n,) int64
        Bodies of the same number certainly stay together.
    far : (n,) float64 [mm]
        How far no point of a body ever gets from where it would be, did it move as one with the first body of its group: with what
        stands where that is in it.
    body_of : (parts,) int64
        Body of each part.
    """

    group: Ints
    far: Floats
    body_of: Ints

    @property
    def all_locked(self) -> bool:
        """True where all bodies are locked together."""
        return bool((self.group == self.group[0]).all())


def closure_bound(assembly: Assembly, context: Context = UNLIMITED) -> ClosureBound:
    """Find the bodies that contacts lock: pairs first, then what these have become, in the end all at once.

    Parameters
    ----------
    assembly : Assembly
        As made; contacts with a gap of next to nothing count with it.
    context : Context, optional

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = closure_bound(wr.patterns.chain(3, "swallowtail", gap=0.0))
    >>> found.all_locked, bool(found.far.max() < 1e-4)
    (True, True)
    >>> closure_bound(wr.patterns.chain(3, "finger", gap=0.0)).group.tolist()
    [0, 1, 2]
    """
    contacts = finite_contacts(assembly)
    group, far = np.arange(contacts.count), np.zeros(contacts.count)
    known: dict[bytes, Floats | None] = {}
    again = True
    while again and not context.stopped:
        again = False
        for a, b in _touching_groups(contacts, group):
            if context.stopped:
                break
            pair = np.unique(group[[a, b]])
            if len(pair) == 2 and (moved := _locked(contacts, group, far, pair, known, context)) is not None:
                group, far = _joined(group, moved, pair, contacts.ground)
                again = True
    every = np.unique(group)
    if 2 < len(every) <= MAX_AT_ONCE and not context.stopped:
        moved = _locked(contacts, group, far, every, {}, context)
        if moved is not None:
            group, far = _joined(group, moved, every, contacts.ground)
    return ClosureBound(group, far, contacts.body_of)


def _touching_groups(contacts: FiniteContacts, group: Ints) -> Iterable[tuple[int, int]]:
    """One body of either of two groups that touch, each pair of groups once."""
    pairs = np.sort(group[np.column_stack([contacts.a, contacts.b])], axis=1)
    return [(int(a), int(b)) for a, b in np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)]


def _first(some: Ints, group: Ints, ground: int) -> int:
    """The group that counts as standing: that of what stands, else the one of the lowest number."""
    return int(group[ground]) if group[ground] in some else int(some[0])


def _joined(group: Ints, far: Floats, some: Ints, ground: int) -> tuple[Ints, Floats]:
    return np.where(np.isin(group, some), _first(some, group, ground), group), far


def _locked(
    contacts: FiniteContacts, group: Ints, far: Floats, some: Ints, known: dict[bytes, Floats | None], context: Context
) -> Floats | None:
    """How far bodies get (n,) [mm] once some groups count as one, where contacts lock these; else None."""
    a, b = group[contacts.a], group[contacts.b]
    rows = np.flatnonzero((a != b) & np.isin(a, some) & np.isin(b, some))
    unknowns = 3 * (len(some) - 1)
    if len(rows) <= unknowns:
        return None
    root = _first(some, group, contacts.ground)
    others = some[some != root]
    point = contacts.point[rows]
    middle = point.mean(0)
    unit = float(np.abs(point - middle).max())
    if not unit > 0:
        return None
    B = _rows((point - middle) / unit, contacts.normal[rows], np.searchsorted(others, a[rows]), np.searchsorted(others, b[rows]),
              a[rows] != root, b[rows] != root, unknowns)  # fmt: skip
    key = np.round(B.toarray(), 6).tobytes() if unknowns == 3 else b""
    force = known[key] if key in known else _bounding_forces(B, context)
    known[key] = force  # of congruent pairs it is looked for once, and judged for each
    if force is None:
        return None
    balance = np.concatenate([np.eye(unknowns), -np.eye(unknowns)])
    loose = np.abs(force @ B - balance).sum(1).max()
    worth = force.sum(1).max()
    if not (worth < MAX_SUM and loose + 1e-15 * len(rows) * worth < 0.5):
        return None
    wobble = far[contacts.a[rows]] + far[contacts.b[rows]]
    room = float((contacts.room[rows] + 3 * wobble).max()) / unit
    spread = float(np.hypot(*((point - middle) / unit).T).max())
    speed = 2 * (np.sqrt(2) + spread)  # of a point as an edge sees it, per unit of |y|
    r = 2 * worth * room / (1 - loose)
    error = room + r * room + (speed + spread) * r * r
    shift = float(speed * r * unit + (contacts.room[rows] + wobble).max())
    if not (worth * error < r * (1 - loose) and shift < contacts.valid[rows].min() and r < 0.1):
        return None
    corner_group = group[contacts.body]
    moved = far.copy()
    for g in others.tolist():
        reach = float(np.hypot(*(contacts.corner[corner_group == g] - middle).T).max())
        moved[group == g] += r * (np.sqrt(2) * unit + reach)
    return moved


def _rows(
    arm: Floats, normal: Floats, a: Ints, b: Ints, a_moves: NDArray[np.bool_], b_moves: NDArray[np.bool_], unknowns: int
) -> sparse.csr_array:
    """Rows (k, unknowns): how fast points come away from edges, per shift along x and y and turn of every group that moves."""
    from scipy import sparse  # slow to load

    wrench = np.column_stack([normal, arm[:, 0] * normal[:, 1] - arm[:, 1] * normal[:, 0]])
    blocks = sparse.csr_array((len(arm), unknowns))
    for which, moves, sign in ((b, b_moves, 1.0), (a, a_moves, -1.0)):
        row = np.flatnonzero(moves)
        column = (3 * which[row])[:, None] + np.arange(3)
        blocks = blocks + sparse.csr_array(
            (sign * wrench[row].ravel(), (np.repeat(row, 3), column.ravel())), shape=(len(arm), unknowns)
        )
    return blocks


def _bounding_forces(B: sparse.csr_array, context: Context) -> Floats | None:
    """Forces (2 d, k) >= 0 of least sum with B^T f the unit vectors, and then their negatives; None where there are none."""
    from scipy.optimize import linprog  # slow to load

    k, d = B.shape
    if len(np.unique(B.indices)) < d:
        return None
    force = []
    for sign in (1.0, -1.0):
        for unknown in range(d):
            aim = np.zeros(d)
            aim[unknown] = sign
            if context.stopped:
                return None
            done = linprog(np.ones(k), A_eq=B.T, b_eq=aim, bounds=(0, None), method="highs")
            if done.status != 0:
                return None
            force.append(np.maximum(done.x, 0.0))
    return np.array(force)
