"""Candidate joints of two panels: lines of flanks laid on each other by voting over their shift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wiggleroom.mating.flanks import FlankLine, SheetPlate

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class VotingSettings:
    """Parameters of the votes for shifts.

    Parameters
    ----------
    midpoint_tolerance : float in (0, 0.5)
        Flanks meet when their midpoints are nearer than this share of the thickness: half a thickness would reach the next one.
    max_shifts : int
        Shifts that are kept for two lines.
    min_vote_share : float in (0, 1)
        A shift with fewer votes than this share of the best one's is not kept.
    length_reach : float in (0, 1)
        Flanks of two panels can meet where their lengths differ from the partner's thickness by at most this share.
    """

    midpoint_tolerance: float = 0.18
    max_shifts: int = 4
    min_vote_share: float = 0.5
    length_reach: float = 0.21


VOTING = VotingSettings()


class Fit(NamedTuple):
    """Panel B's pose in the frame of panel A.

    Parameters
    ----------
    turn : (3, 3) float64
        Rotation matrix.
    move : (3,) float64 [mm]
    votes : int
        Flanks of one line that meet.
    """

    turn: Floats
    move: Floats
    votes: int


def fits(a: SheetPlate, b: SheetPlate) -> list[Fit]:
    """Poses in which a line of flanks of `b` lies on one of `a`, their planes square to each other.

    Source: voting over one parameter, as in the generalised Hough transform (Ballard 1981).
    """
    return [fit for line in a.lines for other in b.lines for fit in line_fits(line, other, a.thickness, b.thickness)]


def line_fits(a: FlankLine, b: FlankLine, thick_a: float, thick_b: float) -> list[Fit]:
    """The same for one line of each; thicknesses of both panels [mm]."""
    tolerance = VOTING.midpoint_tolerance * min(thick_a, thick_b)
    found = []
    for sign in (1.0, -1.0):
        for shift, votes in _shifts(a, b, sign, tolerance, thick_a, thick_b):
            for fold in (1.0, -1.0):
                turn, move = _pose(a, b, sign, shift, fold)
                found.append(Fit(turn, move, votes))
    return found


def _shifts(
    a: FlankLine, b: FlankLine, sign: float, tolerance: float, thick_a: float, thick_b: float
) -> list[tuple[float, int]]:
    """Shifts of `b` along `a` for which flanks face each other, most votes first."""
    in_a = np.abs(a.length - thick_b) < VOTING.length_reach * thick_b
    in_b = np.abs(b.length - thick_a) < VOTING.length_reach * thick_a
    if not in_a.any() or not in_b.any():
        return []
    at_a, sense_a, at_b, sense_b = a.at[in_a], a.sense[in_a], sign * b.at[in_b], sign * b.sense[in_b]
    votes = np.sort((at_a[:, None] - at_b)[sense_a[:, None] * sense_b < 0])
    if not len(votes):
        return []
    counts = np.searchsorted(votes, votes + 2 * tolerance, "right") - np.arange(len(votes))
    kept: list[tuple[float, int]] = []
    for k in np.argsort(-counts, kind="stable").tolist():
        count = int(counts[k])
        shift = float(votes[k : k + count].mean())
        if kept and (count < VOTING.min_vote_share * kept[0][1] or len(kept) == VOTING.max_shifts):
            break
        if any(abs(shift - other) < 3 * tolerance for other, _ in kept):
            continue
        if _contradictions(at_a, at_b + shift, tolerance) - 2 * count <= count:
            kept.append((shift, count))
    return kept


def _contradictions(a: Floats, b: Floats, tolerance: float) -> int:
    """How many flanks lie in the stretch that two lines share, met or not."""
    low, high = max(a.min(), b.min()) - tolerance, min(a.max(), b.max()) + tolerance
    return int(((a > low) & (a < high)).sum() + ((b > low) & (b < high)).sum())


def _pose(a: FlankLine, b: FlankLine, sign: float, shift: float, fold: float) -> tuple[Floats, Floats]:
    # The line of B on that of A, B's plane square to A's: rows of the rotation in the frames of the lines.
    (ax, ay), (bx, by) = a.along, b.along
    turn = np.array(
        [[sign * ax * bx, sign * ax * by, 0.0], [sign * ay * bx, sign * ay * by, 0.0], [-fold * by, fold * bx, 0.0]]
    )
    turn[:, 2] = sign * fold * ay, -sign * fold * ax, 0.0
    move = np.array([a.offset * -ay + shift * ax, a.offset * ax + shift * ay, -fold * b.offset])
    return turn, move
