"""Studies of gaps in space: against closed forms, against solving again, and both sides of a border checked."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

import wiggleroom as wr
from tests.test_spatial import PEG, PLATE, spatial
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import JointGap
from wiggleroom.spatial.solids.corner_displacement import corner_displacements
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial

JOINT = "examples/43_mortise_and_tenon/joint.json"
LOCKED = PEG | {"lock": ["rx", "ry", "rz"]}
ALONG_X = wr.Pull("peg", (1, 0, 0))
BAR = {
    "name": "bar",
    "boxes": [[-10, -4, -4, 10, 4, 4], [-10, -6, -4, -8, 6, 4], [8, -6, -4, 10, 6, 4]],
    "lock": ["y", "z", "rx", "ry", "rz"],
}
SLOT = {"name": "wall", "boxes": [[-3, 5, -5, 3, 9, 5], [-3, -9, -5, 3, -5, 5]], "fixed": True}


def joint() -> Assembly:
    return wr.read(JOINT)


def flex_joint(assembly: Assembly, goal: wr.Pull | wr.Turn, more: float) -> float:
    """The largest motion when `gaps` gives the only joint more gap [mm]."""
    names = assembly.names[0], assembly.names[1]
    drawing = replace(assembly.drawing, gaps=(JointGap(names, assembly.gap + more),))
    answer = wr.flex(assemble_spatial(drawing), goal)
    assert answer.objective is not None
    return answer.objective


def test_ranking_by_forces_is_what_solving_again_gives() -> None:
    assembly, goal = joint(), wr.Pull("rail", (0, 0, 1), (120, 0, 0))
    by_forces, again = (wr.rank(assembly, goal, by=by) for by in ("duals", "differences"))
    assert by_forces.unique.all()
    assert by_forces.looser == pytest.approx(again.looser, rel=1e-4)
    assert by_forces.tighter == pytest.approx(again.tighter, rel=1e-4)
    step = 1e-4
    more, less = (
        wr.flex(assemble_spatial(assembly.drawing, gap=assembly.gap + s), goal).objective for s in (step, -step)
    )
    assert by_forces.looser.sum() == pytest.approx((more - less) / (2 * step), rel=1e-4)
    own = [flex_joint(assembly, goal, s) for s in (step, -step)]
    assert by_forces.joint_looser == pytest.approx([(own[0] - own[1]) / (2 * step)], rel=1e-4)
    assert wr.rank(by_forces.answer).looser == pytest.approx(by_forces.looser)


def test_ranking_of_many_parts_tells_who_holds_and_who_does_not() -> None:
    burr = wr.read("examples/44_six_piece_burr/burr.json")
    found = wr.rank(burr, wr.Pull("stick2", (1, 0, 0)))
    worth = dict(zip(burr.names, found.importance.tolist(), strict=True))
    assert worth == pytest.approx(
        {"key": 0, "stick1": 0.5, "stick2": 0.5, "stick3": 0, "stick4": 0, "stick5": 0}, abs=1e-6
    )
    assert [tuple(burr.names[k] for k in pair) for pair in found.joints.tolist()] == [("stick1", "stick2")]


def test_draws_are_those_of_the_closed_form_also_where_parts_get_larger_than_drawn() -> None:
    # the peg, locked, moves by 0.2 and half of both extra gaps; nothing but these matters
    found = wr.sample(spatial(PLATE, LOCKED), 0.05, ALONG_X, draws=12, seed=3, limit=0.25)
    assert (found.extra.sum(axis=1) < 0).any()
    assert found.value == pytest.approx(0.2 + found.extra.sum(axis=1) / 2, abs=1e-7)
    assert found.good == int((found.value <= 0.25).sum())
    assert found.foreseen == pytest.approx(0.05 / np.sqrt(2), rel=1e-4)
    assert not len(found.checked)


def test_tightening_takes_away_what_the_rank_says() -> None:
    found = wr.tighten(spatial(PLATE, LOCKED, gap=0.3), ALONG_X, parts=1, draws=2)
    assert found.before.objective == pytest.approx(0.5, abs=1e-7)
    assert found.after.objective == pytest.approx(0.5 - 0.27 / 2, abs=1e-7)  # a tenth of the gap is left
    assert found.random == pytest.approx([0.365, 0.365], abs=1e-7)


def test_the_largest_gap_for_a_motion_is_that_of_the_closed_form() -> None:
    found = wr.allowable_gap(spatial(PLATE, LOCKED, gap=0.05), ALONG_X, at_most=0.35)
    assert found.gap <= 0.15 <= found.beyond <= 1.0011 * found.gap
    assert found.certainty == "searched"


@pytest.mark.slow
def test_the_largest_gap_that_holds_has_a_checked_state_on_both_sides() -> None:
    # heads 12 wide behind a slot of 10: they pass from a gap of 1 on
    assembly = spatial(BAR, SLOT, gap=0.5)
    found = wr.largest_gap(assembly)
    assert found.holds <= 1.0 <= found.parts_at <= 1.0011 * found.holds
    assert (found.interlocked.verdict, found.apart.verdict) == ("interlocked", "comes apart")


@pytest.mark.slow
def test_a_gap_that_holds_says_from_which_on_parts_fit() -> None:
    # one arm is 0.1 mm too thick: it overlaps the wall as drawn up to a gap of 0.1
    bar = BAR | {"boxes": [*BAR["boxes"][:1], [-10, -6, -4, -2.9, 6, 4], BAR["boxes"][2]]}
    found = wr.allowable_gap(spatial(bar, SLOT, gap=0.5), holds=True)
    assert found.fits_from == pytest.approx(0.1, abs=1e-5)
    assert found.fits_from < found.gap < 1.0011


@pytest.mark.parametrize(
    ("larger", "side", "truth"), [(0.3, 0.0, 0.4), (0.3, 0.1, 0.5), (0.1, 0.0, 0.0), (0.0, 0.4, 0.2)]
)
def test_the_smallest_gap_that_fits_is_that_of_the_closed_form(larger: float, side: float, truth: float) -> None:
    # 0.2 mm of room on every side; a shift takes it from one side
    found = wr.allowable_gap(spatial(PLATE, PEG | {"at": [side, 0, 0]}, gap=0.1), fits=larger)
    assert found.gap == pytest.approx(truth, abs=2e-6)
    assert found.certainty == "proven"
    assert (found.beyond is None) == (truth == 0)


@pytest.mark.parametrize("seed", range(2))
def test_the_smallest_gap_of_turned_meshes_that_fits_by_another_library(seed: int, tmp_path: Path) -> None:
    """Two turned blocks whose faces lie further out: apart at the gap, in each other a little below it, by the library fcl."""
    fcl = pytest.importorskip("fcl")
    rng = np.random.default_rng(seed)
    turns = [trimesh.transformations.random_rotation_matrix(rng.uniform(size=3)) for _ in range(2)]
    at = np.array([[0.0, 0, 0], rng.uniform(7, 9, 3)])
    larger = float(rng.uniform(0.5, 2.0))
    parts = []
    for k, (turn, place) in enumerate(zip(turns, at, strict=True)):
        turn[:3, 3] = place
        trimesh.creation.box((10, 12, 8), turn).export(tmp_path / f"{k}.ply")
        parts.append({"name": f"p{k}", "mesh": f"{k}.ply", "fixed": k == 0})
    file = tmp_path / "blocks.json"
    file.write_text(json.dumps({"format": "wiggleroom/2", "unit": "mm", "gap": 0.5, "parts": parts}))
    found = wr.allowable_gap(wr.read(file), fits=larger)

    def meet(gap: float) -> bool:
        more = 2 * larger - gap
        both = [
            fcl.CollisionObject(fcl.Box(10 + more, 12 + more, 8 + more), fcl.Transform(turn[:3, :3], place))
            for turn, place in zip(turns, at, strict=True)
        ]
        return fcl.collide(*both, fcl.CollisionRequest(), fcl.CollisionResult()) > 0

    assert found.gap is not None
    assert not meet(found.gap + 1e-4)
    assert found.gap == 0 or meet(found.gap - 1e-4)


def test_no_gap_fits_at_which_a_drawn_part_is_gone() -> None:
    found = wr.allowable_gap(spatial(PLATE, PEG), fits=6.0)
    assert found.gap is None
    assert found.why.startswith("no gap makes room")


def test_questions_that_cannot_be_asked_in_space_are_refused_in_one_line() -> None:
    with pytest.raises(wr.InputError, match="nothing stops the motion"):
        wr.rank(spatial(PLATE, PEG), wr.Pull("peg", (0, 0, 1)))


@pytest.mark.parametrize(
    "ask", [wr.prepare, wr.tight_verdict, wr.blocking, wr.Live, lambda assembly: wr.free_space(assembly, "lid", "box")]
)
def test_what_is_for_the_plane_alone_says_so(ask) -> None:
    with pytest.raises(wr.InputError, match=r"parts in the plane; this is in space"):
        ask(wr.read("examples/40_box_with_a_lid/box.json"))


@pytest.mark.parametrize(("question", "options"), [(wr.check, {"boxes": 100}), (wr.sweep, {"seconds": 5.0})])
def test_an_option_of_drawings_is_refused_in_space(question: Callable[..., Any], options: dict[str, Any]) -> None:
    with pytest.raises(wr.InputError, match=f"{next(iter(options))}: for drawings only") as raised:
        question(wr.read(JOINT), **options)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("options", [{"unit": "in"}, {"flatten": 0.1}, {"only": ["rail"]}, {"join": 0.1}])
def test_an_option_of_reading_drawings_is_refused_in_space(options: dict[str, Any]) -> None:
    with pytest.raises(wr.InputError, match=f"{next(iter(options))}: for drawings only"):
        wr.read(JOINT, **options)


def test_the_table_of_an_answer_has_every_waypoint_of_what_moves(command: Callable[..., int], tmp_path: Path) -> None:
    place = tmp_path / "path.csv"
    assert command("flex", JOINT, "--pull", "rail:+z@120,0,0", "--csv", place) == 0
    rows = [line.split(",") for line in place.read_text().splitlines()]
    assert rows[0] == ["path", "step", "part", "dx_mm", "dy_mm", "dz_mm", "rx_deg", "ry_deg", "rz_deg"]
    path = wr.flex(joint(), wr.Pull("rail", (0, 0, 1), (120, 0, 0))).waypoints
    assert [row[:3] for row in rows[1:]] == [["1", str(k), "rail"] for k in range(len(path))]
    rail = joint().names.index("rail")
    told = np.array([[float(x) for x in row[3:]] for row in rows[1:]])
    assert told == pytest.approx(np.hstack([path[:, rail, :3], np.degrees(path[:, rail, 3:])]), abs=1e-9)


def test_corners_follow_the_faces_of_plates_boxes_and_meshes() -> None:
    outline = [[0, 0], [6, 0], [6, 2], [2, 2], [2, 5], [0, 5]]
    boxes = [[0, 0, 0, 6, 2, 3], [0, 0, 0, 2, 5, 3]]
    for part in ({"outline": outline, "thickness": 3}, {"boxes": boxes}):
        made, smaller = (spatial({"name": "a", **part}, PLATE, gap=gap).solids[0] for gap in (0.2, 0.202))
        for k, piece in enumerate(made.pieces):
            moved = piece.corners + 1e-3 * corner_displacements(made, k)
            assert np.abs(moved - smaller.pieces[k].corners).max() < 1e-9


def test_parts_that_do_not_fit_are_counted_as_misfits() -> None:
    found = wr.sample(spatial(PLATE, LOCKED), wr.Spread(0.4, "uniform"), ALONG_X, draws=12, seed=1)
    assert found.misfits == int((0.2 + found.extra.sum(axis=1) / 2 <= 0).sum()) > 0


@pytest.mark.parametrize("question", [wr.flex, wr.check, wr.sweep, wr.largest_gap, wr.allowable_gap])
def test_a_misspelt_option_is_refused_in_space(question: Callable[..., Any]) -> None:
    with pytest.raises(TypeError, match="secnds"):
        question(wr.read(JOINT), secnds=1.0)
