"""Exhaustive search for assemblies in which every needed flank meets another, and so for proof that there is only one.

A flank that is still open must be met by a flank of a panel not yet placed, which leaves a few poses for each of them. The
search branches on the open flank with the fewest poses left (the most constrained variable of constraint satisfaction),
and looks first at lines that had none before (weighted constraints, Boussemart et al. 2004). Of congruent panels only the
first is tried (value symmetry), and every open line of a placed panel must be left a panel of its own: a placement is given
up where no matching of its lines to the waiting panels exists (all-different constraint, Regin 1994).
Where no assembly closes all flanks, lines of flanks may be left open, first one, then two and so on (limited
discrepancy search, Harvey and Ginsberg 1995). Work is counted in poses that are tried, not in seconds, so that the answer
is the same on every machine.
"""

from __future__ import annotations

import functools
import operator
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_bipartite_matching

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.mating.beam_search import extent
from wiggleroom.mating.congruence import PanelIsometries, congruent
from wiggleroom.mating.contact import MAX_ASKEW_COSINE, MET_TOLERANCE
from wiggleroom.mating.flanks import bits, flank_rows
from wiggleroom.mating.pair_poses import PairPoseTable
from wiggleroom.mating.panel_set import PanelSet, Placement

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ExhaustiveSettings:
    """Parameters of the exhaustive search; none of them decides what is found, only when.

    Parameters
    ----------
    branching_lines : int
        Lines with open flanks that are compared before the search branches at the one with the fewest choices.
    moment_tolerance : float > 0
        Placements whose moments differ by more than this cannot be congruent.
    max_assemblies : int > 1
        Different assemblies after which the search stops: more only say again that there is a choice.
    max_open_lines : int
        Lines of flanks that may stay open.
    max_poses : int
        Poses of one panel more that are tried before the search ends without being exhausted.
    open_share : float in (0, 1)
        Share of them that each number of open lines may take.
    """

    branching_lines: int = 5
    moment_tolerance: float = 1e-3
    max_assemblies: int = 2
    max_open_lines: int = 3
    max_poses: int = 4000
    open_share: float = 0.4


SETTINGS = ExhaustiveSettings()


@dataclass
class Closed:
    """What the search found.

    Parameters
    ----------
    placements : list of Placement
        Assemblies in which all needed flanks meet, but for those of `open_lines` lines; congruent ones and mirror images once.
    open_lines : int
        Lines of flanks that each of them leaves open though they could meet others.
    exhausted : bool
        Whether there is no other with as few open lines.
    """

    placements: list[Placement] = field(default_factory=list)
    open_lines: int = 0
    exhausted: bool = True


def closed_placements(
    panel_set: PanelSet,
    starts: Sequence[Placement],
    free: Iterable[int],
    table: PairPoseTable,
    *,
    share: float = 1.0,
    max_open_lines: int = SETTINGS.max_open_lines,
    context: Context = UNLIMITED,
) -> Closed:
    """Assemblies that hold the panels of one of `starts` and leave as few lines of needed flanks open as possible.

    Parameters
    ----------
    panel_set : PanelSet
    starts : sequence of Placement
        Of the same panels.
    free : iterable of int
        Panels that may be used.
    table : PairPoseTable
    share : float in (0, 1)
        Of the poses that are tried at most.
    max_open_lines : int
        Lines of flanks that may stay open.

    Notes
    -----
    Complete as far as flanks decide: two placements count as one when they cover the same places, up to a mirror.
    Flanks that no panel of the sheet could meet do not count as needed here.
    """
    kinds = {panel_set.plates[row].kind: row for row in free}
    for a in kinds.values():
        for b in kinds.values():
            context.go_on()
            table.between(a, b)
    search = _ExhaustiveSearch(panel_set, frozenset(free), table, context)
    most = share * SETTINGS.max_poses
    found = search.closed(starts, 0, int(most))
    for spare in range(1, max_open_lines + 1):
        if found.placements:
            break
        found = search.closed(starts, spare, int(SETTINGS.open_share * most))
    return found


