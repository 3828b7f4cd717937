"""Upper bounds in space: of parts that move in one plane, and proven ones of one body, with certificates that are changed."""

from __future__ import annotations

import copy
import hashlib
import json
import random

import numpy as np
import pytest

import wiggleroom as wr

pytest.importorskip("highspy")
pytest.importorskip("flint")
pytest.importorskip("manifold3d")

from tests.test_spatial import spatial
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.cli import main
from wiggleroom.deadline import Deadline
from wiggleroom.spatial.proof.inner_pieces import inner_pieces
from wiggleroom.verify import work_limit
from wiggleroom.verify.checker import verify

CYCLE = {0: ["x", "ry", "rz"], 1: ["y", "rz", "rx"], 2: ["z", "rx", "ry"]}
"""Locks that leave the motions of the plane across an axis."""


def turned(points: list[list[float]], axis: int) -> list[list[float]]:
    """Boxes along other axes: z becomes the given one."""
    found = []
    for box in points:
        corners = np.roll(np.reshape(box, (2, 3)), axis - 2, axis=1)
        found.append(corners.ravel().tolist())
    return found


def dovetail(axis: int, high: float) -> Assembly:
    """A hook in a pocket; above a level the pocket is wider, so cross-sections differ."""
    pocket = [
        [-3, -3, 0, 3, 0, 1], [-3, 0, 0, -1, 3, 1], [1, 0, 0, 3, 3, 1], [-3, 3, 0, -0.4, 4, 1], [0.4, 3, 0, 3, 4, 1],
    ]  # fmt: skip
    wide = [[-3, -3, 1, 3, 0, 2], [-3, 0, 1, -2, 4, 2], [2, 0, 1, 3, 4, 2]]
    hook = [[-0.8, 0.2, 0, 0.8, 2.8, high], [-0.2, 2.8, 0, 0.2, 6, high]]
    return spatial(
        {"name": "pocket", "boxes": turned([*pocket, *wide], axis), "fixed": True},
        {"name": "hook", "boxes": turned(hook, axis), "lock": CYCLE[axis]},
    )


@pytest.mark.parametrize(("axis", "high"), [(0, 1.0), (1, 2.0), (2, 1.0)])
def test_what_moves_in_a_plane_has_a_bound_near_the_motion(axis: int, high: float) -> None:
    assembly = dovetail(axis, high)
    along = np.roll([0.0, 1.0, 0.0], axis - 2)
    found = wr.flex(assembly, wr.Pull("hook", tuple(along)))
    assert found.objective == pytest.approx(
        0.2, abs=1e-6
    )  # the hook's shoulder meets the narrow mouth, at the lower level
    assert found.at_most is not None
    assert found.objective <= found.at_most < 0.2 * 1.2
    turn = wr.flex(assembly, wr.Turn("hook", tuple(np.roll([0.0, 0.0, -1.0], axis - 2))))
    assert turn.at_most is None or turn.objective <= turn.at_most


def test_a_film_in_a_cross_section_leaves_the_bound_as_it_is() -> None:
    """A film beside the pocket, of which the section keeps less than a billionth of its size."""
    with_film = dovetail(2, 2.0)
    film = [[-4, -3, 0, -4 + 8e-9, 5, 2]]
    pocket, hook = with_film.drawing.parts
    boxes = [box.ravel().tolist() for box in pocket.solid.boxes]
    again = spatial(
        {"name": "pocket", "boxes": [*boxes, *film], "fixed": True},
        {"name": "hook", "boxes": [box.ravel().tolist() for box in hook.solid.boxes], "lock": CYCLE[2]},
    )
    pull = wr.Pull("hook", (0.0, 1.0, 0.0))
    assert wr.flex(again, pull).at_most == pytest.approx(wr.flex(with_film, pull).at_most, rel=1e-6)


def test_a_weighted_pull_across_the_plane_counts_only_what_lies_in_it() -> None:
    found = wr.flex(dovetail(2, 1.0), wr.Pull("hook", (0.0, 0.6, 0.8), weight=5.0))
    assert found.objective == pytest.approx(5 * 0.6 * 0.2, abs=1e-5)
    assert found.at_most is not None
    assert found.objective <= found.at_most


def test_extruded_chains_are_proven_as_in_the_plane() -> None:
    flat = wr.patterns.chain(3, joint="swallowtail", gap=0.01)
    parts = [
        {"name": p.name, "outline": p.regions[0].outer.tolist(), "thickness": 0.4, "at": [*p.at[:2], 0], "fixed": p.fixed, "lock": CYCLE[2]}
        for p in flat.drawing.parts
    ]  # fmt: skip
    last = flat.drawing.parts[-1]
    found = wr.flex(spatial(*parts, gap=0.01), wr.Pull(last.name, (0, 1, 0), (*last.at[:2], 0.2)))
    truth = wr.flex(flat, wr.Pull(last.name, (0, 1)), search=0)
    assert found.verdict == "proven"
    assert found.objective == pytest.approx(truth.objective, rel=1e-6)
    assert truth.objective < found.at_most < 1.001 * truth.objective


