"""tighten, sweep and sample, against closed forms, against all choices, and against asking again from nothing."""

from __future__ import annotations

import threading
from dataclasses import replace
from itertools import combinations, pairwise

import numpy as np
import pytest
from scipy import stats

import wiggleroom as wr
from tests.flexing import box, polygon_part, slot
from tests.oracle import blocks, chain
from tests.oracle.slices import Slices
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import JointGap
from wiggleroom.sensitivity.gap_distribution import wilson


def rectangle(left: float, low: float, right: float, high: float) -> np.ndarray:
    """Its corners (4, 2) [mm], counter-clockwise."""
    return np.array([(left, low), (right, low), (right, high), (left, high)], dtype=float)


# -- tighten --------------------------------------------------------------------------------------------------------


def test_eleven_parts_of_the_frame_take_most_of_the_motion() -> None:
    found = wr.tighten(wr.patterns.frame(15, 15, gap=0.01), parts=11, draws=12, workers=1)
    assert len(set(found.chosen)) == 11
    assert found.lowered >= 50
    assert found.lowered_at_random < found.lowered / 2
    assert found.after.collision_free


def everything(assembly: wr.Assembly, count: int, outward: float) -> dict[tuple[str, ...], float]:
    """Motion with every choice of so many parts made larger."""
    found = {}
    for chosen in combinations(assembly.names, count):
        value = wr.flex(assemble(assembly.drawing, offset=dict.fromkeys(chosen, outward)), search=0).objective
        assert value is not None
        found[chosen] = value
    return found


def test_no_other_choice_of_two_is_better() -> None:
    assembly = wr.patterns.chain(5, joint="swallowtail", gap=0.02)
    found = wr.tighten(assembly, parts=2, draws=0)
    assert found.after.objective <= min(everything(assembly, 2, 0.009).values()) * (1 + 1e-6)


def test_no_fewer_parts_keep_the_limit() -> None:
    assembly = wr.patterns.jigsaw(3, 2, gap=0.01, seed=2)
    before = wr.flex(assembly, search=0).objective
    assert before is not None
    found = wr.tighten(assembly, limit=0.5 * before, draws=0)
    assert found.reached
    assert found.after.objective <= 0.5 * before
    fewer = everything(assembly, len(found.chosen) - 1, 0.0045)
    assert min(fewer.values()) > 0.5 * before


def test_a_limit_that_nothing_reaches_is_said_so() -> None:
    found = wr.tighten(wr.patterns.chain(3, gap=0.02), limit=1e-6, draws=0)
    assert not found.reached
    assert len(found.chosen) == 3


def test_parts_that_have_no_room_are_not_chosen() -> None:
    made = wr.patterns.chain(6, joint="tee", gap=0.02)
    tight = replace(made.drawing, gaps=(JointGap(("b1", "b2"), 0.002),))
    found = wr.tighten(assemble(tight, gap=0.02, goals=[wr.Pull("b4", (0, 1))]), parts=6, draws=3, workers=1)
    assert found.chosen == ("b3", "b4", "b5", "b6"), "the joint b1-b2 is as tight as the others shall be"


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({}, "how many parts, or the limit"),
        ({"parts": 1, "limit": 1.0}, "how many parts, or the limit"),
        ({"parts": 0}, "choose 1 to 3"),
        ({"parts": 4}, "choose 1 to 3"),
        ({"limit": -1.0}, "more than 0"),
        ({"limit": float("nan")}, "more than 0"),
        ({"parts": 1, "gap": 0.02}, "less than the present gap"),
    ],
)
def test_tighten_refuses(asked: dict[str, float], said: str) -> None:
    with pytest.raises(wr.InputError, match=said):
        wr.tighten(wr.patterns.chain(3, gap=0.02), **asked)


# -- sweep ----------------------------------------------------------------------------------------------------------


def test_sweep_is_what_flex_says_for_each_gap() -> None:
    drawing = wr.patterns.chain(5, joint="dovetail", gap=0.02).drawing
    found = wr.sweep(assemble(drawing), [0.03, 0.01, 0.02, 0.015])
    assert [s.gap for s in found.steps] == [0.01, 0.015, 0.02, 0.03]
    for step in found.steps:
        assert step.objective == pytest.approx(wr.flex(assemble(drawing, gap=step.gap), search=0).objective, rel=1e-6)
        assert step.checked
    assert found.lost is None


def test_a_proven_band_holds_the_true_curve() -> None:
    """Between two gaps as well: the truth of another program lies above the lower motion and below the bound of the larger gap."""
    pytest.importorskip("highspy")
    assembly = wr.patterns.chain(3, joint="tee", gap=0.01)
    found = wr.sweep(assembly, [0.01, 0.014, 0.02], wr.Pull("b3", (0, 1)), prove=0.005)
    for step in found.steps:
        assert step.objective <= step.at_most <= 1.0051 * step.objective
    for one, other in pairwise(found.steps):
        gap = (one.gap + other.gap) / 2
        made = blocks.block("tee", gap)
        truth = chain.reach(Slices(made, made, (1.0, 0.0)), 3, (0.0, 1.0), cells=60).value
        assert one.objective <= truth <= other.at_most


