"""Convex pieces of meshes that rounded files make hard to cut: judged by the slabs that the meshes were drawn from."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely
from benchmarks.attack.families_solid import draw_solids
from benchmarks.attack.solids import Block
from scipy.spatial import ConvexHull, Delaunay

import wiggleroom as wr
from wiggleroom.spatial.solids.convex_hulls import hull_surface, hull_volume
from wiggleroom.spatial.solids.fins import convex_without_fins
from wiggleroom.spatial.solids.solid_boolean import solid_of, surface_of, volume_of
from wiggleroom.spatial.solids.spatial_model import Surface

BORDER = 1e-3
"""Points nearer to a border are not asked about [mm]."""


def inside(block: Block, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which points (k, 3) of the world lie in a block, and which are far enough from its borders to say so."""
    own = (points - block.at) @ block.R
    within, near = np.zeros(len(points), dtype=bool), np.zeros(len(points), dtype=bool)
    flat = shapely.points(own[:, :2])
    for polygon, low, high in block.slabs:
        z = own[:, 2]
        rim = shapely.distance(polygon.boundary, flat) < BORDER
        near |= rim | (np.abs(z - low) < BORDER) | (np.abs(z - high) < BORDER)
        within |= shapely.contains(polygon, flat) & (z > low) & (z < high)
    return within, ~near


@pytest.mark.parametrize("number", [5035, 5638, 5702, 5992, 20036])
def test_meshes_from_rounded_files_are_cut_into_pieces_that_make_them_up(number: int, tmp_path: Path) -> None:
    _, drawn = draw_solids(number)
    assembly = wr.read(drawn.write(tmp_path))
    rng = np.random.default_rng(number)
    for block, part, made in zip(drawn.parts, assembly.parts, assembly.made, strict=True):
        if (tmp_path / f"{block.name}.stl").exists():  # films of rounding, 1e-7 of the size thick, are left out
            volume = sum(ConvexHull(p.corners).volume for p in made.pieces)
            assert volume == pytest.approx(block.mesh().volume, rel=5e-6)
        if not block.slabs:
            continue
        corners = np.vstack(block.pieces())
        points = rng.uniform(corners.min(axis=0), corners.max(axis=0), (4000, 3))
        truth, asked = inside(block, points)
        said = np.zeros(len(points), dtype=bool)
        for piece in made.pieces:
            said |= Delaunay(piece.corners @ part.R.T + part.at).find_simplex(points) >= 0
        assert truth[asked].sum() > 100
        assert (said == truth)[asked].all()


def test_a_hull_keeps_all_corners_of_a_wide_cap_that_is_nearly_flat() -> None:
    turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    ring = np.column_stack([10 * np.cos(turn), 10 * np.sin(turn), np.zeros(40)])
    rng = np.random.default_rng(1)
    cap = ring + np.array([0, 0, 4]) + rng.uniform(-1e-9, 1e-9, (40, 3))
    whole = 0.5 * 40 * 100 * np.sin(2 * np.pi / 40) * 4
    points = np.vstack([ring, cap])
    assert hull_volume(points) == pytest.approx(whole, rel=1e-8)
    assert volume_of(hull_surface(points)) == pytest.approx(whole, rel=1e-8)
    assert hull_volume(ring) == 0.0


def with_fin(thick: float) -> Surface:
    """A box 4 x 3 x 2 and a triangle of some thickness that stands out of one edge in the plane of a face."""
    x, y, z = 4.0, 3.0, 2.0
    corners = [[0, 0, 0], [x, 0, 0], [x, y, 0], [0, y, 0], [0, 0, z], [x, 0, z], [x, y, z], [0, y, z]]
    corners += [[6.0, 1.5, z - thick / 2]]
    faces = [
        [0, 2, 1],
        [0, 3, 2],
        [4, 5, 6],
        [4, 6, 7],
        [0, 1, 5],
        [0, 5, 4],
        [2, 3, 7],
        [2, 7, 6],
        [3, 0, 4],
        [3, 4, 7],
    ]
    corners += [[x, 0, z - thick], [x, y, z - thick]]
    faces += [[5, 8, 6], [9, 10, 8], [9, 8, 5], [10, 6, 8], [1, 2, 10], [1, 10, 9], [1, 9, 5], [2, 6, 10]]
    return Surface(np.array(corners, dtype=float), np.array(faces, dtype=np.int64))


def test_a_fin_of_rounding_is_left_out_and_one_of_material_is_not() -> None:
    fin = solid_of(with_fin(1e-8))
    assert hull_volume(surface_of(fin).vertices) > 24.5
    corners = convex_without_fins(fin, thin=1e-6)
    assert corners is not None
    assert hull_volume(corners) == pytest.approx(24.0, rel=1e-7)
    assert convex_without_fins(solid_of(with_fin(0.1)), thin=1e-6) is None
