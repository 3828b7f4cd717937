"""Distances while one body turns among others, against shapely and against all pairs of corners and edges."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely

from wiggleroom.disassembly.turn_moves import corner_distance, edge_boxes


def star(random: np.random.Generator, corners: int) -> np.ndarray:
    angle = np.sort(random.uniform(0, 2 * np.pi, corners))
    return random.uniform(0.5, 1.5, corners)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])


def placed(ring: np.ndarray, pose: np.ndarray) -> np.ndarray:
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return ring @ np.array([[c, s], [-s, c]]) + pose[:2]


@pytest.mark.parametrize("seed", range(6))
def test_leaving_far_edges_out_changes_no_distance_and_no_push(seed: int) -> None:
    random = np.random.default_rng(seed)
    rings = [star(random, int(random.integers(3, 60))) for _ in range(3)]
    first = np.cumsum([0, *map(len, rings)])
    corner = np.vstack(rings)
    after = np.concatenate([np.roll(np.arange(a, b), -1) for a, b in pairwise(first)])
    boxes, begin = edge_boxes(corner, after, first)
    poses = random.uniform((-2, -2, -3), (2, 2, 3), (3, 3))
    for want in (0.0, 0.3, 10.0):
        for known in (np.inf, 0.2, 1e-3):
            push = np.zeros(2)
            least = corner_distance.py_func(
                corner, after, first, boxes, begin, 0, poses[0], 1, poses[1], push, want, known
            )
            mine, other = placed(rings[0], poses[0]), shapely.LinearRing(placed(rings[1], poses[1]))
            nearest = shapely.get_coordinates(
                shapely.line_interpolate_point(other, shapely.line_locate_point(other, shapely.points(mine)))
            )
            away = mine - nearest
            far = np.hypot(*away.T)
            near = far < want
            assert least == pytest.approx(min(known, far.min()), abs=1e-12)
            assert push == pytest.approx(((want / far - 1)[:, None] * away)[near].sum(axis=0), abs=1e-9)
