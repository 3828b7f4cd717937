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
