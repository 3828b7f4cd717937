"""Poses in which long pieces of two outlines fit: partial contour matching by local descriptors and votes.

Source: Wolfson, On curve matching (1990); the descriptor here is the contour itself in a frame of its own.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.spatial import KDTree

from wiggleroom.context import UNLIMITED, Context

Floats = NDArray[np.float64]

_OFFSETS = np.concatenate([-np.arange(6, 0, -1), np.arange(1, 7)]) / 6.0
"""Places along the contour, as shares of the window, at which a descriptor looks."""
_BENT = 0.06
"""A contour is salient where it leaves its tangent by more than this share of the window (root mean square)."""
_ANGLE_BIN = 0.12
"""Width of a vote's bin [rad]."""
_VOTES = 3_000_000
"""With more votes only some of the samples are asked."""
_SUPPORT = 0.2
"""Poses with less than this share of the best one's votes are not looked at."""
_CHOICES = 5
"""Poses that are looked at closely for two parts of usual size; more where an outline is longer."""
_OPPOSED = -0.8
"""Largest cosine between the tangents of two contours that touch: they run against each other."""


@dataclass(frozen=True, eq=False)
class SampledContour:
    """All rings of a polygon sampled at equal steps; material lies left of the way.

    Parameters
    ----------
    polygon : shapely.Polygon [mm]
        Its centroid is the origin.
    step, window : float [mm]
        Between samples, and the arc to either side that a descriptor sees.
    points, tangents : (n, 2) float64 [mm], [1]
    headings : (n,) complex128
        Direction of each sample's own frame, from a quarter window before to a quarter window after it.
    descriptors : (n, 24) float64 [mm]
        Where the contour is before and after each sample, in that frame.
    """

    polygon: shapely.Polygon
    step: float
    window: float
    points: Floats
    tangents: Floats
    headings: NDArray[np.complex128]
    descriptors: Floats

    @cached_property
    def tree(self) -> KDTree:
        """For the nearest sample."""
        return KDTree(self.points)

    @cached_property
    def salient(self) -> NDArray[np.bool_]:
        """(n,) where the contour is bent: only there can it tell where another one belongs."""
        across = self.descriptors.reshape(len(self.points), -1, 2)[:, :, 1]
        return np.sqrt((across**2).mean(axis=1)) > _BENT * self.window

    @cached_property
    def radius(self) -> float:
        """Of the circle about the centroid that holds all samples [mm]."""
        return float(np.hypot(*self.points.T).max())

    @property
    def length(self) -> float:
        """Of all rings [mm]."""
        return float(self.polygon.length)


def sampled(polygon: shapely.Polygon, step: float, window: float) -> SampledContour:
    """Samples of a polygon whose centroid is the origin.

    Examples
    --------
    >>> square = sampled(shapely.box(-5, -5, 5, 5), 0.5, 2.0)
    >>> len(square.points), bool(square.salient[0]), bool(square.salient[10])
    (80, True, False)
    """
    polygon = shapely.geometry.polygon.orient(polygon)
    parts = [_ring(shapely.get_coordinates(ring), step, window) for ring in (polygon.exterior, *polygon.interiors)]
    points, tangents, headings, descriptors = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    return SampledContour(polygon, step, window, points, tangents, headings, descriptors)


def _ring(closed: Floats, step: float, window: float) -> tuple[Floats, Floats, NDArray[np.complex128], Floats]:
    """Points, tangents, headings and descriptors of one closed ring."""
    edges = np.hypot(*np.diff(closed, axis=0).T)
    arc = np.concatenate([[0.0], np.cumsum(edges)])
    whole = arc[-1]
    count = max(8, round(whole / step))
    places = np.arange(count) * (whole / count)
    window = min(window, whole / 4)

    def at(s: Floats) -> Floats:
        s = np.mod(s, whole)
        return np.stack([np.interp(s, arc, closed[:, 0]), np.interp(s, arc, closed[:, 1])], axis=-1)

    points = at(places)
    edge = np.minimum(np.searchsorted(arc, places, side="right") - 1, len(edges) - 1)
    tangents: Floats = (closed[edge + 1] - closed[edge]) / np.maximum(edges[edge], 1e-300)[:, None]
    # A frame from two points of the contour is the same for both partners, at corners too.
    chord = at(places + window / 4) - at(places - window / 4)
    chord /= np.maximum(np.hypot(*chord.T), 1e-300)[:, None]
    away = at(places[:, None] + window * _OFFSETS) - points[:, None, :]
    along = np.einsum("nkd,nd->nk", away, chord)
    across = np.einsum("nkd,nd->nk", away, np.column_stack([-chord[:, 1], chord[:, 0]]))
    headings = chord[:, 0] + 1j * chord[:, 1]
    return points, tangents, headings, np.stack([along, across], axis=-1).reshape(count, -1)


