"""Tiny faults of closed outlines, mended: corner loops, spikes, slits, outlines that touch themselves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from wiggleroom.drawing.model import Points
from wiggleroom.drawing.outlines.rings import clean_ring, signed_area

MAX_FAULT_SIZE = 1.0
"""Loops and pieces no larger than this [mm] are faults, ..."""
MAX_FAULT_SHARE = 0.02
"""... and no larger than this share of their outline."""
SPIKE_WIDTH = 1e-6
"""A spike narrower than this share of its outline has no width."""


@dataclass(frozen=True, eq=False)
class RepairedOutline:
    """What became of one outline.

    Parameters
    ----------
    rings : tuple of (n, 2) float64 [mm]
        Outlines, in the sense in which they were drawn; one, unless it touched itself.
    faults : tuple of (kind, (x, y) [mm])
        What was mended, and where.
    """

    rings: tuple[Points, ...]
    faults: tuple[tuple[str, tuple[float, float]], ...] = ()


def mend(ring: Points) -> RepairedOutline:
    """Outline without tiny faults; one that crosses itself in earnest comes back as it is.

    Parameters
    ----------
    ring : (n, 2) float64 [mm]
        Corners, the first not repeated at the end.

    Examples
    --------
    >>> spike = np.array([[0.0, 0], [9, 0], [9, 4], [12, 4], [9, 4], [9, 9], [0, 9]])
    >>> mended = mend(spike)
    >>> len(clean_ring(mended.rings[0])), mended.faults
    (4, (('spike', (12.0, 4.0)),))
    """
    if len(ring) < 3 or not np.isfinite(ring).all():
        return RepairedOutline((ring,))
    polygon = shapely.Polygon(ring)
    if polygon.is_valid:
        return RepairedOutline((ring,))
    size = float(np.ptp(ring, axis=0).max())
    bare, tips = _without_spikes(clean_ring(ring, clockwise=signed_area(ring) < 0), SPIKE_WIDTH * size)
    if len(bare) < 3:
        return RepairedOutline((ring,))
    spikes = tuple(("spike", (float(x), float(y))) for x, y in tips)
    if shapely.Polygon(bare).is_valid:
        return RepairedOutline((bare,), spikes)
    return _from_faces(ring, bare, min(MAX_FAULT_SIZE, MAX_FAULT_SHARE * size), spikes)


def _without_spikes(ring: Points, width: float) -> tuple[Points, list[Points]]:
    """Without corners at which the outline turns back on itself, and those corners."""
    tips: list[Points] = []
    while len(ring) >= 3:
        back, ahead = np.roll(ring, 1, axis=0) - ring, np.roll(ring, -1, axis=0) - ring
        lengths = np.hypot(*back.T), np.hypot(*ahead.T)
        longer = np.maximum(*lengths)
        cross = np.abs(back[:, 0] * ahead[:, 1] - back[:, 1] * ahead[:, 0])
        flat = ((back * ahead).sum(axis=1) > 0) & (cross <= width * longer)
        rows = np.flatnonzero(flat)
        if not len(rows):
            break
        tips.append(ring[rows[0]])
        ring = np.delete(ring, rows[0], axis=0)
        same = np.hypot(*(ring - np.roll(ring, 1, axis=0)).T) <= width
        ring = ring[~same] if (~same).sum() >= 1 else ring[:1]
    return ring, tips


def _from_faces(
    drawn: Points, ring: Points, tiny: float, spikes: tuple[tuple[str, tuple[float, float]], ...]
) -> RepairedOutline:
    """Outline of the faces that a ring runs round once, without tiny ones."""
    noded = shapely.unary_union(shapely.LinearRing(ring))
    faces = [face for face in shapely.get_parts(shapely.polygonize(shapely.get_parts(noded))) if face.area > 0]
    turns = [_winding(ring, face) for face in faces]
    small = [_extent(face) <= tiny for face in faces]
    senses = {turn for turn, minor in zip(turns, small, strict=True) if not minor and turn}
    if senses not in ({1}, {-1}):
        return RepairedOutline((drawn,))
    sense = senses.pop()
    body = shapely.union_all(
        [f for f, turn, minor in zip(faces, turns, small, strict=True) if turn and (not minor or turn * sense > 0)]
    )
    pieces = [piece for piece in shapely.get_parts(body) if _extent(piece) > tiny]
    rings: list[Points] = []
    faults = list(spikes)
    for piece in pieces:
        rings.append(shapely.get_coordinates(piece.exterior)[:-1][::sense])
        holes = [hole for hole in piece.interiors if _extent(shapely.Polygon(hole)) > tiny]
        rings += [shapely.get_coordinates(hole)[:-1][::sense] for hole in holes]
    for face, minor in zip(faces, small, strict=True):
        if minor:
            faults.append(("loop", (face.centroid.x, face.centroid.y)))
    if len(rings) > 1:
        faults.append(("touch", _touching(ring)))
    if not faults:
        faults.append(("touch", _touching(ring)))
    return RepairedOutline(tuple(rings), tuple(faults)) if rings else RepairedOutline((drawn,))


def _winding(ring: Points, face: shapely.Polygon) -> int:
    """How often a ring runs round a face, counter-clockwise."""
    point = face.representative_point()
    here = ring - (point.x, point.y)
    there = np.roll(here, -1, axis=0)
    up = (here[:, 1] <= 0) & (there[:, 1] > 0)
    down = (here[:, 1] > 0) & (there[:, 1] <= 0)
    left = here[:, 0] * there[:, 1] - here[:, 1] * there[:, 0]
    return int((up & (left > 0)).sum() - (down & (left < 0)).sum())


def _extent(shape: shapely.Geometry) -> float:
    low_x, low_y, high_x, high_y = shape.bounds
    return max(high_x - low_x, high_y - low_y)


def _touching(ring: Points) -> tuple[float, float]:
    """Where a ring touches itself."""
    said = shapely.is_valid_reason(shapely.Polygon(ring)).partition("[")[2].rstrip("]").split()
    return (float(said[0]), float(said[1])) if len(said) == 2 else (float(ring[0, 0]), float(ring[0, 1]))
