"""Motions that repeat: gone twice they stay free of overlap, and nothing that ends is said to repeat."""

from __future__ import annotations

import json
import runpy
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import shapely
from benchmarks.attack import drawing, families_mechanisms
from benchmarks.attack.oracle import Ground
from shapely import affinity

import wiggleroom as wr
from wiggleroom.geometry.rotational_symmetry import symmetry_order

MECHANISMS = Path(__file__).parents[1] / "examples" / "23_mechanisms"
DRAWN = runpy.run_path(str(MECHANISMS / "draw.py"))
SAMPLES = 400
"""States of a path at which all parts are tested for overlap."""


def assembled(made: dict, folder: Path, gap: float = 0.0) -> wr.Assembly:
    """The assembly of a file with this content."""
    file = folder / "made.json"
    file.write_text(json.dumps(made))
    return wr.read(file, gap=gap)


def material(part: wr.Part, motion: np.ndarray) -> shapely.Geometry:
    """A part after a motion about its reference point, by shapely alone."""
    shape = shapely.union_all([shapely.Polygon(region.outer, region.holes) for region in part.regions])
    x, y, angle = part.at
    turned = affinity.rotate(shape, angle + motion[2], origin=(0, 0), use_radians=True)
    return affinity.translate(turned, x + motion[0], y + motion[1])


def deepest(assembly: wr.Assembly, motions: np.ndarray) -> float:
    """Largest area that two parts share at some motions (k, n, 3), apart from pairs that pass each other."""
    passes = {frozenset(pair) for pair in assembly.drawing.ignore}
    worst = 0.0
    for motion in motions:
        shapes = [material(part, one) for part, one in zip(assembly.parts, motion, strict=True)]
        for one, other in combinations(range(len(shapes)), 2):
            if frozenset((assembly.names[one], assembly.names[other])) not in passes:
                worst = max(worst, shapely.intersection(shapes[one], shapes[other]).area)
    return worst


def centroids(assembly: wr.Assembly) -> np.ndarray:
    """Centroid of every part [mm], from its reference point."""
    shapes = [material(part, np.zeros(3)) for part in assembly.parts]
    return np.array([shape.centroid.coords[0] for shape in shapes]) - assembly.rest[:, :2]


def gone_twice(answer: wr.Answer) -> np.ndarray:
    """Motions along the second round: every part turned about its centroid by the period's turn, then moved as in the first."""
    period, path = answer.period, answer.waypoints[answer.period.first :]
    share = np.linspace(0, len(path) - 1, SAMPLES)
    low = np.minimum(share.astype(int), len(path) - 2)
    first = path[low] + (share - low)[:, None, None] * (path[low + 1] - path[low])
    arm = centroids(answer.assembly)
    c, s = np.cos(period.turn), np.sin(period.turn)
    shift = arm - np.column_stack([c * arm[:, 0] - s * arm[:, 1], s * arm[:, 0] + c * arm[:, 1]])
    angle = first[:, :, 2]
    second = first.copy()
    second[:, :, 0] += np.cos(angle) * shift[:, 0] - np.sin(angle) * shift[:, 1]
    second[:, :, 1] += np.sin(angle) * shift[:, 0] + np.cos(angle) * shift[:, 1]
    second[:, :, 2] += period.turn
    return second


@pytest.mark.parametrize(
    ("name", "part", "sense", "turns"),
    [
        ("gears_17_23.svg", "gear1", "cw", {"gear1": 360 / 17, "gear2": -360 / 23}),
        ("linkage.json", "crank", "ccw", {"crank": 360}),
    ],
)
def test_a_mechanism_goes_round_for_ever(name, part, sense, turns):
    assembly = wr.read(MECHANISMS / name, gap=0.3)
    answer = wr.flex(assembly, wr.Turn(part, sense), search=0)
    sign = 1 if sense == "ccw" else -1
    assert (answer.verdict, answer.objective, answer.path) == ("unbounded", None, "checked")
    found = dict(zip(assembly.names, sign * np.degrees(answer.period.turn), strict=True))
    assert {k: v for k, v in found.items() if k in turns} == pytest.approx(turns)
    assert np.degrees(answer.period.objective) == pytest.approx(turns[part])
    assert set(turns) <= set(answer.turns)
    second = gone_twice(answer)
    assert np.abs(second[0] - answer.waypoints[-1]).max() < 1e-4  # the second round begins where the first ends
    assert deepest(assembly, second) < 1e-4  # [mm2] of parts drawn to 1e-4 mm


