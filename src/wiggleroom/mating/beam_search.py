"""Beam search over placements: panels are added one by one where most of their flanks meet those placed before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.mating.panel_set import PanelSet, Placement

Floats = NDArray[np.float64]

MIN_SCORE = 0.5
"""A pose that scores less, in flanks that meet, is not taken."""


@dataclass(frozen=True)
class Effort:
    """How widely the search looks.

    Parameters
    ----------
    width : int
        Placements that are kept at every step.
    power : float
        Of the number of flanks that meet between two panels, in their score.
    """

    width: int
    power: float


def beam_search(
    panel_set: PanelSet, state: Placement, free: frozenset[int], effort: Effort, *, context: Context = UNLIMITED
) -> list[Placement]:
    """Add panels to a placement until none fits; the last placements of the beam, best first.

    Parameters
    ----------
    panel_set : PanelSet
    state : Placement
    free : frozenset of int
        Panels that may be used, those placed included.
    effort : Effort
    """
    beam = [state]
    while True:
        grown: dict[tuple[float, ...], Placement] = {}
        for placed in beam:
            context.go_on()
            for child in _children(panel_set, placed, free, effort):
                grown.setdefault(tuple(np.round(panel_set.signature(child) * 1e3).tolist()), child)
        if not grown:
            return beam
        ranked = sorted(grown.values(), key=lambda child: (-child.met, extent(panel_set, child)))
        beam = ranked[: effort.width]
        context.tell(len(beam[0].rows))


def _children(panel_set: PanelSet, state: Placement, free: frozenset[int], effort: Effort) -> list[Placement]:
    """The best placements with one panel more that do not overlap."""
    waiting = {panel_set.plates[i].kind: i for i in sorted(free - set(state.rows), reverse=True)}
    pools = panel_set.pools(state, waiting, effort.power)
    rows = [(kind, k) for kind in waiting for k in range(len(pools[kind].score))]
    if not rows:
        return []
    scores = np.concatenate([pools[kind].score for kind in waiting])
    seen: set[tuple[float, ...]] = set()
    children: list[Placement] = []
    for at in np.argsort(-scores, kind="stable").tolist():
        kind, k = rows[at]
        score = float(scores[at])
        if score < MIN_SCORE:
            break
        if len(children) >= effort.width:
            break
        pool = pools[kind]
        mark = (kind, *np.round(panel_set.trace(kind, pool.turns[k : k + 1], pool.moves[k : k + 1])[0], 1))
        if mark in seen:
            continue
        seen.add(mark)
        if not panel_set.allowed(state, waiting[kind], pool.turns[k], pool.moves[k]):
            pool.score[k] = -np.inf
            continue
        placed, turn, move = (*state.rows, waiting[kind]), pool.turns[k], pool.moves[k]
        turns, moves = np.concatenate([state.turns, turn[None]]), np.concatenate([state.moves, move[None]])
        children.append(Placement(placed, turns, moves, state.met + score, pools))
    return children


def extent(panel_set: PanelSet, state: Placement) -> float:
    """Volume of the box round a placement [mm3]."""
    return float(np.prod(np.ptp(np.vstack(panel_set.places(state)), axis=0) + panel_set.tolerance))
