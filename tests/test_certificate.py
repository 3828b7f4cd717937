"""Certificates: what is written verifies, what is changed does not, and what still does is true."""

from __future__ import annotations

import copy
import hashlib
import json
import random
from pathlib import Path

import numpy as np
import pytest

import wiggleroom as wr
from tests.flexing import random_chain, row_of
from tests.oracle import blocks, chain
from wiggleroom.assembly.build import assemble
from wiggleroom.verify.caging_check import check_caging_surface

pytest.importorskip("highspy")
pytest.importorskip("flint")
import flint

from wiggleroom.verify.ball_arithmetic import Refused, point
from wiggleroom.verify.ball_bounds import highest
from wiggleroom.verify.checker import read_certificate, verify
from wiggleroom.verify.chord_check import Material
from wiggleroom.verify.work_limit import WorkLimit


def sealed(content):
    """A changed certificate that says it was not changed."""
    rest = {k: v for k, v in content.items() if k != "sha256"}
    return rest | {"sha256": hashlib.sha256(json.dumps(rest).encode()).hexdigest()}


@pytest.fixture(scope="module")
def proven():
    """A chain of three swallowtails, its answer with a proof, and the certificate as read from a file."""
    answer = wr.prove(
        wr.flex(assemble(row_of([blocks.block("swallowtail", 0.02)] * 3), gap=0.0), search=0), 0.02, certify=True
    )
    return answer, json.loads(json.dumps(answer.bound.certificate))


@pytest.mark.parametrize(("joint", "n"), [("swallowtail", 10), ("tee", 3)])
def test_chains_verify_and_hold_the_true_optimum(joint, n):
    assembly = assemble(row_of([blocks.block(joint, 0.03)] * n), gap=0.0)
    answer = wr.prove(wr.flex(assembly, search=0), 0.01, certify=True)
    content = json.loads(json.dumps(answer.bound.certificate))
    found = verify(content)
    assert found.proven, found.why
    assert answer.at_most <= found.at_most * (1 + 1e-12)  # what was known before may be nearer
    assert found.at_most <= 1.01 * answer.objective
    if n == 10:
        value, accuracy = chain.stored(joint, 0.03, n)
        assert found.at_most >= value - accuracy


def test_a_certificate_takes_no_nearer_bound_away():
    answer = wr.flex(assemble(row_of([blocks.block("swallowtail", 0.02)] * 2), gap=0.0))
    assert answer.verdict == "proven"
    assert answer.at_most <= 1.001 * answer.objective
    proven = wr.prove(answer, 0.5, certify=True)
    assert proven.bound.certificate["at_most"] > 1.001 * answer.objective
    assert proven.verdict == "proven"
    assert proven.at_most == answer.at_most
    assert proven.bound.within == pytest.approx(answer.at_most / answer.objective - 1)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["grid", "hook", "jigsaw", "seed 3"])
def test_more_certificates_verify(kind):
    if kind == "grid":
        made = wr.patterns.grid(3, 3, joint="tee", gap=0.01)
        assembly = assemble(made.drawing, goals=[wr.Pull(made.names[-1], (0, 1))])
    elif kind in blocks.JOINTS:
        assembly = assemble(row_of([blocks.block(kind, 0.03 if kind != "round" else 0.01)] * 4), gap=0.0)
    elif kind.startswith("seed"):
        assembly = random_chain(int(kind[5:]), 4, 0.01)
    else:
        made = wr.patterns.chain(4, joint=kind, gap=0.02)
        assembly = assemble(made.drawing, goals=[wr.Pull(made.names[-1], (0, 1))])
    answer = wr.prove(wr.flex(assembly, search=0), 0.02, certify=True, seconds=300)
    found = verify(answer.bound.certificate)
    assert found.proven, found.why
    assert answer.at_most <= 1.021 * answer.objective


def refused(text):
    """Whether the file of a certificate does not verify; one that is no JSON any more does not either."""
    try:
        return not verify(read_certificate(text)).proven
    except (ValueError, Refused):
        return True


def with_digit(text, k, rng):
    """The text with another digit at place k."""
    return text[:k] + rng.choice([d for d in "0123456789" if d != text[k]]) + text[k + 1 :]


def test_the_file_verifies_as_it_was_written(proven):
    assert not refused(json.dumps(proven[1]) + "\n")


