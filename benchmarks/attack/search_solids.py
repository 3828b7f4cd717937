"""A search of its own for ways out of assemblies in space: a tree of states, grown by straight moves and turns of one part.

Source: expansive trees, Hsu, Latombe and Motwani 1997, with the library python-fcl as the judge of every step.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

STEP, TURN = 0.004, 0.02
"""Share of the size, and angle [rad], by which a part moves at most before overlaps are looked for."""
FAR = 1.2
"""A part that got further than this multiple of the size has left."""


def way_out(
    depth: Callable[[np.ndarray], float],
    count: int,
    free: list[int],
    axes: np.ndarray,
    size: float,
    rng,
    moves: int,
    allowed: float,
) -> np.ndarray | None:
    """States (k, n, 6) from rest to where a part has left; None where none was found after so many moves.

    `depth` is the deepest overlap at motions (n, 6), which may be `allowed`. Parts `free` may move, of `count`; `axes` (a, 3) are
    directions that they have.
    """
    states, before, tries = [np.zeros((count, 6))], [-1], [1]
    for _ in range(moves):
        weight = np.array([(0.2 + np.abs(s[:, :3]).max() / size) for s in states]) / np.square(tries)
        at = int(rng.choice(len(states), p=weight / weight.sum()))
        tries[at] += 1
        part = int(rng.choice(free))
        axis = axes[rng.integers(len(axes))] * rng.choice([-1, 1]) if rng.random() < 0.7 else rng.normal(size=3)
        axis = axis / np.linalg.norm(axis)
        turns = rng.random() < 0.3
        most = float(rng.exponential(0.7)) if turns else FAR * size * (1.0 if rng.random() < 0.5 else rng.random() ** 2)
        step = TURN if turns else STEP * size
        state, gone = states[at], 0.0
        while gone < most:
            ahead = state.copy()
            if turns:
                ahead[part, 3:] = (
                    Rotation.from_rotvec(step * axis) * Rotation.from_rotvec(state[part, 3:])
                ).as_rotvec()
            else:
                ahead[part, :3] += step * axis
            if depth(ahead) > allowed:
                break
            state, gone = ahead, gone + step
        if gone < 2 * step:
            continue
        states.append(state)
        before.append(at)
        tries.append(1)
        if np.abs(state[part, :3]).max() > FAR * size:
            path, k = [], len(states) - 1
            while k >= 0:
                path.append(states[k])
                k = before[k]
            return np.array(path[::-1])
    return None
