"""Exhaustive search for assemblies in which every needed flank meets another, and so for proof that there is only one.

A flank that is still open must be met by a flank of a panel not yet placed, which leaves two poses for each of them. The
search branches on the open flank with the fewest poses left (the most constrained variable of constraint satisfaction).
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop, go_on
from wiggleroom.mating.beam_search import BeamState, Placement
from wiggleroom.mating.congruence import congruent

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ExhaustiveSettings:
    """Parameters of the exhaustive search; none of them decides what is found, only when.

    Parameters
    ----------
    branching_flanks : int
        Open flanks, of different panels and lines, that are compared before the search branches at the one with the fewest choices.
    moment_tolerance : float > 0
        Placements whose moments differ by more than this cannot be congruent.
    max_assemblies : int > 1
        Different assemblies after which the search stops: more only say again that there is a choice.
    """

    branching_flanks: int = 3
    moment_tolerance: float = 1e-3
    max_assemblies: int = 2


SETTINGS = ExhaustiveSettings()


@dataclass
class Closed:
    """What the search found.

    Parameters
    ----------
    placements : list of Placement
        Assemblies in which all needed flanks meet; congruent ones and mirror images once.
    exhausted : bool
        Whether there is no other.
    """

    placements: list[Placement] = field(default_factory=list)
    exhausted: bool = True


def closed_placements(
    bench: BeamState, start: Placement, free: Iterable[int], *, seconds: float, stop: Stop | None = None
) -> Closed:
    """Assemblies that hold the panels of `start` and leave no needed flank open.

    Parameters
    ----------
    bench : Bench
    start : Placement
    free : iterable of int
        Panels that may be used.
    seconds : float
        Processor time after which the search ends without being exhausted.

    Notes
    -----
    Complete as far as flanks decide: two placements count as one when they cover the same places, up to a mirror.
    """
    search = _Search(bench, frozenset(free), time.process_time() + seconds, stop)
    search.descend(start)
    return search.result


class _Search:
    def __init__(self, bench: BeamState, free: frozenset[int], deadline: float, stop: Stop | None) -> None:
        self.bench, self.free, self.deadline, self.stop = bench, free, deadline, stop
        self.result = Closed()
        self._seen: list[tuple[Floats, Placement]] = []

    def descend(self, state: Placement) -> None:
        """Depth first; every placement once."""
        go_on(self.stop)
        mark = self.bench.signature(state)
        if any(
            np.abs(other - mark).max() < SETTINGS.moment_tolerance and self._same(placed, state)
            for other, placed in self._seen
        ):
            return
        self._seen.append((mark, state))
        if time.process_time() > self.deadline or len(self.result.placements) >= SETTINGS.max_assemblies:
            self.result.exhausted = False
            return
        left = self.bench.open(state)
        if not any(len(rows) for rows in left.values()):
            self.result.placements.append(state)
            return
        for child in self._fewest(state, left):
            self.descend(child)

    def _same(self, a: Placement, b: Placement) -> bool:
        """Whether two placements are congruent or mirror images."""
        panels = []
        for state in (a, b):
            shapes = (self.bench.shape[row] for row in state.rows)
            panels.append(list(zip(shapes, self.bench.places(state), strict=True)))
        return congruent(panels[0], panels[1], 1.5 * self.bench.tolerance)

    def _fewest(self, state: Placement, left: dict[int, NDArray[np.int64]]) -> list[Placement]:
        """Placements with one panel more, for the open flank that leaves the fewest."""
        waiting = {self.bench.plates[i].kind: i for i in sorted(self.free - set(state.rows), reverse=True)}
        best: list[Placement] | None = None
        for row, flank in self._asked(left):
            found = self._answers(state, row, flank, waiting)
            if best is None or len(found) < len(best):
                best = found
            if len(best) < 2:
                break
        return best or []

    def _asked(self, left: dict[int, NDArray[np.int64]]) -> list[tuple[int, int]]:
        """One open flank of each of some lines: those with the most flanks met beside them come first."""
        asked = []
        for row, rows in left.items():
            opened = set(rows.tolist())
            for line in self.bench.plates[row].lines:
                mine = [k for k in line.rows.tolist() if k in opened]
                if mine:
                    asked.append((len(mine) == len(line.rows), -len(mine), row, mine[len(mine) // 2]))
        return [(row, flank) for *_, row, flank in sorted(asked)[: SETTINGS.branching_flanks]]

    def _answers(self, state: Placement, row: int, flank: int, waiting: dict[int, int]) -> list[Placement]:
        """Every way in which a panel can meet one flank of a placed panel without overlap or blocking another flank."""
        bench, place = self.bench, state.rows.index(row)
        found: list[tuple[float, Placement]] = []
        marks: set[tuple[float, ...]] = set()
        for kind, other in waiting.items():
            turns, moves = self._poses(row, flank, other)
            if not len(moves):
                continue
            turns = np.einsum("ij,kjl->kil", state.turns[place], turns)
            moves = moves @ state.turns[place].T + state.moves[place]
            for k in [place, *(k for k in range(len(state.rows)) if k != place)]:
                inner, shift = (
                    np.einsum("ji,kjl->kil", state.turns[k], turns),
                    (moves - state.moves[k]) @ state.turns[k],
                )
                alive = bench.blocked(state.rows[k], other, inner, shift) <= 0
                turns, moves = turns[alive], moves[alive]
            score = np.zeros(len(moves))
            for k, a in enumerate(state.rows):
                inner, shift = (
                    np.einsum("ji,kjl->kil", state.turns[k], turns),
                    (moves - state.moves[k]) @ state.turns[k],
                )
                score += bench.scores(a, other, inner, shift, 1.0)
            for k in range(len(moves)):
                mark = (kind, *np.round(bench.trace(kind, turns[k : k + 1], moves[k : k + 1])[0], 2))
                if mark in marks or bench.overlaps(state, other, turns[k], moves[k]):
                    continue
                marks.add(mark)
                move = bench.centred(state, other, turns[k], moves[k])
                grown = np.concatenate([state.turns, turns[k : k + 1]]), np.concatenate([state.moves, move[None]])
                found.append((-score[k], Placement((*state.rows, other), *grown, state.met + float(score[k]), {})))
        return [placement for _, placement in sorted(found, key=lambda item: item[0])]

    def _poses(self, row: int, flank: int, other: int) -> tuple[Floats, Floats]:
        """Poses of panel `other` in the frame of panel `row` that lay one of its flanks on `flank`."""
        a, b = self.bench.plates[row], self.bench.plates[other]
        fits = np.abs(b.length - a.thickness) < 0.21 * a.thickness
        if abs(a.length[flank] - b.thickness) > 0.21 * b.thickness or not fits.any():
            return np.zeros((0, 3, 3)), np.zeros((0, 3))
        inward = np.append(a.inward[flank], 0.0)
        middle = np.append(a.middle[flank], 0.0)
        turns, moves = [], []
        for k in np.flatnonzero(fits).tolist():
            own = np.array([[*b.inward[k], 0.0], [-b.inward[k][1], b.inward[k][0], 0.0], [0.0, 0.0, 1.0]])
            for fold in (1.0, -1.0):
                up = np.array([0.0, 0.0, fold])
                turn = np.column_stack([-inward, up, np.cross(-inward, up)]) @ own
                turns.append(turn)
                moves.append(middle - turn[:, :2] @ b.middle[k])
        return np.array(turns), np.array(moves)
