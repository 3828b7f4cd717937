"""Distances of convex pieces, judged by non-negative least squares over their corners."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from wiggleroom.spatial.solids.separating_axis import distance

Floats = NDArray[np.float64]
Piece = tuple[Floats, Floats, Floats]


def piece(points: Floats) -> Piece:
    """Corners, normals of faces and directions of edges of a hull."""
    hull = ConvexHull(points)
    ends = points[hull.simplices[:, [0, 1, 0, 2, 1, 2]]].reshape(-1, 2, 3)
    edges = ends[:, 0] - ends[:, 1]
    edges /= np.linalg.norm(edges, axis=1)[:, None]
    return points[hull.vertices].copy(), hull.equations[:, :3].copy(), edges


def nearest(P: Floats, Q: Floats) -> float:
    """Least distance between points of two hulls: weights of corners that are not negative and add up to one."""
    heavy = 1e6  # of the two sums: what is missing there is of second order
    rows = np.block(
        [[P.T, -Q.T], [heavy * np.ones(len(P)), np.zeros(len(Q))], [np.zeros(len(P)), heavy * np.ones(len(Q))]]
    )
    return float(nnls(rows, np.array([0, 0, 0, heavy, heavy]), maxiter=10_000)[1])


def prism(rng: np.random.Generator) -> Floats:
    """A regular prism of up to 40 sides, lying anyhow."""
    turn = 2 * np.pi * np.arange(k := int(rng.integers(3, 41))) / k
    ring = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(k)])
    return np.vstack([ring, ring + np.array([0, 0, rng.uniform(0.2, 3)])])


@pytest.mark.parametrize(
    "shape", [prism, lambda rng: rng.normal(size=(int(rng.integers(4, 12)), 3))], ids=["prism", "hull"]
)
def test_the_distance_of_pieces_is_that_of_their_nearest_points(shape):
    rng, seen = np.random.default_rng(7), 0
    for _ in range(80):
        P = piece(shape(rng))
        Q = piece(
            shape(rng) @ Rotation.random(random_state=rng).as_matrix().T + rng.normal(size=3) * rng.choice([2.0, 5.0])
        )
        axis = np.zeros(3)
        found, truth = distance(*P, *Q, axis, 1.0), nearest(P[0], Q[0])
        if found <= 0:
            assert truth < 1e-3
            continue
        seen += 1
        assert found == pytest.approx(truth, rel=1e-6)
        assert (Q[0] @ axis).min() - (P[0] @ axis).max() == pytest.approx(found, rel=1e-9)
    assert seen > 30
