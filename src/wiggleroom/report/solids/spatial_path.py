"""Paths in space followed evenly: positions go straight between waypoints, turns about one constant axis."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.spatial.bodies.rotations import exponential, logarithm, quaternion

Floats = NDArray[np.float64]

IN_SIGHT = 0.8
"""Parts that have gone further than this share of the size are out of sight."""
MAX_SHARE = 0.5
"""A way out of sight counts no longer than this share of the size, so that parts that fly off do not use up the time."""


def timed_path(assembly: Assembly, waypoints: Floats) -> tuple[Floats, Floats]:
    """When each waypoint is reached, (m,) from 0 to 1, by how far corners move; and the path (m, n, 6), with waypoints where sight ends."""
    far = IN_SIGHT * assembly.size
    reach = np.array([np.linalg.norm(m.surface.vertices - m.centroid, axis=1).max() for m in assembly.solids])
    path = [waypoints[0]]
    for one, other in itertools.pairwise(waypoints):
        share = _sight_left(one[:, :3], other[:, :3], far)
        path += [other] if share is None else [between_motions(one, other, share), other]
    points = np.array(path)
    step = np.linalg.norm(np.diff(points[:, :, :3], axis=0), axis=2)
    turn = np.linalg.norm(np.diff(points[:, :, 3:], axis=0), axis=2) * reach
    gone = np.linalg.norm(points[1:, :, :3], axis=2) > far * (1 + 1e-9)
    length = np.minimum(step + turn, np.where(gone, MAX_SHARE * assembly.size, np.inf)).max(axis=1, initial=0.0)
    passed = np.concatenate([[0.0], np.cumsum(length)])
    return (passed / passed[-1] if passed[-1] > 0 else np.linspace(0, 1, len(passed))), points


def _sight_left(one: Floats, other: Floats, far: float) -> float | None:
    """Share of a straight piece between displacements (n, 3) after which all that leave sight on it have left; None where none does."""
    leaves = (np.linalg.norm(one, axis=1) <= far) & (np.linalg.norm(other, axis=1) > far)
    if not leaves.any():
        return None
    start, way = one[leaves], (other - one)[leaves]
    a, b, c = (way**2).sum(axis=1), (start * way).sum(axis=1), (start**2).sum(axis=1) - far**2  # |start + s way| = far
    return float(((np.sqrt(b**2 - a * c) - b) / a).max())


def along_path(assembly: Assembly, waypoints: Floats, shares: Floats) -> Floats:
    """Motions (m, n, 6) [mm, rad] after some shares (m,) of a path (k, n, 6); its first and last point as they are."""
    if len(waypoints) == 1:
        return np.repeat(waypoints, len(shares), axis=0)
    times, waypoints = timed_path(assembly, waypoints)
    found = np.empty((len(shares), *waypoints.shape[1:]))
    for k, t in enumerate(shares.tolist()):
        i = int(np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(times) - 2))
        span = times[i + 1] - times[i]
        share = float((t - times[i]) / span) if span > 0 else 1.0
        if share in (0.0, 1.0):
            found[k] = waypoints[i + int(share)]
        else:
            found[k] = between_motions(waypoints[i], waypoints[i + 1], share)
    return found


def between_motions(one: Floats, other: Floats, share: float) -> Floats:
    """Motions (n, 6) between two.

    >>> half = between_motions(np.zeros((1, 6)), np.array([[2.0, 0, 0, 0, 0, 1]]), 0.5)
    >>> half.round(12).tolist()
    [[1.0, 0.0, 0.0, 0.0, 0.0, 0.5]]
    """
    R0, R1 = exponential(one[:, 3:]), exponential(other[:, 3:])
    turn = logarithm(np.einsum("nji,njk->nik", R0, R1))
    out = np.empty_like(one)
    out[:, :3] = one[:, :3] + share * (other[:, :3] - one[:, :3])
    out[:, 3:] = logarithm(np.einsum("nij,njk->nik", R0, exponential(share * turn)))
    return out


def in_sight(waypoints: Floats, far: float) -> Floats:
    """Motion (n, 6) at the last moment of a path (k, n, 6) until which no part has gone further than `far` [mm].

    >>> path = np.zeros((3, 1, 6))
    >>> path[1:, 0, 0] = 3.0, 40.0
    >>> in_sight(path, 10.0)[0, 0].round(6).tolist()
    10.0
    """
    gone = np.linalg.norm(waypoints[:, :, :3], axis=2).max(axis=1) > far
    if not gone.any():
        return np.asarray(waypoints[-1])
    k = max(int(gone.argmax()), 1)
    low, high = 0.0, 1.0
    for _ in range(60):  # distances are convex along a straight piece: they pass the limit once
        middle = (low + high) / 2
        shift = waypoints[k - 1, :, :3] + middle * (waypoints[k, :, :3] - waypoints[k - 1, :, :3])
        low, high = (middle, high) if np.linalg.norm(shift, axis=1).max() <= far else (low, middle)
    return between_motions(waypoints[k - 1], waypoints[k], low)


def with_quaternions(motions: Floats) -> Floats:
    """Motions (..., 7) with quaternions x, y, z, w in place of the rotation vectors of (..., 6)."""
    q = quaternion(exponential(motions[..., 3:]))
    return np.concatenate([motions[..., :3], q[..., 1:], q[..., :1]], axis=-1)
