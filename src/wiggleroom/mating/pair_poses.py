"""All poses in which one panel holds another, worked out once for every two kinds of panels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wiggleroom.mating.candidates import VOTING
from wiggleroom.mating.contact import ASKEW_LENGTH_TOLERANCE, finger_length, finger_setback, line_shifts
from wiggleroom.mating.edge_constraints import JoinedEdges
from wiggleroom.mating.edge_ends import edge_ends, ends_together
from wiggleroom.mating.flanks import FlankLine, SheetPlate, bits, flank_rows
from wiggleroom.mating.joint_angles import joint_angles
from wiggleroom.mating.panel_set import PanelSet

Floats = NDArray[np.float64]
LONG_ROW = 4
"""Of a row with as many flanks one may stay open: at the end a corner can swallow it."""
SAME_LENGTH = 0.01
"""Lengths of fingers that differ by less than this share of the thickness are not told apart."""


@dataclass(frozen=True, eq=False)
class PairPoses:
    """Poses of panel B in the frame of panel A in which flanks meet and no material overlaps.

    Flanks are bits of integers: bit i stands for flank i of the panel.

    Parameters
    ----------
    turns, moves : (k, 3, 3) and (k, 3) float64 [mm]
    met : tuple of (int, int)
        Flanks of A and of B that meet.
    blocked : tuple of (int, int)
        Needed flanks of A and of B that the other's material leaves no partner for.
    together : (k,) float64
        How many of the ends of the edges that are joined are together; 0 where their fingers are as long as another angle asks.
    """

    turns: Floats
    moves: Floats
    met: tuple[tuple[int, int], ...]
    blocked: tuple[tuple[int, int], ...]
    together: Floats

    @cached_property
    def at_flank(self) -> dict[int, list[int]]:
        """By flank of A, the poses in which it meets another."""
        found: dict[int, list[int]] = {}
        for k, (met, _) in enumerate(self.met):
            for flank in flank_rows(met):
                found.setdefault(flank, []).append(k)
        return found


class PairPoseTable:
    """Poses by kinds of panels, each worked out when it is first asked for.

    Parameters
    ----------
    panel_set : PanelSet
    whole : bool
        Only poses in which rows of fingers meet from end to end: a joint is a row of one panel in a row of another.
    aligned_of : PairPoseTable, optional
        A table of which only those poses count in which the edges end together.
    """

    def __init__(self, panel_set: PanelSet, *, whole: bool, aligned_of: PairPoseTable | None = None) -> None:
        self.panel_set = panel_set
        self.whole = whole
        self.aligned_of = aligned_of
        self.angles = joint_angles(panel_set.plates)
        self._known: dict[tuple[int, int], PairPoses] = {}

    def between(self, a: int, b: int) -> PairPoses:
        """Poses of a panel like `b` in the frame of a panel like `a`; both are rows."""
        key = self.panel_set.plates[a].kind, self.panel_set.plates[b].kind
        if key not in self._known:
            if self.aligned_of is not None:
                poses = self.aligned_of.between(a, b)
                joined = bool(self.panel_set.constraints.between(a, b))
                self._known[key] = poses if joined else _chosen(poses, poses.together == 2.0)
            elif key[::-1] in self._known:
                self._known[key] = _inverse(self._known[key[::-1]])
            else:
                self._known[key] = self._worked_out(a, b, self.panel_set.constraints.between(a, b))
        return self._known[key]

    def unjoined(self, a: int, b: int) -> PairPoses:
        """The same as if nothing had been said of the two."""
        return self._worked_out(a, b, [])

    def _worked_out(self, a: int, b: int, joins: Sequence[JoinedEdges]) -> PairPoses:
        """Poses in which every join holds; these need not close whole rows."""
        panel_set = self.panel_set
        one, other = panel_set.plates[a], panel_set.plates[b]
        cosines = np.cos(self.angles).tolist()
        found = list(_line_poses(one, other, panel_set.tolerance, cosines))
        for cosine in cosines:
            found += _askew_poses(one, other, panel_set.tolerance, cosine, cosines)
        if not found:
            return PairPoses(np.zeros((0, 3, 3)), np.zeros((0, 3)), (), (), np.zeros(0))
        turns, moves, together = (np.concatenate(values) for values in zip(*found, strict=True))
        met_a, met_b = panel_set.met_flags(a, b, turns, moves)
        fine = met_a.any(axis=1)
        for join in joins:
            for met, edge in zip((met_a, met_b), join.flanks, strict=True):
                fine &= met[:, list(flank_rows(edge))].sum(axis=1) >= join.least
        if self.whole and not joins:
            fine &= _meets_whole_rows(panel_set.plates[a], met_a) & _meets_whole_rows(panel_set.plates[b], met_b)
        turns, moves, together = turns[fine], moves[fine], together[fine]
        met_a, met_b, blocked_a, blocked_b = panel_set.masks(a, b, turns, moves)
        count, odd = met_a.sum(axis=1), blocked_a.sum(axis=1) + blocked_b.sum(axis=1)
        corners = np.column_stack(
            [np.round(turns.reshape(-1, 9) * 10), np.round(moves / panel_set.tolerance), np.round(turns[:, 2, 2] * 500)]
        ).astype(int)
        keep, marks = [], set()
        for k in np.lexsort([-together, -count]).tolist():
            mark = corners[k].tobytes()
            if (
                (odd[k] > count[k] and not joins)
                or mark in marks
                or panel_set.volume(a, b, turns[k], moves[k]) > panel_set.most
            ):
                continue
            marks.add(mark)
            keep.append(k)
        return PairPoses(
            turns[keep],
            moves[keep],
            tuple(zip(bits(met_a[keep]), bits(met_b[keep]), strict=True)),
            tuple(zip(bits(blocked_a[keep]), bits(blocked_b[keep]), strict=True)),
            together[keep],
        )


def _chosen(poses: PairPoses, keep: NDArray[np.bool_]) -> PairPoses:
    """Some of the poses."""
    rows = np.flatnonzero(keep).tolist()
    met, blocked = (tuple(pairs[k] for k in rows) for pairs in (poses.met, poses.blocked))
    return PairPoses(poses.turns[keep], poses.moves[keep], met, blocked, poses.together[keep])


def _inverse(poses: PairPoses) -> PairPoses:
    """Poses of A in the frame of B."""
    turns = np.swapaxes(poses.turns, 1, 2)
    moves = -np.einsum("kij,kj->ki", turns, poses.moves)
    met, blocked = ((tuple((b, a) for a, b in pairs)) for pairs in (poses.met, poses.blocked))
    return PairPoses(turns, moves, met, blocked, poses.together)


def _meets_whole_rows(plate: SheetPlate, met: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether every row of fingers of a panel that meets another panel does so from end to end, for flags (k, n)."""
    if not len(plate.joint_rows):
        return np.ones(len(met), dtype=np.bool_)
    near = plate.neighbours
    beside = (met[:, near] & (near >= 0)).any(axis=2)
    row = (plate.joint_rows[:, None] == np.arange(plate.joint_rows.max() + 1)).astype(np.float32)
    left = (plate.needed & ~met & ~beside).astype(np.float32) @ row
    spare = (row.sum(axis=0) >= LONG_ROW).astype(np.float32)
    broken = (met.astype(np.float32) @ row > 0) & (left > spare)
    return ~broken.any(axis=1)


