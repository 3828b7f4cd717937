"""Relative poses of bodies; and relative motion of two parts (as users give it) converted to them (as cells use them), and back.

Slices use a third form: the shift of a point of B that lies in the joint, the *pivot*. A slice
moves little from angle to angle when it is measured there; about a reference point far away it would run off.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.geometry.bodies import Bodies

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def relative_pose(bodies: Bodies, a: Ints, b: Ints, motion: Floats | None = None) -> Floats:
    """B seen from A (P, 3) [mm, mm, rad]: position of B's origin in A's frame and its angle, at rest or moved."""
    pose = bodies.rest if motion is None else bodies.rest + motion
    c, s = np.cos(pose[a, 2]), np.sin(pose[a, 2])
    x, y = (pose[b, :2] - pose[a, :2]).T
    return np.column_stack([c * x + s * y, -s * x + c * y, pose[b, 2] - pose[a, 2]])


@dataclass(frozen=True, eq=False)
class PairFrames:
    """How part b lies against part a at rest, all in the axes of part a's own frame.

    Parameters
    ----------
    turned : float [rad]
        Angle of body A's frame in part a's frame.
    apart : (2,) float64 [mm]
        From body A's origin to the pivot at rest.
    origin : (2,) float64 [mm]
        From the pivot to body B's origin at rest.
    point : (2,) float64 [mm]
        From the pivot to part b's reference point at rest.
    psi : float [rad]
        Angle of body B's frame in body A's frame at rest.
    """

    turned: float
    apart: Floats
    origin: Floats
    point: Floats
    psi: float

    def swing(self, phi: Floats) -> Floats:
        """Motion (k, 2) [mm] of part b's reference point when B turns about the pivot by `phi` (k,) [rad]."""
        return rotated(self.point, phi) - self.point

    def pose(self, shift: Floats, phi: Floats) -> Floats:
        """Relative poses (k, 3) of the bodies, the pivot moved by `shift` (k, 2) [mm], B turned by `phi` (k,)."""
        q = rotated(self.apart + shift + rotated(self.origin, phi), np.full(len(phi), -self.turned))
        return np.column_stack([q, self.psi + phi])

    def shift(self, relative: Floats) -> Floats:
        """Motion of the pivot (k, 2) [mm] for relative motions (k, 3) [mm, mm, rad]."""
        return relative[:, :2] - self.swing(relative[:, 2])


def relate(at_a: Floats, at_b: Floats, body_a: Floats, body_b: Floats, pivot: Floats) -> PairFrames:
    """Put the frames of two parts and of their bodies, all (x, y, angle) at rest, and the pivot (x, y) in relation.

    Examples
    --------
    >>> import numpy as np
    >>> a, b = np.array([0.0, 0.0, np.pi / 2]), np.array([0.0, 3.0, 0.0])
    >>> relation = relate(a, b, a, b, pivot=np.array([0.0, 2.0]))
    >>> relation.swing(np.array([0.1])).round(4)  # a's x axis points up, and so does the way to b
    array([[-0.005 ,  0.0998]])
    """

    def own(vector: Floats) -> Floats:
        return rotated(vector, np.array([-at_a[2]]))[0]

    return PairFrames(
        float(body_a[2] - at_a[2]),
        own(pivot - body_a[:2]),
        own(body_b[:2] - pivot),
        own(at_b[:2] - pivot),
        float(body_b[2] - body_a[2]),
    )


def rotated(points: Floats, angle: Floats | float) -> Floats:
    """Points (2,) or (k, 2), each turned by its angle (k,), or all by one [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)
