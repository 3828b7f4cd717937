"""Forces that lock parts drawn tight: a proof, and its check in exact rationals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from wiggleroom.form_closure.point_contacts import PointContacts

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Matrix = list[dict[int, Fraction]]


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