@pytest.mark.parametrize("seed", range(10))
def test_one_digit_changed_anywhere_is_refused(proven, seed):
    text, rng = json.dumps(proven[1]), random.Random(seed)
    k = rng.choice([k for k, c in enumerate(text) if c.isdigit()])
    assert refused(with_digit(text, k, rng))


@pytest.mark.parametrize("seed", range(8))
def test_one_digit_of_the_proof_changed_and_sealed_says_nothing_false(proven, seed):
    """Without the checksum the mathematics alone: what still verifies is not below the truth."""
    answer, content = proven
    rng = random.Random(seed)
    key = rng.choice(["regions", "pairs", "proof", "at_most", "worth"])
    text = json.dumps(content[key])
    k = rng.choice([k for k, c in enumerate(text) if c.isdigit()])
    try:
        other = sealed(content | {key: json.loads(with_digit(text, k, rng))})
    except ValueError:
        return
    found = verify(other)
    assert not found.proven or found.at_most >= answer.objective * (1 - 1e-9)


def numbers(node, path=()):
    """Places of all numbers of a certificate."""
    if isinstance(node, dict):
        return [p for k, v in node.items() for p in numbers(v, (*path, k))]
    if isinstance(node, list):
        return [p for k, v in enumerate(node) for p in numbers(v, (*path, k))]
    return [path] if isinstance(node, int | float) and not isinstance(node, bool) else []


def changed(content, path, value):
    made = copy.deepcopy(content)
    node = made
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = value
    return sealed(made)


STATEMENT = ("bodies", "goal", "gap")
"""What the statement is about: another outline or goal is another question, which only the drawing can tell apart."""


def test_a_changed_proof_says_nothing_false(proven):
    """Numbers of regions, pairs and multipliers, changed and sealed again: whatever verifies is not below the truth."""
    answer, content = proven
    rng = random.Random(1)
    places = [p for p in numbers(content) if p[0] not in STATEMENT]
    truth = answer.objective
    refused = 0
    for path in rng.sample(places, 20):
        node = content
        for key in path:
            node = node[key]
        if isinstance(node, int):
            value = node + rng.choice([-1, 1])
        else:
            value = node * rng.choice([-1.0, 0.5, 0.99, 1.01, 2.0]) + rng.choice([0.0, 1e-3])
        found = verify(changed(content, path, value))
        refused += not found.proven
        assert not found.proven or found.at_most >= truth
    assert refused > 20 / 3


def test_chords_lie_inside():
    square = Material([[[[0, 0], [4, 0], [4, 4], [0, 4]], [[1, 1], [1, 2], [2, 2], [2, 1]]]], WorkLimit(16))
    square.check((point([0.5, 0.5]), point([3.5, 0.5])))
    for start, end in (
        ([0.5, 0.5], [4.5, 0.5]),
        ([0.5, 1.5], [3, 1.5]),
        ([1.2, 1.2], [1.7, 1.7]),
        ([5, 5], [6, 6]),
        ([0, 0], [4, 0]),
    ):
        with pytest.raises(Refused):
            square.check((point(start), point(end)))


def test_highest_is_above_all_samples():
    rng = np.random.default_rng(0)
    for _ in range(300):
        a, b, c = rng.standard_normal(3) * rng.choice([0.0, 1e-3, 1.0, 10.0], 3)
        low = rng.uniform(-7, 7)
        high = low + rng.choice([0.0, 1e-6, 0.3, 2.0, 8.0])
        t = np.linspace(low, high, 4001)
        seen = (a * np.cos(t) + b * np.sin(t) + c * t).max()
        top = highest(*(flint.arb(float(v)) for v in (a, b, c, low, high)))
        assert float(top.upper()) >= seen - 1e-12
        assert float(top.upper()) <= seen + 1e-4


def test_commands(tmp_path, capsys, command):
    file, proof, other = (tmp_path / name for name in ("chain.json", "proof.json", "other.json"))
    assert command("make", "chain", "3", "--joint", "swallowtail", "--gap", "0.02", "-o", file) == 0
    assert command("flex", file, "--prove", "0.02", "--certificate", proof) == 0
    assert command("verify", proof, file) == 0
    assert "verified: no motion of b3" in capsys.readouterr().out
    assert command("make", "chain", "3", "--joint", "swallowtail", "--gap", "0.03", "-o", other) == 0
    assert command("verify", proof, other) == 1
    assert "other outlines" in capsys.readouterr().out
    text = proof.read_text()
    proof.write_text(text.replace('"worth": 0.', '"worth": 0.0', 1))
    assert command("verify", proof) == 1
    for wrong in (["verify", file], ["verify", tmp_path / "none"], ["flex", file, "--certificate", other]):
        assert command(*wrong) == 2
    proof.write_text(text[:1000])
    assert command("verify", proof) == 2


