"""Compiled operations on all rows of a program at once, without arrays in between: large programs are as quick as memory is."""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import NO_ALLOCATION, njit
from wiggleroom.compiled.vector_operations import larger

SUM = {**NO_ALLOCATION, "fastmath": {"reassoc"}}
"""For sums, whose terms may then be added several at a time."""
MAX_CHANGE, REPETITIONS = 10.0, 3
"""A multiplier that is fitted becomes at most this many times larger or smaller, in this many steps."""


@njit(**NO_ALLOCATION)
def step_length(x, dx):
    """Largest step in [0, 1] that keeps x + step * dx >= 0, for x > 0."""
    fastest = 1.0
    for k in range(len(x)):
        fastest = larger(fastest, -dx[k] / x[k])
    return 1.0 / fastest


@njit(**NO_ALLOCATION)
def step_lengths(x, dx, more, shares, out):
    """Fill `out` with the largest step in [0, 1] that keeps x + step * (dx + share * more) >= 0 for each of three shares, for x > 0."""
    one, two, three = shares[0], shares[1], shares[2]
    fastest, second, third = 1.0, 1.0, 1.0
    for k in range(len(x)):
        change, further = -dx[k] / x[k], -more[k] / x[k]
        fastest = larger(fastest, change + one * further)
        second = larger(second, change + two * further)
        third = larger(third, change + three * further)
    out[0], out[1], out[2] = 1.0 / fastest, 1.0 / second, 1.0 / third


@njit(**SUM)
def dot(x, y):
    """X . y: vectors of small programs are worked on sooner than numpy is called."""
    total = 0.0
    for k in range(len(x)):
        total += x[k] * y[k]
    return total


@njit(**NO_ALLOCATION)
def residual_work(residual, move, u, begin):
    """Work of a dual residual along the last step, of which at most 1 counts, and along the whole motion, in absolute values."""
    step, whole = 0.0, 0.0
    for k in range(len(u)):
        force = abs(residual[k])
        step += force * min(abs(move[k]), 1.0)
        whole += force * abs(u[k] - begin[k])
    return step, whole


@njit(**NO_ALLOCATION)
def farthest_pulled(gradient, u):
    """Largest shift |x| or |y| of a body that the objective depends on; a loose one may drift anywhere."""
    far = 0.0
    for k in range(0, len(u), 3):
        if gradient[k] != 0 or gradient[k + 1] != 0 or gradient[k + 2] != 0:
            far = max(far, abs(u[k]), abs(u[k + 1]))
    return far


@njit(**SUM)
def violation(lam, s, h):
    """Sum of the differences of slacks and rows, weighted with the multipliers."""
    total = 0.0
    for k in range(len(s)):
        total += lam[k] * abs(s[k] - h[k])
    return total


@njit(**SUM)
def stepped_slacks(s, ds, step, lam, h, least, out):
    """Fill `out` with slacks after a step, no less than the rows and `least`; their violation, and the sum of the products with `lam`."""
    wrong, gap = 0.0, 0.0
    for k in range(len(s)):
        slack = max(max(s[k] + step * ds[k], h[k]), least)
        out[k] = slack
        wrong += lam[k] * abs(slack - h[k])
        gap += slack * lam[k]
    return wrong, gap


@njit(**SUM)
def gap_after(s, ds, lam, dlam, step, dual_step):
    """Sum of the products of slack and multiplier after some steps."""
    total = 0.0
    for k in range(len(s)):
        total += (s[k] + step * ds[k]) * (lam[k] + dual_step * dlam[k])
    return total


@njit(**NO_ALLOCATION)
def corrector_goal(s, ds, lam, dlam, mean, most, goal):
    """Fill `goal` with the changes that bring products to `mean`, less the predictor's second-order term, which is at most `most`."""
    for k in range(len(s)):
        goal[k] = mean - s[k] * lam[k] - min(max(ds[k] * dlam[k], -most), most)


@njit(**NO_ALLOCATION)
def centring_goal(s, ds, lam, dlam, step, dual_step, least, most, goal):
    """Fill `goal` with the changes that bring products after some steps between `least` and `most`; none is less than -`most`."""
    for k in range(len(s)):
        product = (s[k] + step * ds[k]) * (lam[k] + dual_step * dlam[k])
        goal[k] = max(min(max(product, least), most) - product, -most)


@njit(**NO_ALLOCATION)
def add_share(x, more, share):
    """Add a share of `more` to x."""
    for k in range(len(x)):
        x[k] += share * more[k]


@njit(**NO_ALLOCATION)
def fit_wrenches(row, d, fresh, wrench, lever, room, lam):
    """Change the multipliers of pairs that are `fresh` so that their wrenches come near `wrench`; `room` (3, 4) is worked in."""
    for p in range(len(row) - 1):
        if not fresh[p]:
            continue
        share = 1.0 / lever[p]  # a torque becomes a force
        for _ in range(REPETITIONS):
            for i in range(3):
                room[i, 3] = wrench[p, i] * (share if i == 2 else 1.0)
                for j in range(3):
                    room[i, j] = 0.0
            for k in range(row[p], row[p + 1]):
                x, y, z, f = d[k, 0], d[k, 1], d[k, 2] * share, lam[k]
                room[0, 3] -= f * x
                room[1, 3] -= f * y
                room[2, 3] -= f * z
                room[0, 0] += f * f * x * x
                room[0, 1] += f * f * x * y
                room[0, 2] += f * f * x * z
                room[1, 1] += f * f * y * y
                room[1, 2] += f * f * y * z
                room[2, 2] += f * f * z * z
            small = 1e-9 * (room[0, 0] + room[1, 1] + room[2, 2]) + 1e-300
            # Cholesky of the 3 x 3 matrix
            l00 = np.sqrt(room[0, 0] + small)
            l10, l20 = room[0, 1] / l00, room[0, 2] / l00
            l11 = np.sqrt(max(room[1, 1] + small - l10 * l10, small))
            l21 = (room[1, 2] - l20 * l10) / l11
            l22 = np.sqrt(max(room[2, 2] + small - l20 * l20 - l21 * l21, small))
            b0 = room[0, 3] / l00
            b1 = (room[1, 3] - l10 * b0) / l11
            b2 = (room[2, 3] - l20 * b0 - l21 * b1) / l22
            y2 = b2 / l22
            y1 = (b1 - l21 * y2) / l11
            y0 = (b0 - l10 * y1 - l20 * y2) / l00
            limit = MAX_CHANGE ** (1.0 / REPETITIONS)
            for k in range(row[p], row[p + 1]):
                f = lam[k]
                change = f * (d[k, 0] * y0 + d[k, 1] * y1 + d[k, 2] * share * y2)
                lam[k] = f * min(max(1.0 + change, 1.0 / limit), limit)