@pytest.mark.parametrize("seed", range(3))
def test_random_mechanisms_that_repeat_do_so(seed, tmp_path):
    family = [families_mechanisms.gears, families_mechanisms.four_bars, families_mechanisms.ratchets][seed % 3]
    made = next(m for k in range(9) if drawing.lie_apart(m := family(np.random.default_rng([seed, k])), 2e-3))
    assembly = assembled(made, tmp_path)
    answer = wr.flex(assembly, search=0)
    if answer.period is not None:
        assert answer.verdict == "unbounded"
        assert deepest(assembly, gone_twice(answer)) < 1e-9
    else:
        assert answer.verdict != "unbounded" or answer.leaves


def test_a_stop_work_ends_after_some_turns(tmp_path):
    """A Geneva drive with a slot missing lets its driver turn a few times; then the pin meets the wheel's rim.

    A climb from rest may end at any earlier place where the pin is caught, so the value has no lower limit but rest.
    """
    slot, turns, shapes = 1, 1, DRAWN["geneva"]()
    plug = affinity.rotate(shapely.box(25, -3.2, 56, 3.2), (2 * slot + 1) * 30, origin=(0, 0))
    shapes["wheel"] = shapely.union(shapes["wheel"], affinity.translate(plug, -60))
    parts = [drawing.part(name, shape, fixed=name.startswith("axle")) for name, shape in shapes.items()]
    answer = wr.flex(assembled(drawing.assembly(parts, []), tmp_path, gap=0.3), wr.Turn("driver"), search=0)
    assert answer.verdict in ("optimal", "stationary", "stopped")
    assert np.radians(90) < answer.objective < 2 * np.pi * turns + np.radians(125)
    assert answer.path == "checked"


def test_a_row_that_unfolds_far_is_not_said_to_leave(tmp_path):
    """Nine bars on pins, folded up on each other: the last gets nine bars away, more than six drawing sizes, and no further."""
    count, radius = 9, 0.1
    spots = [(float(k % 2), 0.0) for k in range(count + 1)]
    parts = []
    for k in range(count):
        solid = shapely.buffer(shapely.LineString(spots[k : k + 2]), 0.2, quad_segs=3)
        holes = [drawing.disc(radius + 0.03, 16, spot) for spot in spots[k : k + 2]]
        parts.append(drawing.part(f"bar{k}", drawing.cut(solid, *holes)))
    parts += [drawing.part(f"pin{k}", drawing.disc(radius, 16, spot), fixed=k == 0) for k, spot in enumerate(spots)]
    names = [part["name"] for part in parts]
    joined = {frozenset((f"bar{k}", f"pin{j}")) for k in range(count) for j in (k, k + 1)}
    passes = [[a, b] for a, b in combinations(names, 2) if frozenset((a, b)) not in joined]
    made = drawing.assembly(parts, [drawing.pull(f"bar{count - 1}", (1, 0))], ignore=passes)
    answer = wr.flex(assembled(made, tmp_path), search=0)
    assert answer.verdict != "unbounded"
    assert answer.objective < count * 1.06


@pytest.mark.parametrize(("order", "digits"), [(2, 16), (5, 5), (12, 16)])
def test_symmetry_is_that_of_the_corners(order, digits):
    rng = np.random.default_rng(order)
    sector = np.column_stack([rng.uniform(1, 2, 4), np.sort(rng.uniform(0, 2 * np.pi / order, 4))])
    angle = (sector[:, 1] + 2 * np.pi * np.arange(order)[:, None] / order).ravel()
    radius = np.tile(sector[:, 0], order)
    ring = np.round(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]), digits)
    after = np.roll(np.arange(len(ring)), -1)
    assert symmetry_order(ring, after, 10.0 ** (1 - min(digits, 12))) == order
    ring[0] += 1e-2
    assert symmetry_order(ring, after, 1e-4) == 1