def _made_for(line: FlankLine, length: float, thickness: float, cosines: Sequence[float]) -> bool:
    """Whether the fingers of an edge are as long as one angle asks rather than as long as another of the sheet's angles does."""
    if not line.outward:
        return True
    mean = float(line.length.mean())
    nearest = min(abs(mean - each) for each in (thickness, *(finger_length(cosine, thickness) for cosine in cosines)))
    return bool(abs(mean - length) <= nearest + SAME_LENGTH * thickness)


def _line_poses(
    a: SheetPlate, b: SheetPlate, tolerance: float, cosines: Sequence[float]
) -> Iterator[tuple[Floats, Floats, Floats]]:
    """Poses, many at once, that lay a line of flanks of B on one of A, their planes square to each other."""
    ends = [[edge_ends(plate, line) for line in plate.lines] for plate in (a, b)]
    for line, own in zip(a.lines, ends[0], strict=True):
        for other, its in zip(b.lines, ends[1], strict=True):
            for sign in (1.0, -1.0):
                shifts = _shifts(line, other, sign, a, b, tolerance)
                if len(shifts):
                    laid = [] if its is None else [sign * end for end in (its if sign > 0 else its[::-1])]
                    moved = [(laid[0] + shift, laid[1] + shift) if laid else None for shift in shifts.tolist()]
                    together = np.array([ends_together(own, each, a.thickness) for each in moved])
                    if not (
                        _made_for(line, b.thickness, b.thickness, cosines)
                        and _made_for(other, a.thickness, a.thickness, cosines)
                    ):
                        together[:] = 0.0
                    for fold in (1.0, -1.0):
                        yield *_poses(line, other, sign, shifts, fold), together


