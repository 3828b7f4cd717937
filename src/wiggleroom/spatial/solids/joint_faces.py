"""The faces that the gap of one joint in space moves: what a little more of it does to the surfaces of both parts."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.joint_edges import AT_JOINT, gaps_beside
from wiggleroom.drawing.model import Drawing, MadeSolid
from wiggleroom.spatial.solids.face_planes import face_planes, lies_in
from wiggleroom.spatial.solids.facing_faces import FlatFace
from wiggleroom.spatial.solids.joint_gap_solid import patched_solids

Floats = NDArray[np.float64]

NEAR = 1e-6
"""A point nearer to a face than this share of the solid's size lies on it."""
SAME_NORMAL = 1e-6
"""Normals that differ by less are the same."""


@dataclass(frozen=True, eq=False)
class JointFaces:
    """Faces of a part as drawn, and what of each of them lies in a joint."""

    faces: tuple[FlatFace, ...]
    regions: dict[int, shapely.Geometry]

    def moves(self, normal: Floats, point: Floats) -> float:
        """How far a face moves inward, for 1 mm more gap in the joint, that has this normal and goes through a point, as made."""
        alike = [k for k, f in enumerate(self.faces) if float(np.linalg.norm(f.normal - normal)) < SAME_NORMAL]
        if not alike:
            return 0.0  # a step where another joint's gap ends
        spots = [shapely.Point(self.faces[k].frame @ point) for k in alike]
        far = [
            float(np.hypot(self.faces[k].normal @ point - self.faces[k].level, self.faces[k].polygon.distance(spot)))
            for k, spot in zip(alike, spots, strict=True)
        ]
        face, spot = alike[int(np.argmin(far))], spots[int(np.argmin(far))]
        if face not in self.regions:
            return 0.0
        rest = shapely.difference(self.faces[face].polygon, self.regions[face])
        return 0.0 if not rest.is_empty and rest.distance(spot) < self.regions[face].distance(spot) else AT_JOINT


def joint_faces(drawing: Drawing, pair: tuple[str, str]) -> tuple[JointFaces, JointFaces] | None:
    """What the gap of the joint of two parts moves, as `gaps` of an assembly file says it; None where they face each other nowhere."""
    gaps, number = gaps_beside(drawing.gaps, pair, drawing.gap)
    patched, _ = patched_solids(replace(drawing, gaps=gaps))
    sides = [
        JointFaces(patched[name].faces, {p.face: p.region for p in patched[name].patches if p.joint == number})
        for name in pair
    ]
    return (sides[0], sides[1]) if all(side.regions for side in sides) else None


class TouchedSurface:
    """The faces of a part as made that meet at a point of its surface."""

    def __init__(self, made: MadeSolid, point: Floats) -> None:
        self._point = point
        normal, level, label = face_planes(made.surface)
        near = NEAR * float(np.ptp(made.surface.vertices, axis=0).max())
        on = np.flatnonzero(np.abs(normal @ point - level) < near)
        triangles = made.surface.vertices[made.surface.faces]
        self._normals = [normal[k] for k in on.tolist() if lies_in(triangles[label == k], point, near)]

    def displacement(self, joint: JointFaces) -> Floats:
        """Displacement (3,) of the point for 1 mm more gap in a joint; along directions that no face fixes it stays."""
        inward = np.array([-joint.moves(n, self._point) for n in self._normals])
        return np.linalg.lstsq(np.array(self._normals), inward, rcond=1e-6)[0] if inward.any() else np.zeros(3)
