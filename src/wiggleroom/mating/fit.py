"""Whether placed plates fit each other: the room of tabs and slots, shifts of the panels that free them, and what is too thick.

Two plates whose planes are square to each other share material where both have some at the same place of the line in which their
planes cross. Along that line, a plate has material inside the other one (solid), or it leaves it room on both sides, as a slot does.
So what is asked of the shifts of the panels is linear in them, and a linear program says how far outlines must move inward.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.mating.panel_outline import inset
from wiggleroom.mating.panel_set import PanelSet, Placement
from wiggleroom.mating.refinement import pressing, relief_needed

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class FitSettings:
    """Parameters of fitting placed plates.

    Parameters
    ----------
    reach : float in (0, 0.5)
        Share of the thinner plate's thickness: faces nearer to each other than this, or overlapping by less, ask something of the shifts.
    max_cosine : float in (0, 1)
        Planes are square to each other where the cosine of the angle between them is below this.
    grain : float > 0 [mm]
        Places along the crossing line that are nearer to each other than this are one.
    rounds : int
        How often rooms are measured again at the shifted panels.
    margin : float > 0 [mm]
        Added to the relief that was found to be enough.
    """

    reach: float = 0.3
    max_cosine: float = 1e-3
    grain: float = 1e-6
    rounds: int = 4
    margin: float = 2e-6


SETTINGS = FitSettings()

Kind = Literal["thickness", "width"]


@dataclass(frozen=True)
class Misfit:
    """A panel that is too thick for slots of another one, or whose tabs are too wide for them.

    Parameters
    ----------
    kind : "thickness" or "width"
        Of the panel, or of its tab along the slot.
    panels : (int, int)
        The one that is too large, the one with the slots.
    size, room : float [mm]
        Of the panel or its tab, and of the slot, as cut.
    places : int
        How many slots.
    """

    kind: Kind
    panels: tuple[int, int]
    size: float
    room: float
    places: int = 1

    @property
    def excess(self) -> float:
        """By how much it is too large [mm]."""
        return self.size - self.room


@dataclass(frozen=True, eq=False)
class _Room:
    """Room between two faces of panels `i` and `j` of a placement, and how it changes.

    Parameters
    ----------
    i, j : int
        Places in the placement.
    gap : float [mm]
        Negative where they overlap.
    along : (3,) float64
        The gap grows by the shift of j less that of i along this.
    share : float
        By how much it grows for every mm of relief: 2 between two cut edges, 1 between a cut edge and a face of the sheet.
    """

    i: int
    j: int
    gap: float
    along: Floats
    share: float


@dataclass(frozen=True)
class _Stretch:
    """A stretch of the crossing line, and what one plate has there of the other plate's slab.

    Parameters
    ----------
    start, stop : float [mm]
    solid : bool
        Material inside the slab.
    above, below : float [mm]
        Where it is not solid: room between the slab's upper, or lower, face and the material beyond it; infinite where there is none.
    """

    start: float
    stop: float
    solid: bool
    above: float
    below: float

    @property
    def overlap(self) -> float:
        """How deep material reaches into the slab [mm]."""
        return max(0.0, -self.above, -self.below)


def fitted(
    panel_set: PanelSet,
    state: Placement,
    thickness: list[float],
    least: float,
    most: float,
    tied: Sequence[tuple[int, int]] = (),
) -> tuple[Placement, float]:
    """Placement whose panels are shifted so that no plates overlap, and the relief that takes [mm].

    Parameters
    ----------
    panel_set : PanelSet
    state : Placement
    thickness : list of float [mm]
        Real thickness of every panel of the sheet.
    least, most : float [mm]
        The relief is at least the one, and infinite where the other is not enough.
    tied : sequence of (int, int)
        Panels that keep their place against each other.
    """
    if not pressing(panel_set, state, thickness, least):
        return state, least
    rooms: list[_Room] = []
    shifts, relief = np.zeros((len(state.rows), 3)), least
    bonds = [(state.rows.index(a), state.rows.index(b)) for a, b in tied if {a, b} <= set(state.rows)]
    for _ in range(SETTINGS.rounds):
        here = _shifted(state, shifts)
        found = [
            _Room(r.i, r.j, r.gap - float(r.along @ (shifts[r.j] - shifts[r.i])) - r.share * relief, r.along, r.share)
            for i in range(len(state.rows)) for j in range(i)
            for r in _rooms(panel_set, here, thickness, i, j, relief)[0]
        ]  # fmt: skip
        if all(_at(room, shifts, relief) >= -SETTINGS.margin / 4 for room in found):
            break
        rooms += found
        solved = _least_relief(rooms, len(state.rows), least, most, SETTINGS.reach * min(thickness), bonds)
        if solved is None:
            break
        shifts, relief = solved
    if relief > least:
        relief += SETTINGS.margin
    here = _shifted(state, shifts)
    if relief <= most and not pressing(panel_set, here, thickness, relief):
        return here, relief
    # Plates in planes at other angles, or shapes that leave no room as above: only how deep they overlap is known.
    return min(((each, relief_needed(panel_set, each, thickness, least, most)) for each in (state, here)), key=_relief)


def _relief(found: tuple[Placement, float]) -> float:
    return found[1]


def _shifted(state: Placement, shifts: Floats) -> Placement:
    return Placement(state.rows, state.turns, state.moves + shifts, state.met, {})


def _at(room: _Room, shifts: Floats, relief: float) -> float:
    return room.gap + float(room.along @ (shifts[room.j] - shifts[room.i])) + room.share * relief


def _least_relief(
    rooms: list[_Room], count: int, least: float, most: float, reach: float, bonds: list[tuple[int, int]]
) -> tuple[Floats, float] | None:
    """Shifts (count, 3) [mm] that free all rooms with the least relief, and of these the shortest ones; None where nothing does."""
    from scipy.optimize import linprog

    # Variables: shifts, their lengths along the axes, the relief.
    n = 3 * count
    matrix, side = np.zeros((len(rooms) + 2 * n, 2 * n + 1)), np.zeros(len(rooms) + 2 * n)
    for k, room in enumerate(rooms):
        matrix[k, 3 * room.j : 3 * room.j + 3] -= room.along
        matrix[k, 3 * room.i : 3 * room.i + 3] += room.along
        matrix[k, -1] = -room.share
        side[k] = room.gap
    rows = np.arange(n)
    matrix[len(rooms) + rows, rows], matrix[len(rooms) + rows, n + rows] = 1.0, -1.0
    matrix[len(rooms) + n + rows, rows], matrix[len(rooms) + n + rows, n + rows] = -1.0, -1.0
    tied = np.zeros((3 * len(bonds), 2 * n + 1))
    for k, (i, j) in enumerate(bonds):
        for axis in range(3):
            tied[3 * k + axis, 3 * i + axis], tied[3 * k + axis, 3 * j + axis] = 1.0, -1.0
    cost = np.append(np.zeros(n), np.full(n, 1e-4 / n))
    bounds = [(-reach, reach)] * n + [(0.0, reach)] * n + [(least, most)]
    solved = linprog(
        np.append(cost, 1.0), matrix, side, tied if len(bonds) else None, np.zeros(3 * len(bonds)) if bonds else None,
        bounds, method="highs",
    )  # fmt: skip
    if solved.x is None:
        return None
    return solved.x[:n].reshape(count, 3), float(solved.x[-1])


def misfits(
    panel_set: PanelSet, state: Placement, thickness: list[float], relief: float, tolerance: float
) -> list[Misfit]:
    """What is too thick, or too wide, for slots by more than a tolerance [mm], when outlines are moved inward by a relief [mm]."""
    found: dict[tuple[Kind, tuple[int, int], float, float], int] = {}
    for i in range(len(state.rows)):
        for j in range(i):
            for kind, panels, size, room in _rooms(panel_set, state, thickness, i, j, relief)[1]:
                if size - room > tolerance:
                    key = (kind, panels, round(size, 3), round(room, 3))
                    found[key] = found.get(key, 0) + 1
    return [Misfit(*key, places) for key, places in found.items()]


def _rooms(
    panel_set: PanelSet, state: Placement, thickness: list[float], i: int, j: int, relief: float
) -> tuple[list[_Room], list[tuple[Kind, tuple[int, int], float, float]]]:
    """Rooms between two placed plates, and the size and room of everything that is held on two sides."""
    a, b = state.rows[i], state.rows[j]
    turn, move = state.turns[i].T @ state.turns[j], state.turns[i].T @ (state.moves[j] - state.moves[i])
    normal = turn[:, 2]
    apart = float(np.linalg.norm(move)) > panel_set.radius[a] + panel_set.radius[b] + thickness[a] + thickness[b]
    if abs(normal[2]) > SETTINGS.max_cosine or apart:
        return [], []
    across = np.append(normal[:2] / np.hypot(*normal[:2]), 0.0)  # B's normal, in A's plane
    line = np.array([-across[1], across[0], 0.0])
    one = _outline(panel_set, a, relief) @ np.column_stack([line[:2], across[:2]])
    one[..., 1] -= across @ move
    other = _outline(panel_set, b, relief) @ turn[:, :2].T @ np.column_stack([line, [0.0, 0.0, 1.0]])
    other += [line @ move, move[2]]
    thick, thicker = thickness[a] / 2, thickness[b] / 2
    reach = SETTINGS.reach * 2 * min(thick, thicker)
    stretches = _stretches(one, thicker, other, thick, reach)
    if not stretches:
        return [], []
    world = state.turns[i]
    line, across, up = world @ line, world @ across, world[:, 2]
    rooms: list[_Room] = []
    held: list[tuple[Kind, tuple[int, int], float, float]] = []
    # Faces of the one plate in slots of the other.
    for place in _places(stretches, reach):
        above = min(own.above for _, own in place), min(own.below for _, own in place)
        rooms += [_Room(i, j, gap, sign * up, 1.0) for gap, sign in zip(above, (1.0, -1.0), strict=True) if gap < reach]
        if max(above) < reach:
            held.append(("thickness", (a, b), 2 * thick, 2 * thick + sum(above)))
    for place in _places([(own, others) for others, own in stretches], reach):
        above = min(own.above for _, own in place), min(own.below for _, own in place)
        rooms += [
            _Room(i, j, gap, sign * across, 1.0) for gap, sign in zip(above, (-1.0, 1.0), strict=True) if gap < reach
        ]
        if max(above) < reach:
            held.append(("thickness", (b, a), 2 * thicker, 2 * thicker + sum(above)))
    # Edges that follow each other along the line.
    first, second = (_runs([each[k] for each in stretches]) for k in (0, 1))
    for start, stop in first:
        for begin, end in second:
            after, before = begin - stop, start - end
            if -reach < max(after, before) < reach:
                rooms.append(_Room(i, j, max(after, before), line if after >= before else -line, 2.0))
    tabs, gaps = _between(first, second, reach), _between(second, first, reach)
    held += [("width", (a, b), *sizes) for sizes in tabs] if len(tabs) >= len(gaps) else []
    held += [("width", (b, a), *sizes) for sizes in gaps] if len(gaps) > len(tabs) else []
    # Corners: the smaller of two overlaps is the one to be freed.
    for own, others in stretches:
        if not own.solid and not others.solid and own.overlap and others.overlap:
            if others.overlap <= own.overlap:
                rooms += [
                    _Room(i, j, gap, s * up, 1.0) for gap, s in ((others.above, 1.0), (others.below, -1.0)) if gap < 0
                ]
            else:
                rooms += [
                    _Room(i, j, gap, s * across, 1.0) for gap, s in ((own.above, -1.0), (own.below, 1.0)) if gap < 0
                ]
    return rooms, held


def _outline(panel_set: PanelSet, row: int, relief: float) -> Floats:
    """Ends (n, 2, 2) of all edges of a panel's outline [mm]."""
    polygon = inset(panel_set.plates[row].polygon, relief)
    rings = [shapely.get_coordinates(ring) for ring in (polygon.exterior, *polygon.interiors)]
    return np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])


