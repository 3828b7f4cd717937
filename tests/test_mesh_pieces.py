"""Convex pieces of meshes that rounded files make hard to cut: judged by the slabs that the meshes were drawn from."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely
import trimesh
from benchmarks.attack.families_solid import draw_solids
from benchmarks.attack.solids import Block
from scipy.spatial import ConvexHull, Delaunay, HalfspaceIntersection
from scipy.spatial.transform import Rotation

import wiggleroom as wr
from wiggleroom.drawing.model import Surface
from wiggleroom.spatial.solids.convex_hulls import filled_up, hull_surface, hull_volume
from wiggleroom.spatial.solids.fins import convex_without_fins
from wiggleroom.spatial.solids.mesh_file import MeshFiles
from wiggleroom.spatial.solids.mesh_pieces import CutsLeft, in_pieces, mesh_made
from wiggleroom.spatial.solids.solid_boolean import solid_of, surface_of, volume_of


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


@pytest.mark.parametrize("number", [5035, 5992, 20036])
def test_meshes_from_rounded_files_are_cut_into_pieces_that_make_them_up(number: int, tmp_path: Path) -> None:
    _, drawn = draw_solids(number)
    assembly = wr.read(drawn.write(tmp_path))
    rng = np.random.default_rng(number)
    for block, part, made in zip(drawn.parts, assembly.parts, assembly.solids, strict=True):
        if (tmp_path / f"{block.name}.stl").exists():  # films of rounding, 1e-7 of the size thick, are left out
            assert volume_of(made.surface) == pytest.approx(block.mesh().volume, rel=5e-6)
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


def convex_block(kind: str, rng: np.random.Generator) -> np.ndarray:
    """Planes (k, 4) of a convex block of size 1 or so with corners where three, four and more faces meet: n . x + c <= 0."""
    turn = 2 * np.pi * np.arange(9) / 9
    if kind == "pyramid":
        normals = np.column_stack([np.cos(turn), np.sin(turn), np.full(9, 0.7)])
        normals = np.vstack([normals, [0, 0, -1]])
    elif kind == "octahedron":
        normals = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    else:
        normals = np.vstack([rng.normal(size=(20, 3)), np.eye(3), -np.eye(3)])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return np.column_stack(
        [normals, -rng.uniform(0.5, 1.2, len(normals)) if kind == "stone" else np.full(len(normals), -0.5)]
    )


@pytest.mark.parametrize(("kind", "ending"), [("pyramid", "obj"), ("octahedron", "stl"), ("stone", "obj")])
@pytest.mark.parametrize("seed", [1])
def test_blocks_are_convex_to_the_digits_of_their_file(tmp_path: Path, kind: str, ending: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    planes = convex_block(kind, rng)
    R, at = Rotation.random(random_state=seed), rng.uniform(-3, 3, 3)
    normals = R.apply(planes[:, :3])
    planes = np.column_stack([normals, planes[:, 3] - normals @ at])
    mesh = hull_surface(np.unique(HalfspaceIntersection(planes, at).intersections.round(12), axis=0))
    file = tmp_path / f"a.{ending}"
    if ending == "obj":
        lines = ["v {:.6f} {:.6f} {:.6f}".format(*v) for v in mesh.vertices]
        file.write_text("\n".join(lines + ["f {} {} {}".format(*f) for f in mesh.faces + 1]))
    else:
        trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).export(file)
    surface, _ = MeshFiles(1.0).read(file)
    for gap in (0.0, 0.05, 0.3):
        made, wrong = mesh_made(surface, gap)
        assert wrong == []
        assert made is not None
        made = in_pieces(made, float)
        assert len(made.pieces) == 1
        truth = HalfspaceIntersection(planes + np.array([0, 0, 0, gap / 2]), at).intersections
        assert ConvexHull(made.pieces[0].corners).volume == pytest.approx(ConvexHull(truth).volume, rel=2e-5)
        outside = made.surface.vertices @ planes[:, :3].T + planes[:, 3] + gap / 2
        assert outside.max() < 2e-5


def test_a_round_mesh_of_many_faces_is_convex_to_six_decimals(tmp_path: Path) -> None:
    """Its faces of four corners are so narrow that no small shift of corners makes all of them flat."""
    ball = trimesh.creation.uv_sphere(radius=10, count=[40, 40])
    ball.vertices = Rotation.random(random_state=4).apply(ball.vertices)
    lines = ["v {:.6f} {:.6f} {:.6f}".format(*v) for v in ball.vertices]
    (tmp_path / "a.obj").write_text("\n".join(lines + ["f {} {} {}".format(*f) for f in ball.faces + 1]))
    surface, notes = MeshFiles(1.0).read(tmp_path / "a.obj")
    assert len(notes) == 1
    for gap in (0.0, 0.4):
        made, _ = mesh_made(surface, gap)
        assert made is not None
        made = in_pieces(made, float)
        assert len(made.pieces) == 1
        # the moved faces bound a solid that is similar to it: all touch one ball
        touched = float(np.einsum("ij,ij->i", ball.triangles_center, ball.face_normals).max())
        volume = ConvexHull(made.pieces[0].corners).volume
        assert volume == pytest.approx(ball.volume * (1 - gap / 2 / touched) ** 3, rel=1e-5 if gap == 0 else 2e-3)


def test_a_solid_that_needs_more_cuts_than_are_left_is_a_shell() -> None:
    bowl = trimesh.creation.box((9, 9, 9)).difference(trimesh.creation.icosphere(subdivisions=1, radius=3))
    made, _ = mesh_made(Surface(np.array(bowl.vertices), np.array(bowl.faces, dtype=np.int64)), 0.0)
    assert made is not None
    assert in_pieces(made, lambda: 1e-3).overshoot == 0
    shell = in_pieces(made, lambda: 1e-3, left=CutsLeft(5))
    assert shell.overshoot == 1e-3
    assert len(shell.pieces) == len(made.surface.faces)


def test_a_fin_of_rounding_is_left_out_and_one_of_material_is_not() -> None:
    fin = solid_of(with_fin(1e-8))
    assert hull_volume(surface_of(fin).vertices) > 24.5
    corners = convex_without_fins(fin, thin=1e-6)
    assert corners is not None
    assert hull_volume(corners) == pytest.approx(24.0, rel=1e-7)
    assert convex_without_fins(solid_of(with_fin(0.1)), thin=1e-6) is None


@pytest.mark.parametrize(
    ("wide", "deep", "filled"), [(1e-6, 1e-7, True), (1e-3, 1e-7, True), (1e-6, 0.5, False), (0.1, 1e-3, False)]
)
def test_a_groove_is_filled_up_where_it_is_shallow_and_not_where_it_is_narrow(
    wide: float, deep: float, filled: bool
) -> None:
    """A groove across a lid: all its corners lie on the hull."""
    ring = np.array([(0, 0), (4, 0), (4, 3), (2 + wide / 2, 3), (2, 3 - deep), (2 - wide / 2, 3), (0, 3)], dtype=float)
    mesh = trimesh.creation.extrude_polygon(shapely.Polygon(ring), 5, engine="manifold")
    surface = Surface(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64))
    found = filled_up(surface, 8e-6)
    assert (found is not None) == filled
    if found is not None:
        assert volume_of(found[0]) == pytest.approx(60, rel=1e-12)
        assert deep / 3 < found[1] < 3.1 * deep
