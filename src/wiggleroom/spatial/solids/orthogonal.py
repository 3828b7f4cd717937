"""Solids whose faces lie along three axes at right angles, turned anywhere: their frame, their faces, and the cells that they fill.

A mesh that is one is made like boxes: its faces follow any gap, also round corners at which others cannot, and cuboids cover it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import Surface
from wiggleroom.spatial.solids.box_union import BoxGrid

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

ALIGNED = 1e-2
"""Faces whose normals are nearer [rad] to one axis than this help to find it."""
STRAIGHT = 1e-9
"""A frame that misses the axes of the world by less is that of the world [rad]."""
SAMPLE = (0.4877, 0.5231, 0.4693)
"""Where in a cell it is seen whether it is filled, as shares of its sides: seldom on an edge of a triangle."""


@dataclass(frozen=True, eq=False)
class OrthogonalFaces:
    """Triangles of closed surfaces whose faces lie along three axes at right angles.

    Parameters
    ----------
    frame : (3, 3) float64
        The axes, as columns.
    corners : (k, 3, 3) float64 [mm]
        Triangles in that frame.
    axis : (k,) int64
        Axis that each faces; -1 for one that is too thin to tell.
    up : (k,) bool
        True where the material lies below.
    """

    frame: Floats
    corners: Floats
    axis: Ints
    up: Bools

    def levels(self, axis: int, up: bool) -> Floats:
        """Where the faces lie that look along an axis, upwards or downwards: one number (k,) for each triangle [mm]."""
        return self.corners[(self.axis == axis) & (self.up == up), :, axis].mean(axis=1)


def frame_of(triangles: Floats) -> Floats | None:
    """Axes (3, 3), as columns, of triangles (k, 3, 3) of which most lie along three axes at right angles."""
    area = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    found: list[Floats] = []
    left = area
    for _ in range(2):
        size = np.linalg.norm(left, axis=1)
        if not size.max(initial=0.0) > 0:
            return None
        first = left[size.argmax()] / size.max()
        along = left @ first
        near = np.abs(along) > (1 - ALIGNED**2 / 2) * size
        axis = (np.sign(along[near])[:, None] * left[near]).sum(axis=0)
        found.append(axis / np.linalg.norm(axis))
        across = np.abs(area @ np.array(found).T).max(axis=1) < ALIGNED * np.linalg.norm(area, axis=1)
        left = area[across]
    u, _, v = np.linalg.svd(np.column_stack([*found, np.cross(found[0], found[1])]))
    frame = u @ v
    # each axis where it is nearest to that of the world, so that what is not turned keeps its numbers
    order: list[int] = []
    for world in np.abs(frame):
        order.append(max({0, 1, 2} - set(order), key=lambda k: world[k]))
    frame = frame[:, order]
    frame = frame * np.where(np.diag(frame) < 0, -1.0, 1.0)
    return np.eye(3) if np.abs(frame - np.eye(3)).max() < STRAIGHT else frame


def orthogonal_faces(triangles: Floats, near: float) -> OrthogonalFaces | None:
    """The faces of triangles (k, 3, 3) [mm] of closed surfaces; None where one is oblique by more than `near` [mm]."""
    frame = frame_of(triangles)
    if frame is None:
        return None
    corners = triangles @ frame
    thick = np.ptp(corners, axis=1)
    axis = thick.argmin(axis=1)
    if (thick.min(axis=1) > near).any():
        return None
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = area[np.arange(len(axis)), axis]
    thin = np.abs(facing) <= near * thick.max(axis=1)
    return OrthogonalFaces(frame, corners, np.where(thin, -1, axis), facing > 0)


def filled(faces: OrthogonalFaces, mine: Bools, lines: tuple[Floats, Floats, Floats]) -> Bools | None:
    """Which cells between lines [mm] of each axis are inside the closed surface of some of the triangles (k,); None where it is not closed.

    It is seen at one point in each cell, by counting the faces below.
    """
    at = [line[:-1] + share * np.diff(line) for line, share in zip(lines, SAMPLE, strict=True)]
    count = np.zeros((len(at[0]), len(at[1]), len(at[2]) + 1), dtype=np.int64)
    some = mine & (faces.axis == 2)
    for corners, up in zip(faces.corners[some], faces.up[some].tolist(), strict=True):
        flat = corners[:, :2]
        (i0, j0), (i1, j1) = (
            [int(np.searchsorted(at[k], x)) for k, x in enumerate(end)] for end in (flat.min(axis=0), flat.max(axis=0))
        )
        if i0 == i1 or j0 == j1:
            continue
        x, y = at[0][i0:i1, None], at[1][None, j0:j1]
        sides = [
            (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
            for p, q in zip(flat, np.roll(flat, -1, axis=0), strict=True)
        ]
        inside = np.logical_and.reduce([side > 0 if up else side < 0 for side in sides])
        above = int(np.searchsorted(at[2], corners[:, 2].mean()))
        count[i0:i1, j0:j1, above] += np.where(inside, -1 if up else 1, 0)
    found = count.cumsum(axis=2)
    if found.min() < 0 or found.max() > 1 or found[:, :, -1].any():
        return None
    return np.asarray(found[:, :, :-1] == 1)


def boxes_of_mesh(surface: Surface, near: float) -> tuple[Floats, BoxGrid, float] | None:
    """A mesh as cells of an uneven grid, in a frame of its own: the frame (3, 3), the grid, and by how much faces are moved at most [mm].

    None where a face is oblique by more than `near` [mm].
    """
    faces = orthogonal_faces(surface.vertices[surface.faces], near)
    if faces is None:
        return None
    lines: list[Floats] = []
    moved = 0.0
    for axis in range(3):
        of_faces = faces.corners[faces.axis == axis, :, axis]
        if not len(of_faces):
            return None
        levels = np.sort(of_faces.ravel())
        groups = np.split(levels, np.flatnonzero(np.diff(levels) > near) + 1)
        lines.append(np.array([(group[0] + group[-1]) / 2 for group in groups]))
        moved = max(moved, *((group[-1] - group[0]) / 2 for group in groups))
    grid = (lines[0], lines[1], lines[2])
    solid = filled(faces, np.ones(len(faces.axis), dtype=bool), grid)
    if moved > near or solid is None or not solid.any():
        return None
    return faces.frame, BoxGrid(grid, solid), moved
