"""The exact optimum of a chain: how far the last of n blocks in a row can move, the first one fixed.

Only neighbours meet, so the turns of the links decide everything: for given turns the best translation of every pair is
a support function of a slice. A dynamic programme over the turn of each block finds the best turns on a grid; grids
that get four times finer round by round then close in on it, each of them with exact slices of its own.

``python -m tests.oracle.chain`` writes chain_values.json anew; ``python -m tests.oracle.chain tee 0.01 10`` shows one.
"""

from __future__ import annotations

import functools
import json
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .blocks import JOINTS, block
from .geometry import turn
from .slices import Slices

VALUES = Path(__file__).with_name("chain_values.json")
GAPS, BLOCKS = (0.01, 0.02, 0.03), (2, 5, 10)
D = np.array([1.0, 0.0])  # from block to block at rest
HALF = 5  # grid points on either side of the best turn of each pair
FINEST = 1e-12  # [rad]
ROUNDING = 2e-11  # seen between different first grids: slices near the end of the turn are too thin to be cut finer


@dataclass(frozen=True)
class Reach:
    """Largest displacement of the last block's centre along `direction`.

    `relative` (n - 1, 3) are the relative motions of the pairs, `motion` (n, 3) the motions of the blocks,
    `accuracy` is the absolute change of `value` over the last three refinements, never below rounding.
    """

    value: float
    accuracy: float
    relative: np.ndarray
    motion: np.ndarray


@functools.cache
def slices(joint: str, gap: float) -> Slices:
    """The pair (left block, right block), shared by the chains of all lengths."""
    made = block(joint, gap)
    return Slices(made, made, (1.0, 0.0))


def reach(pair: Slices, n: int, direction: tuple[float, float] = (0.0, 1.0), cells: int = 150) -> Reach:
    """The optimum for `n` blocks; `cells` is the number of grid steps from 0 to the larger end of the turn."""
    e = np.asarray(direction, dtype=float) / np.hypot(*direction)
    step = max(pair.high, -pair.low) / cells
    phis = _coarse(pair, n - 1, e, step)
    best = -np.inf
    history: list[float] = []
    while step > FINEST:
        phis, value = _closer(pair, phis, e, step)
        if value <= best + 1e-15 or len(history) > 200:
            step /= 4
        best = max(best, value)
        history.append(best)
    relative, motion = _unfold(pair, phis, e)
    shown = float((motion[-1, :2]) @ e)
    settled = abs(history[-1] - history[-4]) if len(history) > 3 else np.inf
    return Reach(shown, max(settled, abs(shown - best), ROUNDING), relative, motion)


def _support(corners: np.ndarray, thetas: np.ndarray, e: np.ndarray) -> np.ndarray:
    """Largest tau . (R(-theta) e) over the corners, for each theta; -inf where there are none."""
    if not len(corners):
        return np.full(len(thetas), -np.inf)
    c, s = np.cos(thetas), np.sin(thetas)
    turned = np.stack([c * e[0] + s * e[1], -s * e[0] + c * e[1]])
    return np.max(corners @ turned, axis=0)


def _coarse(pair: Slices, links: int, e: np.ndarray, step: float) -> np.ndarray:
    """Best turns of all pairs on one grid through 0 that also meets the larger end of the turn."""
    first, last = int(np.ceil(pair.low / step - 1e-9)), int(np.floor(pair.high / step + 1e-9))
    turns = np.clip(np.arange(first, last + 1) * step, pair.low, pair.high)
    thetas = np.arange(links * first, links * last + 1) * step
    zero = -links * first
    gain = np.stack([_support(pair.corners(p), thetas, e) for p in turns])
    lever = (np.cos(thetas) * e[0] + np.sin(thetas) * e[1]) * D[0]
    ahead, choices = np.zeros(len(thetas)), []
    for _ in range(links):
        total = np.full(len(thetas), -np.inf)
        choice = np.zeros(len(thetas), dtype=int)
        for i, shift in enumerate(range(first, last + 1)):
            here = slice(max(0, -shift), len(thetas) - max(0, shift))
            there = slice(max(0, shift), len(thetas) + min(0, shift))
            offer = np.full(len(thetas), -np.inf)
            offer[here] = gain[i, here] + ahead[there]
            better = offer > total
            total[better], choice[better] = offer[better], i
        ahead = total + lever
        choices.append(choice)
    at, phis = zero, []
    for choice in choices[::-1]:
        i = choice[at]
        phis.append(turns[i])
        at += first + i
    return np.array(phis)


