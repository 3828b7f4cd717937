"""What is maximised in space: displacements of material points, their squares, twists and nearness, with exact derivatives.

A drag maximises the nearness of a material point to a place, while everything else stays where it is if it can.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.spatial.bodies.rigid import SpatialPose
from wiggleroom.spatial.bodies.rotations import quaternion

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
class SquaredTravel:
    """Weight * squared displacement of a material point of a body [mm2].

    Parameters
    ----------
    body, arm, rest : as of `Displacement`
    weight : float
    """

    body: int
    arm: Floats
    rest: Floats
    weight: float

    def towards(self, pose: SpatialPose) -> Displacement:
        """The pull that it is at a pose: along the displacement, twice as strong as that is long."""
        b = self.body
        moved = pose.T[b] - self.rest + (pose.R[b] - np.eye(3)) @ self.arm
        return Displacement(b, self.arm, 2 * self.weight * moved, self.rest)

    def value(self, pose: SpatialPose, before: float | None) -> float:
        """Squared displacement at a pose."""
        return self.towards(pose).value(pose, before) / 2

    def derivatives(self, pose: SpatialPose) -> tuple[Floats, Floats]:
        """Gradient (6,) and Hessian (6, 6) by (dT, a)."""
        gradient, H = self.towards(pose).derivatives(pose)
        J = moved_by(pose, self.body, self.arm)
        return gradient, H + 2 * self.weight * J.T @ J


@dataclass(frozen=True, eq=False)
class Nearness:
    """Weight * what the squared distance of material points of two bodies loses [mm2].

    Parameters
    ----------
    one, other : int
        Bodies, in order.
    arms : (2, 3) float64 [mm]
        The points in their frames.
    apart : float [mm2]
        Squared distance at rest.
    weight : float
    """

    one: int
    other: int
    arms: Floats
    apart: float
    weight: float

    def _between(self, pose: SpatialPose) -> Floats:
        ends = [pose.T[b] + pose.R[b] @ arm for b, arm in zip((self.one, self.other), self.arms, strict=True)]
        return np.asarray(ends[1] - ends[0])

    def value(self, pose: SpatialPose, before: float | None) -> float:  # noqa: ARG002
        """What is lost at a pose."""
        return self.weight * (self.apart - float((self._between(pose) ** 2).sum()))

    def of_each(self, pose: SpatialPose) -> list[tuple[int, Floats, Floats]]:
        """Either body, with gradient (6,) and Hessian (6, 6) by its (dT, a)."""
        found = []
        for body, arm, sign in ((self.one, self.arms[0], 1.0), (self.other, self.arms[1], -1.0)):
            pull = Displacement(body, arm, sign * 2 * self.weight * self._between(pose), pose.T[body])
            gradient, H = pull.derivatives(pose)
            J = moved_by(pose, body, arm)
            found.append((body, gradient, H - 2 * self.weight * J.T @ J))
        return found

    def coupled(self, pose: SpatialPose) -> Floats:
        """Second derivatives (6, 6) by the first body's (dT, a) and the second one's."""
        first, second = (moved_by(pose, b, arm) for b, arm in zip((self.one, self.other), self.arms, strict=True))
        return 2 * self.weight * first.T @ second


def moved_by(pose: SpatialPose, body: int, arm: Floats) -> Floats:
    """Derivatives (3, 6) of a material point by its body's (dT, a)."""
    x, y, z = arm
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.hstack([np.eye(3), -pose.R[body] @ cross])


Term = Displacement | Twist | SquaredTravel | Nearness


@dataclass(frozen=True, eq=False)
class SumOfTerms:
    """Sum of displacements, twists, squared displacements and nearness.

    At most one twist is counted on past half a turn exactly; of several, each is counted by its own last value.
    """

    terms: tuple[Term, ...]

    @property
    def couples(self) -> tuple[tuple[int, int], ...]:
        """Pairs of bodies, in order, that have second derivatives in common."""
        return tuple((t.one, t.other) for t in self.terms if isinstance(t, Nearness))

    def pulls(self, pose: SpatialPose) -> list[Displacement] | None:
        """Pulls that say where parts leave to, of squared displacements the largest one; None where something else is asked, too."""
        squares = [t.towards(pose) for t in self.terms if isinstance(t, SquaredTravel)]
        found = [t for t in self.terms if isinstance(t, Displacement)]
        if len(squares) + len(found) < len(self.terms):
            return None
        return [*found, *sorted(squares, key=lambda t: -float(np.linalg.norm(t.direction)))[:1]]

    def value(self, pose: SpatialPose, before: float | None = None) -> float:
        """Value at a pose."""
        if len(self.terms) == 1:
            return self.terms[0].value(pose, before)
        others = sum(t.value(pose, None) for t in self.terms if not isinstance(t, Twist))
        twists = [t for t in self.terms if isinstance(t, Twist)]
        if len(twists) == 1:
            return others + twists[0].value(pose, None if before is None else before - others)
        return others + sum(t.value(pose, None) for t in twists)

    def _blocks(self, pose: SpatialPose) -> list[tuple[int, Floats, Floats]]:
        found = []
        for term in self.terms:
            if isinstance(term, Nearness):
                found += term.of_each(pose)
            else:
                found.append((term.body, *term.derivatives(pose)))
        return found

    def gradient(self, pose: SpatialPose) -> Floats:
        """Derivatives by (dT, a) of every body (n, 6)."""
        out = np.zeros((len(pose.T), 6))
        for body, gradient, _ in self._blocks(pose):
            out[body] += gradient
        return out

    def hessian(self, pose: SpatialPose) -> Floats:
        """Second derivatives by (dT, a) of every body (n, 6, 6)."""
        out = np.zeros((len(pose.T), 6, 6))
        for body, _, hessian in self._blocks(pose):
            out[body] += hessian
        return out

    def coupled(self, pose: SpatialPose) -> Floats:
        """Second derivatives (c, 6, 6) of the couples."""
        found = [t.coupled(pose) for t in self.terms if isinstance(t, Nearness)]
        return np.array(found).reshape(-1, 6, 6)


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