@dataclass(frozen=True)
class PlanarPose:
    """A rigid motion of the plane: turn by `angle` [rad] about the origin, then move to (x, y) [mm]."""

    x: float = 0.0
    y: float = 0.0
    angle: float = 0.0

    @property
    def rotation(self) -> Floats:
        """(2, 2), for column vectors."""
        cosine, sine = np.cos(self.angle), np.sin(self.angle)
        return np.array([[cosine, -sine], [sine, cosine]])

    def of(self, points: Floats) -> Floats:
        """Points (n, 2) [mm] moved."""
        return points @ self.rotation.T + (self.x, self.y)

    def after(self, first: PlanarPose) -> PlanarPose:
        """Give this motion after another one."""
        x, y = self.of(np.array([[first.x, first.y]]))[0]
        return PlanarPose(float(x), float(y), self.angle + first.angle)

    def inverse(self) -> PlanarPose:
        """The motion back."""
        x, y = -(np.array([self.x, self.y]) @ self.rotation)
        return PlanarPose(float(x), float(y), -self.angle)


@dataclass(frozen=True, eq=False)
class ContourContact:
    """Where two contours touch.

    Parameters
    ----------
    first, second : (n,) int
        Samples of the one and the other that lie on each other.
    salient : float [mm]
        Length of the second contour along which both are bent.
    """

    first: NDArray[np.int64]
    second: NDArray[np.int64]
    salient: float = 0.0


def contact(a: SampledContour, b: SampledContour, pose: PlanarPose, tolerance: float) -> ContourContact:
    """Samples of b, moved by a pose, that lie on a within a tolerance [mm] and run against it."""
    points = pose.of(b.points)
    reach = np.hypot(tolerance, a.step)
    distance, near = a.tree.query(points, distance_upper_bound=reach)
    second = np.flatnonzero(np.isfinite(distance))
    first = near[second].astype(np.int64)
    tangents = b.tangents[second] @ pose.rotation.T
    normals = np.column_stack([-a.tangents[first, 1], a.tangents[first, 0]])
    off = np.abs(np.einsum("nd,nd->n", points[second] - a.points[first], normals))
    good = (np.einsum("nd,nd->n", a.tangents[first], tangents) < _OPPOSED) & (off <= tolerance)
    first, second = first[good], second[good]
    return ContourContact(first, second, float((a.salient[first] & b.salient[second]).sum()) * b.step)


@dataclass(frozen=True, eq=False)
class ContourMatch:
    """One pose of a second part against a first, and for how long their outlines then fit.

    Parameters
    ----------
    parts : (int, int)
    pose : PlanarPose
        Of the second in the frame of the first.
    salient : float [mm]
        Length of bent contour that fits.
    """

    parts: tuple[int, int]
    pose: PlanarPose
    salient: float = field(compare=False)


