"""The gap of one joint in space: solids against closed forms and the plane, motions against drawings, ends against a collision library."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import numpy as np
import pytest
import shapely
from benchmarks import spatial_overlaps

import wiggleroom as wr
from tests.test_spatial import sound, spatial
from wiggleroom.assembly.gaps import apply_gap
from wiggleroom.cli import main
from wiggleroom.drawing.model import Drawing, JointGap, Pull, Turn
from wiggleroom.report.solids.spatial_listing import drawn_parts
from wiggleroom.spatial.solids.solid_boolean import centroid_of
from wiggleroom.spatial.spatial_flex import flex_spatial

WALLS = [
    {"name": "west", "boxes": [[-2, 0, 0, 0, 10, 10]], "fixed": True},
    {"name": "east", "boxes": [[10, 0, 0, 12, 10, 10]], "fixed": True},
    {"name": "floor", "boxes": [[0, 0, -2, 10, 10, 0]], "fixed": True},
]
BLOCK = {"name": "block", "boxes": [[0, 0, 0, 10, 10, 10]], "lock": ["rx", "ry", "rz"]}


def volume(made) -> float:
    return centroid_of(made.surface)[0]


def joint(a: str, b: str, gap: float) -> dict:
    return {"parts": [a, b], "gap": gap}


@pytest.mark.parametrize("gap", [0.0, 0.2])
def test_a_joint_moves_by_its_own_gap_and_all_others_by_theirs(gap: float) -> None:
    gaps = [joint("west", "block", 0.5), joint("block", "east", 0.1), joint("floor", "block", 0.3)]
    assembly = spatial(*WALLS, BLOCK, gap=gap, gaps=gaps)
    for direction, far in (((-1, 0, 0), 0.5), ((1, 0, 0), 0.1), ((0, 0, -1), 0.3)):
        answer = sound(flex_spatial(assembly, Pull("block", direction)))
        assert answer.objective == pytest.approx(far, abs=1e-9)


def test_the_list_of_parts_shows_them_as_drawn() -> None:
    found = drawn_parts(spatial(*WALLS, BLOCK, gap=0.2, gaps=[joint("west", "block", 0.5)]).drawing)
    assert {part.name: part.size for part in found}["block"] == (10.0, 10.0, 10.0)
    assert {part.name: part.volume for part in found}["block"] == pytest.approx(1000.0)


@pytest.mark.parametrize("larger", [0.0, 0.1, 0.2])
def test_parts_drawn_larger_than_nominal_face_each_other_as_in_the_plane(larger: float) -> None:
    wall = {"name": "west", "boxes": [[-2, 0, 0, larger, 10, 10]], "fixed": True}
    gaps = [joint("west", "block", 0.5), joint("block", "east", 0.1), joint("floor", "block", 0.3)]
    assembly = spatial(wall, *WALLS[1:], BLOCK, gaps=gaps)
    answer = sound(flex_spatial(assembly, Pull("block", (-1, 0, 0))))
    assert answer.objective == pytest.approx(0.5 - larger, abs=1e-9)


@pytest.mark.parametrize(("own", "rotate"), [(0.05, [20, -35, 70]), (0.6, [0, 0, 0])])
def test_corners_between_faces_of_a_joint_are_mitred(own: float, rotate: list[float]) -> None:
    # an L and a block in its inner corner, as long as it
    angle = {"name": "angle", "boxes": [[0, 0, 0, 10, 2, 8], [0, 0, 0, 2, 10, 8]], "fixed": True, "rotate": rotate}
    block = {"name": "block", "boxes": [[2, 2, 0, 10, 10, 8]], "rotate": rotate}
    made = spatial(angle, block, gap=0.2, gaps=[joint("angle", "block", own)]).solids
    # as long as the block: the faces of the joint move by half of its gap, all others by 0.1
    leg = 2 - 0.1 - own / 2
    long = 10 - 0.2
    assert volume(made[0]) == pytest.approx((2 * leg * long - leg**2) * 7.8, rel=1e-11)
    assert volume(made[1]) == pytest.approx((8 - 0.1 - own / 2) ** 2 * 7.8, rel=1e-11)


@pytest.mark.parametrize(("family", "own"), [("tee", 0.004), ("jigsaw", 0.03)])
def test_extruded_joints_are_the_drawings_extruded(family: str, own: float) -> None:
    flat = wr.patterns.chain(3, joint=family, gap=0.01).drawing
    names = [p.name for p in flat.parts]
    thick = 0.4
    parts = [
        {"name": p.name, "outline": p.regions[0].outer.tolist(), "thickness": thick, "at": [*p.at[:2], 0], "rotate": [0, 0, p.at[2]]}
        for p in flat.parts
    ]  # fmt: skip
    made = spatial(*parts, gap=0.01, gaps=[joint(names[0], names[1], own)]).solids
    truth, wrong = apply_gap(Drawing(flat.parts, gap=0.01, gaps=(JointGap((names[0], names[1]), own),)))
    assert not wrong
    for solid, part in zip(made, truth, strict=True):
        area = sum(shapely.Polygon(r.outer, r.holes).area for r in part.regions)
        assert volume(solid) == pytest.approx(area * (thick - 0.01), rel=1e-8)


def test_a_chain_with_a_loose_joint_moves_as_the_drawing_does() -> None:
    flat = wr.patterns.chain(4, joint="swallowtail", gap=0.01)
    names = flat.names
    loose = wr.Drawing(flat.drawing.parts, gap=0.01, gaps=(JointGap((names[1], names[2]), 0.03),))
    truth = wr.flex(wr.assemble(loose), wr.Pull(names[-1], (0, 1))).objective
    parts = [
        {"name": p.name, "outline": p.regions[0].outer.tolist(), "thickness": 0.4, "at": [*p.at[:2], 0]}
        | {"fixed": p.fixed, "lock": ["z", "rx", "ry"]}
        for p in flat.drawing.parts
    ]  # fmt: skip
    assembly = spatial(*parts, gap=0.01, gaps=[joint(names[1], names[2], 0.03)])
    last = flat.drawing.parts[-1]
    answer = sound(flex_spatial(assembly, Pull(last.name, (0, 1, 0), (*last.at[:2], 0.2))))
    assert answer.objective == pytest.approx(truth, abs=1e-6)


@pytest.mark.parametrize(("family", "own"), [("swallowtail", None), ("tee", 0.03)])
def test_a_joint_in_space_is_worth_what_a_gap_of_its_own_is(family: str, own: float | None) -> None:
    flat = wr.patterns.chain(3, joint=family, gap=0.02).drawing
    parts = [
        {"name": p.name, "outline": p.regions[0].outer.tolist(), "thickness": 0.4, "at": [*p.at[:2], 0]}
        | {"fixed": p.fixed, "lock": ["z", "rx", "ry"]}
        for p in flat.parts
    ]  # fmt: skip
    names = [p.name for p in flat.parts]
    goal = Pull(names[-1], (0, 1, 0), (*flat.parts[-1].at[:2], 0.2))
    usual = dict.fromkeys(itertools.pairwise(names), 0.02) | ({} if own is None else {(names[0], names[1]): own})

    def made(gaps: dict[tuple[str, str], float]):
        return spatial(*parts, gap=0.02, gaps=[joint(*pair, gap) for pair, gap in gaps.items()])

    ranking = wr.rank(made({} if own is None else {(names[0], names[1]): own}), goal)
    assert len(ranking.joints) == 2
    for (a, b), worth in zip(ranking.joints.tolist(), ranking.joint_looser, strict=True):
        pair = names[a], names[b]
        high, low = (flex_spatial(made(usual | {pair: usual[pair] + h}), goal).objective for h in (1e-5, -1e-5))
        assert worth == pytest.approx((high - low) / 2e-5, rel=2e-4)


def test_offset_adds_to_the_gap_of_a_joint_on_cut_edges_only() -> None:
    square = [[0, 0], [10, 0], [10, 10], [0, 10]]
    plate = {"name": "plate", "outline": square, "thickness": 3, "offset": 0.02}
    side = {"name": "side", "boxes": [[10, 0, 0, 14, 10, 3]], "fixed": True}
    top = {"name": "top", "boxes": [[0, 0, 3, 10, 10, 5]], "fixed": True}
    made = spatial(plate, side, top, gap=0.1, gaps=[joint("plate", "side", 0.3), joint("plate", "top", 0.4)]).solids[0]
    assert volume(made) == pytest.approx((10 - 0.05 + 0.02 - 0.15 + 0.02) * 9.94 * (3 - 0.05 - 0.2), rel=1e-12)


def corners(*boxes: list[float]) -> list[np.ndarray]:
    return [np.array(list(itertools.product(*zip(b[:3], b[3:], strict=True)))) for b in boxes]


def test_ways_in_a_pocket_are_free_for_a_collision_library() -> None:
    # floor and lid have a pocket of the block's own face; all shapes of the judge are written down by hand
    floor = {"name": "floor", "boxes": [[-10, -10, -4, 20, 20, 0]], "fixed": True}
    lid = {"name": "lid", "boxes": [[-10, -10, 10, 20, 20, 14]], "fixed": True}
    block = {"name": "block", "boxes": [[0, 0, 0, 10, 10, 10]]}
    assembly = spatial(floor, lid, block, gap=0.2, gaps=[joint("floor", "block", 1.0), joint("lid", "block", 0.05)])
    rim = [(-9.9, -9.9, 0, 19.9), (10, -9.9, 19.9, 19.9), (0, -9.9, 10, 0), (0, 10, 10, 19.9)]
    shapes = [
        corners([-9.9, -9.9, -3.9, 19.9, 19.9, -0.5], *([x0, y0, -0.5, x1, y1, -0.1] for x0, y0, x1, y1 in rim)),
        corners([-9.9, -9.9, 10.1, 19.9, 19.9, 13.9], [0, 0, 10.025, 10, 10, 13.9]),
        corners([0.1, 0.1, 0.5, 9.9, 9.9, 9.975]),
    ]
    judge = spatial_overlaps.Judge(shapes, assembly.reference, [True, True, False])
    rng = np.random.default_rng(0)
    for goal in (
        Pull("block", tuple(rng.normal(size=3) * [0.1, 0.1, 1]), tuple(rng.uniform(0, 10, 3))),
        Turn("block", tuple(rng.normal(size=3))),
    ):
        answer = flex_spatial(assembly, goal)
        assert answer.collision_free
        assert answer.path == "checked"
        assert spatial_overlaps.worst_on(judge, answer.waypoints) < 1e-7
    # the judge sees an overlap as deep as a step that was left out
    down = np.zeros((3, 6))
    down[2, 2], down[2, 0] = -0.9, 1.0
    assert judge.depth(down) > 0.1


def test_steps_stay_where_they_are_when_a_part_gets_looser() -> None:
    # the floor is built up below the post; the block goes down beside that, and then as far as the step
    floor = {"name": "floor", "boxes": [[-10, -10, -4, 20, 20, 0]], "fixed": True}
    post = {"name": "post", "boxes": [[0, -4, 0, 4, 14, 10]], "fixed": True}
    block = {"name": "block", "boxes": [[5, 0, 0, 10, 10, 10]], "lock": ["y", "rx", "ry", "rz"]}
    wall = {"name": "wall", "boxes": [[12, -4, 0, 14, 14, 10]], "fixed": True}  # else it may fall off the floor
    assembly = spatial(floor, post, block, wall, gap=0.2, gaps=[joint("floor", "post", 0.05)])
    pull = [wr.Pull("block", (0, 0, -1), weight=5.0), wr.Pull("block", (-1, 0, 0))]
    found = wr.rank(assembly, pull)
    assert sound(found.answer).objective == pytest.approx(5 * 0.2 + 1.1, abs=1e-7)
    assert dict(zip(assembly.names, found.looser, strict=True)) == pytest.approx(
        {"floor": 2.5, "post": 0, "block": 3.0, "wall": 0}
    )
    assert found.looser == pytest.approx(wr.rank(assembly, pull, by="differences").looser, rel=1e-4, abs=1e-6)


def test_check_takes_gaps_of_joints_and_its_ways_are_free() -> None:
    # heads 12 wide in a slot of 8, as long as the wall is thick
    heads = [[-10, -6, -4, -3, 6, 4], [3, -6, -4, 10, 6, 4]]
    bar = {"name": "bar", "boxes": [[-10, -4, -4, 10, 4, 4], *heads], "lock": ["y", "z", "rx", "ry", "rz"]}
    slot = {"name": "wall", "boxes": [[-3, 4, -5, 3, 9, 5], [-3, -9, -5, 3, -4, 5]], "fixed": True}
    assert wr.check(spatial(bar, slot, gap=0.5)).verdict == "interlocked"
    held = spatial(bar, slot, gap=0.5, gaps=[joint("bar", "wall", 0.1)])
    assert sound(flex_spatial(held, Pull("bar", (1, 0, 0)))).objective == pytest.approx(0.1, abs=1e-9)
    assert wr.check(held).verdict == "interlocked"
    assert wr.check(spatial(*WALLS, BLOCK, gap=0.1, gaps=[joint("block", "floor", 0.5)])).verdict == "comes apart"


SHELL = [[-10, -10, -10, -5, 10, 10], [5, -10, -10, 10, 10, 10], [-5, -10, -10, 5, -5, 10], [-5, 5, -10, 5, 10, 10],
         [-5, -5, -10, 5, 5, -5], [-5, -5, 5, 5, 5, 10]]  # fmt: skip
"""A cube of 20 mm with a cavity of 10 mm in its middle."""
CUBE = {"name": "cube", "boxes": [[-5, -5, -5, 5, 5, 5]]}


@pytest.mark.parametrize(("pair", "far"), [("cube", 0.5), ("lid", 0.2)])
def test_a_closed_cavity_stays_hollow(pair: str, far: float) -> None:
    shell = {"name": "shell", "boxes": SHELL, "fixed": True}
    lid = {"name": "lid", "boxes": [[-10, -10, 10, 10, 10, 12]], "fixed": True}
    assembly = spatial(shell, CUBE, lid, gap=0.2, gaps=[joint("shell", pair, 0.5)])
    made = assembly.solids[0]
    drawn = 20.0 - 0.2, 10.0 + (0.5 if pair == "cube" else 0.2)
    lost = 19.8**2 * 0.15 if pair == "lid" else 0.0  # the lid's joint takes 0.25 off where the others take 0.1
    assert volume(made) == pytest.approx(drawn[0] ** 3 - drawn[1] ** 3 - lost, rel=1e-9)
    answer = sound(flex_spatial(assembly, Pull("cube", (1, 0, 0))))
    assert answer.objective == pytest.approx(far, abs=1e-9)


def test_a_part_that_a_joint_cuts_in_two_is_refused_with_a_hollow_in_it_too() -> None:
    left = [[x - 20, y, z, u - 20, v, w] for x, y, z, u, v, w in SHELL]
    neck = [-10, -10, -10, 10, 10, -9.4]
    bar = {"name": "bar", "boxes": [*left, neck, [10, -10, -10, 30, 10, 10]]}
    post = {"name": "post", "boxes": [[-10, -10, -9.4, 10, 10, 30]], "fixed": True}
    with pytest.raises(wr.InputError, match=r'part "bar" falls into 2 pieces at gap 0\.1 and the gaps of its joints'):
        spatial(bar, post, gap=0.1, gaps=[joint("bar", "post", 1.4)])


def test_two_parts_that_do_not_face_each_other_are_no_joint() -> None:
    far = {"name": "far", "boxes": [[40, 40, 40, 41, 41, 41]]}
    with pytest.raises(wr.InputError, match='gaps: parts "west" and "far" face each other nowhere'):
        spatial(*WALLS, far, gaps=[joint("west", "far", 0.1)])


def test_the_option_replaces_the_gap_of_the_file(tmp_path: Path, monkeypatch, capsys) -> None:
    file = tmp_path / "tray.json"
    file.write_text(
        json.dumps(
            {"format": "wiggleroom/2", "gap": 0.2, "parts": [*WALLS, BLOCK], "gaps": [joint("east", "block", 0.4)]}
        )
    )

    def run(options: str) -> int:
        monkeypatch.setattr("sys.argv", ["wiggleroom", "flex", str(file), "--pull", "block:+x", *options.split()])
        return main()

    for option, far in (("", 0.4), ("--gap-of block,east:0.7", 0.7)):
        assert run(f"{option} --json -") == 0
        assert json.loads(capsys.readouterr().out)["objective"] == pytest.approx(far, abs=1e-9)
    assert run("--gap-of block,oast:0.7") == 2
    assert "--gap-of" in capsys.readouterr().err


@pytest.mark.parametrize("own", [0.05, 0.6])
def test_a_region_inside_a_face_is_cut_away_or_built_up(own: float) -> None:
    big = {"name": "big", "boxes": [[0, 0, 0, 20, 20, 10]], "fixed": True}
    small = {"name": "small", "boxes": [[4, 6, 10, 9, 12, 14]]}
    made = spatial(big, small, gap=0.2, gaps=[joint("big", "small", own)]).solids
    assert volume(made[0]) == pytest.approx(19.8**2 * 9.8 - 30 * (own - 0.2) / 2, rel=1e-12)
    assert volume(made[1]) == pytest.approx(4.8 * 5.8 * (3.9 - own / 2), rel=1e-12)
    assert sum(len(m.pieces) for m in made) >= 2
