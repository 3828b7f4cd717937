"""What the gaps of single joints in space are worth: each moves only the regions of faces that face each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.spatial.solids.joint_faces import JointFaces, TouchedSurface, joint_faces
from wiggleroom.spatial.solids.spatial_model import SpatialAssembly

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME_PLACE = 1e-9
"""Joints whose parts lie to each other alike, to this share of the assembly's size, are the same."""


@dataclass(frozen=True, eq=False)
class HoldingCorners:
    """Corners of pieces that planes hold.

    Parameters
    ----------
    part, other : (k,) int64
        Part of the corner, and part across the plane.
    piece, corner : (k,) int64
        Which piece of the part, and which corner of the piece.
    toward : (k, 3) float64
        Normal of the plane, to the other side, as the corner's body had it at rest.
    side : (k,) int64
        Number of the side of the plane that the corner lies on.
    place : (k, 3) float64 [mm]
        The corner at rest, in assembly coordinates.
    """

    part: Ints
    other: Ints
    piece: Ints
    corner: Ints
    toward: Floats
    side: Ints
    place: Floats


def spatial_joint_gains(assembly: SpatialAssembly, held: HoldingCorners, force: Floats) -> tuple[Ints, sp.csr_matrix]:
    """Joints (m, 2) that planes hold, and what each of k forces is worth (m, k) per mm of their gaps.

    The corners on one side of a plane touch the other part at their mean, weighted by their forces (k,). It follows the faces it lies on; a
    plane gains what it moves away.
    """
    joints = np.unique(np.sort(np.column_stack([held.part, held.other]), axis=1), axis=0).reshape(-1, 2)
    of: list[list[tuple[int, JointFaces]]] = [[] for _ in assembly.parts]
    known: dict[tuple[object, ...], tuple[JointFaces, JointFaces] | None] = {}
    alone = {name for joint in assembly.drawing.gaps for name in joint.parts}
    for k, (a, b) in enumerate(joints.tolist()):
        names = assembly.names[a], assembly.names[b]
        key = _key(assembly, a, b) if alone.isdisjoint(names) else names
        if key not in known:
            known[key] = joint_faces(assembly.drawing, names)
        for part, faces in zip((a, b), known[key] or (), strict=False):
            of[part].append((k, faces))
    value, joint, column = [], [], []
    for side in np.unique(held.side):
        rows = np.flatnonzero(held.side == side)
        part = int(held.part[rows[0]])
        middle = force[rows] @ held.place[rows] / force[rows].sum()
        own = assembly.parts[part]
        touched = TouchedSurface(assembly.made[part], (middle - own.at) @ own.R)
        for k, faces in of[part]:
            value.append(-held.toward[rows] @ own.R @ touched.displacement(faces))
            joint.append(np.full(len(rows), k))
            column.append(rows)
    flat = [np.concatenate(x) if x else np.zeros(0) for x in (value, joint, column)]
    return joints, sp.csr_matrix((flat[0], (flat[1].astype(int), flat[2].astype(int))), shape=(len(joints), len(force)))


def _key(assembly: SpatialAssembly, a: int, b: int) -> tuple[object, ...]:
    """What is alike where two joints are."""
    one, other = assembly.drawing.parts[a], assembly.drawing.parts[b]
    size = float(np.abs([p.at for p in assembly.drawing.parts]).max(initial=1.0))
    place = np.concatenate([(other.at - one.at) @ one.R / size, (one.R.T @ other.R).ravel()])
    return (id(one.solid), id(other.solid), *np.round(place / SAME_PLACE).tolist())