def _stretches(
    one: Floats, half_other: float, other: Floats, half_one: float, reach: float
) -> list[tuple[_Stretch, _Stretch]]:
    """The crossing line in stretches between corners of either outline, with what both plates have there.

    Edges (n, 2, 2) are given along the line and across the other plate's slab, of which the half thickness is given.
    """
    low, high = max(one[..., 0].min(), other[..., 0].min()), min(one[..., 0].max(), other[..., 0].max())
    low, high = low - reach, high + reach
    if high <= low:
        return []
    own = []
    for edges, half in ((one, half_other), (other, half_one)):
        corners = edges[..., 0][np.abs(edges[..., 1]) < half + reach]
        cuts = np.unique(np.concatenate([[low, high], corners[(corners > low) & (corners < high)]]))
        cuts = cuts[np.append(True, np.diff(cuts) > SETTINGS.grain)]
        own.append(_with_corners([_stretch(edges, half, *ends, reach) for ends in pairwise(cuts)]))
    found = []
    i = j = 0
    while i < len(own[0]) and j < len(own[1]):
        first, second = own[0][i], own[1][j]
        start, stop = max(first.start, second.start), min(first.stop, second.stop)
        if stop - start > SETTINGS.grain:
            found.append((replace(first, start=start, stop=stop), replace(second, start=start, stop=stop)))
        i, j = i + (first.stop <= stop), j + (second.stop <= stop)
    return found