SLIDER = Path(__file__).parents[1] / "examples" / "13_slider" / "slider.dxf"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "others"),
    [
        (["--turn", "b3:ccw"], ["--turn", "b3:cw"]),
        (["--glue", "b2,b3", "--pull", "b3:+y"], ["--pull", "b3:+y"]),
        (["--pull", "b3:+y", "--pull", "b2:+x"], ["--pull", "b3:+y"]),
        (["--pull", "b3:+y", "--turn", "b2:cw"], ["--pull", "b3:+y", "--turn", "b2:ccw"]),
    ],
)
def test_of_a_chain(options, others, tmp_path, command, capsys):
    chain, proof = tmp_path / "chain.json", tmp_path / "proof.json"
    assert command("make", "chain", 3, "--joint", "swallowtail", "--gap", 0.02, "-o", chain) == 0
    assert command("flex", chain, *options, "--prove", 0.02, "--certificate", proof) == 0
    capsys.readouterr()
    assert command("verify", proof, chain, *options) == 0
    assert capsys.readouterr().out.startswith("verified: ")
    assert command("verify", proof, chain, *others) == 1
    assert capsys.readouterr().out.startswith("not verified: ")


@pytest.mark.slow
def test_of_a_dxf_drawing(tmp_path, command, capsys):
    proof = tmp_path / "proof.json"
    options = ["--gap", 0.2, "--pull", "slider:+x"]
    assert command("flex", SLIDER, *options, "--prove", 0.02, "--certificate", proof) == 0
    capsys.readouterr()
    assert command("verify", proof, SLIDER, *options) == 0
    assert "13.05" in capsys.readouterr().out
    assert command("verify", proof, SLIDER, "--gap", 0.3, "--pull", "slider:+x") == 1


def test_a_skin_with_a_hole_is_refused(proven):
    region = proven[1]["regions"][0]
    check_caging_surface(region)
    middle = len(region["loops"]) // 2
    for share in (0.9, -1.0):  # inside the walls
        bad = copy.deepcopy(region)
        bad["loops"][middle][1][0] = [share * v for v in bad["loops"][middle][1][0]]
        with pytest.raises(Refused):
            check_caging_surface(bad)
    bad = copy.deepcopy(region)
    del bad["loops"][middle], bad["seams"][middle]
    with pytest.raises(Refused):
        check_caging_surface(bad)
    bad = copy.deepcopy(region)  # moved away from rest as a whole
    for loop in bad["loops"]:
        loop[1] = [[x + 1, y] for x, y in loop[1]]
    with pytest.raises(Refused):
        check_caging_surface(bad)


def test_multipliers_count(proven):
    """All multipliers halved: the bound that they prove is another."""
    content = copy.deepcopy(proven[1])

    def halve(step):
        for row in [step["best"]] if "best" in step else [cut[3] for cut in step["cuts"]]:
            row[0] /= 2
        for then in step.get("then", []):
            halve(then)

    halve(content["proof"])
    assert not verify(sealed(content)).proven


@pytest.mark.parametrize("share", [0.5, 0.9, 0.999])
def test_less_than_was_proven_is_refused(proven, share):
    answer, content = proven
    assert not verify(changed(content, ("at_most",), share * answer.objective)).proven
    low = changed(content, ("at_most",), share * answer.objective)
    assert not verify(changed(low, ("worth",), share * answer.objective)).proven


def test_smaller_parts_are_refused(proven):
    """Chords that stick out of the outlines prove nothing."""
    content = copy.deepcopy(proven[1])
    body = content["bodies"][1]
    middle = np.mean(body["polygons"][0][0], axis=0)
    body["polygons"] = [
        [(middle + 0.99 * (np.array(ring) - middle)).tolist() for ring in rings] for rings in body["polygons"]
    ]
    assert not verify(sealed(content)).proven