@dataclass(frozen=True, eq=False)
class _Partial:
    """A placement with, for every placed panel, bits of the flanks that meet and of those that may stay open."""

    state: Placement
    met: tuple[int, ...]
    excused: tuple[int, ...]


_Tried = dict[tuple[float, ...], tuple[int, _Partial] | None]


@dataclass(frozen=True, eq=False)
class _LaidPanel:
    """A panel laid beside another: its pose, and the flanks of the other and of its own that meet."""

    row: int
    turn: Floats
    move: Floats
    met: int
    mine: int


class _ExhaustiveSearch:
    def __init__(self, panel_set: PanelSet, free: frozenset[int], table: PairPoseTable, context: Context) -> None:
        self.panel_set, self.free, self.table, self.context = panel_set, free, table, context
        plates = panel_set.plates
        self._needed = [bits(plate.needed[None])[0] if len(plate.needed) else 0 for plate in plates]
        self._lines = [
            [sum(1 << k for k in line.rows.tolist()) & self._needed[row] for line in plate.lines]
            for row, plate in enumerate(plates)
        ]
        self._beside = [
            [(f, sum(1 << int(k) for k in plate.neighbours[f] if k >= 0)) for f in flank_rows(self._needed[row])]
            for row, plate in enumerate(plates)
        ]
        self._reaches: dict[tuple[int, int], tuple[int, int]] = {}
        self._failures: Counter[tuple[int, int]] = Counter()
        self._hopeless = {row: self._needed[row] & ~self._matchable(row) for row in free}

    def _matchable(self, row: int) -> int:
        """Flanks of a panel that some other free panel can meet."""
        matchable = 0
        for other in {self.panel_set.plates[i].kind: i for i in self.free if i != row}.values():
            for met, _ in self.table.between(row, other).met:
                matchable |= met
        return matchable

    def _reach(self, row: int, other: int) -> tuple[int, int]:
        """How many lines of a panel another one can close at once, and bits of the lines it can close at all."""
        plates = self.panel_set.plates
        key = plates[row].kind, plates[other].kind
        if key not in self._reaches:
            met = [
                sum(1 << number for number, line in enumerate(self._lines[row]) if line & closed)
                for closed in {self._closed(row, flanks) for flanks, _ in self.table.between(row, other).met}
            ]
            self._reaches[key] = (
                max((lines.bit_count() for lines in met), default=0),
                functools.reduce(operator.or_, met, 0),
            )
        return self._reaches[key]

    def closed(self, starts: Sequence[Placement], spare: int, max_poses: int) -> Closed:
        """Assemblies that leave as many lines open; what failed before is looked at first."""
        self.left = max_poses
        self.result = Closed(open_lines=spare)
        self._seen: dict[int, tuple[list[Floats], list[Placement]]] = {}
        for start in starts:
            _, flags = self.panel_set.met(start)
            met = tuple(bits(flags[row][None])[0] if len(flags[row]) else 0 for row in start.rows)
            self.descend(_Partial(start, met, tuple(self._hopeless.get(row, 0) for row in start.rows)), spare)
        return self.result

    def descend(self, node: _Partial, spare: int) -> None:
        """Depth first; every placement once. `spare` more lines may stay open."""
        self.context.go_on()
        if self.left <= 0 or len(self.result.placements) >= SETTINGS.max_assemblies:
            self.result.exhausted = False
            return
        mark = self.panel_set.signature(node.state)
        marks, states = self._seen.setdefault(spare, ([], []))
        if marks:
            near = np.abs(np.array(marks) - mark).max(axis=1) < SETTINGS.moment_tolerance
            if any(
                self._same(states[k], node.state, self.panel_set.told_isometries) for k in np.flatnonzero(near).tolist()
            ):
                return
        marks.append(mark)
        states.append(node.state)
        lines = self._open(node)
        if not lines:
            if len(node.state.rows) > 1:
                self._keep(node.state)
            return
        place, line, children = self._fewest(node, spare, lines)
        for child in children:
            self.descend(child, spare)
        if spare:
            excused = tuple(e | line if k == place else e for k, e in enumerate(node.excused))
            self.descend(_Partial(node.state, node.met, excused), spare - 1)

    def _keep(self, state: Placement) -> None:
        """Keep an assembly; the larger one of two where lines stay open."""
        kept = self.result.placements
        if any(self._same(other, state, self.panel_set.isometries) for other in kept):
            return
        if self.result.open_lines and kept:
            if len(state.rows) < len(kept[0].rows):
                return
            if len(state.rows) > len(kept[0].rows):
                kept.clear()
        kept.append(state)

    def _open(self, node: _Partial) -> list[tuple[int, int, int]]:
        """(place of a panel, one of its lines, bits of open flanks there): first what failed before, what meets in part, what is long."""
        found = []
        for place, row in enumerate(node.state.rows):
            fine = self._closed(row, node.met[place]) | node.excused[place]
            kind = self.panel_set.plates[row].kind
            for number, line in enumerate(self._lines[row]):
                rest = line & ~fine
                if rest:
                    failed = -self._failures[kind, number]
                    found.append((failed, rest == line, -rest.bit_count(), place, number, rest))
        return [(place, number, rest) for *_, place, number, rest in sorted(found)]

    def _closed(self, row: int, met: int) -> int:
        """Bits of the flanks of a panel that are met, and of those beside them."""
        return met | sum(1 << flank for flank, near in self._beside[row] if met & near)

    def _same(self, a: Placement, b: Placement, isometries: PanelIsometries) -> bool:
        """Whether two placements are congruent or mirror images."""
        panels = [
            [
                (self.panel_set.plates[row].kind, turn, move)
                for row, turn, move in zip(each.rows, each.turns, each.moves, strict=True)
            ]
            for each in (a, b)
        ]
        return congruent(isometries, panels[0], panels[1], MET_TOLERANCE * self.panel_set.tolerance)

    def _fewest(self, node: _Partial, spare: int, left: list[tuple[int, int, int]]) -> tuple[int, int, list[_Partial]]:
        """Place and line of the open flank that leaves the fewest choices, and those choices: one panel more each."""
        waiting = self.panel_set.interchangeable(self.free - set(node.state.rows))
        best: tuple[int, int, list[_Partial]] | None = None
        tried: _Tried = {}
        for place, number, line in left[: SETTINGS.branching_lines]:
            flanks = list(flank_rows(line))
            found = self._answers(node, spare, place, flanks[len(flanks) // 2], waiting, tried)
            if best is None or len(found) < len(best[2]):
                best = place, line, found
            if not found:
                self._failures[self.panel_set.plates[node.state.rows[place]].kind, number] += 1
            if len(best[2]) < 2:
                break
        return (left[0][0], left[0][2], []) if best is None else best

    def _answers(
        self, node: _Partial, spare: int, place: int, flank: int, waiting: dict[int, int], tried: _Tried
    ) -> list[_Partial]:
        """Every way in which a panel can meet one flank of a placed panel without overlap or blocking another; the likeliest first.

        Of those that close as much the smallest body goes first, unless lines may stay open: then panels folded inward are small.
        """
        state, panel_set = node.state, self.panel_set
        row = state.rows[place]
        found: list[tuple[int, float, float, _Partial]] = []
        for kind, other in waiting.items():
            poses = self.table.between(row, other)
            hopeless = self._hopeless[other]
            marks: set[tuple[float, ...]] = set()
            for k in poses.at_flank.get(flank, ()):
                (met, mine), (blocked, own) = poses.met[k], poses.blocked[k]
                if met & node.met[place]:
                    continue
                if blocked & ~(node.excused[place] | node.met[place]) or own & ~hopeless:
                    continue
                turn = state.turns[place] @ poses.turns[k]
                move = state.turns[place] @ poses.moves[k] + state.moves[place]
                mark = (kind, *np.round(panel_set.trace(kind, turn[None], move[None])[0], 2))
                if mark in marks:
                    continue
                marks.add(mark)
                if mark not in tried:
                    tried[mark] = self._joined(node, spare, place, _LaidPanel(other, turn, move, met, mine))
                joined = tried[mark]
                if joined is not None:
                    size = 0 if spare else round(extent(panel_set, joined[1].state))
                    found.append((-joined[0], -float(poses.together[k]), size, joined[1]))
        return [child for *_, child in sorted(found, key=lambda item: item[:3])]

    def _joined(self, node: _Partial, spare: int, place: int, laid: _LaidPanel) -> tuple[int, _Partial] | None:
        """The placement with one panel more, and how many flanks it closes; None where it overlaps or blocks others."""
        state, panel_set = node.state, self.panel_set
        other, turn, move, met, mine = laid.row, laid.turn, laid.move, laid.met, laid.mine
        self.left -= 1
        everyone = list(node.met)
        everyone[place] |= met
        odd = 0
        refused: list[tuple[int, int]] = []
        closed = met.bit_count()
        meeting = {state.rows[place]: (met, mine)}
        for q, a in enumerate(state.rows):
            if q == place:
                continue
            inner, shift = state.turns[q].T @ turn, state.turns[q].T @ (move - state.moves[q])
            if (
                float(shift @ shift)
                > (panel_set.radius[a] + panel_set.radius[other] + panel_set.plates[a].thickness) ** 2
            ):
                continue
            if panel_set.volume(a, other, inner, shift) > panel_set.most:
                return None
            if abs(inner[2, 2]) > MAX_ASKEW_COSINE:
                continue
            flags = panel_set.masks(a, other, inner[None], shift[None])
            met_a, met_b, blocked_a, blocked_b = (bits(each)[0] if each.size else 0 for each in flags)
            everyone[q] |= met_a
            mine |= met_b
            meeting[a] = met_a, met_b
            closed += met_a.bit_count()
            refused.append((q, blocked_a))
            odd |= blocked_b
        if odd & ~(mine | self._hopeless[other]):
            return None
        if any(blocked & ~(everyone[q] | node.excused[q]) for q, blocked in refused):
            return None
        if panel_set.constraints.named and not panel_set.constraints.allow(
            state.rows, state.turns, state.moves, other, turn, move, meeting
        ):
            return None
        move = panel_set.centred(state, other, turn, move)
        turns, moves = np.concatenate([state.turns, turn[None]]), np.concatenate([state.moves, move[None]])
        grown = Placement((*state.rows, other), turns, moves, state.met + closed, {})
        child = _Partial(grown, (*everyone, mine), (*node.excused, self._hopeless[other]))
        return (closed, child) if self._enough(child, spare) else None

    def _enough(self, node: _Partial, spare: int) -> bool:
        """Whether the waiting panels are enough for the open lines of every placed panel, but for `spare` of them.

        Every line needs a panel of its own, or every few lines where a panel can meet several at once: a matching of the
        lines to the panels that can meet them.
        """
        waiting = sorted(self.free - set(node.state.rows))
        lines: dict[int, list[int]] = {}
        for place, number, _ in self._open(node):
            lines.setdefault(place, []).append(number)
        for place, numbers in lines.items():
            if len(numbers) <= spare + 1:
                continue
            row = node.state.rows[place]
            seats = [other for other in waiting for _ in range(self._reach(row, other)[0])]
            partners = np.array([[self._reach(row, other)[1] >> k & 1 for other in seats] for k in numbers], dtype=bool)
            matched = maximum_bipartite_matching(
                csr_array(partners.reshape(len(numbers), len(seats))), perm_type="column"
            )
            if np.count_nonzero(matched < 0) > spare:
                return False
        return True
