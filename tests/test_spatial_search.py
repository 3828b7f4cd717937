"""Beyond the nearest local optimum in space, and rounds that go on where the last one ended."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

import wiggleroom as wr
from tests.test_spatial import sound, spatial
from wiggleroom.drawing.model import Pull
from wiggleroom.report.results.answer_words import answer_sure
from wiggleroom.spatial.spatial_flex import flex_spatial

WALLS = [
    [-2, -2, 22, 0], [-2, 0, 0, 16], [20, 0, 22, 16], [0, 5, 2, 16], [2, 8, 6, 16], [6, 5, 12, 16], [12, 14, 16, 16],
    [16, 5, 20, 16],
]  # fmt: skip
"""A room with a slot of 3 above the block, and one of 9 elsewhere."""
CASE = {"name": "case", "boxes": [[x, y, 0, u, v, 4] for x, y, u, v in WALLS], "fixed": True}
BLOCK = {"name": "block", "boxes": [[3, 1, 1, 5, 3, 3]], "lock": ["z", "rx", "ry"]}
UP = {"part": "block", "direction": [0, 1, 0]}


def test_a_search_finds_the_deeper_of_two_slots() -> None:
    assembly = spatial(CASE, BLOCK)
    near = sound(wr.flex(assembly, wr.Pull("block", (0, 1, 0)), search=0))
    assert near.objective == pytest.approx(5, abs=1e-6)
    assert near.search is None
    far = sound(wr.flex(assembly, wr.Pull("block", (0, 1, 0)), search=12))
    assert far.objective == pytest.approx(11, abs=1e-6)
    assert far.search is not None
    assert far.search.next_best == pytest.approx(5, rel=1e-3)
    said = dict(answer_sure(far))["search"]
    assert said.startswith(f"{far.search.starts} starts, {far.search.at_value} ended at this value")
    assert (far.waypoints[0] == 0).all()
    drawn = wr.sample(far, 1e-4, draws=3)  # of the deeper slot too, not of what is nearest to rest
    assert drawn.value == pytest.approx(11, abs=1e-2)


def test_the_command_takes_the_number_of_starts(tmp_path: Path, command_output) -> None:
    file = tmp_path / "slots.json"
    file.write_text(json.dumps({"format": "wiggleroom/2", "parts": [CASE, BLOCK], "pull": [UP]}))
    code, out, _ = command_output("flex", file, "--search", 2, "--json", "-")
    found = json.loads(out)
    assert code == 0
    assert found["objective"] > 4.999
    assert 1 < found["search"]["starts"] <= 3
    code, out, _ = command_output("flex", file)
    assert " starts, " in out
    code, out, _ = command_output("flex", file, "--search", 0)
    assert "search:  from rest only; --search 8 may find a better local optimum" in out
    code, _, err = command_output("flex", file, "--search", -1)
    assert code == 2
    assert len(err) == 1


def test_contacts_that_close_to_the_last_digits_leave_the_path_checked(tmp_path: Path) -> None:
    from benchmarks.attack.families_solid import draw_solids

    found = wr.flex(
        wr.read(draw_solids(3011)[1].write(tmp_path)), search=0
    )  # corners of a turned mesh lie off its faces by rounding
    assert (found.verdict, found.path) == ("optimal", "checked")


def test_a_film_that_cutting_leaves_across_a_bore_is_no_material(tmp_path: Path) -> None:
    from benchmarks.attack.families_solid import draw_solids

    found = wr.flex(wr.read(draw_solids(1036)[1].write(tmp_path)))
    assert found.verdict == "unbounded"  # the pin of this hinge has no heads


@pytest.mark.slow
def test_no_end_is_an_optimum_where_a_long_lid_still_tilts_over_a_pebble() -> None:
    rim = [
        [-500, -500, 0, -450, 500, 25], [450, -500, 0, 500, 500, 25], [-500, -500, 0, 500, -450, 25],
        [-500, 450, 0, 500, 500, 25],
    ]  # fmt: skip
    parts = (
        {"name": "slab", "boxes": [[-500, -500, 0, 500, 500, 10]], "fixed": True},
        {"name": "pebble", "boxes": [[0, 0, 10.01, 1, 1, 11]]},
        {"name": "lid", "boxes": [[-400, -400, 11.02, 400, 400, 20]]},
        {"name": "roof", "boxes": [[-500, -500, 20.03, 500, 500, 25], *rim], "fixed": True},
    )
    answer = sound(flex_spatial(spatial(*parts), Pull("lid", (0, 0, -1))))
    assert answer.verdict != "optimal" or answer.objective > 0.05


def test_a_wedge_slides_on_where_a_slope_ends(tmp_path: Path) -> None:
    """A ceiling that rises and then is level: the wedge's upper edge stopped where both pieces meet. The plane knows of no pieces."""
    cheek, floor, top, ends = -2.99, -3.94, 5.35, (-8.71, -0.43)
    ceiling = [[-12, 0], [-0.78, 0.16], [-0.49, 0.16], [0.52, 0.16], [12, 2.35]]
    wedge = [[-6.77, -1.12], [-2.77, -1.12], [-2.77, -0.12], [-6.77, -0.42]]
    profiles = [([p, q, [q[0], top], [p[0], top]], -6.0, 6.0) for p, q in itertools.pairwise(ceiling)]
    profiles.append(([[-12, floor - 1], [12, floor - 1], [12, floor], [-12, floor]], -6.0, 6.0))
    profiles += [([[x, floor], [x + 1, floor], [x + 1, top], [x, top]], -6.0, 6.0) for x in (ends[0] - 1, ends[1])]
    profiles.append(([[-12, floor], [12, floor], [12, top], [-12, top]], cheek, cheek + 1))

    def prism(profile: list[list[float]], low: float, high: float) -> trimesh.Trimesh:
        return trimesh.convex.convex_hull(np.array([[x, y, z] for y in (low, high) for x, z in profile]))

    trimesh.boolean.union([prism(*each) for each in profiles], engine="manifold").export(tmp_path / "room.ply")
    prism(wedge, -1, 1).export(tmp_path / "wedge.ply")
    room = {"name": "room", "mesh": "room.ply", "fixed": True}
    parts = [room, {"name": "wedge", "mesh": "wedge.ply", "lock": ["y", "rx", "rz"]}]
    (tmp_path / "a.json").write_text(json.dumps({"format": "wiggleroom/2", "parts": parts}))
    (left, right), height = ends, 0.16 / 11.22
    free = [[left, floor], [right, floor], [right, 0.16], [-0.78, 0.16], [left, (left + 12) * height]]
    walls = [[-12, floor - 1], [12, floor - 1], [12, top], [-12, top]]
    flat = [{"name": "room", "outline": walls, "holes": [free], "fixed": True}, {"name": "wedge", "outline": wedge}]
    (tmp_path / "flat.json").write_text(json.dumps({"format": "wiggleroom/1", "parts": flat}))
    found = wr.flex(wr.read(tmp_path / "a.json"), wr.Pull("wedge", (0.5, 0.0, 1.0)))
    x, _, z = found.assembly.reference[1].tolist()
    truth = wr.flex(wr.read(tmp_path / "flat.json"), wr.Pull("wedge", (0.5, 1.0), (x, z)))
    assert found.objective == pytest.approx(truth.objective, abs=1e-5)


def test_a_block_below_a_roof_goes_aside_and_up() -> None:
    roof = {"name": "roof", "boxes": [[-2, -2, 3, 2, 2, 4]], "fixed": True}
    block = {"name": "block", "boxes": [[-1, -1, 0, 1, 1, 2]]}
    up = wr.Pull("block", (0, 0, 1))
    assert sound(wr.flex(spatial(roof, block), up, search=0)).objective == pytest.approx(1, abs=1e-6)
    assert sound(wr.flex(spatial(roof, block), up)).verdict == "unbounded"
