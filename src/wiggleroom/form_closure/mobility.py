"""Are parts drawn tight locked, or can some begin to move: the test by first-order motions, with proof.

A motion gives every body a twist y = (vx, vy, w) about one origin; a contact at p with normal n, from a into b, allows it where
n . (velocity of b at p - velocity of a at p) >= 0: together B y >= 0 with the standing body at rest. Only y = 0 is allowed exactly
where B has full rank and B^T f = 0 has a solution with every force f > 0 (Stiemke). Such forces are a proof that anyone can check, see
`wiggleroom.form_closure.mobility`.

Sources: Wilson and Latombe 1994 for first-order motions of assemblies; Wang, Song, Isvoranu and Pauly 2019 for the rows. Their
linear program looks for contacts that open and takes sliding and spinning parts for locked; here the rank is tested too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import qr
from scipy.sparse import csgraph
from scipy.sparse.linalg import eigsh, splu

from wiggleroom.assembly.assembly import Assembly, require_planar
from wiggleroom.displayable import Displayable
from wiggleroom.form_closure.point_contacts import PointContacts, point_contacts
from wiggleroom.verdict import Tightness

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_VELOCITY = 1e6
"""Largest entry of a first-order motion that opens every contact it opens by at least 1 (lengths in sizes of the bodies)."""
EIGENVALUE_TOLERANCE = 1e-12
"""Eigenvalues of B^T B below this share of the largest are zero: contacts only slide there."""
MAX_DENSE_UNKNOWNS = 300
"""Up to this many unknowns the eigenvalues are worked out without sparse matrices."""

Matrix = list[dict[int, Fraction]]


@dataclass(frozen=True, eq=False)
class TightVerdict(Displayable):
    """Whether parts drawn tight are locked.

    Parameters
    ----------
    verdict : Tightness
        "locked": no part can move against any other, proven by `locks`. "moves": `motion` keeps every contact to first order; the
        curvature of contacts may stop it (second-order immobility), which is not tested.
    motion : (parts, 3) float64 or None [mm, mm, rad]
        First-order motion of every part about its reference point, scaled so that the fastest corner moves about 1 mm.
    moving : tuple of str
        Parts that move in it.
    locks : tuple of SelfStress
        Forces that prove groups of bodies locked together, one step after the other; all of them if the verdict is "locked".
    contacts : PointContacts
    """

    verdict: Tightness
    motion: Floats | None
    moving: tuple[str, ...]
    locks: tuple[SelfStress, ...]
    contacts: PointContacts

    def verify(self) -> bool:
        """Check the proof of "locked", or that `motion` keeps all contacts, apart from how they were found.

        The proof is checked in exact rationals; it says that the contacts as listed cannot all hold. The motion is checked to 1e-6.
        """
        if self.verdict is Tightness.LOCKED:
            return prove_form_closure(self.contacts, self.locks)
        if self.motion is None or not np.abs(self.motion).max() > 0:
            return False
        return bool((opening(self.contacts, self.motion) >= -1e-6).all())


def tight_verdict(assembly: Assembly, within: float | None = None) -> TightVerdict:
    """Whether the parts, as drawn tight, are locked or can begin to move.

    Fixed parts stand; if none is fixed, the largest part stands. An assembly with a gap is taken as drawn, before the gap.

    Parameters
    ----------
    assembly : Assembly
    within : float, optional [mm]
        Outlines closer than this touch; by default a millionth of the drawing's size.

    Raises
    ------
    InputError
        If `within` is no length.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> str(wr.tight_verdict(wr.patterns.grid(3, 3, "swallowtail")).verdict)
    'locked'
    >>> wr.tight_verdict(wr.patterns.chain(2, "finger")).moving
    ('b2',)
    """
    require_planar(assembly, "tight_verdict")
    contacts = point_contacts(assembly, within)
    label, locks = _joined(contacts)
    if label.max() == 0:
        return TightVerdict(Tightness.LOCKED, None, (), locks, contacts)
    ground = label[contacts.ground]
    twist, force, rows = _together(contacts, label, ground)
    if twist is None:
        return TightVerdict(Tightness.LOCKED, None, (), (*locks, SelfStress(rows, force)), contacts)
    motion = _of_parts(contacts, twist)
    speed = np.hypot(*motion[:, :2].T) + np.abs(motion[:, 2]) * contacts.reach
    motion /= speed.max()
    moving = tuple(name for name, v in zip(contacts.names, speed / speed.max(), strict=True) if v > 1e-6)
    return TightVerdict(Tightness.MOVES, motion, moving, locks, contacts)


def opening(contacts: PointContacts, motion: Floats) -> Floats:
    """How fast contacts open (k,) [mm] under a first-order motion (parts, 3) of parts about their reference points."""
    first = np.unique(contacts.body_of, return_index=True)[1]
    body = motion[first]
    arm_a, arm_b = (contacts.point - contacts.reference[first[x]] for x in (contacts.a, contacts.b))
    va, vb = (
        body[x, :2] + body[x, 2:] * np.column_stack([-arm[:, 1], arm[:, 0]])
        for x, arm in ((contacts.a, arm_a), (contacts.b, arm_b))
    )
    return np.asarray(((vb - va) * contacts.normal).sum(1))


def contact_wrenches(contacts: PointContacts, rows: Ints) -> Floats:
    """Rows (k, 3) of contacts for relative twists about the middle of them all, lengths in units of their spread."""
    point = contacts.point[rows]
    middle = point.mean(0)
    return _wrenches(contacts, rows, middle, max(np.abs(point - middle).max(), 1e-300))


def _wrenches(contacts: PointContacts, rows: Ints, middle: Floats, length: float) -> Floats:
    """Rows (k, 3) of contacts for relative twists about `middle`, in units of `length`."""
    arm = (contacts.point[rows] - middle) / length
    n = contacts.normal[rows]
    return np.column_stack([n, arm[:, 0] * n[:, 1] - arm[:, 1] * n[:, 0]])


def _joined(contacts: PointContacts) -> tuple[Ints, tuple[SelfStress, ...]]:
    """Bodies that the contacts of pairs alone lock together, until no such pair is left, and the forces that prove it."""
    label = np.arange(contacts.count)
    locks: list[SelfStress] = []
    known: dict[bytes, Floats | None] = {}
    while True:
        pairs, found = [], []
        for rows in _pairs(label[contacts.a], label[contacts.b]):
            W = contact_wrenches(contacts, rows)
            W *= np.where(label[contacts.a[rows]] < label[contacts.b[rows]], 1.0, -1.0)[:, None]
            key = np.round(W, 6).tobytes()  # congruent pairs once
            if key not in known:
                known[key] = cone(sparse.csr_array(W))[1]
            force = known[key]
            if force is not None:
                pairs.append(np.sort(label[[contacts.a[rows[0]], contacts.b[rows[0]]]]))
                found.append(SelfStress(rows, _balanced(sparse.csr_array(W), force)))
        if not pairs:
            return label, tuple(locks)
        i, j = np.array(pairs).T
        graph = sparse.csr_array((np.arange(1, len(i) + 1), (i, j)), shape=(label.max() + 1,) * 2)
        tree = csgraph.minimum_spanning_tree(graph)
        locks += [found[k] for k in np.sort(tree.data.astype(np.int64)) - 1]
        label = csgraph.connected_components(tree, directed=False)[1].astype(np.int64)[label]


def _pairs(a: Ints, b: Ints) -> Iterator[Ints]:
    """Rows of every pair of different bodies."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    rows = np.flatnonzero(low != high)
    order = rows[np.lexsort((high[rows], low[rows]))]
    cut = np.flatnonzero((np.diff(low[order]) != 0) | (np.diff(high[order]) != 0)) + 1
    return (piece for piece in np.split(order, cut) if len(piece))


