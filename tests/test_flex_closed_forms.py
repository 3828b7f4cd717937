"""The largest motion where it is known: exact formulas, and chains whose optimum a dynamic programme knows."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.flex_truth import check_safe
from tests.flexing import case_assembly, displaced, row_of
from tests.oracle import blocks, chain, closed_forms
from wiggleroom.assembly.build import assemble
from wiggleroom.bound.displacement_bound import furthest
from wiggleroom.drawing.read import write_drawing

BOUNDED = {f"{k} {case.name}": case for k, case in enumerate(closed_forms.bounded())}
UNBOUNDED = {case.name: case for case in closed_forms.unbounded()}
CLOSE = 1e-6
CHAINS = [(joint, gap, n) for joint in blocks.JOINTS for gap in chain.GAPS for n in chain.BLOCKS]
LOW = ("arrow", 0.03, 10)  # ends in another local optimum, as conftest says
PAPER = ("tee", "swallowtail")  # the chains that the figures are promised for


@pytest.mark.parametrize("name", BOUNDED)
def test_reaches_the_exact_value(name):
    case = BOUNDED[name]
    answer = wr.flex(case_assembly(case), search=0)
    check_safe(answer)
    assert answer.objective <= case.value * (1 + 1e-9)
    assert answer.objective >= case.value * (1 - CLOSE)
    assert case.objective(answer.motion) == pytest.approx(answer.objective, rel=1e-12, abs=1e-12)
    assert answer.verdict in ("proven", "optimal", "stationary")
    assert answer.path == "checked"


@pytest.mark.parametrize("name", UNBOUNDED)
def test_says_what_nothing_stops(name):
    answer = wr.flex(case_assembly(UNBOUNDED[name]), search=0)
    check_safe(answer)
    assert answer.verdict == "unbounded"
    assert answer.objective is None
    assert answer.path == "checked"
    assert (answer.leaves, answer.turns) == ((("p1",), ()) if name == "block on a floor" else ((), ("p1",)))


@pytest.mark.parametrize("s", [1.0, 25.0])
@pytest.mark.parametrize("c", [0.001, 0.02, 0.2])
def test_square_peg(s, c):
    shift = wr.flex(case_assembly(closed_forms.square_shift(s, c * s)), search=0)
    turn = wr.flex(case_assembly(closed_forms.square_turn(s, c * s)), search=0)
    assert shift.objective == pytest.approx(c * s, rel=CLOSE)
    assert turn.objective == pytest.approx(0.5 * math.asin((1 + 2 * c) ** 2 - 1), rel=CLOSE)


@pytest.mark.parametrize(("joint", "gap", "n"), CHAINS)
def test_chain_reaches_the_optimum(joint, gap, n):
    truth, accuracy = chain.stored(joint, gap, n)
    answer = wr.flex(assemble(drawn(joint, n), gap=gap), search=0)
    check_safe(answer)
    assert answer.path == "checked"
    assert answer.objective >= truth * 0.999
    assert answer.objective <= truth + accuracy + 1e-9 * n
    if joint in PAPER:
        assert answer.objective >= truth * (1 - CLOSE)
        assert answer.verdict in ("proven", "optimal")


@pytest.mark.parametrize(("joint", "gap", "n"), [case for k, case in enumerate(CHAINS) if k % 4 == 0 or case == LOW])
def test_chain_turned_and_far_away_is_the_same(joint, gap, n, tmp_path):
    """Turned by 37 degrees, 2,500 mm away, each outline in a frame of its own, the gap in the file."""
    file = tmp_path / "chain.json"
    write_drawing(far_away(joint, gap, n), file)
    answer = wr.flex(wr.read(file), search=0)
    check_safe(answer)
    assert answer.path == "checked"
    assert answer.objective == pytest.approx(wr.flex(assemble(drawn(joint, n), gap=gap), search=0).objective, rel=CLOSE)


def drawn(joint, n):
    return row_of([shapely.Polygon(blocks.outline(joint))] * n)


def far_away(joint, gap, n):
    return displaced(replace(drawn(joint, n), gap=gap), math.radians(37), (2500 * 0.6, 2500 * 0.8))


WAYS = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]


@pytest.mark.parametrize("made", ["jigsaw", "swallowtails"])
def test_no_motion_exceeds_it(made: str) -> None:
    assembly = (
        wr.patterns.jigsaw(3, 2, gap=0.5, pitch=40)
        if made == "jigsaw"
        else wr.patterns.chain(3, joint="swallowtail", gap=0.4, pitch=20)
    )
    most = furthest(assembly, 600_000)
    assert most is not None
    found = [wr.flex(assembly, wr.Pull(assembly.names[-1], way), search=0) for way in WAYS]
    reached = max(one.objective for one in found if one.objective is not None)
    assert 0 < reached <= most
    assert np.isfinite(most)
    assert most < 40 * reached
