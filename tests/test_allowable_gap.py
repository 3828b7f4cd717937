"""The gap that answers a maker's question, against closed forms, exact chains, and collisions worked out by shapely."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from threading import Event

import numpy as np
import pytest
import shapely
from shapely import affinity

import wiggleroom as wr
from tests.flex_truth import Ground, value_of
from tests.flexing import polygon_part, row_of
from tests.oracle import blocks, chain
from wiggleroom.assembly.build import assemble
from wiggleroom.context import Context
from wiggleroom.deadline import Deadline
from wiggleroom.drawing import write_drawing
from wiggleroom.drawing.model import Drawing, JointGap, Part, Pull, Region, Translation
from wiggleroom.sensitivity.motion_border import MotionBorder
from wiggleroom.sensitivity.planar_study import PlanarStudy
from wiggleroom.verdict import Certainty

PEG = np.array([[-5.0, -5.0], [5.0, -5.0], [5.0, 5.0], [-5.0, 5.0]])


def peg_in_slot(right: float = 3.0, side: float = 0.0, name: str = "peg") -> Drawing:
    """A peg of 10 x 10 mm in a slot that leaves `right` to its right and `side` on the other sides, as drawn."""
    hole = np.array([[-5 - side, -5 - side], [-5 - side, 5 + side], [5 + right, 5 + side], [5 + right, -5 - side]])
    rim = np.array([[-20.0, -20.0], [20.0, -20.0], [20.0, 20.0], [-20.0, 20.0]])
    parts = (Part("rim", (Region(rim, (hole,)),), fixed=True), Part(name, (Region(PEG),)))
    return Drawing(parts, goals=(Pull(name, (1.0, 0.0)),))


def row(joint: str, count: int, gap: float = 0.0) -> wr.Assembly:
    """A chain of blocks drawn without gap."""
    return assemble(row_of([blocks.block(joint, 0.0)] * count), gap=gap)


@pytest.mark.parametrize("limit", [3.1, 4.9])
def test_a_peg_moves_by_its_room_and_the_gap(limit: float) -> None:
    found = wr.allowable_gap(assemble(peg_in_slot(), gap=0.05), at_most=limit)
    truth = limit - 3.0
    assert found.gap is not None
    assert found.beyond is not None
    assert found.gap <= truth < found.beyond
    assert found.beyond - found.gap <= 0.011 * truth
    assert found.searched_gap == pytest.approx(truth, rel=1.1e-3)


@pytest.mark.parametrize(
    ("joint", "count", "gap"),
    [("tee", 2, 0.01), ("swallowtail", 2, 0.03), pytest.param("swallowtail", 10, 0.03, marks=pytest.mark.slow)],
)
def test_a_chain_whose_optimum_is_known(joint: str, count: int, gap: float) -> None:
    value, accuracy = chain.stored(joint, gap, count)
    found = wr.allowable_gap(row(joint, count, 0.017), at_most=value + accuracy)
    assert found.gap is not None
    assert found.beyond is not None
    assert found.gap <= gap * (1 + 1e-4)  # never above the truth: there is a motion beyond the limit there
    assert found.gap >= 0.985 * gap
    assert found.beyond >= gap * (1 - 1e-9)


@pytest.mark.slow
def test_a_bound_of_a_smaller_gap_is_none_of_a_larger_one() -> None:
    """Where a search falls short, what a smaller gap has shown stands in for it, but not what was proven there."""

    class Halfway(PlanarStudy):
        def flexed(self, search, context):  # type: ignore[no-untyped-def]
            found = super().flexed(search, context)
            if self.assembly.gap < 0.3 or found.objective is None:
                return found
            return replace(found, objective=found.objective / 2, motion=found.motion / 2, at_most=None, bound=None)

    drawing = peg_in_slot()
    model = Halfway(assemble(drawing, gap=0.25), drawing.goals)
    found = MotionBorder(model, 3.5, Context(stop=Deadline(60.0, None))).enclose()
    assert found.gap is not None
    assert found.gap > 1.0  # the search misses that it moves further
    assert found.certainty is Certainty.SEARCHED
    for trial in found.trials:
        assert trial.at_most is None or trial.at_most >= 3.0 + trial.gap - 1e-9


def test_the_state_beyond_is_a_motion_past_the_limit_that_is_free_of_collisions() -> None:
    found = wr.allowable_gap(row("swallowtail", 3, 0.02), at_most=0.4)
    (trial,) = [t for t in found.trials if t.gap == found.beyond]
    answer = trial.answer
    assert answer is not None
    made = assemble(found.assembly.drawing, gap=found.beyond)
    assert value_of(made, made.goals, answer.motion[None])[0] > 0.4
    assert Ground(made).free_of_overlap(answer.waypoints).all()


def test_a_limit_that_even_the_drawing_breaks() -> None:
    found = wr.allowable_gap(assemble(peg_in_slot(side=0.2), gap=0.1), at_most=2.0)
    assert found.gap is None
    assert found.beyond is not None
    assert "no gap keeps the limit" in found.why


def test_what_nothing_stops_has_no_gap() -> None:
    parts = (polygon_part("a", PEG, fixed=True), polygon_part("b", PEG + np.array([10.0, 0.0])))
    found = wr.allowable_gap(assemble(Drawing(parts, goals=(Pull("b", (1.0, 0.0)),)), gap=0.1), at_most=5.0)
    assert found.gap is None
    assert "nothing stops it" in found.why


def test_a_sum_of_squares_is_searched_and_says_so() -> None:
    found = wr.allowable_gap(assemble(peg_in_slot(), gap=0.1), Translation(), at_most=3.3**2)
    assert found.gap is not None
    assert found.certainty is Certainty.SEARCHED
    # the end of the slot, and half of the play across: (3 + g)^2 + g^2 / 4 cannot be met from its middle only
    assert (3 + found.gap) ** 2 <= 3.3**2


@pytest.mark.slow
def test_a_joint_of_its_own_gap_stays() -> None:
    drawing = replace(peg_in_slot(), gaps=(JointGap(("rim", "peg"), 0.4),))
    found = wr.allowable_gap(assemble(drawing, gap=0.1), Pull("peg", (-1.0, 0.0)), at_most=0.5)
    assert found.gap is not None
    assert found.gap > 1
    assert found.beyond is None  # on the left the joint's own gap stays, whatever the gap is
    assert found.why


@pytest.mark.parametrize(
    ("larger", "side", "truth"), [(0.1, 0.0, 0.2), (0.3, 0.2, 0.4), (0.1, 0.2, 0.0), (0.0, 0.0, 0.0)]
)
def test_the_smallest_gap_that_fits(larger: float, side: float, truth: float) -> None:
    found = wr.allowable_gap(assemble(peg_in_slot(right=3.0, side=side), gap=0.5), fits=larger)
    assert found.gap == pytest.approx(truth, rel=2e-6, abs=1e-9)
    assert found.certainty is Certainty.PROVEN


@pytest.mark.parametrize("seed", range(4))
def test_fits_of_slanted_parts_by_shapely(seed: int) -> None:
    rng = np.random.default_rng(seed)
    one = shapely.Point(0, 0).buffer(10, quad_segs=2)
    turned = affinity.rotate(affinity.translate(one, 20.5, rng.uniform(-4, 4)), rng.uniform(0, 45), origin="center")
    parts = tuple(
        polygon_part(name, np.array(shape.exterior.coords)[:-1], fixed=name == "a")
        for name, shape in (("a", one), ("b", turned))
    )
    larger = float(rng.uniform(0.5, 2.0))
    found = wr.allowable_gap(assemble(Drawing(parts), gap=2.0), fits=larger)
    assert found.gap is not None

    def area(gap: float) -> float:
        a, b = (s.buffer(larger - gap / 2, join_style="mitre", mitre_limit=50) for s in (one, turned))
        return float(a.intersection(b).area)

    assert area(found.gap * (1 + 1e-5)) == pytest.approx(0, abs=1e-9)
    assert found.gap == 0 or area(found.gap * 0.999) > 0


def test_no_gap_holds_what_slides_apart() -> None:
    found = wr.allowable_gap(wr.patterns.chain(2, joint="finger", gap=0.02), holds=True)
    assert found.gap is None
    assert found.beyond is not None


@pytest.mark.slow
def test_holds_agrees_with_the_largest_gap() -> None:
    assembly = wr.patterns.chain(2, joint="tee", gap=0.05)
    found, border = wr.allowable_gap(assembly, holds=True), wr.largest_gap(assembly)
    assert (found.gap, found.beyond) == (border.holds, border.parts_at)
    assert wr.check(assemble(assembly.drawing, gap=found.beyond)).verdict == "comes apart"


def test_it_stops_with_the_best_so_far() -> None:
    stop = Event()
    stop.set()
    found = wr.allowable_gap(row("tee", 3, 0.02), at_most=0.3, stop=stop)
    assert found.stopped
    assert found.certainty is not Certainty.PROVEN
    late = wr.allowable_gap(row("tee", 3, 0.02), at_most=0.3, seconds=1e-6)
    assert late.stopped


def test_no_gap_fits_at_which_the_drawn_parts_are_gone() -> None:
    """Outlines 6 mm larger fit at a gap of 12 mm, which leaves nothing of a peg of 10 mm."""
    found = wr.allowable_gap(assemble(peg_in_slot(right=3.0), gap=0.5), fits=6.0)
    assert found.gap is None
    assert "fall to pieces" in found.why


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        ({}, ""),
        ({"at_most": 1.0, "holds": True}, ""),
        ({"at_most": 0.0}, ".*more than 0"),
        ({"fits": math.nan}, ".*0 or more"),
    ],
)
def test_questions_that_make_no_sense(wrong: dict[str, float], right: str) -> None:
    with pytest.raises(wr.InputError, match=f"gap: {right}"):
        wr.allowable_gap(row("tee", 2, 0.02), **wrong)  # type: ignore[arg-type]


def test_the_command_answers_in_the_offset_of_the_cutter(
    command: Callable[..., int], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    write_drawing(peg_in_slot(), tmp_path / "peg.json")
    places = [tmp_path / f"out.{kind}" for kind in ("json", "svg", "csv", "html")]
    code = command(
        "gap", tmp_path / "peg.json", "--at-most", 3.2, "--kerf", 0.15, "--gap", 0.1, "--json", places[0],
        "--picture", places[1], "--csv", places[2],
    )  # fmt: skip
    assert code == 0
    told = json.loads(places[0].read_text())
    assert told["offset"] == pytest.approx((0.15 - told["gap"]) / 2)
    assert told["gap"] <= 0.2 < told["beyond"]
    out = capfd.readouterr().out
    assert "inward, drawing as it is" in out
    assert "limit 3.2" in places[1].read_text()
    rows = places[2].read_text().splitlines()
    assert rows[0] == "gap,objective,at_most,verdict,path"
    for line in rows[1:]:  # the peg moves by its room and the gap
        gap, objective = map(float, line.split(",")[:2])
        assert objective == pytest.approx(3 + gap, rel=1e-6)
    assert command("gap", tmp_path / "peg.json", "--fits", 0.1, "--picture", places[3]) == 0
    assert command("gap", tmp_path / "peg.json") == 2
    assert "ask one question" in capfd.readouterr().err


def test_a_drawn_clearance_that_keeps_the_limit_without_any_gap() -> None:
    found = wr.allowable_gap(assemble(peg_in_slot(right=3.0, side=0.2), gap=1.0), at_most=3.05)
    assert found.gap is not None
    assert found.gap <= 0.05 < (found.beyond or math.inf)