def _askew_poses(
    a: SheetPlate, b: SheetPlate, tolerance: float, cosine: float, cosines: Sequence[float]
) -> Iterator[tuple[Floats, Floats, Floats]]:
    """Poses that join edges of two plates which turn by an angle at the joint; its cosine."""
    if abs(a.thickness - b.thickness) > 0.01 * a.thickness:
        return
    length, back = finger_length(cosine, a.thickness), finger_setback(cosine, a.thickness)
    sine, reach = np.sqrt(1.0 - cosine * cosine), ASKEW_LENGTH_TOLERANCE * a.thickness
    edges = [
        [line for line in plate.lines if line.outward and (np.abs(line.length - length) < reach).all()]
        for plate in (a, b)
    ]
    for line in edges[0]:
        for other in edges[1]:
            for sign in (1.0, -1.0):
                order = np.argsort(sign * other.at)
                shifts = line_shifts(
                    line.at, line.sense, a.needed[line.rows],
                    (sign * other.at)[order], (sign * other.sense)[order], b.needed[other.rows][order], tolerance,
                )  # fmt: skip
                if not len(shifts):
                    continue
                made = all(_made_for(each, length, a.thickness, cosines) for each in (line, other))
                for fold in (sine, -sine):
                    out = line.outward * line.across
                    along, into = np.append(sign * line.along, 0.0), np.append(cosine * out, fold)
                    space = np.column_stack([along, into, np.cross(along, into)])
                    flat = np.zeros((3, 3))
                    flat[:2, 0], flat[:2, 1] = other.along, -other.outward * other.across
                    flat[:, 2] = np.cross(flat[:, 0], flat[:, 1])
                    turn = space @ flat.T
                    axis = np.append((line.offset + line.outward * back) * line.across, 0.0)
                    own = np.append((other.offset + other.outward * back) * other.across, 0.0)
                    moves = axis - turn @ own + shifts[:, None] * np.append(line.along, 0.0)
                    yield np.repeat(turn[None], len(shifts), axis=0), moves, np.full(len(shifts), 2.0 * made)


def _shifts(a: FlankLine, b: FlankLine, sign: float, one: SheetPlate, other: SheetPlate, tolerance: float) -> Floats:
    """Shifts of line B along line A at which flanks face each other and most others do not contradict."""
    reach = VOTING.length_reach
    in_a = np.abs(a.length - other.thickness) < reach * other.thickness
    in_b = np.abs(b.length - one.thickness) < reach * one.thickness
    if not in_a.any() or not in_b.any():
        return np.zeros(0)
    order = np.argsort(sign * b.at[in_b])
    return line_shifts(
        a.at[in_a], a.sense[in_a], one.needed[a.rows[in_a]],
        (sign * b.at[in_b])[order], (sign * b.sense[in_b])[order], other.needed[b.rows[in_b]][order], tolerance,
    )  # fmt: skip


def _poses(a: FlankLine, b: FlankLine, sign: float, shifts: Floats, fold: float) -> tuple[Floats, Floats]:
    """The line of B on that of A, B's plane square to A's; see `candidates`."""
    (ax, ay), (bx, by) = a.along, b.along
    turn = np.array(
        [
            [sign * ax * bx, sign * ax * by, sign * fold * ay],
            [sign * ay * bx, sign * ay * by, -sign * fold * ax],
            [-fold * by, fold * bx, 0.0],
        ]
    )
    moves = np.column_stack(
        [a.offset * -ay + shifts * ax, a.offset * ax + shifts * ay, np.full(len(shifts), -fold * b.offset)]
    )
    return np.repeat(turn[None], len(shifts), axis=0), moves
