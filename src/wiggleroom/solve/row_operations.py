"""Compiled operations on all rows of a program at once, without arrays in between: large programs are as quick as memory is."""

from __future__ import annotations

from wiggleroom.geometry.jit_options import NO_ALLOCATION, njit


@njit(**NO_ALLOCATION)
def step_length(x, dx, more, share):
    """Largest step in [0, 1] that keeps x + step * (dx + share * more) >= 0, for x > 0."""
    fastest = 1.0
    for k in range(len(x)):
        change = dx[k] + share * more[k]
        if -change > fastest * x[k]:
            fastest = -change / x[k]
    return 1.0 / fastest


@njit(**NO_ALLOCATION)
def eliminated(s, lam, primal, goal, out):
    """Fill `out` with what rows ask of the variables once slacks and multipliers are eliminated: (lam * primal + goal) / s."""
    for k in range(len(s)):
        out[k] = (lam[k] * primal[k] + goal[k]) / s[k]


@njit(**NO_ALLOCATION)
def multiplier_change(s, lam, ds, goal, out):
    """Fill `out` with the change of the multipliers that belongs to one of the slacks: (goal - lam * ds) / s."""
    for k in range(len(s)):
        out[k] = (goal[k] - lam[k] * ds[k]) / s[k]


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