def test_no_band_in_space_and_none_of_nonsense() -> None:
    solid = wr.read("examples/43_mortise_and_tenon/joint.json")
    with pytest.raises(wr.InputError, match="drawings only"):
        wr.sweep(solid, [0.1], prove=0.01)
    with pytest.raises(wr.InputError, match="it must be"):
        wr.sweep(wr.patterns.chain(2), [0.01], prove=0.0)


def caged_bolt(*others: wr.Part) -> wr.Assembly:
    """A bolt pulled against a wall, below a mouth 0.2 mm narrower than itself, by which it leaves from a gap of 0.1 mm on."""
    inside = [(4.9, 5), (4.9, 3), (5, 3), (5, -5), (-5, -5), (-5, 3), (-4.9, 3), (-4.9, 5)]
    cage = [(-10, -8), (10, -8), (10, 5), *inside, (-10, 5)]
    parts = polygon_part("cage", cage, fixed=True), box("bolt", -5, -5, 5, 3)
    return assemble(wr.Drawing((*parts, *others), 0.05, goals=(wr.Pull("bolt", (1, 0)),)))


def test_a_sweep_finds_the_way_out_that_does_not_begin_where_the_motion_ends() -> None:
    found = wr.sweep(caged_bolt(), [0.05, 0.09, 0.12, 0.5])
    assert [s.verdict == "unbounded" for s in found.steps] == [s.gap > 0.1 for s in found.steps]
    assert [s.objective for s in found.steps[:2]] == pytest.approx([0.05, 0.09])
    assert found.lost is not None
    assert found.lost[0] <= 0.1 * (1 + 1e-6)
    assert 0.1 * (1 - 1e-9) <= found.lost[1] < 0.1003


@pytest.mark.slow
def test_the_largest_gap_that_is_searched_is_one_at_which_parts_can_be_made() -> None:
    """A needle beside the bolt vanishes at a gap of 0.4 mm; where the bolt leaves, what cannot be made does not."""
    found = wr.sweep(caged_bolt(box("needle", 20, 0, 20.4, 5, fixed=True)), [0.05, 0.2, 0.5])
    assert [s.verdict for s in found.steps[1:]] == ["unbounded", "cannot be made"]
    assert found.lost is not None
    assert found.lost[0] < 0.2
    assert 0.1 <= found.lost[1] <= 0.2


class LaterStop:
    """Is set from the second time on that it is asked once `armed`."""

    def __init__(self) -> None:
        self.armed, self.asked = False, 0

    def is_set(self) -> bool:
        self.asked += self.armed
        return self.asked > 1


def test_a_sweep_that_is_stopped_where_it_searches_again_keeps_what_it_found() -> None:
    stop = LaterStop()

    def progress(done: int, total: int) -> None:
        stop.armed = done == total

    found = wr.sweep(caged_bolt(), [0.05, 0.07, 0.09, 0.2], stop=stop, progress=progress)
    assert [s.objective for s in found.steps[:3]] == pytest.approx([0.05, 0.07, 0.09])
    assert all(s.verdict.ends for s in found.steps[:3])
    assert found.lost is not None
    assert found.lost[0] == 0.09
    assert 0.1 < found.lost[1] <= 0.2  # the path out may have been followed a little before it was stopped


@pytest.mark.parametrize("gaps", [[], [-0.1], [float("nan")], [float("inf")]])
def test_sweep_refuses(gaps: list[float]) -> None:
    with pytest.raises(wr.InputError):
        wr.sweep(wr.patterns.chain(3, gap=0.02), gaps)


def test_gaps_that_cannot_be_made_or_touch_are_said() -> None:
    found = wr.sweep(wr.patterns.chain(2, joint="dovetail", gap=0.02), [0.0, 0.02, 0.2])
    assert found.steps[0].verdict == "touching"
    assert found.steps[1].objective is not None
    assert found.steps[2].verdict == "cannot be made"


# -- sample ---------------------------------------------------------------------------------------------------------


def test_every_draw_of_the_slot_is_its_closed_form() -> None:
    found = wr.sample(assemble(slot()), 0.05, draws=60, limit=0.32, workers=1)
    left, right, block, *_ = found.extra.T
    exact = 0.3 + (right + block) / 2
    misfit = (exact <= 0) | (0.2 + (left + block) / 2 <= 0)
    assert (np.isnan(found.value) == misfit).all()
    assert found.value[~misfit] == pytest.approx(exact[~misfit], abs=1e-6)
    assert found.good == ((exact <= 0.32) & ~misfit).sum()
    assert found.contributions == pytest.approx([0, 50, 50, 0, 0], abs=1e-3)
    assert found.foreseen == pytest.approx(0.05 / np.sqrt(2), rel=1e-4)
    assert not found.undecided.any()
    assert found.value[found.worst] == np.nanmax(found.value)


