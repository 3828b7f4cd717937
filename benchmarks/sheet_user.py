"""A person who knows the design, for measurements: says one thing at a time about a sheet that is not right.

The person knows which rows of fingers the generator drew, and of generators that draw two boxes which panels are of one. What is
said is one of these, the first that there is: the panels of one box (`groups`), outlines that are no plate or no part of the
whole (`skip`), or how one panel is joined (`join`), or where it stands (`[[plate]]`) where a joint is as deep as two plates. Of all
ways to lay an open row of a panel into one of a panel that stands the one is said that closes the most joints without sharing material.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import manifold3d
import numpy as np
import shapely
from numpy.typing import NDArray

from benchmarks.boxes_sheets import DrawnSheet, JointRow
from benchmarks.joint_judge import SAME_LENGTH, JudgedJoints, judge_joints
from benchmarks.sheet_judge import Judged
from wiggleroom.mating.hints import EdgeReference, FixedPlate, Hints

Floats = NDArray[np.float64]
Pose = tuple[Floats, Floats]
TOUCH = 0.3
"""Panels are made smaller by this all round before it is asked whether they share material [mm]."""
BODIES = {
    "DiceBox": (("p-1", "p-3", "p-4", "p-7", "p11", "p12"),),
    "TwoPiece": (("p-1", "p-2", "p-3", "p-4", "p-9"),),
    "UnevenHeightBox": (("p-1", "p-2", "p-3", "p-4", "p-5"),),
}
"""Panels of one of two boxes, as their generators draw them, where the fingers of one fit the other."""

FLEXIBLE = {"Silverware": ("p-1",)}
"""Walls that bend along their slits: no plates, which a person leaves out."""


def next_hint(
    drawn: DrawnSheet,
    panels: Mapping[str, shapely.Polygon],
    poses: Mapping[str, Pose],
    joints: JudgedJoints,
    judged: Judged,
    said: Hints,
    thickness: float,
) -> Hints | None:
    """What was said and one hint more; None where nothing closes a joint more."""
    if not said.groups and drawn.name in BODIES:
        return replace(said, groups=BODIES[drawn.name])
    if not said.skip and drawn.name in FLEXIBLE:
        return replace(said, skip=FLEXIBLE[drawn.name])
    foreign = tuple(sorted(judged.unfilled & (set(poses) - joints.joined)))
    if foreign and joints.asked:
        return replace(said, skip=(*said.skip, *foreign))
    named = {edge.panel for pair in said.joins for edge in pair[:1]} | {plate.panel for plate in said.plates}
    waiting = sorted((name for name in joints.open if name not in named), key=lambda name: -len(joints.open[name]))
    waiting.sort(key=lambda name: name in poses)
    best: tuple[int, str, str, Pose, Pose, JointRow, JointRow] | None = None
    for name in waiting:
        others = {other: pose for other, pose in poses.items() if other != name}
        open_now = judge_joints(drawn, panels, others)
        for row in open_now.open.get(name, []):
            for other in others:
                for partner in open_now.open.get(other, []):
                    if partner.tabs == row.tabs or abs(partner.length - row.length) > SAME_LENGTH:
                        continue
                    for pose in _laid(row, partner, others[other]):
                        closed = judge_joints(drawn, panels, {**others, name: pose}).closed
                        if closed > max(joints.closed, best[0] if best else 0) and not _shares(
                            panels, others, name, pose, thickness
                        ):
                            best = closed, name, other, pose, others[other], row, partner
    if best is None:
        return None
    _, name, other, pose, home, row, partner = best
    if abs(row.depth - partner.depth) > 0.1 * thickness or row.angle != 90.0:
        return replace(said, plates=(*said.plates, _fixed(panels, name, other, pose, home)))
    return replace(said, joins=(*said.joins, (_edge(name, row), _edge(other, partner))))


def _edge(name: str, row: JointRow) -> EdgeReference:
    """A row of fingers by the point that a person would press."""
    x, y = row.ends.mean(axis=0).round(1).tolist()
    return EdgeReference(name, point=(x, y))


def _laid(row: JointRow, partner: JointRow, pose: Pose) -> list[Pose]:
    """Poses of a panel that lay its row on another panel's: either way round, to either side, on either face of a deeper joint."""
    turn, move = pose
    ends = partner.ends @ turn[:, :2].T + move
    found = []
    along = (row.ends[1] - row.ends[0]) / np.linalg.norm(row.ends[1] - row.ends[0])
    flat = np.column_stack([along, [-along[1], along[0]]])
    normal = turn[:, 2]
    spare = abs(row.depth - partner.depth) / 2
    for first, last in (ends, ends[::-1]):
        axis = (last - first) / np.linalg.norm(last - first)
        beside = np.cross(normal, axis)
        sine, cosine = np.sin(np.radians(row.angle)), np.cos(np.radians(row.angle))
        for up in {sine, -sine}:
            for side in {round(cosine, 12), -round(cosine, 12)}:
                across = up * normal + side * beside
                space = np.column_stack([axis, across, np.cross(axis, across)])
                whole = np.zeros((3, 3))
                whole[:2, :2], whole[2, 2] = flat, 1.0
                rotation = space @ whole.T
                for off in {spare, -spare}:
                    found.append((rotation, first - rotation[:, :2] @ row.ends[0] + off * rotation[:, 2]))
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