def _together(contacts: PointContacts, label: Ints, ground: int) -> tuple[Floats | None, Floats, Ints]:
    """First-order motion of all bodies (n, 3) about the origin, or the forces that rule it out, and the contacts they act at."""
    a, b = label[contacts.a], label[contacts.b]
    rows = np.flatnonzero(a != b)
    count = int(label.max()) + 1
    middle = contacts.reference.mean(0)
    length = contacts.size / np.sqrt(count)
    w = _wrenches(contacts, rows, middle, length)
    column = np.where(np.arange(count) > ground, np.arange(count) - 1, np.arange(count))
    blocks = []
    for body, sign in ((b[rows], 1.0), (a[rows], -1.0)):
        free = np.flatnonzero(body != ground)
        index = (3 * column[body[free]])[:, None] + np.arange(3)
        at = np.repeat(free, 3)
        blocks.append(sparse.coo_array((sign * w[free].ravel(), (at, index.ravel())), (len(rows), 3 * count - 3)))
    y, force = cone((blocks[0] + blocks[1]).tocsr())
    if y is None:
        return None, np.asarray(force), rows
    twist = np.insert(y.reshape(-1, 3), ground, 0.0, axis=0)
    twist[:, 2] /= length
    twist[:, :2] += twist[:, 2:] * [middle[1], -middle[0]]
    return twist[label], np.zeros(0), rows


