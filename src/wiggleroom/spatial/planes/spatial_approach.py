"""What a drag maximises in space: nearness of a material point to a place, while everything else stays where it is if it can."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.spatial.rigid import SpatialPose

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SpatialApproach:
    """Minus half the squared distance of a point of a body from a place, and a weak pull of all bodies back to where they began.

    The pull back is that of the proximal-point method: begun again from its own end, it leads to the same optimum as without.

    Parameters
    ----------
    body : int
    arm : (3,) float64 [mm]
        The point in the body's frame.
    target : (3,) float64 [mm]
    begin : SpatialPose
        Where the bodies began.
    radius : (n,) float64 [mm]
        Of the bodies: a turn counts as the path length of a corner.
    unit : float [mm]
        Values are divided by it, so that they are lengths.
    weight : float
        Of the pull back against the approach.

    Source: proximal-point method, Rockafellar 1976.
    """

    body: int
    arm: Floats
    target: Floats
    begin: SpatialPose
    radius: Floats
    unit: float
    weight: float = 1e-3

    def away(self, pose: SpatialPose) -> Floats:
        """From the target to the point (3,) [mm]."""
        return np.asarray(pose.T[self.body] + pose.R[self.body] @ self.arm - self.target)

    def value(self, pose: SpatialPose, before: float | None = None) -> float:  # noqa: ARG002
        """Value at a pose [mm]."""
        away = self.away(pose)
        shift = (pose.T - self.begin.T) * self._held[:, None]
        trace = np.einsum("nji,nji->n", self.begin.R, pose.R)
        back = (shift**2).sum() + (self.radius**2 * (3 - trace)).sum()
        return -float(away @ away + self.weight * back) / (2 * self.unit)

    def gradient(self, pose: SpatialPose) -> Floats:
        """Derivatives by (dT, a) of every body (n, 6)."""
        M = np.einsum("nji,njk->nik", self.begin.R, pose.R)
        out = np.empty((len(pose.T), 6))
        out[:, :3] = -self.weight * self._held[:, None] * (pose.T - self.begin.T)
        turn = np.stack([M[:, 2, 1] - M[:, 1, 2], M[:, 0, 2] - M[:, 2, 0], M[:, 1, 0] - M[:, 0, 1]], axis=1)
        out[:, 3:] = -self.weight / 2 * self.radius[:, None] ** 2 * turn
        away = self.away(pose)
        out[self.body, :3] -= away
        out[self.body, 3:] -= np.cross(self.arm, pose.R[self.body].T @ away)
        return out / self.unit

    def hessian(self, pose: SpatialPose) -> Floats:
        """Second derivatives by (dT, a) of every body (n, 6, 6)."""
        M = np.einsum("nji,njk->nik", self.begin.R, pose.R)
        trace, eye = np.einsum("nii->n", M), np.eye(3)
        out = np.zeros((len(pose.T), 6, 6))
        out[:, :3, :3] = -self.weight * self._held[:, None, None] * eye
        bend = (M + M.transpose(0, 2, 1)) / 2 - trace[:, None, None] * eye
        out[:, 3:, 3:] = self.weight / 2 * self.radius[:, None, None] ** 2 * bend
        x, y, z = self.arm
        R = pose.R[self.body]
        J = np.hstack([eye, -R @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])])
        g = -R.T @ self.away(pose)
        own = -J.T @ J
        own[3:, 3:] += (np.outer(g, self.arm) + np.outer(self.arm, g)) / 2 - (g @ self.arm) * eye
        out[self.body] += own
        return out / self.unit

    @property
    def couples(self) -> tuple[tuple[int, int], ...]:
        """None: every body for itself."""
        return ()

    def coupled(self, pose: SpatialPose) -> Floats:  # noqa: ARG002
        """No second derivatives by two bodies."""
        return np.zeros((0, 6, 6))

    @property
    def _held(self) -> Floats:
        """One for every body that is held back from going elsewhere, zero for the one that is dragged."""
        held = np.ones(len(self.begin.T))
        held[self.body] = 0.0
        return held
