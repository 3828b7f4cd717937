"""Assemblies of boxes by whole steps, against a search over cells that shares nothing with it."""

from __future__ import annotations

import itertools
import json

import numpy as np
import pytest
from benchmarks import six_piece_burr, spatial_burrs, spatial_figures, spatial_overlaps

import wiggleroom as wr
from wiggleroom.spatial.lattice_search import lattice, lattice_motions, lattice_search
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.solids.spatial_file import read_spatial
from wiggleroom.spatial.solids.spatial_model import SpatialAssembly
from wiggleroom.spatial.spatial_disassembly import check_spatial
from wiggleroom.spatial.spatial_prepare import prepare_spatial


def spatial(*parts: dict, gap: float = 0.1, **entries: object) -> SpatialAssembly:
    file = {"format": "wiggleroom/2", "gap": gap, "parts": list(parts)} | entries
    return assemble_spatial(read_spatial(json.dumps(file)))


def burr(parts: list[set], gap: float = 0.05) -> SpatialAssembly:
    return assemble_spatial(spatial_burrs.assembled(parts, gap).drawing, fix=("p0",))


@pytest.mark.parametrize("pieces", [3, 4, 5, 6])
def test_random_burrs_come_apart_by_whole_steps_as_the_cells_say(pieces: int) -> None:
    rng = np.random.default_rng(40 + pieces)
    for _ in range(8):
        parts = spatial_burrs.random_burr(rng, pieces)
        truth = spatial_burrs.comes_apart_on_grid(parts)
        grid = lattice(prepare_spatial(burr(parts)))
        assert grid is not None
        found = lattice_search(grid, None)
        assert found.complete
        assert bool(found.offsets) == truth


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
    found = lattice_search(grid, None)
    assert found.complete
    path = lattice_motions(ready, grid, found)
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


def test_the_burr_of_the_gallery_comes_apart_on_the_grid_and_its_way_is_free_for_a_collision_library() -> None:
    assembly = wr.read("examples/44_six_piece_burr/burr.json")
    boxes = [(p.solid.boxes / 10).round().astype(int) for p in assembly.parts]
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
            [shapes[k] for k in stays],
            assembly.reference[stays] / 10,
            [assembly.parts[k].fixed for k in stays],
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
    free = lattice_search(lattice(prepare_spatial(spatial(floor, block))), None)
    assert free.offsets
    held = lattice_search(lattice(prepare_spatial(spatial(floor, block | {"lock": ["x", "y", "z"]}))), None)
    assert held.complete
    assert not held.offsets


def test_only_boxes_along_the_axes_are_on_a_lattice() -> None:
    floor = {"name": "floor", "boxes": [[0, 0, 0, 4, 4, 1]], "fixed": True}
    block = {"name": "block", "boxes": [[1, 1, 2, 2, 2, 3]]}
    assert lattice(prepare_spatial(spatial(floor, block | {"rotate": [0, 0, 90]}))) is not None
    assert lattice(prepare_spatial(spatial(floor, block | {"rotate": [0, 0, 30]}))) is None
    plate = {"name": "block", "outline": [[1, 1], [2, 1], [2, 2]], "thickness": 1, "at": [0, 0, 2]}
    assert lattice(prepare_spatial(spatial(floor, plate))) is None
    assert lattice(prepare_spatial(spatial(floor, block, ignore=[["floor", "block"]]))) is None
