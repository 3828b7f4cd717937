"""All poses in which one panel holds another, worked out once for every two kinds of panels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.mating.beam_search import BeamState
from wiggleroom.mating.candidates import VOTING
from wiggleroom.mating.contact import line_shifts
from wiggleroom.mating.flanks import FlankLine, SheetPlate

Floats = NDArray[np.float64]


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
    """

    turns: Floats
    moves: Floats
    met: tuple[tuple[int, int], ...]
    blocked: tuple[tuple[int, int], ...]


class PairPoseTable:
    """Poses by kinds of panels, each worked out when it is first asked for."""

    def __init__(self, bench: BeamState) -> None:
        self.bench = bench
        self._known: dict[tuple[int, int], PairPoses] = {}

    def between(self, a: int, b: int) -> PairPoses:
        """Poses of a panel like `b` in the frame of a panel like `a`; both are rows."""
        key = self.bench.plates[a].kind, self.bench.plates[b].kind
        if key not in self._known:
            self._known[key] = self._worked_out(a, b)
        return self._known[key]

    def _worked_out(self, a: int, b: int) -> PairPoses:
        bench = self.bench
        found = list(_line_poses(bench.plates[a], bench.plates[b], bench.tolerance))
        if not found:
            return PairPoses(np.zeros((0, 3, 3)), np.zeros((0, 3)), (), ())
        turns, moves = (np.concatenate(values) for values in zip(*found, strict=True))
        met_a, met_b, blocked_a, blocked_b = bench.masks(a, b, turns, moves)
        count, odd = met_a.sum(axis=1), blocked_a.sum(axis=1) + blocked_b.sum(axis=1)
        keep, marks = [], set()
        for k in np.argsort(-count, kind="stable").tolist():
            if count[k] == 0 or odd[k] > count[k]:
                continue
            mark = (*np.round(turns[k].ravel() * 10).astype(int), *np.round(moves[k] / bench.tolerance).astype(int))
            if mark in marks or bench.volume(a, b, turns[k], moves[k]) > bench.most:
                continue
            marks.add(mark)
            keep.append(k)
        return PairPoses(
            turns[keep],
            moves[keep],
            tuple(zip(bits(met_a[keep]), bits(met_b[keep]), strict=True)),
            tuple(zip(bits(blocked_a[keep]), bits(blocked_b[keep]), strict=True)),
        )


def bits(flags: NDArray[np.bool_]) -> list[int]:
    """Every row of `flags` (k, n) as an integer whose bit i is flag i.

    Examples
    --------
    >>> bits(np.array([[True, False, True], [False, True, False]]))
    [5, 2]
    """
    packed = np.packbits(flags, axis=1, bitorder="little")
    return [int.from_bytes(row.tobytes(), "little") for row in packed]


def flank_rows(mask: int) -> Iterator[int]:
    """Numbers of the bits that are set, ascending."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def _line_poses(a: SheetPlate, b: SheetPlate, tolerance: float) -> Iterator[tuple[Floats, Floats]]:
    """Poses, many at once, that lay a line of flanks of B on one of A, their planes square to each other."""
    for line in a.lines:
        for other in b.lines:
            for sign in (1.0, -1.0):
                shifts = _shifts(line, other, sign, a, b, tolerance)
                if len(shifts):
                    for fold in (1.0, -1.0):
                        yield _poses(line, other, sign, shifts, fold)


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
