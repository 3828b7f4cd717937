"""Timing of a film: constant speed along the path, slower at both ends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.errors import InputError
from wiggleroom.geometry.bodies import Bodies, bodies
from wiggleroom.geometry.rigid_motions import about

Floats = NDArray[np.float64]


class TimedPath:
    """Motions along a path by its length, straight about the centroids of the bodies between its points.

    Straight about the centroids, because that is how paths are checked; glued parts keep together.

    Parameters
    ----------
    assembly : Assembly
    points : (k, n, 3) float64 [mm, mm, rad]
        Motions of the parts about their reference points, k >= 1.

    Raises
    ------
    InputError
        If the points have another shape or are not finite.

    Examples
    --------
    >>> import numpy as np
    >>> import wiggleroom as wr
    >>> path = TimedPath(wr.patterns.chain(2), np.array([[[0, 0, 0], [0, 0, 0]], [[0, 0, 0], [0, 3.0, 0]]]))
    >>> path.length, float(path.at(np.array([1.5]))[0, 1, 1])
    (3.0, 1.5)
    """

    def __init__(self, assembly: Assembly, points: Floats) -> None:
        points = checked_waypoints(assembly, points)
        them = bodies(assembly)
        self._arm = them.rest[them.body_of, :2] - assembly.rest[:, :2]
        self._centred = about(points, self._arm)
        self._passed = np.concatenate([[0.0], np.cumsum(_lengths(self._centred, them))])

    @property
    def length(self) -> float:
        """How far the corner that moves most goes along the path, about [mm]."""
        return float(self._passed[-1])

    def at(self, lengths: Floats) -> Floats:
        """Motions (m, n, 3) [mm, mm, rad] after some lengths (m,) [mm] of the path."""
        if len(self._centred) == 1:
            return np.repeat(about(self._centred, -self._arm), len(lengths), axis=0)
        piece = np.clip(np.searchsorted(self._passed, lengths, side="right") - 1, 0, len(self._passed) - 2)
        span = np.diff(self._passed)[piece]
        share = np.divide(lengths - self._passed[piece], span, out=np.zeros(len(lengths)), where=span > 0)
        share = np.clip(share, 0.0, 1.0)[:, None, None]
        return about((1 - share) * self._centred[piece] + share * self._centred[piece + 1], -self._arm)


def checked_waypoints(assembly: Assembly, points: Floats) -> Floats:
    """Check the motions along a path, (k, n, 3) [mm, mm, rad].

    Raises
    ------
    InputError
        If they have another shape, or are not finite.
    """
    points, n = np.asarray(points, dtype=float), len(assembly.parts)
    if points.ndim != 3 or points.shape[1:] != (n, 3) or not len(points) or not np.isfinite(points).all():
        finding = (
            f"waypoints have shape {points.shape}: they must be (k, {n}, 3) finite numbers, x, y [mm] and turn [rad]"
        )
        raise InputError(finding)
    return points


def ease_in_out(count: int) -> Floats:
    """Shares (count,) of a path that begins and ends gently.

    >>> ease_in_out(3).round(9).tolist()
    [0.0, 0.5, 1.0]
    """
    return (1.0 - np.cos(np.linspace(0.0, np.pi, count))) / 2


def _lengths(centred: Floats, them: Bodies) -> Floats:
    """Length of every piece of a path [mm]: how far the corner that moves most goes, at most."""
    step = np.abs(np.diff(centred, axis=0))
    reach = np.hypot(step[:, :, 0], step[:, :, 1]) + step[:, :, 2] * them.radius[them.body_of]
    return reach.max(axis=1, initial=0.0)
