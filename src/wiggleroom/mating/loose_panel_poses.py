"""Where a panel without joints could lie: poses in which its faces and edges touch, or are flush with, those of panels that stand.

A person says which point of the loose panel is to be next to which point of a placed one. Of all turns by quarters that
fit this, and all shifts near by at which planes of the loose panel meet planes of the others, the ones count in which the most
panels are touched, then the most area, and no material is shared.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.errors import InputError
from wiggleroom.mating.assembled_sheet import AssembledSheet
from wiggleroom.mating.flanks import SheetPlate
from wiggleroom.mating.hints import FixedPlate
from wiggleroom.mating.panel_set import PanelSet, Placement

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class LayingSettings:
    """Parameters of laying a loose panel on others.

    Parameters
    ----------
    edge_reach : float > 0
        A point nearer to an outline than this many thicknesses means the edge, else the face.
    snap_reach : float > 0
        Planes meet at shifts of at most this many thicknesses from where the two points would coincide.
    max_shifts : int
        Shifts along each axis that are tried, the smallest ones.
    clearance : float > 0
        Faces that face each other at this share of the thickness still guide the panel, such as those of a groove.
    flush_weight : float
        Length of flush edges times thickness counts so much against area in contact.
    max_ways : int
        Most poses that are given.
    """

    edge_reach: float = 1.0
    snap_reach: float = 4.0
    max_shifts: int = 7
    clearance: float = 0.4
    flush_weight: float = 0.5
    max_ways: int = 8


SETTINGS = LayingSettings()


@dataclass(frozen=True, eq=False)
class BoundaryPlanes:
    """Plane pieces of the boundary of panels whose normals are axes of a frame, as boxes in that frame.

    Parameters
    ----------
    axis : (n,) int
        Along which the normal points.
    sign : (n,) float64
    low, high : (n, 3) float64 [mm]
    owner : (n,) int
        Row of the panel.
    """

    axis: NDArray[np.int64]
    sign: Floats
    low: Floats
    high: Floats
    owner: NDArray[np.int64]


def laid_plates(
    found: AssembledSheet,
    panel: str,
    at: tuple[float, float],
    onto: str,
    there: tuple[float, float],
    *,
    context: Context = UNLIMITED,
) -> list[FixedPlate]:
    """Poses of a loose panel in the frame of a placed one that it touches, what seems best first.

    Parameters
    ----------
    found : AssembledSheet
    panel, onto : str
        The loose panel, and the one that it is to touch.
    at, there : (x, y) [mm]
        Points of both on the sheet that come to lie near each other: next to an edge they mean the edge, else the face.

    Raises
    ------
    InputError
        If a panel is not there, `onto` is not placed, or nothing fits.
    """
    names = [plate.name for plate in found.plates]
    wrong = [f'there is no panel "{name}"' for name in (panel, onto) if name not in names]
    if wrong:
        raise InputError(wrong)
    row, base = names.index(panel), names.index(onto)
    home = next((body for body in found.bodies if base in body.rows), None)
    if home is None or row == base:
        message = f"{onto} is not placed itself; lay {panel} on a panel that stands"
        raise InputError(message)
    home = _without(home, row)
    if not home.rows:
        message = f"{onto} stands alone; lay {panel} on a panel that others hold"
        raise InputError(message)
    panel_set = PanelSet(found.plates)
    poses = _laid(panel_set, home, row, np.array(at), base, np.array(there), context)
    if not poses:
        message = f"{panel} cannot touch {onto} there without sharing material; press nearer to where it belongs"
        raise InputError(message)
    place = home.rows.index(base)
    frame, origin = home.turns[place], home.moves[place]
    return [_fixed(panel, onto, frame.T @ turn, frame.T @ (move - origin)) for turn, move in poses]


def _without(body: Placement, row: int) -> Placement:
    keep = [k for k, other in enumerate(body.rows) if other != row]
    return Placement(tuple(body.rows[k] for k in keep), body.turns[keep], body.moves[keep], body.met, {})


def _fixed(panel: str, frame: str, turn: Floats, move: Floats) -> FixedPlate:
    x, y, z = ([round(float(value), 6) + 0.0 for value in row] for row in (move, turn[:, 0], turn[:, 1]))
    return FixedPlate(panel, (x[0], x[1], x[2]), (y[0], y[1], y[2]), (z[0], z[1], z[2]), frame)


def _laid(
    panel_set: PanelSet, home: Placement, row: int, at: Floats, base: int, there: Floats, context: Context
) -> list[tuple[Floats, Floats]]:
    """Poses of a panel, best first."""
    plate, other = panel_set.plates[row], panel_set.plates[base]
    place = home.rows.index(base)
    turn, move = home.turns[place], home.moves[place]
    point, target = at - plate.centre, turn[:, :2] @ (there - other.centre) + move
    own, is_edge, _ = _nearest_edge(plate, point)
    its, on_edge, corner = _nearest_edge(other, there - other.centre)
    along, out, normal = turn[:, :2] @ its, turn[:, :2] @ [its[1], -its[0]], turn[:, 2]
    inner = np.zeros((3, 3))  # the panel's frame seen from that of its edge: along, outward, up
    inner[:2, 0], inner[:2, 1] = own, (own[1], -own[0])
    inner[:, 2] = np.cross(inner[:, 0], inner[:, 1])
    anchor = inner.T @ np.append(point, 0.0)
    mine = _planes([row], inner.T[None], np.zeros((1, 3)), panel_set, np.eye(3))
    ranked: list[tuple[int, float, Floats, Floats]] = []
    for frame in _frames(along, out, normal, is_edge, on_edge):
        context.go_on()
        theirs = _planes(home.rows, home.turns, home.moves, panel_set, frame)
        named = theirs.owner == base
        if on_edge:  # then it is the narrow side that is touched
            outward, place_of_edge = frame.T @ out, frame.T @ (turn[:, :2] @ corner + move)
            axis = int(np.argmax(np.abs(outward)))
            named &= (theirs.axis == axis) & (theirs.sign * outward[axis] > 0)
            named &= np.abs(theirs.low[:, axis] - place_of_edge[axis]) < 0.1 * plate.thickness
        near = frame.T @ target - anchor
        shifts = [_snaps(mine, theirs, axis, near[axis], plate.thickness) for axis in range(3)]
        for each in itertools.product(*shifts):
            shift = np.array(each)
            touched, score = _contact(mine, theirs, shift, named, plate.thickness)
            if touched:
                ranked.append((touched, score - 0.01 * float(np.abs(shift - near).sum()), frame, shift))
    ranked.sort(key=lambda each: (-each[0], -each[1]))
    found: list[tuple[Floats, Floats]] = []
    marks: set[tuple[float, ...]] = set()
    for *_, frame, shift in ranked:
        pose = frame @ inner.T, frame @ shift
        mark = tuple(np.round([*pose[0].ravel(), *pose[1]], 2))
        if mark in marks or panel_set.overlaps(home, row, *pose):
            continue
        marks.add(mark)
        found.append(pose)
        if len(found) == SETTINGS.max_ways:
            break
    return found


def _nearest_edge(plate: SheetPlate, point: Floats) -> tuple[Floats, bool, Floats]:
    """Direction of the straight edge that is nearest to a point, whether it is near, and its beginning; of a face of the longest edge."""
    here, there = _edges(plate)
    apart = shapely.distance(shapely.linestrings(np.stack([here, there], axis=1)), shapely.Point(point))
    long = np.hypot(*(there - here).T)
    near = bool(apart.min() < SETTINGS.edge_reach * plate.thickness)
    k = int(np.argmin(np.where(long > plate.thickness, apart, np.inf))) if near else int(np.argmax(long))
    return (there[k] - here[k]) / long[k], near, here[k]


def _edges(plate: SheetPlate) -> tuple[Floats, Floats]:
    rings = [np.asarray(ring.coords)[:-1] for ring in (plate.polygon.exterior, *plate.polygon.interiors)]
    return np.vstack(rings), np.vstack([np.roll(ring, -1, axis=0) for ring in rings])


def _frames(along: Floats, out: Floats, normal: Floats, is_edge: bool, on_edge: bool) -> list[Floats]:
    """Frames (along its edge, out of its edge, up) in which a panel may lie, from those of the edge that it is laid on."""
    if on_edge and is_edge:
        pairs = [(a, b) for a in (along, -along) for b in (out, -out, normal, -normal)]
    elif on_edge:
        pairs = [(a, b) for a in (along, -along) for b in (normal, -normal)]
        pairs += [(a, b) for a in (normal, -normal) for b in (along, -along)]
    elif is_edge:
        pairs = [(a, b) for a in (along, -along, out, -out) for b in (normal, -normal)]
    else:
        pairs = [(a, b) for a in (along, -along) for b in (out, -out)]
        pairs += [(a, b) for a in (out, -out) for b in (along, -along)]
    return [np.column_stack([a, b, np.cross(a, b)]) for a, b in pairs]


def _planes(rows: Sequence[int], turns: Floats, moves: Floats, panel_set: PanelSet, frame: Floats) -> BoundaryPlanes:
    """Faces and straight edges of placed panels whose normals are axes of a frame."""
    axes, signs, lows, highs, owners = [], [], [], [], []
    for row, turn, move in zip(rows, turns, moves, strict=True):
        plate = panel_set.plates[row]
        half = plate.thickness / 2
        pose, shift = frame.T @ turn, frame.T @ move
        here, there = _edges(plate)
        ring = np.asarray(plate.polygon.exterior.coords)[:-1]
        pieces = [(pose[:, 2] * side, np.column_stack([ring, np.full(len(ring), side * half)])) for side in (1.0, -1.0)]
        unit = (there - here) / np.maximum(np.hypot(*(there - here).T), 1e-12)[:, None]
        for a, b, u in zip(here, there, unit, strict=True):
            if np.hypot(*(b - a)) > 0.5 * plate.thickness:
                corners = np.array([[*a, -half], [*a, half], [*b, -half], [*b, half]])
                pieces.append((pose[:, 0] * u[1] - pose[:, 1] * u[0], corners))
        for normal, corners in pieces:
            axis = int(np.argmax(np.abs(normal)))
            if abs(normal[axis]) > 0.999:
                points = corners @ pose.T + shift
                axes.append(axis)
                signs.append(float(np.sign(normal[axis])))
                lows.append(points.min(axis=0))
                highs.append(points.max(axis=0))
                owners.append(row)
    return BoundaryPlanes(
        np.array(axes, dtype=np.int64), np.array(signs), np.array(lows).reshape(-1, 3), np.array(highs).reshape(-1, 3),
        np.array(owners, dtype=np.int64),
    )  # fmt: skip


def _snaps(mine: BoundaryPlanes, theirs: BoundaryPlanes, axis: int, near: float, thickness: float) -> list[float]:
    """Shifts along an axis at which planes meet, or the panel is in the middle between two, nearest first."""
    own, its = mine.axis == axis, theirs.axis == axis
    shifts = (theirs.low[its, axis][:, None] - mine.low[own, axis]).ravel()
    low, high = mine.low[:, axis].min(), mine.high[:, axis].max()
    up, down = its & (theirs.sign > 0), its & (theirs.sign < 0)
    spare = theirs.low[down, axis][:, None] - theirs.low[up, axis] - (high - low)
    middle = (theirs.low[down, axis][:, None] + theirs.low[up, axis]) / 2 - (high + low) / 2
    whole = (theirs.low[:, axis].min() + theirs.high[:, axis].max()) / 2 - (high + low) / 2
    shifts = np.concatenate([shifts, middle[(spare > 0) & (spare < thickness)], [whole, near]])
    shifts = shifts[np.abs(shifts - near) <= SETTINGS.snap_reach * thickness]
    _, first = np.unique(np.round(shifts, 3), return_index=True)
    shifts = shifts[first]
    return shifts[np.argsort(np.abs(shifts - near))][: SETTINGS.max_shifts].tolist()  # type: ignore[no-any-return]


def _contact(
    mine: BoundaryPlanes, theirs: BoundaryPlanes, shift: Floats, named: NDArray[np.bool_], thickness: float
) -> tuple[int, float]:
    """How many panels are touched, and area [mm2] at which planes touch or guide each other with flush length times thickness.

    Both 0 where none of the planes is touched that were named.
    """
    low, high = mine.low + shift, mine.high + shift
    rows, columns = np.nonzero(mine.axis[:, None] == theirs.axis)
    axis = mine.axis[rows]
    gap = (theirs.low[columns, axis] - low[rows, axis]) * mine.sign[rows]
    shared = np.minimum(high[rows], theirs.high[columns]) - np.maximum(low[rows], theirs.low[columns])
    shared[np.arange(len(rows)), axis] = 1.0
    area = np.clip(shared, 0.0, None).prod(axis=1)
    opposed = mine.sign[rows] != theirs.sign[columns]
    touching = opposed & (np.abs(gap) < 0.02 * thickness) & (area > 0.1 * thickness**2)
    guided = opposed & (gap > 0) & (gap < SETTINGS.clearance * thickness) & (area > 0.1 * thickness**2)
    if not (touching | guided)[named[columns]].any():
        return 0, 0.0
    flush = ~opposed & (np.abs(gap) < 0.02 * thickness) & (shared.min(axis=1) > -0.02 * thickness)
    length = np.sort(np.clip(shared, 0.0, None), axis=1)[:, -1] * thickness
    touched = len(np.unique(theirs.owner[columns[touching | guided]]))
    return touched, float(area[touching].sum() + 0.5 * area[guided].sum() + SETTINGS.flush_weight * length[flush].sum())
