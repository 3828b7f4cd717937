"""Mechanisms of curved meshes against the closed forms of their facets: faces that run parallel to others at known distances."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import manifold3d
import numpy as np
import pytest
import trimesh

import wiggleroom as wr

ALONG = {"+x": (1, 0, 0), "+z": (0, 0, 1)}


def solid(vertices: np.ndarray, faces: np.ndarray) -> Any:
    mesh = manifold3d.Mesh64(
        vert_properties=np.ascontiguousarray(vertices), tri_verts=np.ascontiguousarray(faces, dtype=np.uint64)
    )
    made = manifold3d.Manifold(mesh)
    assert made.status() == manifold3d.Error.NoError
    return made


def write(folder: Path, fixed: Any, free: Any) -> Path:
    """A file of two parts, the second free to shift."""
    parts = []
    for name, one in (("fixed", fixed), ("free", free)):
        mesh = one.to_mesh64()
        trimesh.Trimesh(np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts).astype(int)).export(
            folder / f"{name}.stl"
        )
        parts.append({"name": name, "mesh": f"{name}.stl", "fixed": name == "fixed", "lock": ["rx", "ry", "rz"]})
    path = folder / "pair.json"
    path.write_text(json.dumps({"format": "wiggleroom/2", "gap": 0, "parts": parts}))
    return path


def moves(path: Path, way: str) -> float:
    return float(wr.flex(wr.read(path), wr.Pull("free", ALONG[way]), search=0).objective)


def helicoid(profile: list[tuple[float, float]], pitch: float, stations: int, turns: int) -> Any:
    """A screw, from corners (height, radius) of its profile over one pitch, its ends pointed."""
    m, rows = len(profile), (turns + 1) * len(profile)
    height, radius = np.array(profile * (turns + 1)).T
    height += pitch * (np.arange(rows) // m)
    turn = 2 * np.pi * np.arange(stations) / stations
    corners = np.stack(
        [
            radius * np.cos(turn)[:, None],
            radius * np.sin(turn)[:, None],
            height + pitch * np.arange(stations)[:, None] / stations,
        ],
        axis=2,
    ).reshape(-1, 3)

    def number(i: int, q: int) -> int:
        return i * rows + q if i < stations else q + m

    last = rows - 1
    faces = []
    for i in range(stations):
        for q in range(last - (m if i == stations - 1 else 0)):
            a, b, c, d = number(i, q), number(i + 1, q), number(i + 1, q + 1), number(i, q + 1)
            faces += [(a, b, c), (a, c, d)]
    sides = {side for f in faces for side in zip(f, (*f[1:], f[0]), strict=True)}
    tips = np.array([[0, 0, -2 * pitch], [0, 0, (turns + 4) * pitch]])
    middle = (turns + 1) * pitch / 2
    rims = [(b, a) for a, b in sides if (b, a) not in sides]
    caps = [(a, b, len(corners) + int(corners[a, 2] > middle)) for a, b in rims]
    return solid(np.vstack([corners, tips]), np.array(faces + caps))


@pytest.mark.slow
def test_a_bolt_plays_in_its_nut_by_the_clearances_of_flank_and_crest(tmp_path: Path) -> None:
    pitch, root, crest, axial, radial, n = 3.0, 4.0, 5.0, 0.15, 0.2, 8
    bolt = helicoid([(0, root), (0.75, root), (1.35, crest), (2.4, crest)], pitch, n, 5)
    groove = helicoid(
        [(axial, root), (0.75 - axial, root), (1.35 - axial, crest), (1.35 - axial + 1e-9, crest + radial),
         (2.4 + axial, crest + radial), (2.4 + axial + 1e-9, crest)], pitch, n, 5)  # fmt: skip
    bolt = bolt.trim_by_plane((0, 0, 1), 4).trim_by_plane((0, 0, -1), -13)
    bore = manifold3d.Manifold.cylinder(40, root + radial, root + radial, n).translate((0, 0, -10))
    nut = manifold3d.Manifold.cylinder(5, 8, 8, 6).translate((0, 0, 6)) - groove - bore
    path = write(tmp_path, nut, bolt)
    assert moves(path, "+z") == pytest.approx(axial, rel=1e-4)
    assert moves(path, "+x") == pytest.approx(radial, rel=1e-4)  # between two facets of the crest


@pytest.mark.slow
def test_a_shell_moves_as_its_solid_does_and_says_no_more(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=3)
    block = manifold3d.Manifold.cube((26, 26, 19)).translate((-13, -13, -13))
    path = write(tmp_path, block - solid(10.3 * ball.vertices, ball.faces), solid(10 * ball.vertices, ball.faces))
    made = wr.read(path)
    assert 0 < made.overshoot <= 0.3e-3
    answer = wr.flex(made, wr.Pull("free", (0, 0, -1)), search=0)
    nearest = 0.3 * np.einsum("ij,ij->i", ball.face_normals, ball.triangles_center)
    assert answer.objective == pytest.approx(np.min(nearest / -np.minimum(ball.face_normals[:, 2], -1e-9)), rel=1e-3)
    assert answer.verdict is wr.Verdict.STATIONARY
    assert wr.clearances(wr.read(path, overlapping=True)).gap[0] == pytest.approx(nearest.min(), rel=1e-4)
    with pytest.raises(wr.InputError, match="for clearances alone"):
        wr.flex(wr.read(path, overlapping=True), wr.Pull("free", (1, 0, 0)))


def test_what_lies_inside_the_material_of_a_shell_overlaps_it(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=3)
    block = manifold3d.Manifold.cube((60, 26, 19)).translate((-13, -13, -13))
    path = write(
        tmp_path,
        block - solid(10.3 * ball.vertices, ball.faces),
        manifold3d.Manifold.cube((2, 2, 2)).translate((30, 0, -4)),
    )
    with pytest.raises(wr.TouchingError, match="overlap"):
        wr.flex(wr.read(path), wr.Pull("free", (1, 0, 0)))


def test_a_ball_plays_in_its_socket_by_the_distance_of_parallel_facets(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=2)
    faces = ball.face_normals
    near = 0.3 * (faces * ball.triangles_center).sum(axis=1)
    block = manifold3d.Manifold.cube((26, 26, 19)).translate((-13, -13, -13))  # open above
    socket = block - solid(10.3 * ball.vertices, ball.faces)
    path = write(tmp_path, socket, solid(10 * ball.vertices, ball.faces))
    from scipy.optimize import linprog

    closed = faces[:, 2] < 0.4  # facets below the opening
    truth = linprog([-1, 0, 0], A_ub=faces[closed], b_ub=near[closed], bounds=(None, None))
    assert moves(path, "+x") == pytest.approx(-truth.fun, rel=1e-4)
