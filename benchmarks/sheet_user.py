"""A person who knows the design, for measurements: says where the worst panel belongs, one hint at a time.

The person looks at the rows of fingers that the generator drew, takes the panel of which most are open, and lays one of its rows
into an open one of a panel that stands. Of all ways the one is said that closes the most joints without sharing material.
"""

from __future__ import annotations

from collections.abc import Mapping

import manifold3d
import numpy as np
import shapely
from numpy.typing import NDArray

from benchmarks.boxes_sheets import DrawnSheet
from benchmarks.joint_judge import SAME_LENGTH, JudgedJoints, judge_joints
from wiggleroom.mating.hints import FixedPlate

Floats = NDArray[np.float64]
Pose = tuple[Floats, Floats]
TOUCH = 0.3
"""Panels are made smaller by this all round before it is asked whether they share material [mm]."""


def next_hint(
    drawn: DrawnSheet,
    panels: Mapping[str, shapely.Polygon],
    poses: Mapping[str, Pose],
    judged: JudgedJoints,
    said: set[str],
    thickness: float,
) -> FixedPlate | None:
    """Where the worst panel belongs that nothing was said of yet; None where no way closes a joint more."""
    waiting = sorted((name for name in judged.open if name not in said), key=lambda name: -len(judged.open[name]))
    waiting.sort(key=lambda name: name in poses)
    for name in waiting:
        others = {other: pose for other, pose in poses.items() if other != name}
        open_now = judge_joints(drawn, panels, others)
        best: tuple[int, str, Pose] | None = None
        for row in open_now.open.get(name, []):
            for other in others:
                for partner in open_now.open.get(other, []):
                    if partner.tabs == row.tabs or abs(partner.length - row.length) > SAME_LENGTH:
                        continue
                    for pose in _laid(row.ends, partner.ends, others[other], row.angle):
                        closed = judge_joints(drawn, panels, {**others, name: pose}).closed
                        if closed > max(judged.closed, best[0] if best else 0) and not _shares(
                            panels, others, name, pose, thickness
                        ):
                            best = closed, other, pose
        if best is not None:
            return _fixed(panels, name, best[1], best[2], others[best[1]])
    return None


def _laid(row: Floats, partner: Floats, pose: Pose, angle: float) -> list[Pose]:
    """Poses of a panel that lay its row on another panel's: either way round, to either side."""
    turn, move = pose
    ends = partner @ turn[:, :2].T + move
    found = []
    along = (row[1] - row[0]) / np.linalg.norm(row[1] - row[0])
    flat = np.column_stack([along, [-along[1], along[0]]])
    normal = turn[:, 2]
    for first, last in (ends, ends[::-1]):
        axis = (last - first) / np.linalg.norm(last - first)
        beside = np.cross(normal, axis)
        sine, cosine = np.sin(np.radians(angle)), np.cos(np.radians(angle))
        for up in {sine, -sine}:
            for side in {round(cosine, 12), -round(cosine, 12)}:
                across = up * normal + side * beside
                space = np.column_stack([axis, across, np.cross(axis, across)])
                whole = np.zeros((3, 3))
                whole[:2, :2], whole[2, 2] = flat, 1.0
                rotation = space @ whole.T
                found.append((rotation, first - rotation[:, :2] @ row[0]))
    return found


def _shares(
    panels: Mapping[str, shapely.Polygon], others: Mapping[str, Pose], name: str, pose: Pose, thickness: float
) -> bool:
    body = _solid(panels[name], pose, thickness)
    return any((body ^ _solid(panels[other], where, thickness)).volume() > 0.5 for other, where in others.items())


def _solid(panel: shapely.Polygon, pose: Pose, thickness: float) -> manifold3d.Manifold:
    small = max(shapely.get_parts(panel.buffer(-TOUCH)), key=lambda piece: piece.area)
    rings = [shapely.get_coordinates(ring)[:-1] for ring in (small.exterior, *small.interiors)]
    height = thickness - 2 * TOUCH
    section = manifold3d.CrossSection(rings, manifold3d.FillRule.EvenOdd)
    plate = manifold3d.Manifold.extrude(section, height).translate([0.0, 0.0, -height / 2])
    return plate.transform(np.column_stack(pose))


def _fixed(panels: Mapping[str, shapely.Polygon], name: str, frame: str, pose: Pose, home: Pose) -> FixedPlate:
    """The pose as a hint: in the frame of another panel, whose origin is its centroid."""
    turn, move = pose
    inner = home[0].T @ turn
    own, its = (np.append(shapely.get_coordinates(panels[each].centroid)[0], 0.0) for each in (name, frame))
    centre = home[0].T @ (turn @ own + move - home[1]) - its
    x, y, z = (tuple(float(value) for value in row) for row in (centre, inner[:, 0], inner[:, 1]))
    return FixedPlate(name, x, y, z, frame)  # type: ignore[arg-type]
