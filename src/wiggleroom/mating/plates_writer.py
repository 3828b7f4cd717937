"""Assembly files in space: plates with numeric outlines, thickness and pose."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.mating.assembled_sheet import AssembledSheet
from wiggleroom.mating.panel_outline import inset

Floats = NDArray[np.float64]


def write_plates(found: AssembledSheet) -> str:
    """Text of a `wiggleroom/2` file of the panels that were placed.

    Outlines are as cut, in the panel's own plane at z = 0; the plate is thick towards +z. `at` [mm] is where its origin
    lies, `rotate` its turns [degrees] about the fixed x, then y, then z axis.
    """
    rows = [_line(part) for part in plate_entries(found)]
    return '{\n"format": "wiggleroom/2", "unit": "mm", "gap": 0,\n"parts": [\n' + ",\n".join(rows) + "\n]\n}\n"


def plate_entries(found: AssembledSheet) -> list[dict[str, Any]]:
    """One entry for every placed panel, in the order of the sheet."""
    poses = {
        row: (turn, move)
        for body in found.bodies
        for row, turn, move in zip(body.rows, body.turns, body.moves, strict=True)
    }
    entries = []
    for row in sorted(poses):
        turn, move = poses[row]
        plate, thick = found.plates[row], found.thickness[row]
        outline = inset(plate.polygon, found.relief)
        corner = move - turn[:, 2] * thick / 2
        entry: dict[str, Any] = {"name": plate.name, "outline": _ring(outline.exterior)}
        if outline.interiors:
            entry["holes"] = [_ring(ring) for ring in outline.interiors]
        entries.append(entry | {"thickness": thick, "at": _rounded(corner), "rotate": _rounded(fixed_axis_turns(turn))})
    return entries


def fixed_axis_turns(turn: Floats) -> Floats:
    """Turns [degrees] about the fixed x, then y, then z axis that make a rotation matrix (3, 3).

    Examples
    --------
    >>> fixed_axis_turns(np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])).tolist()
    [0.0, 0.0, 90.0]
    """
    sine = float(np.clip(-turn[2, 0], -1.0, 1.0))
    if abs(sine) > 1.0 - 1e-12:  # x and z turn about the same axis: all of it is given to x
        angles = np.array([np.arctan2(sine * turn[0, 1], turn[1, 1]), np.copysign(np.pi / 2, sine), 0.0])
    else:
        angles = np.array([np.arctan2(turn[2, 1], turn[2, 2]), np.arcsin(sine), np.arctan2(turn[1, 0], turn[0, 0])])
    return np.degrees(angles) + 0.0


def _ring(ring: shapely.LinearRing) -> list[list[float]]:
    return [_rounded(point) for point in shapely.get_coordinates(ring)[:-1]]


def _rounded(values: Floats) -> list[float]:
    return [round(float(x), 9) + 0.0 for x in values]


def _line(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)
