"""Panels of a sheet with all that a search over placements asks of them: poses of pairs, scores, overlap, what tells placements apart."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.mating.candidates import VOTING, fits
from wiggleroom.mating.congruence import PanelIsometries
from wiggleroom.mating.contact import MAX_SQUARE_COSINE, MET_TOLERANCE, masks, meeting, met_flags, scores
from wiggleroom.mating.crossing_volume import crossing_volume
from wiggleroom.mating.edge_constraints import EdgeConstraints
from wiggleroom.mating.flanks import SheetPlate, bits
from wiggleroom.mating.panel_outline import inset

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class PlacingSettings:
    """Parameters of placing one panel more.

    Parameters
    ----------
    max_shared_volume : float > 0
        Two eroded panels overlap where they share more than this times the cube of the thickness: less is what laser cuts are off by.
    erosion : float in (0, 0.5)
        Panels are eroded by this share of the thickness before overlap is sought, so that faces which touch do not count.
    max_parallel_sine : float in (0, 1)
        Two planes with a smaller sine of the angle between them count as parallel.
    hopeless_score : float > 0
        A pose whose score is below minus this is not looked at again, not even when more panels are placed.
    """

    max_shared_volume: float = 0.08
    erosion: float = 0.08
    max_parallel_sine: float = 0.05
    hopeless_score: float = 6.0


SETTINGS = PlacingSettings()
_PRIMES = np.random.default_rng(7).integers(2**61, 2**63, size=12)


@dataclass(frozen=True, eq=False)
class PosePool:
    """Poses that are open to the panels of one kind.

    Parameters
    ----------
    turns, moves : (k, 3, 3) and (k, 3) float64 [mm]
    score : (k,) float64
        Pairs of flanks that would meet less those that could meet nothing any more; minus infinity where material would overlap.
    """

    turns: Floats
    moves: Floats
    score: Floats


@dataclass(frozen=True, eq=False)
class Placement:
    """Some panels placed in space.

    Parameters
    ----------
    rows : tuple of int
        Which panels, in the order in which they were placed.
    turns, moves : (n, 3, 3) and (n, 3) float64 [mm]
    met : float
        Sum of the scores of its panels.
    pools : dict of int to PosePool
        By kind of panel: where the next one could go, as it was before the last panel came.
    """

    rows: tuple[int, ...]
    turns: Floats
    moves: Floats
    met: float
    pools: dict[int, PosePool]


class PanelSet:
    """Panels with everything that the search asks of them again and again.

    Parameters
    ----------
    plates : sequence of SheetPlate
        Those of which something was said have kinds of their own.
    constraints : EdgeConstraints, optional
    """

    def __init__(self, plates: Sequence[SheetPlate], constraints: EdgeConstraints | None = None) -> None:
        self.plates = plates
        self.constraints = constraints or EdgeConstraints()
        self.eroded = [inset(p.polygon, SETTINGS.erosion * p.thickness) for p in plates]
        self.edges = [_edges(polygon) for polygon in self.eroded]
        self.filled = [_edges(_filled(p)) for p in plates]
        self.radius = [p.radius for p in plates]
        self.corners = [_edges(p.polygon)[:, :2] for p in plates]
        named = self.constraints.named
        # Corners of panels of which something was said count differently: what was said is of one of several equal edges.
        self.corner_weights = [
            np.linspace(0.6, 1.4, len(corners)) if k in named else np.ones(len(corners))
            for k, corners in enumerate(self.corners)
        ]
        outlines = {p.kind: p.polygon for p in plates}
        thickness = {p.kind: p.thickness for p in plates}
        self.isometries = PanelIsometries(outlines, thickness=thickness)
        # While placements grow, panels of which something was said must not stand for others.
        self.told_isometries = (
            PanelIsometries(outlines, {plates[k].kind for k in named}, thickness) if named else self.isometries
        )
        self.first = {kind: i for i, kind in reversed(list(enumerate(p.kind for p in plates)))}
        self.tolerance = VOTING.midpoint_tolerance * min(p.thickness for p in plates)
        self.most = SETTINGS.max_shared_volume * min(p.thickness for p in plates) ** 3
        self._fits: dict[tuple[int, int], tuple[Floats, Floats]] = {}
        self.flanks = [np.column_stack([p.middle, p.inward, p.along, p.length]).reshape(-1, 7) for p in plates]
        self._flat: dict[tuple[int, ...], float] = {}
        self.scored = 0
        self.size = max(self.radius) * 2.0
        self.shape = _weights(plates)
        self._waves = np.random.default_rng(1).normal(size=(3, 3)) * 0.05

    def interchangeable(self, free: Iterable[int]) -> dict[int, int]:
        """By kind, one of every congruent panels of these, however they lie on the sheet: they may stand for each other."""
        found: dict[int, int] = {}
        for row in sorted(free):
            kind = self.plates[row].kind
            if not any(self.told_isometries.between(kind, other) for other in found):
                found[kind] = row
        return found

    def fits(self, a: int, b: int) -> tuple[Floats, Floats]:
        """Poses of a panel of kind `b` against one of kind `a`."""
        if (a, b) not in self._fits:
            found = fits(self.plates[self.first[a]], self.plates[self.first[b]])
            turns = np.array([fit.turn for fit in found]).reshape(-1, 3, 3)
            self._fits[a, b] = turns, np.array([fit.move for fit in found]).reshape(-1, 3)
        return self._fits[a, b]

    def scores(self, a: int, b: int, turns: Floats, moves: Floats, power: float) -> Floats:
        """Flanks of panels `a` and `b` that meet less those that can meet nothing any more, for many poses of b in a's frame."""
        one, other = self.plates[a].thickness, self.plates[b].thickness
        turns, moves = np.ascontiguousarray(turns), np.ascontiguousarray(moves)
        self.scored += len(moves)
        return scores(
            self.flanks[a],
            one,
            self.filled[a],
            self.flanks[b],
            other,
            self.filled[b],
            turns,
            moves,
            self.tolerance,
            power,
        )

    def met_flags(self, a: int, b: int, turns: Floats, moves: Floats) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Flanks of panels `a` and `b` that meet, for many poses of b in a's frame."""
        thick = self.plates[a].thickness, self.plates[b].thickness
        met_a, met_b = met_flags(self.flanks[a], thick[0], self.flanks[b], thick[1], turns, moves, self.tolerance)
        return met_a, met_b

    def masks(
        self, a: int, b: int, turns: Floats, moves: Floats
    ) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
        """Flanks of panels `a` and `b` that meet, and needed ones that can meet nothing any more, for many poses of b in a's frame."""
        one, other = self.plates[a], self.plates[b]
        turns, moves = np.ascontiguousarray(turns), np.ascontiguousarray(moves)
        met_a, met_b, blocked_a, blocked_b = masks(
            self.flanks[a], one.thickness, self.filled[a], one.needed,
            self.flanks[b], other.thickness, self.filled[b], other.needed, turns, moves, self.tolerance,
        )  # fmt: skip
        return met_a, met_b, blocked_a, blocked_b

    def met(self, state: Placement) -> tuple[list[tuple[int, int, NDArray[np.int64]]], dict[int, NDArray[np.bool_]]]:
        """Joints (panel, panel, rows of flanks that meet), and by panel which flanks meet another."""
        joints = []
        flags = {row: np.zeros(len(self.flanks[row]), dtype=bool) for row in state.rows}
        for i, a in enumerate(state.rows):
            for j in range(i):
                b = state.rows[j]
                turn = state.turns[i].T @ state.turns[j]
                found = self.pairs(a, b, turn, state.turns[i].T @ (state.moves[j] - state.moves[i]))
                if len(found):
                    joints.append((a, b, found))
                    flags[a][found[:, 0]] = True
                    flags[b][found[:, 1]] = True
        return joints, flags

    def open(self, state: Placement) -> dict[int, NDArray[np.int64]]:
        """By panel, the needed flanks that meet nothing and share no corner with one that does."""
        _, flags = self.met(state)
        left = {}
        for row, met in flags.items():
            near = self.plates[row].neighbours
            beside = ((near >= 0) & met[near]).any(axis=1) if len(near) else met
            left[row] = np.flatnonzero(self.plates[row].needed & ~met & ~beside)
        return left

    def pairs(self, a: int, b: int, turn: Floats, move: Floats) -> NDArray[np.int64]:
        """Rows (flank of a, flank of b) of the flanks that meet, shape (m, 2)."""
        found = np.empty((max(1, len(self.flanks[b])), 2), dtype=np.int64)
        thick = self.plates[a].thickness, self.plates[b].thickness
        count = meeting(
            self.flanks[a], thick[0], self.flanks[b], thick[1], turn, move, MET_TOLERANCE * self.tolerance, found
        )
        return found[:count].copy()

    def volume(self, a: int, b: int, turn: Floats, move: Floats) -> float:
        """Material [mm3] that panels `a` and `b` share, both eroded, for a pose of b in a's frame; of too much only some."""
        if float(move @ move) > (self.radius[a] + self.radius[b] + self.plates[a].thickness) ** 2:
            return 0.0
        half = (0.5 - SETTINGS.erosion) * self.plates[a].thickness, (0.5 - SETTINGS.erosion) * self.plates[b].thickness
        if 1.0 - turn[2, 2] ** 2 > SETTINGS.max_parallel_sine**2:
            return float(crossing_volume(self.edges[a], half[0], self.edges[b], half[1], turn, move, self.most))
        depth = half[0] + half[1] - abs(float(move[2]))
        if depth <= 0:
            return 0.0
        key = (self.plates[a].kind, self.plates[b].kind, *np.round(turn[:2, :2].ravel(), 3), *np.round(move[:2], 2))
        if key not in self._flat:
            laid = shapely.transform(self.eroded[b], lambda points: points @ turn[:2, :2].T + move[:2])
            self._flat[key] = self.eroded[a].intersection(laid).area
        return self._flat[key] * depth

    def overlaps(self, state: Placement, b: int, turn: Floats, move: Floats) -> bool:
        """Whether panel `b` would share material with the placed ones."""
        shared = 0.0
        for k, a in enumerate(state.rows):
            shared += self.volume(a, b, state.turns[k].T @ turn, state.turns[k].T @ (move - state.moves[k]))
            if shared > self.most:
                return True
        return False

    def flanks_met(self, state: Placement, new: int, turn: Floats, move: Floats) -> dict[int, tuple[int, int]]:
        """By placed panel, flanks of it and of a new one that meet, as bits."""
        met = {}
        for k, row in enumerate(state.rows):
            inner, shift = state.turns[k].T @ turn, state.turns[k].T @ (move - state.moves[k])
            flags = self.met_flags(row, new, inner[None], shift[None])
            met[row] = bits(flags[0])[0] if flags[0].size else 0, bits(flags[1])[0] if flags[1].size else 0
        return met

    def allowed(self, state: Placement, new: int, turn: Floats, move: Floats) -> bool:
        """Whether a panel would share no material with the placed ones, and what was said of them holds."""
        if self.overlaps(state, new, turn, move):
            return False
        if not self.constraints.named:
            return True
        met = self.flanks_met(state, new, turn, move)
        return self.constraints.allow(state.rows, state.turns, state.moves, new, turn, move, met)

    def trace(self, kind: int, turns: Floats, moves: Floats) -> Floats:
        """Numbers (k, 3) that tell poses of one kind of panel apart unless they cover the same places."""
        corners, weights = self.corners[self.first[kind]], self.corner_weights[self.first[kind]]
        waves = np.einsum("wi,kij->kwj", self._waves, turns)[:, :, :2]
        phase = waves @ corners.T + (moves @ self._waves.T)[:, :, None]
        return np.sin(phase + 0.1) @ weights

    def signature(self, state: Placement) -> Floats:
        """Moments (9,) that agree for placements which are congruent or mirror images, whichever of equal panels is where."""
        points = self.places(state)
        weights = np.concatenate([self.shape[i] * self.corner_weights[i] for i in state.rows])
        stacked = np.vstack(points)
        stacked = stacked - (weights @ stacked) / weights.sum()
        radius = np.linalg.norm(stacked, axis=1)
        stacked, far = stacked / self.size, radius / self.size
        spread = np.einsum("n,ni,nj->ij", weights, stacked, stacked)
        skew = np.einsum("n,ni,nj->ij", weights * far, stacked, stacked)
        moments = np.array([*np.linalg.eigvalsh(spread), *np.linalg.eigvalsh(skew), weights @ far, weights**2 @ far**3])
        return np.append(moments / len(stacked), len(state.rows))

    def places(self, state: Placement) -> list[Floats]:
        """Corners (n, 3) [mm] of every placed panel, in the middle of its thickness."""
        placed = zip(state.rows, state.turns, state.moves, strict=True)
        return [self.corners[i] @ turn[:, :2].T + move for i, turn, move in placed]

    def centred(self, state: Placement, row: int, turn: Floats, move: Floats) -> Floats:
        """Shift of a new panel that is the mean of what its flanks that meet ask for [mm]."""
        asked = []
        for k, a in enumerate(state.rows):
            inner, shift = state.turns[k].T @ turn, state.turns[k].T @ (move - state.moves[k])
            if abs(inner[2, 2]) > MAX_SQUARE_COSINE:  # fingers at other angles do not meet in their middles
                continue
            found = self.pairs(a, row, inner, shift)
            apart = np.zeros((len(found), 3))
            apart[:, :2] = self.flanks[a][found[:, 0], :2]
            apart -= self.flanks[row][found[:, 1], :2] @ inner[:, :2].T + shift
            asked.append(apart @ state.turns[k].T)
        every = np.vstack(asked) if asked else np.zeros((0, 3))
        return move + every.mean(axis=0) if len(every) else move

    def start(self, row: int) -> Placement:
        """One panel in its own frame."""
        return Placement((row,), np.eye(3)[None], np.zeros((1, 3)), 0, {})

    def pools(self, state: Placement, kinds: Iterable[int], power: float) -> dict[int, PosePool]:
        """Where panels of these kinds could go."""
        return {kind: self._grown(state, kind, power) for kind in kinds}

    def _grown(self, state: Placement, kind: int, power: float) -> PosePool:
        last, turn, move = state.rows[-1], state.turns[-1], state.moves[-1]
        sample = self.first[kind]
        new_turns, new_moves = self.fits(self.plates[last].kind, kind)
        turns = np.einsum("ij,kjl->kil", turn, new_turns)
        moves = new_moves @ turn.T + move
        score = np.zeros(len(moves))
        old = state.pools.get(kind)
        if old is not None and len(old.score):
            inner, shift = np.einsum("ji,kjl->kil", turn, old.turns), (old.moves - move) @ turn
            more = self.scores(last, sample, inner, shift, power)
            total = old.score + more
            turns, moves = np.concatenate([old.turns, turns]), np.concatenate([old.moves, moves])
            score = np.concatenate([total, score])
        known = 0 if old is None else len(old.score)
        keep = _first_of_each(np.column_stack([turns.reshape(-1, 9) * 20, moves * 2]))
        fresh = keep[keep >= known]
        for k, a in enumerate(state.rows):
            inner = np.einsum("ji,kjl->kil", state.turns[k], turns[fresh])
            shift = (moves[fresh] - state.moves[k]) @ state.turns[k]
            score[fresh] += self.scores(a, sample, inner, shift, power)
        keep = keep[score[keep] > -SETTINGS.hopeless_score]
        return PosePool(turns[keep], moves[keep], score[keep])


