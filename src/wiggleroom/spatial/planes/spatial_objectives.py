"""What is maximised in space: displacements of material points and twists, with exact derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.spatial.rigid import SpatialPose
from wiggleroom.spatial.rotations import quaternion

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Displacement:
    """Weight * direction . displacement of a material point of a body [mm].

    Parameters
    ----------
    body : int
    arm : (3,) float64 [mm]
        The point in the body's frame.
    direction : (3,) float64
        In the world, its length is the weight.
    rest : (3,) float64 [mm]
        Reference point of the body at rest, where its axes are those of the world.
    """

    body: int
    arm: Floats
    direction: Floats
    rest: Floats

    def value(self, pose: SpatialPose, before: float | None) -> float:  # noqa: ARG002
        """Displacement at a pose."""
        b = self.body
        return float(self.direction @ (pose.T[b] - self.rest + (pose.R[b] - np.eye(3)) @ self.arm))

    def derivatives(self, pose: SpatialPose) -> tuple[Floats, Floats]:
        """Gradient (6,) and Hessian (6, 6) by (dT, a)."""
        g = pose.R[self.body].T @ self.direction
        H = np.zeros((6, 6))
        H[3:, 3:] = (np.outer(g, self.arm) + np.outer(self.arm, g)) / 2 - (g @ self.arm) * np.eye(3)
        return np.concatenate([self.direction, np.cross(self.arm, g)]), H


@dataclass(frozen=True, eq=False)
class Twist:
    """Weight * twist of a body about a direction fixed in the world [rad], counted on past half a turn.

    The rotation is a swing, about an axis across the direction, after a twist about it; other axes are free.
    """

    body: int
    direction: Floats
    weight: float

    def value(self, pose: SpatialPose, before: float | None) -> float:
        """Twist at a pose, the one of all that differ by whole turns that lies nearest to `before`."""
        q = quaternion(pose.R[self.body])
        angle = 2 * np.arctan2(q[1:] @ self.direction, q[0])
        if before is None:
            return float(self.weight * (angle - 2 * np.pi * np.round(angle / (2 * np.pi))))
        turns = np.round((before / self.weight - angle) / (2 * np.pi))
        return float(self.weight * (angle + 2 * np.pi * turns))

    def derivatives(self, pose: SpatialPose) -> tuple[Floats, Floats]:
        """Gradient (6,) and Hessian (6, 6) by (dT, a)."""
        q = quaternion(pose.R[self.body])
        w, v, e = q[0], q[1:], self.direction
        s = v @ e
        ds, dw = (w * e + np.cross(e, v)) / 2, -v / 2
        square = max(s * s + w * w, 1e-12)
        gradient, H = np.zeros(6), np.zeros((6, 6))
        gradient[3:] = 2 * self.weight * (w * ds - s * dw) / square
        cross = np.outer(ds, dw) + np.outer(dw, ds)
        bend = 2 * w * s * (np.outer(dw, dw) - np.outer(ds, ds)) + (s * s - w * w) * cross
        H[3:, 3:] = 2 * self.weight * bend / square**2
        return gradient, H


@dataclass(frozen=True, eq=False)
class SumOfTerms:
    """Sum of displacements and twists.

    At most one twist is counted on past half a turn exactly; of several, each is counted by its own last value.
    """

    terms: tuple[Displacement | Twist, ...]

    def value(self, pose: SpatialPose, before: float | None = None) -> float:
        """Value at a pose."""
        if len(self.terms) == 1:
            return self.terms[0].value(pose, before)
        others = sum(t.value(pose, None) for t in self.terms if isinstance(t, Displacement))
        twists = [t for t in self.terms if isinstance(t, Twist)]
        if len(twists) == 1:
            return others + twists[0].value(pose, None if before is None else before - others)
        return others + sum(t.value(pose, None) for t in twists)

    def gradient(self, pose: SpatialPose) -> Floats:
        """Derivatives by (dT, a) of every body (n, 6)."""
        out = np.zeros((len(pose.T), 6))
        for term in self.terms:
            out[term.body] += term.derivatives(pose)[0]
        return out

    def hessian(self, pose: SpatialPose) -> Floats:
        """Second derivatives by (dT, a) of every body (n, 6, 6)."""
        out = np.zeros((len(pose.T), 6, 6))
        for term in self.terms:
            out[term.body] += term.derivatives(pose)[1]
        return out
