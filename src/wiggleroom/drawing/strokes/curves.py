"""Curves to corners: as few chords as the bound on their distance from the curve allows.

Points of the plane are complex numbers here. A curve and its reverse give exactly the same points, because curves are
brought into one direction and every distinct curve is divided once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

QUADRATURE_CELLS = 64
"""Cells in which the bend of a curve is summed up; a power of two keeps the grid symmetric to the last bit."""
MOST_COMPARED = 1 << 20
"""Shares compared at once."""
ROUNDING_SHARE = 1e-9
"""Share of the tolerance given to rounding, so that copies of a curve elsewhere in the plane get as many chords."""
MAX_CHORDS = 65536
"""More chords than this for one curve are not made."""


class Curves(Protocol):
    """A batch of k smooth curves over the parameter 0..1."""

    def __len__(self) -> int:
        """Count the curves."""

    def take(self, rows: NDArray[np.intp]) -> Curves:
        """Pick the curves of these rows."""

    def point(self, t: Real) -> Complex:
        """Points at parameters (k, m)."""

    def bend(self, t: Real) -> Real:
        """Second derivative across the direction of travel at parameters (k, m)."""

    def deviation(self, t: Real) -> Real:
        """Largest distance (k,) of the curves from their chords between parameters (k, m + 1)."""

    def multiple(self) -> NDArray[np.intp]:
        """Give the numbers (k,) of which the chords of each curve must be a multiple."""


@dataclass(frozen=True)
class Cubics:
    """Cubic Béziers by their control points (k, 4)."""

    control: Complex

    def __len__(self) -> int:
        """Count the curves."""
        return len(self.control)

    def take(self, rows: NDArray[np.intp]) -> Cubics:
        """Pick the curves of these rows."""
        return Cubics(self.control[rows])

    def multiple(self) -> NDArray[np.intp]:
        """Any number of chords will do."""
        return np.ones(len(self), dtype=np.intp)

    def _powers(self) -> tuple[Complex, Complex, Complex, Complex]:
        p0, p1, p2, p3 = (self.control[:, i, None] for i in range(4))
        return p0, 3 * (p1 - p0), 3 * (p2 - 2 * p1 + p0), p3 - 3 * p2 + 3 * p1 - p0

    def point(self, t: Real) -> Complex:
        """Points at parameters (k, m)."""
        p0, p1, p2, p3 = (self.control[:, i, None] for i in range(4))
        s = 1 - t
        return s**3 * p0 + 3 * s * t * (s * p1 + t * p2) + t**3 * p3

    def bend(self, t: Real) -> Real:
        """Second derivative across the direction of travel at parameters (k, m)."""
        _, a1, a2, a3 = self._powers()
        return _across(a1 + t * (2 * a2 + t * 3 * a3), 2 * a2 + t * 6 * a3)

    def deviation(self, t: Real) -> Real:
        """Across and along a chord the curve is a cubic, whose extremes are roots of a quadratic.

        Exact where the curve does not reach beyond the ends of its chord, else a bound.
        """
        a0, a1, a2, a3 = self._powers()
        at = self.point(t)
        start, chord = at[:, :-1], np.diff(at, axis=1)
        length = np.abs(chord)
        frame = np.where(length > 0, np.conj(chord) / np.where(length > 0, length, 1), 1)
        across, beyond = np.zeros(length.shape), np.zeros(length.shape)
        for part in (np.real, np.imag):
            coefficients = [part(frame * a) for a in (a1, 2 * a2, 3 * a3)]
            for root in _quadratic_roots(*coefficients):
                u = np.clip(root, t[:, :-1], t[:, 1:])
                here = frame * (a0 + u * (a1 + u * (a2 + u * a3)) - start)
                across = np.maximum(across, np.abs(here.imag))
                beyond = np.maximum(beyond, np.maximum(-here.real, here.real - length))
        return np.hypot(across, beyond).max(axis=1)


@dataclass(frozen=True)
class Arcs:
    """Elliptic arcs: centre + u cos a + v sin a, for the angle a from `start` [rad] over `sweep` [rad]; all (k,)."""

    centre: Complex
    u: Complex
    v: Complex
    start: Real
    sweep: Real

    def __len__(self) -> int:
        """Count the curves."""
        return len(self.centre)

    def take(self, rows: NDArray[np.intp]) -> Arcs:
        """Pick the curves of these rows."""
        return Arcs(self.centre[rows], self.u[rows], self.v[rows], self.start[rows], self.sweep[rows])

    def multiple(self) -> NDArray[np.intp]:
        """As many chords in every quarter, so that a circle fits a hole drawn as halves or quarters."""
        quarters = np.abs(self.sweep) / (np.pi / 2)
        whole = np.rint(quarters)
        return np.where((whole >= 1) & (np.abs(quarters - whole) < 1e-9), whole, 1).astype(np.intp)

    def _spoke(self, t: Real) -> tuple[Complex, Complex]:
        angle = self.start[:, None] + self.sweep[:, None] * t
        u, v = self.u[:, None], self.v[:, None]
        return u * np.cos(angle) + v * np.sin(angle), v * np.cos(angle) - u * np.sin(angle)

    def point(self, t: Real) -> Complex:
        """Points at parameters (k, m)."""
        return self.centre[:, None] + self._spoke(t)[0]

    def bend(self, t: Real) -> Real:
        """Second derivative across the direction of travel at parameters (k, m)."""
        spoke, tangent = self._spoke(t)
        return _across(tangent, spoke) * self.sweep[:, None] ** 2

    def deviation(self, t: Real) -> Real:
        """Exact up to a quarter turn a chord; more is never allowed."""
        middle, tangent = self._spoke((t[:, 1:] + t[:, :-1]) / 2)
        step = np.abs(np.diff(t, axis=1) * self.sweep[:, None])
        away = _across(tangent, middle) * (1 - np.cos(step / 2))
        return np.where(step > np.pi / 2 * (1 + 1e-9), np.inf, away).max(axis=1)


def flatten_cubics(control: Complex, tolerance: float) -> list[Complex]:
    """Corners strictly between the ends of cubic Béziers.

    Parameters
    ----------
    control : (k, 4) complex128 [mm]
        Control points.
    tolerance : float [mm]
        No curve is further from its chords than this.

    Returns
    -------
    list of k (m,) complex128 [mm]
        In the direction of each curve; exactly reversed for the reversed curve; none for a straight one.

    Examples
    --------
    >>> arch = np.array([[0, 4j, 4 + 4j, 4]])
    >>> flatten_cubics(arch, 1.0)
    [array([2.+3.j])]
    >>> [len(corners) for corners in flatten_cubics(arch, 0.01)]
    [17]
    """
    if not len(control):
        return []
    flipped = _later(control[:, 0], control[:, 3])
    flipped |= (control[:, 0] == control[:, 3]) & _later(control[:, 1], control[:, 2])
    canonical = np.where(flipped[:, None], control[:, ::-1], control)
    return _distinct(canonical, lambda rows: Cubics(rows), tolerance, flipped)


def flatten_arcs(arcs: Arcs, tolerance: float, flipped: NDArray[np.bool_]) -> list[Complex]:
    """Corners strictly between the ends of elliptic arcs.

    Parameters
    ----------
    arcs : Arcs
        k arcs, each in the direction that its ends decide (whichever way it is travelled).
    tolerance : float [mm]
        No curve is further from its chords than this.
    flipped : (k,) bool
        Arcs that are travelled backwards; their corners are returned in reverse.

    Returns
    -------
    list of k (m,) complex128 [mm]

    Examples
    --------
    >>> circle = Arcs(*(np.array([value]) for value in (0j, 1 + 0j, 1j, 0.0, 2 * np.pi)))
    >>> flatten_arcs(circle, 0.3, np.array([False]))[0].round(12) + 0
    array([ 0.+1.j, -1.+0.j,  0.-1.j])
    """
    if not len(arcs):
        return []
    rows = np.column_stack([arcs.centre, arcs.u, arcs.v, arcs.start + 1j * arcs.sweep])
    return _distinct(
        rows, lambda r: Arcs(r[:, 0], r[:, 1], r[:, 2], r[:, 3].real.copy(), r[:, 3].imag.copy()), tolerance, flipped
    )


def _distinct(
    rows: Complex, make: Callable[[Complex], Curves], tolerance: float, flipped: NDArray[np.bool_]
) -> list[Complex]:
    """Divide each distinct curve once; whoever draws it, and in whichever direction, gets the same corners."""
    plain = np.ascontiguousarray(rows + 0.0).view(np.float64)
    _, first, inverse = np.unique(plain, axis=0, return_index=True, return_inverse=True)
    corners = _divide(make(rows[first]), tolerance)
    return [corners[i][::-1] if turn else corners[i] for i, turn in zip(inverse.ravel(), flipped, strict=True)]


def _divide(curves: Curves, tolerance: float) -> list[Complex]:
    """Chord ends are spread by the root of the bend, which makes all deviations alike; then as few as will do."""
    middles = np.broadcast_to((np.arange(QUADRATURE_CELLS) + 0.5) / QUADRATURE_CELLS, (len(curves), QUADRATURE_CELLS))
    # The small constant moves chord ends along even where a curve turns back on itself without bending.
    bend = curves.bend(middles)
    density = np.sqrt(bend + 1e-12 * bend.max(axis=1, keepdims=True) + 1e-300)
    total = density.mean(axis=1)
    shares = np.zeros((len(curves), QUADRATURE_CELLS + 1))
    np.cumsum(density, axis=1, out=shares[:, 1:])
    shares /= shares[:, -1:]
    unit = curves.multiple()
    estimate = total / np.sqrt(8 * tolerance) - 2  # an asymptotic figure: two fewer are tried first
    count = np.maximum(1, np.ceil(np.minimum(estimate, MAX_CHORDS) / unit - 1e-6)).astype(np.intp) * unit
    corners: list[Complex] = [np.empty(0, complex)] * len(curves)
    pending = np.arange(len(curves))
    while len(pending):
        for n in np.unique(count[pending]):
            rows = pending[count[pending] == n]
            batch, t = curves.take(rows), _spread(shares[rows], int(n))
            done = (batch.deviation(t) <= tolerance * (1 + ROUNDING_SHARE)) | (n >= MAX_CHORDS)
            for row, points in zip(rows[done], batch.point(t)[done], strict=True):
                corners[row] = points[1:-1]
            failed = rows[~done]
            count[failed] += unit[failed] * np.maximum(1, n // (64 * unit[failed]))
            pending = np.setdiff1d(pending, rows[done], assume_unique=True)
    return corners


def _spread(shares: Real, n: int) -> Real:
    """Parameters (k, n + 1) at which the summed-up shares (k, cells + 1) reach 0, 1/n, ..., 1."""
    t = np.empty((len(shares), n + 1))
    t[:, 0], t[:, -1] = 0, 1
    ends = np.arange(1, n) / n
    step = max(1, MOST_COMPARED // shares.size)
    for first in range(0, n - 1, step):
        end = ends[first : first + step]
        cell = np.clip((shares[:, None] <= end[:, None]).sum(axis=2) - 1, 0, QUADRATURE_CELLS - 1)
        low, high = np.take_along_axis(shares, cell, 1), np.take_along_axis(shares, cell + 1, 1)
        t[:, 1 + first : 1 + first + len(end)] = (
            cell + (end - low) / np.where(high > low, high - low, 1)
        ) / QUADRATURE_CELLS
    return t


def _across(tangent: Complex, second: Complex) -> Real:
    """Length of `second` across `tangent`; its whole length where the tangent vanishes."""
    speed = np.abs(tangent)
    cross = np.abs((np.conj(tangent) * second).imag)
    return np.where(speed > 0, cross / np.where(speed > 0, speed, 1), np.abs(second))


def _quadratic_roots(c: Real, b: Real, a: Real) -> tuple[Real, Real]:
    """Real roots of a t2 + b t + c, 0 where there is none: the callers look at clipped roots only."""
    root = np.sqrt(np.maximum(b * b - 4 * a * c, 0))
    q = -0.5 * (b + np.where(b < 0, -root, root))
    with np.errstate(over="ignore"):  # roots far outside are clipped
        first = np.where(a != 0, q / np.where(a != 0, a, 1), 0)
        second = np.where(q != 0, c / np.where(q != 0, q, 1), 0)
    return first, second


def _later(a: Complex, b: Complex) -> NDArray[np.bool_]:
    """Whether `a` comes after `b`, by x, then by y."""
    return (a.real > b.real) | ((a.real == b.real) & (a.imag > b.imag))