def _of_parts(contacts: PointContacts, twist: Floats) -> Floats:
    """Motions of parts about their reference points from twists of bodies about the origin."""
    motion = twist[contacts.body_of]
    x, y = contacts.reference.T
    motion[:, :2] += motion[:, 2:] * np.column_stack([-y, x])
    return motion


def cone(B: sparse.csr_array) -> tuple[Floats | None, Floats | None]:
    """A direction y (d,) other than 0 with B y >= 0, or forces f (k,) > 0 with B^T f = 0 that show there is none.

    One linear program, max sum g with B^T (g + h) = 0, 0 <= g <= 1, h >= 0: its multipliers open as many rows as possible; where
    they open none, f = g + h is at least 1 everywhere, and y remains only in the null space of B.

    Parameters
    ----------
    B : (k, d) sparse array
        Entries of the order of 1.

    Returns
    -------
    y : (d,) float64 or None
    f : (k,) float64 or None
        Exactly one of the two.

    Examples
    --------
    >>> slot = sparse.csr_array([[1.0, 0.0], [-1.0, 0.0]])  # between two walls: slides along y
    >>> y, f = cone(slot)
    >>> y.round(6).tolist(), f
    ([0.0, 1.0], None)
    """
    from scipy.optimize import linprog  # slow to load

    k, d = B.shape
    if k == 0 or len(np.unique(B.indices)) < d:
        y = np.zeros(d)
        y[np.setdiff1d(np.arange(d), B.indices)[0] if k else 0] = 1.0
        return y, None
    one = sparse.eye_array(d)
    done = linprog(
        np.r_[-np.ones(k), np.zeros(k), np.full(2 * d, MAX_VELOCITY)],
        A_eq=sparse.hstack([B.T, B.T, one, -one]).tocsc(),
        b_eq=np.zeros(d),
        bounds=[(0, 1)] * k + [(0, None)] * (k + 2 * d),
        method="highs",
    )
    if done.status != 0:
        message = f"the test for first-order motions did not end: {done.message}"
        raise RuntimeError(message)
    closed = -done.fun > k - 0.5
    if not closed:
        y = np.asarray(done.eqlin.marginals)
        y = y if (B @ y).sum() > 0 else -y
        return y / np.abs(y).max(), None
    slide = _null(B)
    return (slide, None) if slide is not None else (None, _balanced(B, done.x[:k] + done.x[k : 2 * k]))


def _null(B: sparse.csr_array) -> Floats | None:
    """A direction with B y = 0, largest entry 1, or None where B has full rank."""
    K = (B.T @ B).tocsc()
    largest = float(K.diagonal().max())
    if K.shape[0] <= MAX_DENSE_UNKNOWNS:
        value, vector = np.linalg.eigh(K.toarray())
    else:
        value, vector = eigsh(K, k=1, sigma=-1e-10 * largest, which="LM", v0=np.ones(K.shape[0]))
    if value[0] > EIGENVALUE_TOLERANCE * largest:
        return None
    y = vector[:, 0] / vector[np.abs(vector[:, 0]).argmax(), 0]
    return np.where(np.abs(y) < 1e-12, 0.0, y)


def _balanced(B: sparse.csr_array, force: Floats) -> Floats:
    """Forces near `force` whose balance B^T f = 0 is as good as rounding allows."""
    solve = splu((B.T @ B).tocsc())
    for _ in range(3):
        force = force - B @ solve.solve(B.T @ force)
    return force


@dataclass(frozen=True, eq=False)
class SelfStress:
    """Positive forces in balance that lock bodies against each other.

    Parameters
    ----------
    contact : (k,) int64
        Numbers of contacts. The bodies they join, each with whatever earlier locks joined to it, are locked together.
    force : (k,) float64
        Force at each contact along its normal, all positive; every body is in balance.
    """

    contact: Ints
    force: Floats