def _weights(plates: Sequence[SheetPlate]) -> list[float]:
    """The same number for panels of the same shape, turned or turned over as they may lie on the sheet."""
    shapes: list[tuple[float, float, int]] = []
    weights = []
    for plate in plates:
        shape = (plate.polygon.area, plate.polygon.length, len(plate.length))
        alike = (
            i for i, other in enumerate(shapes)
            if abs(shape[0] - other[0]) < 0.01 * shape[1] and abs(shape[1] - other[1]) < 1e-3 * shape[1]
            and shape[2] == other[2]
        )  # fmt: skip
        place = next(alike, len(shapes))
        if place == len(shapes):
            shapes.append(shape)
        weights.append(1.0 + 0.37 * place)
    return weights


def _filled(plate: SheetPlate) -> shapely.Polygon:
    """Outline of a panel with the notches and holes of its joints filled, a little smaller."""
    reach = 1.6 * plate.thickness
    small = [ring for ring in plate.polygon.interiors if shapely.Polygon(ring).buffer(-reach).is_empty]
    whole = shapely.union_all([plate.polygon, *(shapely.Polygon(ring) for ring in small)])
    closed = whole.buffer(reach, join_style="mitre").buffer(-reach - 0.2 * plate.thickness, join_style="mitre")
    return max(shapely.get_parts(closed), key=lambda piece: piece.area)


def _edges(polygon: shapely.Polygon) -> Floats:
    rings = [shapely.get_coordinates(ring) for ring in (polygon.exterior, *polygon.interiors)]
    return np.ascontiguousarray(np.vstack([np.hstack([ring[:-1], ring[1:]]) for ring in rings]))


def _first_of_each(values: Floats) -> NDArray[np.int64]:
    """Rows of `values` (n, m) that, rounded, no earlier row equals (by a hash of 64 bits); ascending."""
    with np.errstate(over="ignore"):
        hashed = (np.rint(values).astype(np.int64) * _PRIMES[: values.shape[1]]).sum(axis=1)
    _, first = np.unique(hashed, return_index=True)
    return np.sort(first)
