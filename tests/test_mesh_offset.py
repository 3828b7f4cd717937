"""Meshes whose faces cannot all move inward: judged by points, and by the distance of these from the surface as drawn."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

import wiggleroom as wr
from wiggleroom.drawing.model import MadeSolid, Surface
from wiggleroom.spatial.overlaps.surface_distance import surface_distances
from wiggleroom.spatial.solids import mesh_pieces
from wiggleroom.spatial.solids.mesh_pieces import in_pieces, mesh_made
from wiggleroom.spatial.solids.solid_angle import winding_numbers
from wiggleroom.verdict import Separability, Verdict


def dented() -> trimesh.Trimesh:
    """A ball of radius 10 with a smooth dent from above, 2.5 deep."""
    ball = trimesh.creation.icosphere(subdivisions=2, radius=10)
    off = np.linalg.norm(ball.vertices / 10 - (0, 0, 1), axis=1)
    ball.vertices *= (1 - 0.25 * np.exp(-(off**2) / 0.3))[:, None]
    return ball


def made_of(mesh: trimesh.Trimesh, gap: float) -> MadeSolid:
    made, wrong = mesh_made(Surface(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64)), gap)
    assert wrong == []
    assert made is not None
    return made if made.pieces else in_pieces(made, float)


def socket() -> trimesh.Trimesh:
    """A block with a round socket that is open above: its rim has slivers."""
    ball = trimesh.creation.icosphere(subdivisions=2, radius=10)
    return trimesh.creation.box(bounds=[(-13, -13, -13), (13, 13, 6)]).difference(ball)


@pytest.mark.slow
def test_a_moved_mesh_goes_round_what_is_made_and_little_more() -> None:
    mesh, gap = dented(), 0.1
    made = made_of(mesh, gap)
    assert 0 < made.mostly <= made.overshoot
    assert made.mostly <= gap / 8
    triangles = np.ascontiguousarray(mesh.triangles)
    side = made.surface.vertices[made.surface.faces][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2, 3)
    along = np.einsum("pe,kex->pkx", np.column_stack([np.arange(9), np.arange(9)[::-1]]) / 8, side).reshape(-1, 3)
    shallow = surface_distances(triangles, along, np.empty_like(along)).min()
    assert shallow >= gap / 2 - made.overshoot - 1e-9
    assert shallow <= gap / 2 - 0.95 * made.overshoot
    rng = np.random.default_rng(3)
    share = rng.dirichlet((1, 1, 1), 2500)
    near = mesh.triangles[rng.integers(0, len(mesh.faces), 2500)]
    points = np.einsum("kij,ki->kj", near, share) + rng.normal(scale=gap, size=(2500, 3))
    deep = surface_distances(triangles, points, np.empty_like(points))
    deep = np.where(winding_numbers(triangles, points) > 0.5, deep, -deep)
    inside = winding_numbers(made.surface.vertices[made.surface.faces], points) > 0.5
    sure = deep >= 1.01 * gap / 2
    assert sure.sum() > 180
    assert inside[sure].all()
    assert not inside[deep < gap / 2 - made.overshoot - 1e-6].any()
    assert inside[deep < gap / 2 - 2 * made.mostly - 1e-6].mean() < 0.01


def test_a_mesh_for_a_larger_gap_lies_in_that_for_a_smaller_one() -> None:
    moved = [made_of(dented(), gap).surface for gap in (0.0, 0.1, 0.6)]
    for larger, smaller in itertools.pairwise(moved):
        assert (winding_numbers(larger.vertices[larger.faces], smaller.vertices) > 0.5).all()


def test_a_mesh_that_is_too_uneven_is_refused_with_the_number(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = dented()
    surface = Surface(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64))
    mostly = made_of(mesh, 0.05).mostly
    monkeypatch.setattr(mesh_pieces, "MOST_OVERSHOOT", mostly / 0.05 / 2)
    made, wrong = mesh_made(surface, 0.05)
    assert made is None
    assert len(wrong) == 1
    assert (
        f"would be {mostly:.3g} mm larger than made on a twentieth of its surface; at most {mostly / 2:.3g} will do"
        in wrong[0]
    )


@pytest.mark.slow
def test_a_ball_gains_the_gap_in_its_socket(tmp_path: Path) -> None:
    socket().export(tmp_path / "socket.stl")
    trimesh.creation.icosphere(subdivisions=2, radius=10).export(tmp_path / "ball.stl")
    parts = [
        {"name": n, "mesh": f"{n}.stl", "fixed": n == "socket", "lock": ["rx", "ry", "rz"]} for n in ("socket", "ball")
    ]
    (tmp_path / "a.json").write_text(json.dumps({"format": "wiggleroom/2", "gap": 0.2, "parts": parts}))
    made = wr.read(tmp_path / "a.json")
    answer = wr.flex(made, wr.Pull("ball", (0, 0, -1)), search=0)
    assert answer.verdict is Verdict.STATIONARY
    assert answer.objective == pytest.approx(0.2, rel=0.02)  # the lowest facets are nearly level


def assembly(folder: Path, gap: float) -> wr.Assembly:
    """The dented ball between two walls 21 apart, so that it may move by 1 and the gap along x; closed in by a box of walls."""
    dented().export(folder / "a.stl")
    walls = [[-30, -30, -30, -10.5, 30, 30], [10.5, -30, -30, 30, 30, 30]]
    walls += [[-10.5, -30, -30, 10.5, -10.5, 30], [-10.5, 10.5, -30, 10.5, 30, 30]]
    walls += [[-10.5, -10.5, -30, 10.5, 10.5, -10.5], [-10.5, -10.5, 10.5, 10.5, 10.5, 30]]
    parts = [
        {"name": "ball", "mesh": "a.stl", "lock": ["rx", "ry", "rz"]},
        {"name": "cage", "boxes": walls, "fixed": True},
    ]
    (folder / "a.json").write_text(json.dumps({"format": "wiggleroom/2", "gap": gap, "parts": parts}))
    return wr.read(folder / "a.json")


@pytest.mark.slow
def test_nothing_that_stops_a_cover_is_claimed_of_what_it_covers(tmp_path: Path) -> None:
    assert wr.check(assembly(tmp_path, 0.0), seconds=60).verdict is Separability.INTERLOCKED
    made = assembly(tmp_path, 0.2)
    assert made.overshoot > 0
    assert any("is covered by" in note and "larger than it is made" in note for note in made.drawing.notes)
    assert wr.check(made, seconds=2).verdict is Separability.UNKNOWN
    pull = wr.Pull("ball", (1, 0, 0))
    answer = wr.flex(made, pull, search=0)
    assert answer.verdict in (Verdict.STATIONARY, Verdict.STOPPED)
    assert answer.at_most is None
    assert answer.objective == pytest.approx(0.5 + 0.2, abs=0.03)
    for study in (wr.rank, lambda a, p: wr.allowable_gap(a, p, at_most=1.0)):
        with pytest.raises(wr.InputError, match="what stops them is not known; ask flex, check or sweep"):
            study(made, pull)