def _stretch(edges: Floats, half: float, start: float, stop: float, reach: float) -> _Stretch:
    """What a plate with these edges has of a slab of this half thickness, between two places of the line."""
    above = below = np.inf
    solid = False
    step = min(1e-7, (stop - start) / 4)
    for place in (start + step, stop - step):
        crossing = (edges[:, 0, 0] > place) != (edges[:, 1, 0] > place)
        here, there = edges[crossing, 0], edges[crossing, 1]
        at = np.sort(here[:, 1] + (place - here[:, 0]) / (there[:, 0] - here[:, 0]) * (there[:, 1] - here[:, 1]))
        for bottom, top in at.reshape(-1, 2):
            if bottom >= half - reach:
                above = min(above, float(bottom) - half)
            elif top <= reach - half:
                below = min(below, -half - float(top))
            else:
                solid = True
    return _Stretch(start, stop, solid, above, below)


def _with_corners(stretches: list[_Stretch]) -> list[_Stretch]:
    """Stretches in which what reaches deeper into the slab than it is long, beside solid material, is solid too: a rounded corner."""
    solid = [False, *(each.solid for each in stretches), False]
    return [
        replace(each, solid=each.solid or (each.overlap > each.stop - each.start and (solid[k] or solid[k + 2])))
        for k, each in enumerate(stretches)
    ]


