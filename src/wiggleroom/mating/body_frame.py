"""How a body of panels lies in space: the drawn sides outward, upright, one body beside the other."""

from __future__ import annotations

import numpy as np

from wiggleroom.mating.panel_set import PanelSet, Placement
from wiggleroom.mating.sheet_settings import SETTINGS


def without_panel(body: Placement, row: int) -> Placement:
    """Placement without one of its panels."""
    keep = [k for k, other in enumerate(body.rows) if other != row]
    return Placement(tuple(body.rows[k] for k in keep), body.turns[keep], body.moves[keep], body.met, {})


def outward(panel_set: PanelSet, body: Placement) -> Placement:
    """Body or its mirror image: the one whose panels show their drawn side outward."""
    areas = np.array([panel_set.plates[row].polygon.area for row in body.rows])
    centre = areas @ body.moves / areas.sum()
    if areas @ np.einsum("ki,ki->k", body.turns[:, :, 2], body.moves - centre) >= 0:
        return body
    flip = np.diag([1.0, 1.0, -1.0])
    return Placement(body.rows, flip @ body.turns @ flip, body.moves @ flip, body.met, {})


def upright(panel_set: PanelSet, body: Placement) -> Placement:
    """Body standing on the panel called bottom or on the one that suits it."""
    turns, moves = body.turns, body.moves
    areas = np.array([panel_set.plates[row].polygon.area for row in body.rows])
    calling = ("bottom", "floor", "base", "boden")
    said = [k for k, row in enumerate(body.rows) if panel_set.plates[row].name.lower().startswith(calling)]
    points = np.vstack(panel_set.places(Placement(body.rows, turns, moves, 0.0, {})))

    def tilted(i: int) -> tuple[float, int]:
        """Size of the box round everything in the frame of one panel, then how many panels stand askew in it."""
        askew = (np.abs(turns[:, :, 2] @ turns[i]).max(axis=1) < 0.999).sum()
        return round(float(np.prod(np.ptp(points @ turns[i], axis=0) + 1.0)), -1), int(askew)

    k = said[0] if said else min(range(len(body.rows)), key=tilted)
    frame, origin = turns[k], moves[k]
    turns, moves = frame.T @ turns, (moves - origin) @ frame
    if areas @ moves[:, 2] < 0:  # the others stand on it, not below
        half = np.diag([1.0, -1.0, -1.0])
        turns, moves = half @ turns, moves @ half
    return Placement(body.rows, np.round(turns, 12) + 0.0, moves, body.met, {})


def side_by_side(panel_set: PanelSet, bodies: list[Placement]) -> list[Placement]:
    """Bodies moved apart along x."""
    result: list[Placement] = []
    reach = 0.0
    for body in bodies:
        thick = max(plate.thickness for plate in panel_set.plates)
        points = np.vstack(panel_set.places(body))
        shift = np.array([reach - points[:, 0].min() + thick, 0.0, 0.0]) if result else np.zeros(3)
        reach = float((points + shift)[:, 0].max() + thick + SETTINGS.body_distance)
        result.append(Placement(body.rows, body.turns, body.moves + shift, body.met, {}))
    return result
