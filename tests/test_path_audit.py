"""The audit of paths: what it calls free is free by polygons of shapely, and it calls free what keeps clear."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import numpy as np
import pytest
import shapely
from benchmarks.attack.drawing import Json, box, cut, disc, part, wider
from benchmarks.attack.families import FAMILIES, draw
from benchmarks.attack.oracle import Ground

import wiggleroom as wr
from tests.flexing import box as box_part
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.audit.audit_outlines import INSET
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.drawing.model import Drawing
from wiggleroom.freespace.cells.cells import select
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import ZERO_MOTION
from wiggleroom.search.path_check import missed_at
from wiggleroom.search.prepare import Prepared, prepare_as_drawn


def made_of(tmp_path: Path, *parts: Json, **more: object) -> Assembly:
    file = tmp_path / "parts.json"
    file.write_text(json.dumps({"format": "wiggleroom/1", "unit": "mm", "parts": parts, **more}))
    return wr.read(str(file))


def waypoints_of(count: int, who: int, *motions: tuple[float, float, float]) -> np.ndarray:
    """Waypoints of one of some parts, from rest."""
    out = np.zeros((len(motions) + 1, count, 3))
    out[1:, who] = motions
    return out


def test_one_part_that_moves_otherwise_is_judged_against_all_others() -> None:
    """A grid of loose parts: whichever moves, however far, the word is that of a whole audit."""
    made = wr.patterns.grid(4, 4, joint="tee", gap=0.05)
    count, rng, told = len(made.names), np.random.default_rng(5), []
    for who, far in itertools.product(range(1, count), (0.005, 0.02, 0.2)):
        path = waypoints_of(count, who, (*rng.uniform(-far, far, 2), 0.0))
        whole, one = audit_path(made, path), audit_path(made, path, changed=np.arange(count) == who)
        np.testing.assert_array_equal([whole.a, whole.b, whole.piece], [one.a, one.b, one.piece])
        told.append(one.free)
    assert {True, False} == set(told)


def least_distance(ground: Ground, waypoints: np.ndarray) -> float:
    """Smallest distance of any two parts at many motions."""
    share = np.linspace(0, 1, 41)[:, None, None]
    dense = np.concatenate([a + share * (b - a) for a, b in itertools.pairwise(waypoints)])
    shapes = ground.at(dense)
    return min(float(shapely.distance(shapes[i], shapes[j]).min()) for i, j in ground.pairs)


def random_paths(ground: Ground, rng: np.random.Generator) -> list[np.ndarray]:
    """Pieces on which some parts move a little or far, and turn little or fast."""
    n, out = len(ground.names), []
    for _ in range(8):
        far = ground.size * np.exp(rng.uniform(np.log(1e-4), np.log(1.0)))
        move = rng.standard_normal((n, 3)) * [far, far, min(far / ground.radius.min(), 4.0)]
        move[ground.fixed | (rng.random(n) < 0.5)] = 0
        out.append(np.stack([np.zeros((n, 3)), move]))
    return out


@pytest.mark.parametrize("kind", range(0, len(FAMILIES), 4), ids=lambda k: FAMILIES[k].__name__)
def test_free_is_free_and_clear_is_called_free(tmp_path: Path, kind: int) -> None:
    name, made = draw(kind + 5 * len(FAMILIES))
    assert made is not None
    file = tmp_path / f"{name}.json"
    file.write_text(json.dumps(made))
    assembly, ground, rng = wr.read(str(file)), Ground(made), np.random.default_rng(kind)
    for waypoints in random_paths(ground, rng):
        audit, overlap = audit_path(assembly, waypoints), ground.overlap_on(waypoints)
        assert overlap is None or not audit.free, f"{overlap}"
        if overlap is None and least_distance(ground, waypoints) > 1e-4 * ground.size:
            assert audit.free


def test_the_path_of_an_answer_is_free_and_the_same_path_with_a_corner_cut_is_not() -> None:
    assembly = wr.patterns.chain(4, joint="swallowtail", gap=0.02)
    answer = wr.flex(assembly, search=0)
    assert audit_path(assembly, answer.waypoints).free
    beyond = np.concatenate([answer.waypoints, 1.05 * answer.motion[None]])
    audit = audit_path(assembly, beyond)
    assert audit.certain == len(answer.waypoints)
    assert audit.doubtful.tolist() == [False] * (len(beyond) - 2) + [True]


def test_a_part_that_lies_in_the_material_of_another_overlaps(tmp_path: Path) -> None:
    plate = part("plate", box(0, 0, 10, 10), fixed=True)
    pebble = part("pebble", disc(0.5, 8, (20, 5)))
    assembly = made_of(tmp_path, plate, pebble)
    inside = np.zeros((2, 2, 3))
    inside[:, 1, 0] = -15
    audit = audit_path(assembly, inside)
    assert (audit.a.tolist(), audit.b.tolist(), audit.certain) == ([0], [1], 0)
    through = audit_path(assembly, waypoints_of(2, 1, (-15, 0, 0)))
    assert (through.doubtful.tolist(), through.certain) == ([True], 1)
    assert audit_path(assembly, waypoints_of(2, 1, (0, 30, 0), (-40, 30, 0))).free


def test_a_part_in_a_hole_is_free_until_it_meets_the_rim(tmp_path: Path) -> None:
    ring = part("ring", cut(box(0, 0, 10, 10), box(2, 2, 8, 8)), fixed=True)
    pebble = part("pebble", box(4.5, 4.5, 5.5, 5.5))
    assembly = made_of(tmp_path, ring, pebble)
    assert (
        audit_path(assembly, waypoints_of(2, 1, (2.5, 0, 0), (0, 0, 7), (-2.5, -2.5, 0))).certain == 2
    )  # turning in the corner does not fit
    assert audit_path(assembly, waypoints_of(2, 1, (2.5, 0, 0), (-2.5, 2.5, 0))).free
    assert not audit_path(assembly, waypoints_of(2, 1, (20, 0, 0))).free


def test_a_rod_that_turns_fast_is_followed_round(tmp_path: Path) -> None:
    rod, post = part("rod", box(-5, -0.05, 5, 0.05)), part("post", disc(0.1, 8, (3, 2)), fixed=True)
    assembly = made_of(tmp_path, rod, post)
    assert not audit_path(assembly, waypoints_of(2, 0, (0, 0, np.pi))).free  # half a turn: both ends are clear
    assert audit_path(assembly, waypoints_of(2, 0, (0, 0, -0.5), (0, 0, 0.5))).free


@pytest.mark.parametrize(("deep", "free"), [(-1e-12, True), (0.5 * INSET, True), (100 * INSET, False)])
def test_sliding_along_a_wall_is_free_and_a_scratch_is_not(tmp_path: Path, deep: float, free: bool) -> None:
    floor, brick = part("floor", box(0, -1, 10, 0), fixed=True), part("brick", box(1, 0.1, 2, 1.1))
    assembly = made_of(tmp_path, floor, brick)
    down = -0.1 - deep * assembly.size
    assert audit_path(assembly, waypoints_of(2, 1, (0, down, 0), (7, down, 0))).free is free


def test_glued_and_ignored_parts_do_not_count(tmp_path: Path) -> None:
    shapes = [part("a", box(0, 0, 1, 1), fixed=True), part("b", box(2, 0, 3, 1)), part("c", box(3, 0, 4, 1))]
    through = waypoints_of(3, 1, (-2, 0, 0))
    through[1, 2] = -2, 0, 0
    assert audit_path(made_of(tmp_path, *shapes, glue=[["b", "c"]]), through).certain == 1
    assert audit_path(made_of(tmp_path, *shapes, glue=[["b", "c"]], ignore=[["a", "b"], ["a", "c"]]), through).free


def test_concave_parts_may_nest(tmp_path: Path) -> None:
    cup = cut(box(0, 0, 4, 4), box(1, 1, 3, 5))
    block = wider(box(1, 1, 3, 4), -0.05)
    assembly = made_of(tmp_path, part("cup", cup, fixed=True), part("block", block))
    assert audit_path(assembly, waypoints_of(2, 1, (0, 9, 0))).free
    assert audit_path(assembly, waypoints_of(2, 1, (0.04, 0.5, 0.01), (-0.04, 3, -0.01), (5, 9, 3))).free is False
    assert audit_path(assembly, waypoints_of(2, 1, (0, 0, 0.2))).certain == 1


@pytest.mark.parametrize(("scale", "away"), [(1e-4, 0.0), (1e4, 0.0), (1.0, 1e5)])
def test_where_it_is_and_how_large_make_no_difference(tmp_path: Path, scale: float, away: float) -> None:
    one, other = (shapely.transform(s, lambda p: p * scale + away) for s in (box(0, 0, 1, 1), box(1.01, 0, 2.01, 1)))
    assembly = made_of(tmp_path, part("a", one, fixed=True), part("b", other))
    assert audit_path(assembly, waypoints_of(2, 1, (-0.00999 * scale, 0, 0))).free
    assert not audit_path(assembly, waypoints_of(2, 1, (-0.0102 * scale, 0, 0))).free


# -- pairs that a path meets and its program does not know -----------------------------------------------------------


SIDE, GAP = 10.0, 0.2


def tiles(*glue: tuple[str, str]) -> Prepared:
    """Nine squares in three rows, a gap between neighbours; the first stands."""
    at = [(i, j) for j in range(3) for i in range(3)]
    parts = [
        box_part(
            f"t{k}", i * (SIDE + GAP), j * (SIDE + GAP), i * (SIDE + GAP) + SIDE, j * (SIDE + GAP) + SIDE, fixed=k == 0
        )
        for k, (i, j) in enumerate(at)
    ]
    return prepare_as_drawn(assemble(Drawing(tuple(parts), glue=glue, gap=0.0)))


@pytest.mark.parametrize("glue", [(), (("t1", "t2"), ("t4", "t8"))])
def test_only_pairs_outside_the_program_are_missed(glue):
    ready = tiles(*glue)
    bodies, rng = ready.bodies, np.random.default_rng(len(glue))
    n = len(bodies.fixed)
    half = select(ready.cells, np.arange(0, len(ready.cells.a), 2))
    program = build_program(bodies, half, ZERO_MOTION, length=ready.clearance)
    known = set(zip(half.a.tolist(), half.b.tolist(), strict=True))
    pitch = SIDE + GAP
    squares = [shapely.box(x, y, x + SIDE, y + SIDE) for y in (0, pitch, 2 * pitch) for x in (0, pitch, 2 * pitch)]
    met = 0
    for _ in range(20):
        motion = np.where(bodies.fixed[:, None], 0.0, rng.uniform(-0.3, 0.3, (n, 3)) * (1, 1, 0))
        moved = [shapely.affinity.translate(square, *motion[bodies.body_of[k], :2]) for k, square in enumerate(squares)]
        truth = set()
        for p, q in itertools.combinations(range(9), 2):
            a, b = sorted((int(bodies.body_of[p]), int(bodies.body_of[q])))
            if a != b and moved[p].intersection(moved[q]).area > 1e-6:
                truth.add((a, b))
        met += len(truth & known)
        found = missed_at(ready, motion[None], program)
        assert set(zip(*(one.tolist() for one in found), strict=True)) == truth - known
    assert met  # some overlap that the program answers for


def test_collinear_sides_and_touching_corners_are_no_overlap(tmp_path: Path) -> None:
    one, other = part("one", box(0, 0, 1, 1), fixed=True), part("other", box(1.5, 0, 2.5, 1))
    assembly = made_of(tmp_path, one, other)
    assert audit_path(assembly, waypoints_of(2, 1, (-0.5, 0, 0), (-0.5, 1, 0), (-1.5, 1, 0))).free