def _places(stretches: list[tuple[_Stretch, _Stretch]], reach: float) -> list[list[tuple[_Stretch, _Stretch]]]:
    """Stretches that follow each other and in which the first plate is solid and the second leaves it room, with material near."""
    found: list[list[tuple[_Stretch, _Stretch]]] = []
    inside = False
    for own, other in stretches:
        now = own.solid and not other.solid and min(other.above, other.below) < reach
        if now and not inside:
            found.append([])
        if now:
            found[-1].append((own, other))
        inside = now
    return found


def _runs(stretches: list[_Stretch]) -> list[tuple[float, float]]:
    """Where a plate is solid."""
    found: list[tuple[float, float]] = []
    for each in stretches:
        if each.solid and found and each.start - found[-1][1] <= SETTINGS.grain:
            found[-1] = found[-1][0], each.stop
        elif each.solid:
            found.append((each.start, each.stop))
    return found


def _between(
    runs: list[tuple[float, float]], walls: list[tuple[float, float]], reach: float
) -> list[tuple[float, float]]:
    """Width [mm] of every run that lies between two walls, and the width between these."""
    found = []
    for start, stop in runs:
        before = [end for begin, end in walls if begin < start and abs(end - start) < reach]
        after = [begin for begin, end in walls if end > stop and abs(begin - stop) < reach]
        if before and after:
            found.append((stop - start, min(after) - max(before)))
    return found
