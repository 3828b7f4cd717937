"""Bodies of a spatial assembly: parts that are glued together move as one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import AXES
from wiggleroom.drawing.writers.glue_groups import body_numbers
from wiggleroom.errors import InputError
from wiggleroom.spatial.bodies.rigid import RigidBodies, SpatialPose
from wiggleroom.spatial.bodies.rotations import exponential, logarithm

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Grouping:
    """Bodies, and which part belongs to which.

    Parameters
    ----------
    bodies : RigidBodies
    body_of : (parts,) int64
    arm : (parts, 3) float64 [mm]
        Reference point of each part against that of its body, at rest.
    """

    bodies: RigidBodies
    body_of: Ints
    arm: Floats

    def part_motion(self, pose: SpatialPose) -> Floats:
        """Motions (parts, 6) [mm, rad]: displacement of the reference point and rotation vector."""
        R, shift = pose.R[self.body_of], (pose.T - self.bodies.at)[self.body_of]
        move = shift + np.einsum("pij,pj->pi", R, self.arm) - self.arm
        return np.hstack([move, logarithm(R)])

    def pose_of(self, motion: Floats) -> SpatialPose:
        """Pose of the bodies from motions (parts, 6) of the parts."""
        first = np.unique(self.body_of, return_index=True)[1]
        R = exponential(motion[first, 3:])
        arm = self.arm[first]
        return SpatialPose(self.bodies.at + motion[first, :3] - np.einsum("pij,pj->pi", R, arm) + arm, R)

    def strain(self, start: Floats, end: Floats) -> float:
        """How far parts of one body shift against each other at most [mm] between two motions (parts, 6) of a path.

        Their reference points go straight while the body turns, so that they leave their arcs by the height of these.
        """
        shared = np.bincount(self.body_of)[self.body_of] > 1
        if not shared.any():
            return 0.0
        turned = np.einsum("nji,njk->nik", exponential(start[shared, 3:]), exponential(end[shared, 3:]))
        angle = np.linalg.norm(logarithm(turned), axis=1)
        height = np.linalg.norm(self.arm[shared], axis=1) * (1 - np.cos(angle / 2))
        return 2 * float(height.max())


def grouped(assembly: Assembly) -> Grouping:
    """Bodies of an assembly at rest.

    Raises
    ------
    InputError
        If locks of glued parts contradict each other.
    """
    parts, reference = assembly.parts, assembly.reference
    body_of = np.array(body_numbers(assembly.names, assembly.drawing.glue), dtype=np.int64)
    count = int(body_of.max()) + 1
    volume = np.array([m.volume for m in assembly.solids])
    total = np.bincount(body_of, volume, minlength=count)
    at = np.column_stack([np.bincount(body_of, volume * reference[:, k], minlength=count) / total for k in range(3)])
    free = np.ones((count, 6), dtype=bool)
    pieces: list[list] = [[] for _ in range(count)]
    owner: list[list[int]] = [[] for _ in range(count)]
    for k, (part, made) in enumerate(zip(parts, assembly.solids, strict=True)):
        b = int(body_of[k])
        alone = int((body_of == b).sum()) == 1
        if alone:
            at[b] = reference[k]  # to the last digit
        if part.fixed:
            free[b] = False
        elif part.lock:
            if not alone:
                finding = f'{assembly.drawing.source}: part "{part.name}" has a lock and is glued: lock parts that stand alone'
                raise InputError(finding)
            free[b] = [axis not in part.lock for axis in AXES]
        pieces[b] += [piece.placed(part.R, part.at - at[b]) for piece in made.pieces]
        owner[b] += [k] * len(made.pieces)
    index = {name: k for k, name in enumerate(assembly.names)}
    ignored = frozenset(
        (min(pair), max(pair)) for one, other in assembly.drawing.ignore if (pair := (index[one], index[other]))
    )
    bodies = RigidBodies(
        tuple(map(tuple, pieces)), at, free, tuple(np.array(o, dtype=np.int64) for o in owner), ignored
    )
    return Grouping(bodies, body_of, reference - at[body_of])
