"""Bodies behind windows through which none of their sections fits, however they turn.

A convex piece that leaves a region between planes carries its middle across one of them. Then its section by that plane through its
middle lies in a window: a part of the plane that obstacles leave free. A section whose area, or whose border, is larger than that of the
window, or of its hull, does not.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.drawing.model import ConvexPiece
from wiggleroom.spatial.overlaps.difference_section import minkowski_difference, slab_shadow
from wiggleroom.spatial.proof.inner_pieces import clipped
from wiggleroom.spatial.solids.convex import distinct_axes

Floats = NDArray[np.float64]

MAX_AXES, MAX_LEVELS = 6, 12
"""Planes are looked for across so many axes of the faces of obstacles, at most, and at so many places along each, the nearest first."""
MAX_CELLS = 4000
"""Sections are compared in so many cells of directions, at most."""
MARGIN = 1e-6
"""A section is larger than a window where it is so by this share."""


@dataclass(frozen=True, eq=False)
class _Wall:
    """A plane {x : normal @ x = level}, seen from the middle of the piece, with what obstacles leave free of it.

    Parameters
    ----------
    normal : (3,) float64
        Away from the piece.
    level : float [mm]
        More than 0.
    frame : (3, 3) float64
        Rows are two axes of the plane and its normal.
    windows : list of Polygon
        Connected pieces in the axes of the plane.
    outside : shapely.Polygon
        What reaches its border has no end.
    """

    normal: Floats
    level: float
    frame: Floats
    windows: list[shapely.Polygon]
    outside: shapely.Polygon

    def is_endless(self, window: shapely.Polygon) -> bool:
        """True where a window reaches the border of what was looked at."""
        return bool(window.intersects(self.outside.exterior))

    @cached_property
    def widest(self) -> float:
        """Area of the largest window [mm²]; infinite where what is opposite to the piece goes on without end."""
        endless = [self.is_endless(window) for window in self.windows]
        if any(w.contains(shapely.Point(0, 0)) for w, end in zip(self.windows, endless, strict=True) if end):
            return np.inf
        return max((w.area for w, end in zip(self.windows, endless, strict=True) if not end), default=0.0)


def behind_narrow_windows(obstacles: Sequence[ConvexPiece], piece: ConvexPiece, context: Context = UNLIMITED) -> bool:
    """True where a convex piece cannot leave a region between planes across the obstacles, which stand still.

    Examples
    --------
    >>> from wiggleroom.spatial.solids.convex import cuboid
    >>> sides = [((-6, -6, -6), (6, 6, -5)), ((-6, -6, -5), (-5, 6, 5)), ((5, -6, -5), (6, 6, 5)), ((-5, -6, -5), (5, -5, 5))]
    >>> lid = [((-6, -6, 5), (-2, 6, 6)), ((2, -6, 5), (6, 6, 6)), ((-2, -6, 5), (2, -2, 6)), ((-2, 2, 5), (2, 6, 6))]
    >>> cage = [cuboid(*np.array(side, dtype=float)) for side in [*sides, ((-5, 5, -5), (5, 6, 5)), *lid]]
    >>> cubes = [cuboid(np.full(3, -half), np.full(3, half)) for half in (2.001, 1.999)]
    >>> [behind_narrow_windows(cage, cube) for cube in cubes]
    [True, False]
    """
    if len(obstacles) < 4:  # planes keep each from the piece, and three of them close nothing in
        return False
    middle = piece.corners.mean(axis=0)
    walls = sorted((wall for wall in _walls(obstacles, middle) if wall.widest < np.inf), key=lambda wall: wall.widest)
    chosen: list[_Wall] = []
    for wall in walls:
        chosen.append(wall)
        if _is_closed(chosen):
            break
    else:
        return False
    windows, faces = [], 0
    for wall in chosen:
        face = _face(wall, chosen).buffer(MARGIN * wall.level)
        faces += not face.is_empty
        met = [window for window in wall.windows if window.intersects(face)]
        if any(wall.is_endless(window) for window in met):
            return False
        windows += met
    if faces < 4:
        return False
    sizes = [((1 + MARGIN) * w.area, (1 + MARGIN) * w.convex_hull.length) for w in windows]
    return _no_section_fits(piece.corners - middle, np.array(sizes).reshape(-1, 2), context)


def _walls(obstacles: Sequence[ConvexPiece], middle: Floats) -> Iterator[_Wall]:
    """Of each direction away from a point the plane with the least windows."""
    solids = [minkowski_difference(p.corners - middle, np.zeros((1, 3))) for p in obstacles]
    reach = max(float(np.linalg.norm(solid.corners, axis=1).max()) for solid in solids)
    outside = shapely.box(-2 * reach, -2 * reach, 2 * reach, 2 * reach)
    for axis in distinct_axes(np.vstack([p.normals for p in obstacles]), MARGIN)[:MAX_AXES]:
        for normal in (axis, -axis):
            across = np.linalg.svd(normal[None])[2][1]
            frame = np.array([across, np.cross(normal, across), normal])
            turned = [solid.turned(frame) for solid in solids]
            heights = np.unique(np.concatenate([solid.corners[:, 2] for solid in turned]).round(9))
            levels = (heights[1:] + heights[:-1]) / 2
            found = []
            for level in levels[levels > 0][:MAX_LEVELS].tolist():
                free = shapely.get_parts(shapely.difference(outside, slab_shadow(turned, level, level)))
                found.append(_Wall(normal, level, frame, [w for w in free.tolist() if w.area > 0], outside))
            if found:
                yield min(found, key=lambda wall: wall.widest)


def _is_closed(walls: Sequence[_Wall]) -> bool:
    """True where the region on the near sides of all planes is bounded."""
    from scipy.optimize import linprog

    normals = np.array([wall.normal for wall in walls])
    levels = np.array([wall.level for wall in walls])
    free = [(None, None)] * 3
    return all(linprog(sign * d, normals, levels, bounds=free).status == 0 for d in np.eye(3) for sign in (1.0, -1.0))


def _face(wall: _Wall, walls: Sequence[_Wall]) -> shapely.Geometry:
    """The face of the region between planes that lies in one of them, in its axes; empty where others keep the region from it."""
    face = shapely.get_coordinates(wall.outside.exterior)[:-1]
    for other in walls:
        if other is not wall:
            x, y, slope = wall.frame @ other.normal
            face = clipped(face, np.array([x, y]), other.level - slope * wall.level)
    return shapely.MultiPoint(face).convex_hull if len(face) else shapely.Polygon()


def _no_section_fits(corners: Floats, windows: Floats, context: Context) -> bool:
    """True where all sections of a hull through the origin are larger than all windows: areas and borders (k, 2) [mm², mm].

    Directions across the sections are covered by squares on three sides of a cube. In one of them all sections, seen along its middle,
    hold that polygon which stays inside the hull however far the directions lean.
    """
    from scipy.spatial import ConvexHull

    faces = np.unique(ConvexHull(corners).equations.round(12), axis=0)
    normals, far = faces[:, :3], -faces[:, 3]
    lever = float(np.linalg.norm(corners, axis=1).max())
    if (far <= 0).any():
        return False
    cells = [(k, a, b, 0.25) for k in range(3) for a in np.arange(-0.75, 1, 0.5) for b in np.arange(-0.75, 1, 0.5)]
    count = 0
    while cells:
        count += 1
        if count > MAX_CELLS or context.stopped:
            return False
        k, a, b, half = cells.pop()
        direction = np.roll([1.0, a, b], k)
        direction /= np.linalg.norm(direction)
        flat, along = normals @ np.linalg.svd(direction[None])[2][1:].T, np.abs(normals @ direction)
        leaning = np.tan(min(np.sqrt(2) * half, 1.5))  # directions of a square are no further apart than its points
        least = _size(flat, far - along * lever * leaning)
        if (least[None] > windows).any(axis=1).all():
            continue
        if not (_size(flat, far)[None] > windows).any(axis=1).all():
            return False
        quarter = half / 2
        cells += [(k, a + i * quarter, b + j * quarter, quarter) for i in (-1, 1) for j in (-1, 1)]
    return True


def _size(normals: Floats, far: Floats) -> Floats:
    """Area and border (2,) of the polygon {y : normals @ y <= far} [mm², mm]; none where the origin is not inside."""
    from scipy.spatial import ConvexHull, HalfspaceIntersection

    steep = np.linalg.norm(normals, axis=1) > MARGIN
    if (far <= 0).any():
        return np.zeros(2)
    rows = np.column_stack([normals[steep], -far[steep]])
    polygon = ConvexHull(HalfspaceIntersection(rows, np.zeros(2)).intersections)
    return np.array([polygon.volume, polygon.area])