def prove_form_closure(contacts: PointContacts, locks: Sequence[SelfStress]) -> bool:
    """Whether the locks prove, in exact rationals, that no body can move against any other to first order.

    Every lock is checked by itself. Let B be the rows of its contacts. With forces f >= s > 0 that leave r = B^T f
    unbalanced (rounding), and a matrix L with L B' = I - D for some rows B' of B, a motion y with B y >= 0 obeys
    s (1 - |D|) |y| <= |L| |r|_1 |y| (largest-entry norms). Where s (1 - |D|) > |L| |r|_1 only y = 0 is left.
    Coordinates and forces are taken exactly as the floating-point numbers they are, so the check itself makes no
    rounding error. Its time grows with the square of the number of bodies that one lock joins; hundreds take seconds.

    Examples
    --------
    >>> from wiggleroom.form_closure.mobility import tight_verdict
    >>> from wiggleroom.assembly.patterns import chain
    >>> found = tight_verdict(chain(4, "tee"))
    >>> prove_form_closure(found.contacts, found.locks), prove_form_closure(found.contacts, found.locks[:-1])
    (True, False)
    """
    label = np.arange(contacts.count)
    for lock in locks:
        a, b = label[contacts.a[lock.contact]], label[contacts.b[lock.contact]]
        bodies = np.unique(np.r_[a, b])
        if len(bodies) < 2 or not (np.isfinite(lock.force).all() and (lock.force > 0).all()):
            return False
        rows = _rows(contacts, lock.contact, np.searchsorted(bodies, a), np.searchsorted(bodies, b))
        length = np.hypot(*(contacts.edge[lock.contact, 1] - contacts.edge[lock.contact, 0]).T)
        force = lock.force / (
            length / 2.0 ** np.frexp(length)[1]
        )  # for rows scaled like those; any positive numbers would do
        if not _locked(rows, [Fraction(f) for f in force.tolist()], 3 * (len(bodies) - 1)):
            return False
        label[np.isin(label, bodies)] = bodies[0]
    return bool((label == label[0]).all())


def _rows(contacts: PointContacts, which: Ints, a: Ints, b: Ints) -> Matrix:
    """Rows of B without body 0, scaled by powers of 2, as columns and entries."""
    point, edge = contacts.point[which], contacts.edge[which]
    middle = [Fraction(x) for x in point.mean(0).tolist()]
    unit = _power(float(np.ptp(point, axis=0).max()))
    rows: Matrix = []
    for p, (start, end), i, j in zip(point.tolist(), edge.tolist(), a.tolist(), b.tolist(), strict=True):
        scale = _power(float(np.hypot(end[0] - start[0], end[1] - start[1])))
        nx = (Fraction(end[1]) - Fraction(start[1])) / scale
        ny = (Fraction(start[0]) - Fraction(end[0])) / scale
        x, y = ((Fraction(v) - m) / unit for v, m in zip(p, middle, strict=True))
        wrench = (nx, ny, x * ny - y * nx)
        row: dict[int, Fraction] = {}
        for body, sign in ((j, 1), (i, -1)):
            if body:
                row |= {3 * body - 3 + c: sign * w for c, w in enumerate(wrench)}
        rows.append(row)
    return rows


def _power(length: float) -> Fraction:
    """The power of 2 next above a length: dividing by it leaves numbers of finitely many binary digits."""
    return Fraction(2) ** int(np.frexp(length)[1])


def _locked(rows: Matrix, force: list[Fraction], d: int) -> bool:
    """Whether B y >= 0 leaves only y = 0; all sums exact."""
    if len(rows) <= d:
        return False
    B = np.zeros((len(rows), d))
    for k, row in enumerate(rows):
        B[k, list(row)] = [float(v) for v in row.values()]
    chosen = qr(B.T, mode="r", pivoting=True)[1][:d]
    try:
        inverse = np.linalg.inv(B[chosen])
    except np.linalg.LinAlgError:
        return False
    if not np.abs(inverse).max() < 1e12:
        return False
    loose = [Fraction(0)] * d
    for row, f in zip(rows, force, strict=True):
        for column, value in row.items():
            loose[column] += f * value
    # entries as whole numbers over one denominator each: exact, and quicker than fractions
    below = max(value.denominator for row in rows for value in row.values())
    digits = 2**60
    L = np.array([[int(v * digits) for v in numbers] for numbers in inverse.tolist()], dtype=object)
    left = np.zeros((d, d), dtype=object)
    for n, k in enumerate(chosen.tolist()):
        for column, value in rows[k].items():
            left[:, column] += L[:, n] * (value.numerator * (below // value.denominator))
    left[np.diag_indices(d)] -= digits * below
    spread = Fraction(int(np.abs(left).sum(1).max()), digits * below)
    largest = Fraction(int(np.abs(L).sum(1).max()), digits)
    return min(force) * (1 - spread) > largest * sum(map(abs, loose), Fraction(0))