def test_parts_that_move_in_space_have_no_bound_and_that_is_said(tmp_path, monkeypatch, capsys) -> None:
    peg = {"name": "peg", "boxes": [[0.1, 0.1, 0.1, 0.9, 0.9, 3]]}
    sides = [[-1, -1, 0, 0, 2, 2], [1, -1, 0, 2, 2, 2], [0, -1, 0, 1, 0, 2], [0, 1, 0, 1, 2, 2]]
    walls = {"name": "walls", "boxes": [[-1, -1, -1, 2, 2, 0], *sides], "fixed": True}
    found = wr.flex(spatial(peg, walls), wr.Pull("peg", (1, 0, 0)))
    assert found.at_most is None
    file = tmp_path / "peg.json"
    for lock, known in ((CYCLE[2], True), ([], False)):
        file.write_text(json.dumps({"format": "wiggleroom/2", "parts": [peg | {"lock": lock}, walls]}))
        monkeypatch.setattr("sys.argv", ["wiggleroom", "flex", str(file), "--pull", "peg:+x"])
        main()
        assert ("at most" in capsys.readouterr().out) == known


# -- proven bounds of one body ---------------------------------------------------------------------------------------


WALLS = [
    [0, 0, 0, 40, 40, 5], [0, 0, 5, 10, 40, 30], [30, 0, 5, 40, 40, 30], [10, 0, 5, 30, 10, 30],
    [10, 30, 5, 30, 40, 30],
]  # fmt: skip
PEG = {
    "format": "wiggleroom/2",
    "gap": 0.4,
    "parts": [
        {"name": "block", "boxes": [*WALLS, [0, 0, 30, 40, 40, 35]], "fixed": True},
        {"name": "peg", "boxes": [[10, 10, 5, 30, 30, 30]]},
    ],
}


@pytest.fixture(scope="module")
def proven(tmp_path_factory):
    file = tmp_path_factory.mktemp("peg") / "peg.json"
    file.write_text(json.dumps(PEG))
    return wr.prove(wr.flex(wr.read(file), wr.Pull("peg", (1, 0, 0)), search=0), 0.01, certify=True)


def test_a_peg_in_a_closed_hole_moves_by_the_gap(proven):
    assert 0.4 - 1e-6 <= proven.at_most <= 0.404
    found = verify(json.loads(json.dumps(proven.bound.certificate)))
    assert found.proven, found.why
    assert found.at_most == pytest.approx(proven.at_most, rel=1e-12)


def test_a_tilted_tenon_is_bounded_near_its_closed_form():
    joint = wr.read("examples/43_mortise_and_tenon/joint.json")
    found = wr.prove(wr.flex(joint, wr.Pull("rail", (0, 0, 1), (120, 0, 0)), search=0), 0.01)
    assert 1.803336906 <= found.at_most <= 1.01 * 1.803336907


def test_each_facet_of_a_round_hole_has_a_piece_behind_all_of_its_plane():
    hinge = wr.flex(wr.read("examples/51_hinge/hinge.json"), wr.Pull("leaf_b", (0, 1, 0)), search=0).assembly
    pieces = [p for p in inner_pieces(hinge, Deadline(None)) if hinge.names[p.part] == "b1"]
    assert len(pieces) == 24
    chord = 2 * (4.807**2 - 2.629**2) ** 0.5  # of the outside, along the plane of a facet
    for piece in pieces:
        across = piece.corners[:, None, [0, 2]] - piece.corners[:, [0, 2]]
        assert (across**2).sum(-1).max() ** 0.5 > 0.97 * chord


def test_a_stop_ends_a_proof_at_once():
    joint = wr.read("examples/43_mortise_and_tenon/joint.json")
    told = []
    found = wr.flex(joint, wr.Pull("rail", (0, 0, 1), (120, 0, 0)), search=0)
    wr.prove(found, 0.01, progress=told.append)
    assert "boxes of poses" in told[-1].stage
    stopped = wr.prove(found, 0.01, stop=Deadline(1e-9), progress=told.append)
    assert stopped.bound.why == "no bound was found in the time or work given"


def test_a_file_that_asks_for_endless_work_is_refused(proven, monkeypatch):
    monkeypatch.setattr(work_limit, "STEPS", work_limit.STEPS // 5)
    assert verify(copy.deepcopy(proven.bound.certificate)).proven
    content = copy.deepcopy(proven.bound.certificate)
    content["parts"][0]["vertices"] += [[0.0, 0.0, 0.0]] * 2000
    content["pieces"] += content["pieces"][:1] * 400
    content["sha256"] = hashlib.sha256(
        json.dumps({n: v for n, v in content.items() if n != "sha256"}).encode()
    ).hexdigest()
    found = verify(content)
    assert not found.proven
    assert "more work" in found.why


def test_lower_bounds_and_changed_numbers_are_refused(proven):
    rng = random.Random(1)
    for k in range(16):
        content = copy.deepcopy(proven.bound.certificate)
        if k % 4 == 0:
            content["at_most"] = 0.4 * rng.uniform(0.5, 0.999)
        elif k % 4 == 1:
            content["pieces"][rng.randrange(7)]["faces"][rng.randrange(6)][3] += rng.uniform(0.1, 1)
        elif k % 4 == 2:
            content["box"][1][0] = rng.uniform(0.01, 0.3)
        else:
            content["points"][rng.randrange(len(content["points"]))][rng.randrange(1, 4)] += rng.choice([-50, 50])
        content["sha256"] = hashlib.sha256(
            json.dumps({n: v for n, v in content.items() if n != "sha256"}).encode()
        ).hexdigest()
        assert not verify(content).proven
