"""Placed panels moved so that flanks meet as well as they can, and outlines relieved where they still press on each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.errors import require_extra
from wiggleroom.mating.contact import MAX_SQUARE_COSINE
from wiggleroom.mating.flanks import SheetPlate
from wiggleroom.mating.panel_outline import inset
from wiggleroom.mating.panel_set import PanelSet, Placement

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class RefinementSettings:
    """Parameters of the last adjustment of poses.

    Parameters
    ----------
    free_volume : float > 0 [mm2]
        Volume that two plates may share through rounding, for every mm of the smaller outline's length.
    relief_resolution : float > 0 [mm]
        How closely the relief that frees the panels is found.
    stay_weight : float > 0
        Weight of staying in place against one flank that meets another: it only fixes what no joint fixes.
    relief_margin : float > 0 [mm]
        Added to the relief that was found to be enough; a little more than its resolution.
    """

    free_volume: float = 1e-9
    relief_resolution: float = 1e-6
    stay_weight: float = 1e-6
    relief_margin: float = 2e-6


SETTINGS = RefinementSettings()


def least_squares_placement(panel_set: PanelSet, state: Placement) -> Placement:
    """Placement whose panels are shifted by least squares over all flanks that meet; turns stay, the first panel stays.

    Returns
    -------
    Placement
    """
    place = {row: k for k, row in enumerate(state.rows)}
    joints = [
        joint for joint in panel_set.met(state)[0]  # fingers at other angles do not meet in their middles
        if abs(state.turns[place[joint[0]]][:, 2] @ state.turns[place[joint[1]]][:, 2]) < MAX_SQUARE_COSINE
    ]  # fmt: skip
    if not joints:
        return state
    count = len(state.rows)
    # A panel that no joint holds, such as one whose place was told, stays where it is.
    matrix = np.vstack([np.zeros((len(joints), count)), SETTINGS.stay_weight * np.eye(count)])
    wanted = np.vstack([np.zeros((len(joints), 3)), SETTINGS.stay_weight * state.moves])
    for q, (a, b, found) in enumerate(joints):
        i, j = place[a], place[b]
        apart = panel_set.flanks[b][found[:, 1], :2] @ state.turns[j][:, :2].T
        apart -= panel_set.flanks[a][found[:, 0], :2] @ state.turns[i][:, :2].T
        weight = np.sqrt(len(found))
        matrix[q, i], matrix[q, j] = weight, -weight
        wanted[q] = weight * apart.mean(axis=0)
    matrix[len(joints), 0], wanted[len(joints)] = 1.0, state.moves[0]
    moves: Floats = np.linalg.lstsq(matrix, wanted, rcond=None)[0].astype(np.float64)
    return Placement(state.rows, state.turns, moves, state.met, {})


def plate_solid(plate: SheetPlate, thickness: float, turn: Floats, move: Floats, relief: float = 0.0) -> Any:
    """Plate in space as a manifold of manifold3d; its outline moved inward by `relief` [mm].

    Raises
    ------
    MissingExtraError
        If manifold3d is not installed.
    """
    require_extra("solid", "putting plates together needs manifold3d", "manifold3d")
    import manifold3d

    outline = inset(plate.polygon, relief)
    rings = [shapely.get_coordinates(ring)[:-1] for ring in (outline.exterior, *outline.interiors)]
    section = manifold3d.CrossSection(rings, manifold3d.FillRule.EvenOdd)
    body = manifold3d.Manifold.extrude(section, thickness).translate([0.0, 0.0, -thickness / 2])
    return body.transform(np.column_stack([turn, move]))


def relief_needed(panel_set: PanelSet, state: Placement, thickness: list[float], least: float, most: float) -> float:
    """Smallest distance [mm] by which all outlines must move inward so that no two plates share material; panels stay.

    Parameters
    ----------
    panel_set : PanelSet
    state : Placement
    thickness : list of float [mm]
        Real thickness of every panel of the sheet.
    least, most : float [mm]
        It is at least the one; infinity is returned where even the other is not enough.
    """
    near = _near(panel_set, state, thickness)
    low, high = least, most
    if not _pressing(panel_set, state, thickness, near, least):
        return least
    left = _pressing(panel_set, state, thickness, near, most)
    if left:
        return float("inf")
    while high - low > max(SETTINGS.relief_resolution, 0.02 * high):
        middle = (low + high) / 2
        if _pressing(panel_set, state, thickness, near, middle):
            low = middle
        else:
            high = middle
    return high + SETTINGS.relief_margin


def pressing(panel_set: PanelSet, state: Placement, thickness: list[float], relief: float) -> bool:
    """Whether any two plates share material when all outlines are moved inward by a relief [mm]."""
    return _pressing(panel_set, state, thickness, _near(panel_set, state, thickness), relief)


def pressed_panel(panel_set: PanelSet, state: Placement, thickness: list[float], relief: float) -> int:
    """Row of the panel that overlaps others at this relief and of whose flanks the fewest meet."""
    _, flags = panel_set.met(state)
    pressed = set()
    for i, j in _near(panel_set, state, thickness):
        if _pressing(panel_set, state, thickness, [(i, j)], relief):
            pressed |= {state.rows[i], state.rows[j]}
    return min(pressed, key=lambda row: (flags[row].sum(), -state.rows.index(row)))


def _near(panel_set: PanelSet, state: Placement, thickness: list[float]) -> list[tuple[int, int]]:
    """Pairs of places in the placement whose boxes meet."""
    boxes = []
    for row, turn, points in zip(state.rows, state.turns, panel_set.places(state), strict=True):
        reach = np.abs(turn[:, 2]) * thickness[row] / 2
        boxes.append((points.min(axis=0) - reach, points.max(axis=0) + reach))
    count = range(len(boxes))
    return [
        (i, j) for i in count for j in range(i)
        if (boxes[i][0] < boxes[j][1]).all() and (boxes[j][0] < boxes[i][1]).all()
    ]  # fmt: skip


def _pressing(
    panel_set: PanelSet, state: Placement, thickness: list[float], near: list[tuple[int, int]], relief: float
) -> bool:
    used = {k for pair in near for k in pair}
    solids = {}
    for k in used:
        row = state.rows[k]
        solids[k] = plate_solid(panel_set.plates[row], thickness[row], state.turns[k], state.moves[k], relief)
    least = SETTINGS.free_volume * min((panel_set.plates[row].polygon.length for row in state.rows), default=1.0)
    return any((solids[i] ^ solids[j]).volume() > least for i, j in near)
