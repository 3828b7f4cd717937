"""A bound from any multipliers of joints: the Lagrangian relaxation of the whole program, evaluated exactly but for rounding.

A joint keeps E = x_b + (R(t_b) - 1) q - x_a - (R(t_a) - 1) p - R(t_a) tau = 0, with arms p, q from both origins to its pivot,
tau the motion of the pivot seen from A and phi = t_b - t_a. Let v be t_a less the middle of its range, m the middle of the range
of (t_a + t_b) / 2 and u that mean less m. For any force w, moment k, slopes l and n, couplings r and s and curvature c

    goal = goal - w . E + k (phi - t_b + t_a) + l (t_a - middle - v) + n ((t_a + t_b) / 2 - m - u)
           + r (cos m (S_b - S_a) - sin m (C_b - C_a) - 2 cos u sin(phi / 2))
           + s (cos m (C_b - C_a) + sin m (S_b - S_a) + 2 sin u sin(phi / 2))
           + c ((1 - cos(t_a - middle)) - (1 - cos v)),

S = sin t and C = cos t. What depends on one body's turn alone falls into parts alpha cos t + beta sin t + gamma t, whose largest
value over a range is known; shifts drop out where forces balance. What is left of a joint is linear in (tau, phi), in v and in u
but for products v tau and u phi and remainders of higher order. So it is largest at a corner of the joint's region, with v and u
at an end. A curvature takes 1 - cos v from the body, whose part bends down anyway, to the joint, where it outweighs products v tau:
then v is best somewhere between. Any multipliers give a valid bound.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.bound.joint_constraints import AngleRanges, JointConstraints
from wiggleroom.bound.joint_ranges import JointRanges
from wiggleroom.bound.trigonometric_envelopes import support
from wiggleroom.geometry.relative_pose import rotated
from wiggleroom.program.objectives import PointMotion

if TYPE_CHECKING:
    import scipy.sparse as sp

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

FORCE_X, FORCE_Y, MOMENT, TURN_SLOPE, MEAN_SLOPE, SINE, COSINE, CURVATURE = range(8)
"""Columns of multipliers (P, 8): w, k, l, n, r, s and c above."""
MULTIPLIERS = 8
"""How many columns these are."""
X, Y, COS, SIN, TURN = range(5)
"""Weights of a body: its shift, cos t - 1, sin t and t."""
ROUNDING_MARGIN = 1e-12
"""Bounds are larger by this share of all that they are summed up from."""


def goal_weights(goal: PointMotion, n: int) -> Floats:
    """Weights (5 n,) of the bodies in what is asked."""
    out = np.zeros((n, 5))
    lever = goal.arm[:, 0] * goal.direction[:, 1] - goal.arm[:, 1] * goal.direction[:, 0]
    np.add.at(out, goal.body, np.column_stack([goal.direction, (goal.direction * goal.arm).sum(1), lever, goal.turn]))
    return out.ravel()


@dataclass(frozen=True, eq=False)
class LagrangianBound:
    """Bodies and joints within some ranges, to ask what multipliers prove.

    Parameters
    ----------
    fixed : (n,) bool
    joints : JointConstraints
    at : JointRanges
    ranges : AngleRanges
    deviation : float [mm]
        E vanishes up to this.
    """

    fixed: Bools
    joints: JointConstraints
    at: JointRanges
    ranges: AngleRanges
    deviation: float = 0.0

    def most(self, weights: Floats, constant: Floats, multipliers: Floats, size: Floats | None = None) -> Floats:
        """Upper bounds (K,) of weights (K, 5 n) . (x, y, C - 1, S, t) + constant, by multipliers (K, P, 8).

        Weights that are sums are rounded: `size` (K, 5 n) is what their terms amount to.
        """
        count = len(multipliers)
        flat = multipliers.reshape(count, -1)
        size = np.abs(weights) if size is None else size
        weights, size = weights + (self.loads @ flat.T).T, size + (abs(self.loads) @ np.abs(flat).T).T
        of_bodies, of_joints = self.of_bodies(weights, size), self.of_joints(multipliers)
        return np.asarray(constant + ROUNDING_MARGIN * np.abs(constant) + of_bodies.sum(1) + of_joints.sum(1))

    @cached_property
    def loads(self) -> sp.csr_matrix:
        """Weights of bodies (5 n,) that multipliers (8 P,) give."""
        import scipy.sparse as sp  # slow to import, and not always needed

        joints, at = self.joints, self.at
        arm = {0: joints.arm_a + at.middle, 1: joints.arm_b}
        one, none = np.ones(len(joints.a)), np.zeros(len(joints.a))
        c, s = np.cos(at.mean), np.sin(at.mean)
        own_c, own_s = np.cos(at.turn), np.sin(at.turn)
        parts = []
        for side, (of, sign) in enumerate(((joints.a, 1.0), (joints.b, -1.0))):
            x, y = arm[side].T
            for column, row, value in (
                (FORCE_X, X, one),
                (FORCE_Y, Y, one),
                (FORCE_X, COS, x),
                (FORCE_X, SIN, -y),
                (FORCE_Y, COS, y),
                (FORCE_Y, SIN, x),
                (MOMENT, TURN, one),
                (TURN_SLOPE, TURN, one if side == 0 else none),
                (MEAN_SLOPE, TURN, sign * one / 2),
                (SINE, COS, s),
                (SINE, SIN, -c),
                (COSINE, COS, -c),
                (COSINE, SIN, -s),
                (CURVATURE, COS, -own_c if side == 0 else none),
                (CURVATURE, SIN, -own_s if side == 0 else none),
            ):
                parts.append((5 * of + row, MULTIPLIERS * np.arange(len(of)) + column, sign * value))
        rows, columns, values = (np.concatenate(v) for v in zip(*parts, strict=True))
        return sp.csr_matrix((values, (rows, columns)), shape=(5 * len(self.fixed), MULTIPLIERS * len(joints.a)))

    def of_bodies(self, weights: Floats, size: Floats) -> Floats:
        """What bodies add at most (K, n) by weights (K, 5 n) that are rounded sums of terms, `size` (K, 5 n) in all."""
        found = np.zeros((len(weights), len(self.fixed)))
        moving = np.flatnonzero(~self.fixed & (size.reshape(len(size), -1, 5) != 0).any((0, 2)))
        if not np.isfinite(self.ranges.far[moving]).all():
            found[:, moving] = np.inf
            return found
        low, high, far = (v[moving] for v in (self.ranges.low, self.ranges.high, self.ranges.far))
        middle, half = (low + high) / 2, (high - low) / 2 * (1 + 1e-15) + 1e-15
        w = weights.reshape(len(weights), -1, 5)[:, moving]
        c, s = np.cos(middle), np.sin(middle)
        alpha, beta, gamma = w[..., COS], w[..., SIN], w[..., TURN]
        top = support(alpha * c + beta * s, beta * c - alpha * s, gamma, half) + gamma * middle - alpha
        shift = (np.abs(w[..., X]) + np.abs(w[..., Y])) * far
        scale = np.column_stack([far, far, 2 + 0 * far, 1 + 0 * far, np.abs(middle) + half])
        doubt = (size.reshape(len(size), -1, 5)[:, moving] * scale).sum(2)
        found[:, moving] = top + shift + ROUNDING_MARGIN * doubt
        return found

    def of_joints(self, multipliers: Floats) -> Floats:
        """What joints add at most (K, P) by multipliers (K, P, 8)."""
        at, m = self.at, multipliers
        force = m[..., :2]
        size = np.hypot(force[..., 0], force[..., 1])
        local = rotated(force, -at.turn)
        coupled = np.abs(m[..., SINE]) + np.abs(m[..., COSINE])
        total = (
            (force * at.middle).sum(2)
            + size * self.deviation
            - m[..., TURN_SLOPE] * at.turn
            - m[..., MEAN_SLOPE] * at.mean
            + np.abs(m[..., SINE]) * at.sag
            + np.abs(m[..., COSINE]) * at.skew
            + m[..., CURVATURE] * (1 - np.cos(at.turn))
        )
        total[(coupled != 0) & ~at.coupled] = np.inf
        moment = m[..., MOMENT] - m[..., SINE] * at.chord
        doubt = np.abs(m[..., TURN_SLOPE] * at.turn) + np.abs(m[..., MEAN_SLOPE] * at.mean)
        doubt += 2 * np.abs(m[..., CURVATURE])
        for p in np.flatnonzero((m != 0).any((0, 2))):
            asked = np.flatnonzero((m[:, p] != 0).any(1))
            corner, margin = at.corner[p], at.cuts[p].margin
            w, k, one = local[asked, p], moment[asked, p], m[asked, p]
            slope, curvature, long = one[:, TURN_SLOPE], one[:, CURVATURE], size[asked, p]
            half = at.half_turn[p]
            plain = corner @ np.stack([w[:, 0], w[:, 1], k])
            # w . R(v) d = w . d + v (w . J d) and a remainder; far from the middle the plain blur is less
            bent = np.abs(corner[:, :2] @ np.stack([w[:, 1], -w[:, 0]]) - slope)
            other = np.abs(np.outer(corner[:, 2], one[:, COSINE]) - one[:, MEAN_SLOPE])
            side = at.half_mean[p] * other
            # 1 - cos v lies between v^2 / 2 and this share of it; the remainder takes away from it
            least = max(0.0, 1 - half * half / 12)
            left = np.where(curvature >= 0, least, 1.0) * curvature - long * at.reach[p] * (1 + half / 3)
            most = (plain + side + _highest(bent, left, half)).max(0)
            flat = (plain + side).max(0) + long * at.blur[p] + half * np.abs(slope)
            flat += np.maximum(-curvature, 0.0) * min(half * half / 2, 2.0)
            spread = np.abs(corner).max(0)
            doubt[asked, p] += (
                long * (np.abs(at.middle[p]).sum() + spread[:2].sum() * (1 + half))
                + np.abs(k) * spread[2]
                + np.abs(slope) * half
                + np.abs(left) * half * half
                + (np.abs(one[:, COSINE]) * spread[2] + np.abs(one[:, MEAN_SLOPE])) * at.half_mean[p]
            )
            angle = at.cuts[p].angle_margin * (np.abs(k) + at.half_mean[p] * np.abs(one[:, COSINE]))
            total[asked, p] += np.minimum(most, flat) + margin * 2 * long * (1 + half) + angle
        return np.asarray(total + ROUNDING_MARGIN * doubt)


def _highest(slope: Floats, curvature: Floats, half: float) -> Floats:
    """Largest slope v - curvature v^2 / 2 over 0 <= v <= half, for slopes (c, K) of at least nought and curvatures (K,)."""
    at_end = slope * half - curvature * half * half / 2
    inside = (curvature > 0) & (slope < curvature * half)
    return np.where(inside, slope * slope / np.where(inside, 2 * curvature, 1.0), at_end)
