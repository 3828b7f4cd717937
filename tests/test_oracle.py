"""The oracles against closed forms and against one another."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest
import shapely

from tests.oracle import blocks, chain, closed_forms, collision, random_joints
from tests.oracle.geometry import inset_polygon, turn
from tests.oracle.slices import Slices

ORACLE = Path(chain.__file__).parent
BOUNDED = closed_forms.bounded()


def _square(side: float, x: float = 0.0, y: float = 0.0) -> shapely.Polygon:
    return shapely.Polygon(closed_forms.rectangle(side, side, (x, y)))


def test_the_oracles_do_not_import_the_package():
    for path in ORACLE.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not any(n.split(".")[0] == "wiggleroom" for n in names), path


# -- collision ------------------------------------------------------------------------------------------------------


def test_depth_of_squares_is_what_one_can_see():
    samples = np.array([[0.9, 0.3, 0], [1.1, 0.3, 0], [0, 0, np.pi / 4], [3, 3, 1]])
    depths = collision.depths(_square(1), _square(1), samples, np.zeros(2))
    assert depths[[0, 1, 3]] == pytest.approx([0.1, 0, 0], abs=1e-15)
    assert depths[2] == pytest.approx(0.5)  # no corner inside: apothem of the common octagon


def test_crossing_bars_overlap_although_no_corner_is_inside():
    bars = [shapely.Polygon(closed_forms.rectangle(*size)) for size in ((4, 0.5), (0.5, 4))]
    assert collision.overlaps(*bars, np.zeros((1, 3)), np.zeros(2))[0]
    assert collision.depths(*bars, np.zeros((1, 3)), np.zeros(2))[0] == pytest.approx(0.25)


def test_a_part_inside_the_hole_is_free_and_inside_the_material_is_not():
    plate = closed_forms.frame(closed_forms.rectangle(1, 1), wall=1)
    peg = _square(0.2)
    samples = np.array([[0, 0, 0.3], [0.39, 0.39, 0], [0.41, 0, 0], [1, 0, 0.2], [2, 0, 0]])
    assert collision.overlaps(plate, peg, samples, np.zeros(2)).tolist() == [False, False, True, True, False]
    assert collision.overlaps(peg, plate, -samples * [1, 1, 0], np.zeros(2)).tolist() == [
        False,
        False,
        True,
        True,
        False,
    ]


@pytest.mark.parametrize("seed", range(4))
def test_overlap_agrees_with_areas(seed):
    rng = np.random.default_rng(seed)
    pair = (random_joints.tab_pair if seed % 2 else random_joints.peg_pair)(seed, 0.02, holes=seed > 1)
    A, B, D = pair.local()
    samples = rng.uniform(-1, 1, (1000, 3)) * np.where(rng.random((1000, 1)) < 0.5, 0.03, [1.2, 1.2, 3.0])
    found = collision.overlaps(A, B, samples, D)
    placed = [shapely.transform(B, lambda p, s=s: p @ turn(s[2]).T + D + s[:2]) for s in samples]
    assert np.array_equal(found, shapely.area(shapely.intersection(A, placed)) > 1e-14)
    assert 50 < found.sum() < 950


def test_free_allows_touching_up_to_the_depth():
    samples = np.array([[1 - 1e-7, 0.3, 0], [1 - 1e-10, 0.3, 0]])
    assert collision.free(_square(1), _square(1), np.zeros(2), samples, 1e-9).tolist() == [False, True]


# -- closed forms ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("case", BOUNDED, ids=lambda c: c.name)
def test_the_witness_reaches_the_value_and_is_free(case):
    assert case.objective(case.witness) == pytest.approx(case.value, rel=1e-12)
    assert collision.pose_depth([[p] for p in case.parts], case.at, case.witness) < 1e-12
    for share in np.linspace(
        0, 1, 21
    ):  # a straight path from rest is free in all these cases but for the slack of a pin
        depth = collision.pose_depth([[p] for p in case.parts], case.at, share * case.witness)
        assert depth < (1e-12 if case.name != "lever on a pin" else 1e-2)


@pytest.mark.parametrize("case", BOUNDED, ids=lambda c: c.name)
def test_no_free_sample_beats_the_value(case):
    rng = np.random.default_rng(1)
    n, count = len(case.parts), 30000
    size = np.abs(case.witness[1:]).max(axis=0) * 1.2 + 1e-3
    spread = np.where(rng.random((count, 1, 1)) < 0.5, 1, 10 ** rng.uniform(-6, 0, (count, 1, 1)))
    centre = np.where(rng.random((count, 1, 1)) < 0.3, 0, case.witness)
    motions = centre + spread * size * rng.uniform(-1, 1, (count, n, 3))
    motions = np.clip(motions, -size, size)  # what lies beyond may be free again, but out of reach
    motions[:, list(case.fixed)] = 0
    values = case.objective(motions)
    better = np.flatnonzero(values > case.value + 1e-9)
    near = np.flatnonzero(values > 0.9 * case.value)
    assert len(better) > 100  # the samples could have refuted it
    assert not np.any(_free_motions(case, motions[better]))
    assert np.any(_free_motions(case, motions[near]))


def _free_motions(case, motions):
    alive = np.ones(len(motions), dtype=bool)
    for i in range(len(case.parts)):
        for j in range(i + 1, len(case.parts)):
            relative = collision.relative_motion(case.at[i], case.at[j], motions[:, i], motions[:, j])
            local = [shapely.transform(case.parts[k], lambda p, k=k: p - case.at[k]) for k in (i, j)]
            alive &= collision.free(*local, case.at[j] - case.at[i], relative, 1e-12)
    return alive


@pytest.mark.parametrize("case", closed_forms.unbounded(), ids=lambda c: c.name)
def test_nothing_stops_an_unbounded_case(case):
    far = np.array([30, 100, 0]) if case.pulls else np.array([0, 0, 1])
    for share in np.linspace(0, 1, 50):
        motion = np.vstack([np.zeros(3), share * far])
        assert collision.pose_depth([[p] for p in case.parts], case.at, motion) == 0
    assert np.isinf(case.value)


# -- slices ---------------------------------------------------------------------------------------------------------

PEGS = [c for c in BOUNDED if len(c.parts) == 2 and np.all(c.at == 0) and "in a square" not in c.name]


@pytest.mark.parametrize("case", PEGS, ids=lambda c: c.name)
def test_slices_end_at_the_exact_turn_and_reach_the_exact_shift(case):
    pair = Slices(*case.parts, (0, 0), step=2e-2)
    if case.turns and not case.pulls:
        assert pair.high == pytest.approx(case.value, abs=1e-11)
    if case.pulls and case.witness[1, 2] == 0 and not case.turns:
        values = [pair.corners(phi) @ closed_forms.unit(case.pulls[0].direction) for phi in (0.0, pair.high / 2)]
        assert values[0].max() == pytest.approx(case.value, abs=1e-14)
        assert values[1].max() < case.value


@pytest.mark.parametrize("joint", blocks.JOINTS)
def test_slices_hold_exactly_the_free_samples(joint):
    rng = np.random.default_rng(3)
    pair = chain.slices(joint, 0.02)
    for phi in rng.uniform(pair.low, pair.high, 5):
        piece = shapely.union_all(pair.at(phi))
        x0, y0, x1, y1 = shapely.buffer(piece, 1e-3).bounds
        taus = rng.uniform([x0, y0], [x1, y1], (3000, 2))
        free = ~collision.overlaps(pair.A, pair.B, np.column_stack([taus, np.full(len(taus), phi)]), pair.D)
        assert np.array_equal(free, shapely.contains_xy(piece, taus))
        assert 30 < free.sum() < 2990


# -- chains ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("joint", blocks.JOINTS)
def test_blocks_fit_one_another_as_drawn_and_lie_the_gap_apart_as_made(joint):
    drawn = shapely.Polygon(blocks.outline(joint))
    beside = shapely.transform(drawn, lambda p: np.add(p, [1, 0]))
    assert drawn.is_valid
    assert drawn.exterior.is_ccw
    assert shapely.union(drawn, beside).area == pytest.approx(2, abs=1e-12)
    made = blocks.block(joint, 0.02)
    assert shapely.distance(made, shapely.transform(made, lambda p: np.add(p, [1, 0]))) == pytest.approx(
        0.02, abs=1e-15
    )
    offset = shapely.buffer(drawn, -0.01, join_style="mitre", mitre_limit=100)
    assert shapely.symmetric_difference(made, offset).area < 1e-12


def _check_chain(joint, gap, n, direction=(0.0, 1.0)):
    """The found motion is free, gives the value, and no small change of it that is free gives more."""
    pair = chain.slices(joint, gap)
    answer = chain.reach(pair, n, direction)
    at = np.column_stack([np.arange(n), np.zeros(n)])
    made = [[shapely.transform(pair.A, lambda p, o=o: p + o)] for o in at]
    assert collision.pose_depth(made, at, answer.motion) < 1e-11
    assert answer.motion[-1, :2] @ closed_forms.unit(direction) == pytest.approx(answer.value, rel=1e-12)
    rng = np.random.default_rng(5)
    for k, best in enumerate(answer.relative):
        changed = best + rng.uniform(-1, 1, (4000, 3)) * 10 ** rng.uniform(-7, -2, (4000, 1))
        changed = changed[collision.free(pair.A, pair.B, pair.D, changed, 0)]
        others = answer.relative.copy()
        for sample in changed:
            others[k] = sample
            assert _last(others) @ closed_forms.unit(direction) <= answer.value + 1e-11
    return answer


def _last(relative):
    place, theta = np.zeros(2), 0.0
    for x, y, phi in relative:
        place, theta = place + turn(theta) @ np.array([1 + x, y]), theta + phi
    return place - [len(relative), 0]


@pytest.mark.parametrize(("joint", "gap", "n"), [("tee", 0.01, 5), ("swallowtail", 0.02, 10), ("hook", 0.01, 5)])
def test_a_chain_is_free_at_its_optimum_and_cannot_be_bettered_nearby(joint, gap, n):
    answer = _check_chain(joint, gap, n)
    assert answer.value == pytest.approx(chain.stored(joint, gap, n)[0], rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("joint", ["tee", "hook"])
def test_all_stored_values_come_out_again(joint):
    for gap in chain.GAPS:
        for n in chain.BLOCKS:
            value, accuracy = chain.stored(joint, gap, n)
            assert chain.reach(chain.slices(joint, gap), n, cells=131).value == pytest.approx(
                value, rel=1e-9, abs=3 * accuracy
            )


# -- random joints --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("make", [random_joints.tab_pair, random_joints.peg_pair])
@pytest.mark.parametrize("holes", [False, True])
def test_random_pairs_are_sound_and_the_gap_apart(make, holes):
    corners = set()
    for seed in range(12):
        pair = make(seed, 0.02, holes)
        assert all(p.is_valid for p in pair.made)
        assert shapely.distance(*pair.made) == pytest.approx(0.02, abs=1e-12)
        assert shapely.intersection(*pair.drawn).area < 1e-12
        assert all(inset_polygon(p, 0.01).equals(q) for p, q in zip(pair.drawn, pair.made, strict=True))
        assert bool(pair.made[1].interiors) == holes
        A, B, D = pair.local()
        assert collision.depths(A, B, np.zeros((1, 3)), D)[0] == 0
        corners.add(len(pair.made[1].exterior.coords))
    assert len(corners) > 2


@pytest.mark.parametrize("seed", range(3))
def test_slices_of_random_joints_hold_exactly_the_free_samples(seed):
    rng = np.random.default_rng(seed)
    A, B, D = (random_joints.tab_pair if seed % 2 else random_joints.peg_pair)(seed, 0.015, holes=seed > 2).local()
    pair = Slices(A, B, tuple(D), step=5e-3)
    for phi in rng.uniform(pair.low, pair.high, 3):
        piece = shapely.union_all(pair.at(phi))
        x0, y0, x1, y1 = shapely.buffer(piece, 1e-4).bounds
        taus = rng.uniform([x0, y0], [x1, y1], (1500, 2))
        free = ~collision.overlaps(A, B, np.column_stack([taus, np.full(len(taus), phi)]), D)
        assert np.array_equal(free, shapely.contains_xy(piece, taus))


def test_the_turn_of_a_joint_ends_where_samples_end():
    pair = chain.slices("swallowtail", 0.02)
    tip = np.append(pair.at(pair.high)[0].centroid.coords[0], pair.high)
    assert collision.depths(pair.A, pair.B, tip, pair.D)[0] < 1e-12
    rng = np.random.default_rng(0)
    beyond = tip + np.array([1e-3, 1e-3, 0]) * rng.uniform(-1, 1, (100000, 3)) + [0, 0, 1e-6]
    assert np.all(collision.overlaps(pair.A, pair.B, beyond, pair.D))


@pytest.mark.parametrize("joint", ["tee", "hook"])
def test_two_blocks_reach_what_samples_reach(joint):
    pair = chain.slices(joint, 0.02)
    value, _ = chain.stored(joint, 0.02, 2)
    rng = np.random.default_rng(7)
    box = np.array([0.03, 1.05 * value, max(pair.high, -pair.low)])
    samples = rng.uniform(-1, 1, (300_000, 3)) * box
    samples[:, 1] = np.abs(samples[:, 1])
    best = samples[collision.free(pair.A, pair.B, pair.D, samples, 0), 1].max()
    assert 0.9 * value < best <= value
