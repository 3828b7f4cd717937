"""B-splines to cubic Béziers: exact up to degree 3, close for rational ones and higher degrees."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.strokes.curves import Complex

Real = NDArray[np.float64]

APPROXIMATION_TOLERANCE = 1e-6
"""Cubics that stand for other curves stray from them by no more than this share of the curve's size."""
MAX_HALVINGS = 12
"""Halvings of one span; only a curve with a spike needs as many."""
SAMPLE_PARAMETERS = np.linspace(0.0, 1.0, 9)[1:-1]


def cubics_of(degree: int, knots: Real, control: Real, weights: Real) -> Complex:
    """Control points (k, 4) [mm] of cubic Béziers that follow a B-spline one after the other.

    Parameters
    ----------
    degree : int
        At least 1.
    knots : (n + degree + 1,) float64
        Not decreasing; clamped or not, the curve runs over knots[degree] to knots[n].
    control : (n, 2) float64 [mm]
    weights : (n,) float64
        Positive; all alike where the spline is not rational.

    Raises
    ------
    ValueError
        With a plain reason, where these make no curve.

    Examples
    --------
    >>> cubics_of(1, np.array([0.0, 0, 1, 1]), np.array([[0.0, 0], [3, 0]]), np.ones(2)).round(12)
    array([[0.+0.j, 1.+0.j, 2.+0.j, 3.+0.j]])
    """
    _check(degree, knots, control, weights)
    spans = _spans(degree, knots, np.column_stack([control * weights[:, None], weights]))
    plain = np.ptp(weights) <= 1e-12 * weights.max()
    if plain and degree <= 3:
        return np.array([_elevated((span[:, 0] + 1j * span[:, 1]) / weights[0]) for span in spans])
    tolerance = APPROXIMATION_TOLERANCE * float(np.ptp(control, axis=0).max())
    pending = [(span, 0) for span in reversed(spans)]
    done: list[Complex] = []
    while pending:
        span, depth = pending.pop()
        cubic = _hermite(span)
        if _strays(span, cubic) <= tolerance or depth == MAX_HALVINGS:
            done.append(cubic)
        else:
            first, second = _halves(span)
            pending += [(second, depth + 1), (first, depth + 1)]
    return np.array(done)


def _check(degree: int, knots: Real, control: Real, weights: Real) -> None:
    n = len(control)
    if not 1 <= degree <= 25 or n <= degree:
        message = f"a spline of degree {degree} cannot have {n} control points"
        raise ValueError(message)
    if len(knots) != n + degree + 1 or len(weights) != n:
        message = f"a spline of {n} control points has {len(knots)} knots; it needs {n + degree + 1}"
        raise ValueError(message)
    if not (np.isfinite(knots).all() and np.isfinite(control).all() and np.isfinite(weights).all()):
        raise ValueError("a spline has a number that is not finite")
    if (np.diff(knots) < 0).any() or knots[degree] >= knots[n]:
        raise ValueError("the knots of a spline must not decrease")
    if weights.min() <= 0:
        raise ValueError("the weights of a spline must be larger than 0")


def _spans(degree: int, knots: Real, points: Real) -> list[Real]:
    """Homogeneous Bézier points (degree + 1, 3) of every span, by Boehm's knot insertion up to full multiplicity."""
    n = len(points)
    low, high = knots[degree], knots[n]
    if n == degree + 1 and knots[0] == low and knots[-1] == high:
        return [points]  # one Bézier already, as most programs write
    for value in np.unique(knots[degree : n + 1]):
        missing = degree - int((knots == value).sum())
        for _ in range(missing):
            knots, points = _inserted(degree, knots, points, value)
    breaks = np.unique(knots[(knots >= low) & (knots <= high)])
    first = [int(np.searchsorted(knots, value, side="right")) - 1 - degree for value in breaks[:-1]]
    return [points[i : i + degree + 1] for i in first]


def _inserted(degree: int, knots: Real, points: Real, value: float) -> tuple[Real, Real]:
    """Insert one knot; the curve stays as it is."""
    k = int(np.searchsorted(knots, value, side="right")) - 1
    k = min(k, len(points) - 1)
    i = np.arange(k - degree + 1, k + 1)
    share = ((value - knots[i]) / (knots[i + degree] - knots[i]))[:, None]
    middle = share * points[i] + (1 - share) * points[i - 1]
    return np.insert(knots, k + 1, value), np.vstack([points[: k - degree + 1], middle, points[k:]])


def _elevated(bezier: Complex) -> Complex:
    """Write a Bézier of degree 1 to 3 as a cubic."""
    while len(bezier) < 4:
        p = len(bezier)
        share = np.arange(1, p) / p
        bezier = np.concatenate([bezier[:1], share * bezier[:-1] + (1 - share) * bezier[1:], bezier[-1:]])
    return bezier


def _flat(points: Real) -> Complex:
    return np.asarray((points[..., 0] + 1j * points[..., 1]) / points[..., 2])


def _hermite(span: Real) -> Complex:
    """Cubic with the ends and end derivatives of a rational Bézier."""
    degree = len(span) - 1
    ends, near = _flat(span[[0, -1]]), _flat(span[[1, -2]])
    handles = degree / 3 * (span[[1, -2], 2] / span[[0, -1], 2]) * (near - ends)
    return np.array([ends[0], ends[0] + handles[0], ends[1] + handles[1], ends[1]])


def _strays(span: Real, cubic: Complex) -> float:
    """Largest distance between a rational Bézier and a cubic [mm], to first order and across the cubic."""
    away = _points(span, SAMPLE_PARAMETERS) - _bezier(cubic, SAMPLE_PARAMETERS)
    step, s = np.diff(cubic), 1 - SAMPLE_PARAMETERS
    tangent = s**2 * step[0] + 2 * s * SAMPLE_PARAMETERS * step[1] + SAMPLE_PARAMETERS**2 * step[2]
    speed = np.abs(tangent)
    across = np.abs((np.conj(tangent) * away).imag) / np.where(speed > 0, speed, 1)
    return float(np.where(speed > 0, across, np.abs(away)).max())


def _bezier(cubic: Complex, t: Real) -> Complex:
    s = 1 - t
    return np.asarray(s**3 * cubic[0] + 3 * s * t * (s * cubic[1] + t * cubic[2]) + t**3 * cubic[3])


def _points(span: Real, t: Real) -> Complex:
    """Points of a rational Bézier, by de Casteljau."""
    level = np.repeat(span[None], len(t), axis=0)
    while level.shape[1] > 1:
        level = (1 - t)[:, None, None] * level[:, :-1] + t[:, None, None] * level[:, 1:]
    return _flat(level[:, 0])


def _halves(span: Real) -> tuple[Real, Real]:
    """Both halves of a rational Bézier, by de Casteljau; weights stay near one."""
    first, second, level = [span[0]], [span[-1]], span
    while len(level) > 1:
        level = (level[:-1] + level[1:]) / 2
        first.append(level[0])
        second.append(level[-1])
    return np.array(first), np.array(second[::-1])