def test_a_hexagon_in_a_round_hole_turns_in_place(tmp_path):
    frame = drawing.cut(drawing.box(-3, -3, 3, 3), drawing.disc(1.2, 40))
    made = drawing.assembly([drawing.part("frame", frame, fixed=True), drawing.part("nut", drawing.disc(1.0, 6))], [])
    answer = wr.flex(assembled(made, tmp_path), wr.Turn("nut"), search=0)
    assert answer.verdict == "unbounded"
    assert np.degrees(answer.period.objective) == pytest.approx(60)


def test_a_lever_turns_about_its_bore_once_it_has_pushed_all_else_away(tmp_path):
    spots = [(0.7, 0.5), (-0.7, -0.4), (-0.3, 0.8)]
    lever = shapely.union(drawing.disc(0.3, 16), drawing.box(0, -0.1, 1, 0.1))
    parts = [
        drawing.part("axle", drawing.disc(0.12, 14), fixed=True),
        drawing.part("lever", drawing.cut(lever, drawing.disc(0.15, 14))),
        *(drawing.part(f"block{k}", drawing.box(x - 0.2, y - 0.2, x + 0.2, y + 0.2)) for k, (x, y) in enumerate(spots)),
    ]
    answer = wr.flex(assembled(drawing.assembly(parts, [drawing.turn("lever", "ccw")]), tmp_path), search=0)
    assert answer.verdict == "unbounded"
    assert answer.path == "checked"
    assert np.degrees(answer.period.turn) == pytest.approx([0.0, 360.0, *[0.0] * len(spots)])
    assert deepest(answer.assembly, gone_twice(answer)) < 1e-9


def test_parts_that_hold_each_other_leave_and_turn_for_ever(tmp_path):
    """Nothing turns in place, and no motion of the turned part alone repeats: both go off and turn as one."""
    tail = shapely.Polygon([(0.9, 0.4), (1.1, 0.3), (1.1, 0.7), (0.9, 0.6)])
    one = drawing.union(drawing.box(0, 0, 0.91, 1), tail)
    other = drawing.cut(drawing.box(0.95, 0, 2, 1), drawing.wider(tail, 0.03))
    stand = drawing.cut(drawing.box(-0.5, -0.5, 2.5, 0.6), drawing.box(-0.1, -0.1, 2.1, 2))
    parts = [drawing.part("stand", stand, fixed=True), drawing.part("one", one), drawing.part("other", other)]
    made = drawing.turned(drawing.assembly(parts, [drawing.turn("other", "ccw")]), 0.9)
    (tmp_path / "made.json").write_text(json.dumps(made))
    answer = wr.flex(wr.read(tmp_path / "made.json"), search=0)
    assert answer.verdict == "unbounded"
    assert Ground(made).overlap_on(answer.waypoints) is None


# -- round outlines drawn with corners hold no more than circles do --------------------------------------------------


def off_centre(count: int, seed: int, folder) -> tuple[wr.Assembly, float, Ground]:
    """A disc in a round hole, pulled at a point beside its middle; what a circle reaches, less what the hole's corners may take."""
    rng = np.random.default_rng([seed, count])
    off, direction = rng.uniform(0.02, 0.6) * np.array(drawing.anywhere(rng)), np.array(drawing.anywhere(rng))
    gap = float(rng.uniform(0.02, 0.04))
    plate = drawing.cut(drawing.box(-2, -2, 2, 2), drawing.disc(1 + gap, count))
    parts = [drawing.part("plate", plate, fixed=True), drawing.part("disc", drawing.disc(1, count))]
    made = drawing.assembly(parts, [drawing.pull("disc", direction, off.tolist())])
    (folder / "made.json").write_text(json.dumps(made))
    reach = float(np.hypot(*off) - direction @ off + (1 + gap) * np.cos(np.pi / count) - 1)
    return wr.read(folder / "made.json"), reach, Ground(made)


@pytest.mark.parametrize(("count", "seed"), [(24, 1), (300, 3), (700, 4)])
def test_an_off_centre_pull_turns_a_disc_as_far_as_a_circle(count, seed, tmp_path):
    assembly, reach, ground = off_centre(count, seed, tmp_path)
    answer = wr.flex(assembly)
    assert answer.objective > 0.998 * reach
    assert answer.verdict == "proven" or count > 200  # such outlines are simplified
    assert answer.path == "checked"
    assert ground.overlap_on(answer.waypoints) is None
