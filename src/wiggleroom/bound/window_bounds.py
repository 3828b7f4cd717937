"""Turns within all local windows, one span after the other, and the sub-proofs of what was found."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from wiggleroom.bound.joint_constraints import AngleRanges, first_ranges
from wiggleroom.bound.joint_ranges import RegionCuts
from wiggleroom.bound.local_windows import SPANS, Window, deviation, window_joints, window_turns, windows, with_window
from wiggleroom.bound.proof_steps import ProofNode
from wiggleroom.bound.turn_tightening import Linkage, RelaxationInRanges, after_cuts
from wiggleroom.deadline import WorkBudget

Floats = NDArray[np.float64]

WORKERS = 2
"""Number of windows that are worked on at once."""
SWEEPS = 2
"""Number of times all turns of a window are tightened."""


@dataclass(frozen=True, eq=False)
class WindowProof:
    """A window, the first ranges of its bodies, what was cut step by step, and what is left.

    Parameters
    ----------
    window : Window
    first, last : AngleRanges
        Of the window's bodies (w,), against the first of them.
    steps : tuple of ProofNode
    """

    window: Window
    first: AngleRanges
    last: AngleRanges
    steps: tuple[ProofNode, ...]


def bounded_windows(
    linkage: Linkage, regions: RegionCuts, budget: WorkBudget, spans: Sequence[int] = SPANS
) -> Iterator[tuple[Linkage, WindowProof]]:
    """The linkage with what one window after the other says of turns, and why that is so."""
    for span in spans:
        found = windows(linkage.place, linkage.joints, linkage.unit, span, budget)
        # those of one span know of shorter spans only, so that several are worked on at once
        known = linkage
        for proof in budget.in_order(partial(_bounded, linkage=known, regions=regions), found, WORKERS):
            low, high = proof.last.low, proof.last.high
            turns = with_window(linkage.turns, linkage.joints, proof.window, low, high)
            linkage = replace(linkage, turns=turns)
            yield linkage, proof


def _bounded(window: Window, budget: WorkBudget, *, linkage: Linkage, regions: RegionCuts) -> WindowProof:
    """What a window's own programs say."""
    own = window.bodies
    fixed = np.zeros(len(own), dtype=bool)
    fixed[0] = True
    small = Linkage(
        fixed,
        linkage.radius[own],
        linkage.place[own],
        window_joints(window, linkage.joints),
        window_turns(window, linkage.turns),
        linkage.unit,
        deviation(window, linkage.joints, np.array([regions.regions[k].far for k in linkage.joints.kind])),
    )
    first = ranges = first_ranges(fixed, small.joints, regions.regions, small.turns, small.deviation)
    steps = []
    for _ in range(SWEEPS):
        program = RelaxationInRanges(small, regions, ranges)
        step = ProofNode()
        step.at(ranges, program.at)
        step.cuts = program.turn_cuts(np.arange(1, len(own)), None, budget, chains=1)
        ranges = after_cuts(ranges, step.cuts, small.turns)
        steps.append(step)
        if budget.is_set():
            break
    return WindowProof(window, first, ranges, tuple(steps))