def _closer(pair: Slices, phis: np.ndarray, e: np.ndarray, step: float) -> tuple[np.ndarray, float]:
    """Best turns on a grid of this step round the given ones: the same programme in a corridor of turns."""
    offsets = np.arange(-HALF, HALF + 1)
    base = np.concatenate([[0], np.cumsum(phis)[:-1]])
    ahead, choices = np.zeros(0), []
    for k in range(len(phis) - 1, -1, -1):
        thetas = base[k] + step * np.arange(-HALF * k, HALF * k + 1)
        gain = np.stack([_support(pair.corners(phis[k] + step * o), thetas, e) for o in offsets])
        if len(ahead):
            gain += np.stack([ahead[HALF + o : HALF + o + len(thetas)] for o in offsets])
        choices.append(np.argmax(gain, axis=0))
        ahead = gain.max(axis=0) + np.cos(thetas) * e[0] + np.sin(thetas) * e[1]
    at, found = 0, []
    for k, choice in enumerate(choices[::-1]):
        o = offsets[choice[HALF * k + at]]
        found.append(phis[k] + step * o)
        at += o
    return np.array(found), float(ahead[0] - D @ e * len(phis))


def _unfold(pair: Slices, phis: np.ndarray, e: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    relative, motion, place, theta = [], [np.zeros(3)], np.zeros(2), 0.0
    for k, phi in enumerate(phis):
        corners = pair.corners(phi)
        tau = corners[np.argmax(corners @ (turn(-theta) @ e))]
        place = place + turn(theta) @ (D + tau)
        theta += phi
        relative.append([*tau, phi])
        motion.append(np.array([*(place - (k + 1) * D), theta]))
    return np.array(relative), np.array(motion)


def stored(joint: str, gap: float, n: int) -> tuple[float, float]:
    """(value, accuracy) from chain_values.json for `n` blocks, the first of them fixed."""
    entry = json.loads(VALUES.read_text())["chains"][f"{joint} {gap} {n}"]
    return entry["value"], entry["accuracy"]


def _work_out(joint: str, gap: float, n: int) -> dict[str, float]:
    """The better of two answers from different first grids; their difference counts into the accuracy."""
    answers = [reach(slices(joint, gap), n, cells=c) for c in (150, 113)]
    best = max(answers, key=lambda a: a.value)
    spread = abs(answers[0].value - answers[1].value)
    return {"value": best.value, "accuracy": float(f"{max(best.accuracy, spread):.1e}")}


def main(words: list[str]) -> None:
    """Work out one chain, or all of them into the file."""
    wanted = [(j, g, n) for j in JOINTS for g in GAPS for n in BLOCKS]
    if words:
        wanted = [(words[0], float(words[1]), int(words[2]))]
    chains = {}
    for joint, gap, n in wanted:
        began = time.perf_counter()
        entry = _work_out(joint, gap, n)
        chains[f"{joint} {gap} {n}"] = entry
        seconds = time.perf_counter() - began
        sys.stderr.write(f"{joint} {gap} {n}: {entry['value']:.12f} +- {entry['accuracy']:.1e} in {seconds:.1f} s\n")
    if not words:
        about = "largest +y move of the last of n unit-pitch blocks, the first fixed: 'joint gap n'"
        command = "python -m tests.oracle.chain"
        VALUES.write_text(json.dumps({"about": about, "command": command, "chains": chains}, indent=1) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
