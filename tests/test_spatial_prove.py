"""Proven bounds of one body in space: against closed forms, and certificates that are changed."""

from __future__ import annotations

import copy
import hashlib
import json
import random

import pytest

import wiggleroom as wr

pytest.importorskip("highspy")
pytest.importorskip("flint")
pytest.importorskip("manifold3d")

from wiggleroom.deadline import Deadline
from wiggleroom.spatial.proof.inner_pieces import inner_pieces
from wiggleroom.verify import work_limit
from wiggleroom.verify.checker import verify

WALLS = [
    [0, 0, 0, 40, 40, 5],
    [0, 0, 5, 10, 40, 30],
    [30, 0, 5, 40, 40, 30],
    [10, 0, 5, 30, 10, 30],
    [10, 30, 5, 30, 40, 30],
]
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
    for k in range(40):
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
