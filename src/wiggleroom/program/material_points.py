"""Compiled motion of material points of bodies: small programs spend more on calls of numpy than on arithmetic."""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import NO_ALLOCATION, njit


@njit(**NO_ALLOCATION)
def turned_arms(body, arm, motion, out):
    """Fill `out` (k, 2) with arms [mm] as they lie after the motion (n, 3)."""
    for k in range(len(body)):
        c, s = np.cos(motion[body[k], 2]), np.sin(motion[body[k], 2])
        x, y = arm[k, 0], arm[k, 1]
        out[k, 0], out[k, 1] = c * x - s * y, s * x + c * y


@njit(**NO_ALLOCATION)
def point_displacements(body, arm, motion, out):
    """Fill `out` (k, 2) with displacements [mm]; (R - I) arm by half angles, which loses no digits at small turns."""
    for k in range(len(body)):
        b = body[k]
        c, s = np.cos(0.5 * motion[b, 2]), np.sin(0.5 * motion[b, 2])
        x, y = arm[k, 0], arm[k, 1]
        out[k, 0] = motion[b, 0] + 2 * s * (-s * x - c * y)
        out[k, 1] = motion[b, 1] + 2 * s * (c * x - s * y)


@njit(**NO_ALLOCATION)
def pulled_value(body, direction, arm, turn, motion):
    """Sum of direction . displacement + turn * angle."""
    total = 0.0
    for k in range(len(body)):
        b = body[k]
        c, s = np.cos(0.5 * motion[b, 2]), np.sin(0.5 * motion[b, 2])
        x, y = arm[k, 0], arm[k, 1]
        total += direction[k, 0] * (motion[b, 0] + 2 * s * (-s * x - c * y))
        total += direction[k, 1] * (motion[b, 1] + 2 * s * (c * x - s * y))
        total += turn[k] * motion[b, 2]
    return total


@njit(**NO_ALLOCATION)
def pulled_derivatives(body, direction, arm, turn, motion, gradient, curvature):
    """Add the derivatives of `pulled_value` to `gradient` (n, 3), and fill in the second ones by each body's angle, `curvature` (k,)."""
    for k in range(len(body)):
        b = body[k]
        c, s = np.cos(motion[b, 2]), np.sin(motion[b, 2])
        x, y = c * arm[k, 0] - s * arm[k, 1], s * arm[k, 0] + c * arm[k, 1]
        gradient[b, 0] += direction[k, 0]
        gradient[b, 1] += direction[k, 1]
        gradient[b, 2] += direction[k, 1] * x - direction[k, 0] * y + turn[k]
        curvature[k] = -(direction[k, 0] * x + direction[k, 1] * y)


@njit(**NO_ALLOCATION)
def subtract_own_blocks(body, own, share, slot, scale, at, data):
    """Take a share of blocks `own` (k, 3, 3) of bodies off the entries at `at` (F, 6) of a matrix, in scaled variables."""
    for k in range(len(body)):
        f = slot[body[k]]
        if f < 0:
            continue
        place = 0
        for j in range(3):
            for i in range(j + 1):
                data[at[f, place]] -= share * own[k, i, j] * scale[3 * f + i] * scale[3 * f + j]
                place += 1