def contour_matches(
    contours: list[SampledContour], tolerance: float, context: Context = UNLIMITED
) -> list[ContourMatch]:
    """Poses of every two parts in which bent pieces of their outlines fit, the longest contact first.

    Parameters
    ----------
    contours : list of SampledContour
        All with the same step and window.
    tolerance : float [mm]
        By how much outlines that belong together may miss each other.
    context : Context, optional

    Notes
    -----
    A descriptor of the one must equal that of the other, run backwards. Every pair of equal descriptors votes for one pose;
    poses with many votes are refined by iterated closest points (Besl and McKay 1992).
    """
    owner = np.concatenate([np.full(int(c.salient.sum()), k) for k, c in enumerate(contours)])
    if len(owner) < 2:
        return []
    index = np.concatenate([np.flatnonzero(c.salient) for c in contours])
    ahead = np.concatenate([c.descriptors[c.salient] for c in contours])
    reverse = -ahead.reshape(len(ahead), -1, 2)[:, ::-1].reshape(len(ahead), -1)
    radius = np.sqrt(len(_OFFSETS)) * (2.0 * tolerance + 0.5 * contours[0].step)
    trees = KDTree(ahead), KDTree(reverse)
    stride = 1 + int(trees[0].count_neighbors(trees[1], radius) // _VOTES)
    found = KDTree(ahead[::stride]).query_ball_tree(trees[1], radius)
    i = np.repeat(np.arange(0, len(owner), stride), [len(rows) for rows in found])
    j = np.concatenate([np.asarray(rows, dtype=np.int64) for rows in found])
    i, j = i[owner[i] < owner[j]], j[owner[i] < owner[j]]
    pair = owner[i] * len(contours) + owner[j]
    order = np.argsort(pair, kind="stable")
    numbers, starts = np.unique(pair[order], return_index=True)
    if not len(numbers):
        return []
    usual = float(np.median([c.length for c in contours]))
    result: list[ContourMatch] = []
    for number, rows in zip(numbers.tolist(), np.split(order, starts[1:]), strict=True):
        context.go_on()
        a, b = divmod(number, len(contours))
        count = round(_CHOICES * max(1.0, max(contours[a].length, contours[b].length) / usual))
        result += _refined_matches(contours[a], contours[b], (a, b), (index[i[rows]], index[j[rows]]), count, tolerance)
    return result


def _refined_matches(
    one: SampledContour,
    other: SampledContour,
    parts: tuple[int, int],
    voted: tuple[NDArray[np.int64], NDArray[np.int64]],
    count: int,
    tolerance: float,
) -> list[ContourMatch]:
    """The poses of the second part in the frame of the first that most pairs of samples vote for, refined."""
    i, j = voted
    spin = one.headings[i] / -other.headings[j]
    centre = one.points[i] @ (1, 1j) - spin * (other.points[j] @ (1, 1j))
    width = 0.25 * one.window
    cells = np.rint([np.angle(spin) / _ANGLE_BIN, centre.real / width, centre.imag / width]).astype(np.int64)
    least = cells.min(axis=1, keepdims=True)
    single = np.ravel_multi_index(tuple(cells - least), tuple((np.ptp(cells, axis=1) + 1).tolist()))
    _, cell, votes = np.unique(single, return_inverse=True, return_counts=True)
    middles, spins = (np.bincount(cell, z.real) + 1j * np.bincount(cell, z.imag) for z in (centre, spin))
    matches: list[ContourMatch] = []
    for best in np.argsort(-votes, kind="stable")[:count].tolist():
        if votes[best] < _SUPPORT * votes.max():
            break
        middle = middles[best] / votes[best]
        pose = closest(one, other, PlanarPose(middle.real, middle.imag, float(np.angle(spins[best]))), tolerance)
        if any(same_pose(pose, match.pose, width) for match in matches):
            continue
        salient = contact(one, other, pose, tolerance).salient
        if salient > 0:
            matches.append(ContourMatch(parts, pose, salient))
    return sorted(matches, key=lambda match: -match.salient)


def same_pose(one: PlanarPose, other: PlanarPose, width: float) -> bool:
    """Whether two poses differ by less than a length [mm] and a vote's angle."""
    turn = abs(np.angle(np.exp(1j * (one.angle - other.angle))))
    return bool(turn < _ANGLE_BIN and np.hypot(one.x - other.x, one.y - other.y) < width)


def closest(a: SampledContour, b: SampledContour, pose: PlanarPose, tolerance: float) -> PlanarPose:
    """PlanarPose refined by iterated closest points: distances along the first contour's normals, least squares."""
    for reach in (0.4 * a.window, 2 * tolerance, tolerance, tolerance):
        touch = contact(a, b, pose, max(reach, tolerance))
        if len(touch.first) < 3:
            return pose
        rows, missing = _normal_equations(a, b, pose, touch)
        light = 1e-9 * len(rows) * np.diag([1.0, 1.0, b.window**2])
        step = np.linalg.solve(rows.T @ rows + light, rows.T @ missing)
        pose = PlanarPose(pose.x + step[0], pose.y + step[1], pose.angle + step[2])
    return pose


def clearance(a: SampledContour, b: SampledContour, pose: PlanarPose, tolerance: float) -> float:
    """Distance [mm] between two contours that belong together, where it is the same all along; negative: they overlap."""
    touch = contact(a, b, pose, tolerance)
    if len(touch.first) < 8:
        return 0.0
    rows, missing = _normal_equations(a, b, pose, touch)
    whole = np.column_stack([rows, np.ones(len(rows))])
    return float(np.linalg.lstsq(whole, missing, rcond=1e-3)[0][3])


def _normal_equations(
    a: SampledContour, b: SampledContour, pose: PlanarPose, touch: ContourContact
) -> tuple[Floats, Floats]:
    """How distances along the first contour's normals change with x, y, angle, (n, 3), and what is missing, (n,) [mm]."""
    points = pose.of(b.points[touch.second])
    normals = np.column_stack([-a.tangents[touch.first, 1], a.tangents[touch.first, 0]])
    arm = points - (pose.x, pose.y)
    rows = np.column_stack([normals, arm[:, 0] * normals[:, 1] - arm[:, 1] * normals[:, 0]])
    return rows, np.einsum("nd,nd->n", a.points[touch.first] - points, normals)
