"""Assemblies of boxes by whole steps, against a search over cells that shares nothing with it."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from benchmarks import six_piece_burr, spatial_burrs, spatial_figures, spatial_overlaps
from scipy.spatial.transform import Rotation

import wiggleroom as wr
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import UNLIMITED
from wiggleroom.disassembly.ground import with_ground
from wiggleroom.spatial.escapes.lattice import lattice
from wiggleroom.spatial.escapes.lattice_search import lattice_motions, lattice_search
from wiggleroom.spatial.escapes.spatial_disassembly import check_spatial
from wiggleroom.spatial.search.spatial_prepare import prepare_spatial
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.solids.spatial_file import read_spatial


def spatial(*parts: dict, gap: float = 0.1, **entries: object) -> Assembly:
    file = {"format": "wiggleroom/2", "gap": gap, "parts": list(parts)} | entries
    return assemble_spatial(read_spatial(json.dumps(file)))


def burr(parts: list[set], gap: float = 0.05) -> Assembly:
    return assemble_spatial(spatial_burrs.assembled(parts, gap).drawing, fix=("p0",))


@pytest.mark.parametrize("pieces", [3, 5])
def test_random_burrs_come_apart_by_whole_steps_as_the_cells_say(pieces: int) -> None:
    rng = np.random.default_rng(40 + pieces)
    for _ in range(4):
        parts = spatial_burrs.random_burr(rng, pieces)
        truth = spatial_burrs.comes_apart_on_grid(parts)
        grid = lattice(prepare_spatial(burr(parts)))
        assert grid is not None
        found = lattice_search(grid, UNLIMITED)
        assert found.complete
        assert bool(found.offsets) == truth


def test_the_burr_of_the_gallery_comes_apart_on_the_grid_and_its_way_is_free_for_a_collision_library() -> None:
    assembly = wr.read("examples/44_six_piece_burr/burr.json")
    boxes = [(p.solid.boxes / 10).round().astype(int) for p in assembly.drawing.parts]
    cells = [
        {v for low, high in part for v in itertools.product(*map(range, low.tolist(), high.tolist()))} for part in boxes
    ]
    assert len(set().union(*cells)) == sum(map(len, cells))
    assert [six_piece_burr.without_blind_corners(part, k) for k, part in enumerate(cells)] == [True] * 6
    # with the key in place nothing else moves, and then everything comes off
    moving = {frozenset(spatial_figures.carried(cells, k, s)) for k in range(6) for s in spatial_burrs.STEPS}
    assert moving <= {frozenset(range(6)), frozenset([0]), frozenset(range(1, 6))}
    assert six_piece_burr.moves_apart(cells) == [1, 2, 1, 2, 1]
    found = check_spatial(assembly)
    assert (found.verdict, found.certainty) == ("comes apart", "proven")
    assert found.escapes[0].parts == ("key",)
    assert sorted(n for e in found.escapes for n in e.parts) == ["key", "stick2", "stick3", "stick4", "stick5"]
    shapes = [spatial_overlaps.voxel_judge(part, 0.025) for part in cells]
    stays = list(range(6))
    for escape in found.escapes:
        judge = spatial_overlaps.Judge(
            [shapes[k] for k in stays], assembly.reference[stays] / 10, [assembly.parts[k].fixed for k in stays]
        )
        path = escape.path[:, stays] / [10, 10, 10, 1, 1, 1]
        assert spatial_overlaps.worst_on(judge, path) < spatial_overlaps.SHALLOW
        stays = [k for k in stays if assembly.names[k] not in escape.parts]


def test_a_part_that_needs_several_slides_gets_out() -> None:
    # a block in a closed case with a shaft that leads out round two corners
    cells = set(itertools.product(range(9), range(9), range(3)))
    free = {(x, 4, 1) for x in range(2, 6)} | {(5, y, 1) for y in range(4, 7)} | {(x, 6, 1) for x in range(5, 9)}
    case = [[*v, *np.add(v, 1).tolist()] for v in sorted(cells - free)]
    found = wr.check(
        spatial(
            {"name": "case", "boxes": case, "fixed": True}, {"name": "block", "boxes": [[2, 4, 1, 3, 5, 2]]}, gap=0.02
        )
    )
    assert found.verdict == "comes apart"
    assert found.certainty == "proven"
    assert found.escapes[0].parts == ("block",)
    closed = [[*v, *np.add(v, 1).tolist()] for v in sorted(cells - free | {(8, 6, 1)})]
    held = wr.check(
        spatial(
            {"name": "case", "boxes": closed, "fixed": True}, {"name": "block", "boxes": [[2, 4, 1, 3, 5, 2]]}, gap=0.02
        )
    )
    assert held.verdict == "interlocked"
    assert held.certainty == "proven"  # the case is closed all round


def test_a_bolt_passes_where_the_gap_is_large_although_it_is_held_as_drawn() -> None:
    # a head of 2.4 above a slot of 2
    case = [[0, 0, 0, 5, 2, 1], [0, 4, 0, 5, 6, 1], [0, 0, 1, 5, 1.8, 3], [0, 4.2, 1, 5, 6, 3], [0, 0, 3, 5, 6, 4]]
    sides = [[-1, 0, 0, 0, 6, 4], [5, 0, 0, 6, 6, 4]]
    bolt = [[1, 2, 0, 4, 4, 1], [1, 1.8, 1, 4, 4.2, 3]]
    parts = {"name": "case", "boxes": case + sides, "fixed": True}, {"name": "bolt", "boxes": bolt}
    held = wr.check(spatial(*parts, gap=0.05))
    assert held.verdict == "interlocked"
    assert held.certainty == "proven"
    assert wr.check(spatial(*parts, gap=0.5)).verdict == "comes apart"


def test_locks_hold_on_the_lattice() -> None:
    floor = {"name": "floor", "boxes": [[0, 0, 0, 4, 4, 1]], "fixed": True}
    block = {"name": "block", "boxes": [[1, 1, 1, 2, 2, 2]]}
    free = lattice_search(lattice(prepare_spatial(spatial(floor, block))), UNLIMITED)
    assert free.offsets
    held = lattice_search(lattice(prepare_spatial(spatial(floor, block | {"lock": ["x", "y", "z"]}))), UNLIMITED)
    assert held.complete
    assert not held.offsets


def voxels(cells: set, inset: float) -> trimesh.Trimesh:
    """The surface of unit cubes, its faces moved inward."""
    hulls = [trimesh.convex.convex_hull(corners) for corners in spatial_overlaps.voxel_judge(cells, inset)]
    return trimesh.boolean.union(hulls, engine="manifold")


@pytest.mark.parametrize(
    ("ending", "turned", "scale", "inset", "gap"),
    [("stl", True, (9.7, 9.7, 9.7), 0.01, 0.0), ("obj", False, (1 / 3, 1 / 3, 1 / 3), 0.03, 0.0)],
)
def test_meshes_turned_anywhere_take_as_many_moves_as_their_cells(
    tmp_path: Path, ending: str, turned: bool, scale: tuple[float, float, float], inset: float, gap: float
) -> None:
    R = Rotation.random(random_state=5) if turned else Rotation.identity()
    seen = set()
    for number in (0, 1, 3, 20, 21):
        parts = spatial_burrs.random_burr(np.random.default_rng([3, number]), 3)
        parts = spatial_burrs.hollowed(parts, np.random.default_rng([3, number, 1]), 0.25)
        fewest = spatial_burrs.fewest_moves(parts)
        seen.add(fewest)
        entries = []
        for k, cells in enumerate(parts):
            mesh = voxels(cells, inset)
            mesh.vertices = R.apply(mesh.vertices * scale) + np.array([20.0, -7.0, 3.0])
            name = f"{number}_{k}.{ending}"
            mesh.export(tmp_path / name, **({"digits": 6} if ending == "obj" else {}))
            entries.append({"name": f"p{k}", "mesh": name})
        file = tmp_path / f"{number}.json"
        file.write_text(json.dumps({"format": "wiggleroom/2", "unit": "mm", "gap": gap, "parts": entries}))
        ready = prepare_spatial(with_ground(wr.read(file)))
        grid = lattice(ready)
        assert grid is not None
        assert grid.step == pytest.approx(scale, rel=1e-4)
        found = lattice_search(grid, UNLIMITED)
        assert found.complete
        assert len(found.offsets) == fewest
        if fewest:
            assert check_spatial(wr.read(file), every=False).verdict == "comes apart"
    assert seen == {0, 1, 2, 3}


def test_parts_with_a_gap_do_not_scrape_along_each_other() -> None:
    """A box in a room with a way out by two moves; its faces and those of the room lie on a lattice of 0.5 mm by chance."""
    room = [
        [0, 0, 0, 40, 40, 10], [0, 0, 20, 40, 40, 30], [0, 0, 10, 40, 10, 20],
        [0, 30, 10, 40, 40, 20], [20, 10, 10, 40, 30, 20], [0, 10, 10, 10, 20, 20],
    ]  # fmt: skip
    parts = {"name": "room", "boxes": room, "fixed": True}, {"name": "p", "boxes": [[10, 10, 10, 20, 19, 20]]}
    plan = wr.plan(spatial(*parts, gap=1.0))
    assert plan.level == (2,)
    assert plan.steps[0].clearance > 0.5


def test_solids_off_every_lattice_have_none() -> None:
    floor = {"name": "floor", "boxes": [[0, 0, 0, 4, 4, 1]], "fixed": True}
    block = {"name": "block", "boxes": [[1, 1, 2, 2, 2, 3]]}
    assert lattice(prepare_spatial(spatial(floor, block | {"rotate": [0, 0, 90]}))) is not None
    assert lattice(prepare_spatial(spatial(floor, block | {"rotate": [0, 0, 30]}))) is None
    wedge = {"name": "block", "outline": [[1, 1], [2, 1], [2, 2]], "thickness": 1, "at": [0, 0, 2]}
    assert lattice(prepare_spatial(spatial(floor, wedge))) is None
    assert lattice(prepare_spatial(spatial(floor, block, ignore=[["floor", "block"]]))) is None


def test_a_path_by_whole_steps_is_free_by_the_collision_library() -> None:
    # a drawer behind a door that must be slid up first, in a cabinet
    cabinet = [[0, 0, 0, 10, 6, 1], [0, 0, 5, 10, 6, 6], [0, 0, 1, 10, 1, 5], [0, 5, 1, 10, 6, 5], [0, 1, 1, 1, 5, 5]]
    drawer, door = [[1, 1, 1, 9, 5, 5]], [[10, 0, 0, 11, 6, 6]]
    rails = [
        [10, -1, 0, 12, 0, 12],
        [10, 6, 0, 12, 7, 12],
        [11, 0, 0, 12, 1, 6],
        [11, 5, 0, 12, 6, 6],
        [10, 0, -1, 12, 6, 0],
    ]
    assembly = spatial(
        {"name": "cabinet", "boxes": cabinet + rails + [[0, -1, 0, 10, 0, 6], [0, 6, 0, 10, 7, 6]], "fixed": True},
        {"name": "drawer", "boxes": drawer},
        {"name": "door", "boxes": door},
    )
    ready = prepare_spatial(assembly)
    grid = lattice(ready)
    found = lattice_search(grid, UNLIMITED)
    assert found.complete
    path = lattice_motions(ready, grid, found.offsets)
    boxes = [
        [spatial_overlaps.box(np.add(b[:3], 0.05), np.subtract(b[3:], 0.05)) for b in part]
        for part in (cabinet + rails, drawer, door)
    ]
    judge = spatial_overlaps.Judge(boxes, assembly.reference, [True, False, False])
    for one, other in itertools.pairwise(path):
        for share in (0.0, 0.5, 1.0):
            assert judge.depth(spatial_overlaps.between(one, other, share)) < spatial_overlaps.SHALLOW
    checked = check_spatial(assembly)
    assert checked.verdict == "comes apart"
    assert [e.parts for e in checked.escapes] == [("door",), ("drawer",)]