def test_parts_that_do_not_fit_are_counted_and_fail() -> None:
    found = wr.sample(
        assemble(slot()), wr.Spread(0.15, "uniform", sheet=1.0, bias=-0.15), draws=60, limit=10.0, workers=1
    )
    assert found.misfits == (found.extra[:, 0] <= -0.2).sum() > 0
    assert found.good == 60 - found.misfits


def test_draws_on_a_jigsaw_are_what_flex_says() -> None:
    assembly = wr.patterns.jigsaw(3, 2, gap=0.012, seed=8)
    found = wr.sample(assembly, wr.Spread(0.002, "truncated", sheet=0.4), draws=4, seed=5, workers=1)
    for value, extra in zip(found.value, found.extra, strict=True):
        offset = dict(zip(assembly.names, (-extra / 2).tolist(), strict=True))
        assert value == pytest.approx(wr.flex(assemble(assembly.drawing, offset=offset), search=0).objective, rel=1e-3)
    assert not found.undecided.any()
    assert found.tightest <= found.value.min() <= found.value.max() <= found.loosest


def test_the_spread_is_foreseen_by_the_ranking() -> None:
    found = wr.sample(wr.patterns.chain(4, gap=0.02), wr.Spread(0.001, sheet=0.7), draws=100, workers=1)
    assert found.bounded.std(ddof=1) == pytest.approx(found.foreseen, rel=0.2)


@pytest.mark.parametrize("kind", ["normal", "uniform", "truncated"])
def test_lots_are_distributed_as_they_say(kind: str) -> None:
    lot = wr.Spread(0.1, kind, sheet=0.5, bias=0.02)
    drawn = lot.draw(4000, 3, seed=1)
    truth = {
        "normal": stats.norm(0.02, 0.1),
        "uniform": stats.uniform(-0.08, 0.2),
        "truncated": stats.truncnorm(-2, 2, loc=0.02, scale=0.1),
    }[kind]
    for column in drawn.T:
        assert stats.kstest(column, truth.cdf).pvalue > 1e-3
    assert lot.deviation == pytest.approx(truth.std(), rel=1e-6)
    assert stats.spearmanr(drawn[:, 0], drawn[:, 1]).statistic == pytest.approx(6 / np.pi * np.arcsin(0.25), abs=0.05)
    assert (lot.draw(10, 3, seed=1) == drawn[:10]).all()


def test_wilson_holds_as_often_as_it_says() -> None:
    rng, share, count = np.random.default_rng(0), 0.93, 60
    inside = [
        low <= share <= high for low, high in (wilson(int(rng.binomial(count, share)), count) for _ in range(2000))
    ]
    assert np.mean(inside) == pytest.approx(0.95, abs=0.02)
    truth = stats.binomtest(57, 60).proportion_ci(method="wilson")
    assert wilson(57, 60) == pytest.approx((truth.low, truth.high))


def test_sample_refuses_nonsense() -> None:
    for make, said in (
        *(
            (lambda wide=wide: wr.sample(assemble(slot()), wide), "spread")
            for wide in (0.0, -1.0, float("nan"), float("inf"))
        ),
        (lambda: wr.Spread(0.1, "cauchy"), "distribution"),
        (lambda: wr.Spread(0.1, sheet=1.5), "correlation"),
        (lambda: wr.Spread(0.1, bias=float("nan")), "bias"),
        (lambda: wr.sample(assemble(slot()), 0.1, draws=0), "at least 1"),
        (lambda: wr.sample(assemble(slot()), 0.1, limit=float("nan")), "limit"),
    ):
        with pytest.raises(wr.InputError, match=said):
            make()


def test_a_stopped_sample_says_what_it_has() -> None:
    stop = threading.Event()
    found = wr.sample(
        assemble(slot()), 0.01, draws=30, workers=1, stop=stop, progress=lambda done, _: stop.set() if done == 7 else None
    )  # fmt: skip
    assert len(found.value) == 7
    assert found.asked == 30


def test_the_tightened_motion_is_that_of_parts_made_so() -> None:
    assembly = wr.patterns.chain(5, joint="tee", gap=0.01)
    found = wr.tighten(assembly, parts=2, gap=0.004, draws=0)
    made = assemble(assembly.drawing, offset=dict.fromkeys(found.chosen, 0.003))
    assert found.after.objective == pytest.approx(wr.flex(made).objective, rel=1e-6)


def test_of_parts_that_share_a_load_the_one_that_takes_most_is_chosen() -> None:
    """A block that tilts between two walls until another one stops it: its own gap counts twice, but only where it gets less."""
    tray = wr.Part("tray", (wr.Region(rectangle(0, 0, 30, 20), (rectangle(5, 5, 25, 15)[::-1],)),), fixed=True)
    block, other = (
        wr.Part(n, (wr.Region(rectangle(x, 5, y, 15)),)) for n, x, y in (("block", 5, 14), ("other", 14, 22))
    )
    goal = wr.Pull("block", (1, 0))
    assembly = assemble(wr.Drawing((tray, block, other), gap=0.2, goals=(goal,)))
    found = wr.tighten(assembly, parts=1, draws=0)
    assert found.after.objective <= min(everything(assembly, 1, 0.09).values()) * (1 + 1e-6)
