"""Where things lie in a picture: how motion is magnified, and how millimetres become pixels."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, place
from wiggleroom.report.pictures import palette

Floats = NDArray[np.float64]

MIN_VISIBLE_SHARE = 0.008
"""Motions of a smaller share of the drawing's size are drawn enlarged."""
ENLARGED_SHARE = 0.04
"""They are enlarged to this share of the size, ..."""
MAX_ENLARGED_TURN = 0.4
"""... and no turn beyond this [rad]."""
MAX_SHOWN_SHARE = 2.0
"""Motions beyond this multiple of the drawing's size are drawn shortened."""


@dataclass(frozen=True)
class View:
    """Millimetres to pixels: y turns over, the drawing lies in the middle of the room it has.

    Parameters
    ----------
    scale : float [px/mm]
    left, top : float [mm]
        Assembly coordinates of the upper left corner of the drawing.
    x, y : float [px]
        Where that corner lies in the picture.
    width, height : float [px]
        Size of the drawing; `canvas` is the width of the whole picture.
    """

    scale: float
    left: float
    top: float
    x: float
    y: float
    width: float
    height: float
    canvas: float

    def pixels(self, points: Floats) -> Floats:
        """Assembly coordinates (..., 2) [mm] as pixels."""
        return (np.asarray(points, dtype=float) - (self.left, self.top)) * (self.scale, -self.scale) + (self.x, self.y)


def boxes(assembly: Assembly, poses: Floats) -> Floats:
    """Box round every part at `poses` (n, 3): (n, 4) left, bottom, right, top [mm]."""
    found = np.empty((len(assembly.parts), 4))
    for box, part, (x, y, angle) in zip(found, assembly.parts, poses.tolist(), strict=True):
        corners = place(np.vstack([r.outer for r in part.regions]), (x, y, angle))
        box[:2], box[2:] = corners.min(axis=0), corners.max(axis=0)
    return found


def bounding_box(found: Floats) -> Floats:
    """One box round all boxes (n, 4) -> (4,)."""
    return np.concatenate([found[:, :2].min(axis=0), found[:, 2:].max(axis=0)])


def largest_displacement(assembly: Assembly, motion: Floats) -> float:
    """How far the corner that moves most is moved [mm]."""
    farthest = 0.0
    for part, (dx, dy, turn) in zip(assembly.parts, motion.tolist(), strict=True):
        corners = np.vstack([r.outer for r in part.regions])
        angle = part.at[2]
        moved = place(corners, (dx, dy, angle + turn)) - place(corners, (0.0, 0.0, angle))
        farthest = max(farthest, float(np.hypot(*moved.T).max()))
    return farthest


def magnification(assembly: Assembly, motion: Floats) -> float:
    """Factor by which the picture enlarges the motion: 1 unless it could not be seen, or would leave the page.

    A motion below 0.8 % of the drawing is drawn about 4 % large, by a round factor.
    """
    size, moved = assembly.size, largest_displacement(assembly, motion)
    if moved > MAX_SHOWN_SHARE * size:
        return round_down(MAX_SHOWN_SHARE * size / moved)
    if moved <= 1e-9 * size or moved >= MIN_VISIBLE_SHARE * size:
        return 1.0
    turn = float(np.abs(motion[:, 2]).max())
    return max(1.0, round_down(min(ENLARGED_SHARE * size / moved, MAX_ENLARGED_TURN / max(turn, 1e-12))))


def round_down(value: float) -> float:
    """Largest of 1, 2, 5, 10, 20, ... (and 0.5, 0.2, ...) that is at most `value`.

    >>> round_down(37.0), round_down(0.06)
    (20.0, 0.05)
    """
    power = math.floor(math.log10(value) + 1e-12)
    step = next(s for s in (5, 2, 1) if s * 10.0**power <= value * (1 + 1e-12))
    return step * 10.0**power if power >= 0 else step / 10.0**-power


def view(box: Floats, top: float) -> View:
    """View of `box` (4,) [mm] whose drawing begins `top` pixels below the picture's upper edge."""
    across, up = max(float(box[2] - box[0]), 1e-12), max(float(box[3] - box[1]), 1e-12)
    scale = min(palette.WIDEST / across, palette.TALLEST / up)
    canvas = max(across * scale, palette.NARROWEST) + 2 * palette.MARGIN
    left = (canvas - across * scale) / 2
    return View(scale, float(box[0]), float(box[3]), left, top, across * scale, up * scale, canvas)
