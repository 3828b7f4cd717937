"""Motions of bodies from those of their parts, and motions of points from those of other points of the same rigid body."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.geometry.bodies import Bodies

Floats = NDArray[np.float64]


def of_bodies(assembly: Assembly, bodies: Bodies, motions: Floats) -> Floats:
    """Motions (k, n, 3) [mm, mm, rad] of the bodies from those of the parts (k, parts, 3)."""
    first = [members[0] for members in bodies.members]
    return about(motions[:, first], bodies.rest[:, :2] - assembly.rest[first, :2])


def of_parts(assembly: Assembly, bodies: Bodies, motions: Floats) -> Floats:
    """Motions (k, parts, 3) of the parts about their reference points, from those of the bodies (k, n, 3)."""
    who = bodies.body_of
    return about(motions[:, who], assembly.rest[:, :2] - bodies.rest[who, :2])


def about(motions: Floats, arm: Floats) -> Floats:
    """Motions (k, n, 3) of points that lie `arm` (n, 2) [mm] from those whose motions are given, on the same rigid things."""
    half = motions[..., 2] / 2
    c, s = np.cos(half), np.sin(half)  # (R - I) arm through half angles: no cancellation at small turns
    x, y = arm[..., 0], arm[..., 1]
    out = motions.copy()
    out[..., 0] += 2 * s * (-s * x - c * y)
    out[..., 1] += 2 * s * (c * x - s * y)
    return out
