"""Proofs that bodies in space stay together: drawn so that they must, or so that a path out is known."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
import shapely
from benchmarks.attack.families_solid import draw_solids
from scipy.optimize import brentq, linprog
from shapely import Polygon, box

import wiggleroom as wr
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import UNLIMITED
from wiggleroom.spatial.bodies.rotations import exponential, logarithm
from wiggleroom.spatial.escapes.spatial_disassembly import check_spatial
from wiggleroom.spatial.overlaps.pose_cells import (
    CLOSED,
    beyond_face,
    quaternion_of,
    rotation_of,
    turned_within,
    worn_by_pair,
)
from wiggleroom.spatial.overlaps.swept_check import SweptCheck
from wiggleroom.spatial.proof.confinement import EFFORTS, PairwiseConfinement, inscribed_cylinders, packed_pieces
from wiggleroom.spatial.proof.narrow_windows import behind_narrow_windows
from wiggleroom.spatial.search.spatial_prepare import prepare_spatial
from wiggleroom.spatial.solids.convex import cuboid
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.solids.spatial_file import read_spatial


def spatial(*parts: dict, gap: float = 0.0) -> Assembly:
    return assemble_spatial(read_spatial(json.dumps({"format": "wiggleroom/2", "gap": gap, "parts": list(parts)})))


def tray(opening: float, scale: float = 1.0, shift: float = 0.0) -> Assembly:
    """A slab 20 x 12 x 4 in a case whose front is open but for a rim that leaves an opening of some height."""
    case = [[-2, -2, -2, 24, 14, 0], [-2, -2, 5, 24, 14, 7], [-2, -2, 0, 24, 0, 5], [-2, 12.6, 0, 24, 14, 5]]
    case += [[-2, 0, 0, 0, 12.6, 5], [22, 0, opening, 24, 12.6, 5]]
    slab = [[0.5, 0.3, 0.4, 20.5, 12.3, 4.4]]
    case, slab = ((scale * (np.array(boxes) + shift)).tolist() for boxes in (case, slab))
    return spatial({"name": "case", "boxes": case, "fixed": True}, {"name": "slab", "boxes": slab})


@pytest.mark.parametrize(("scale", "shift"), [(1e-2, 0.0), (1.0, 1e5), (1e3, 0.0)])
@pytest.mark.parametrize(("opening", "held"), [(3.0, True), (4.0 + 1e-4, False)])
def test_what_is_held_does_not_hang_on_size_and_place(scale, shift, opening, held) -> None:
    """An opening a little higher than the slab lets it out, though pieces overlap by next to nothing where they would have to touch."""
    assembly = tray(opening, scale, shift)
    assert PairwiseConfinement(prepare_spatial(assembly), UNLIMITED).prove(EFFORTS[1]) == held


def test_nothing_is_proven_where_the_rim_lets_it_out_only_after_it_is_let_down() -> None:
    assembly = tray(opening=4.2)  # it lies 0.4 mm above the floor
    held = PairwiseConfinement(prepare_spatial(assembly), UNLIMITED)
    assert not held.prove(EFFORTS[0])
    found = check_spatial(assembly)
    assert (found.verdict, found.certainty) == ("comes apart", "proven")


@pytest.mark.parametrize(("heads", "opening"), [(True, "interlocked"), (False, "comes apart")])
def test_a_pin_with_heads_is_held_by_its_hole(heads: bool, opening: str) -> None:
    circle = np.column_stack([np.cos(np.arange(12) * np.pi / 6), np.sin(np.arange(12) * np.pi / 6)])
    stem = {"outline": (2.0 * circle).tolist(), "thickness": 12, "at": [0, 0, -1]}
    plate = {"name": "plate", "outline": [[-9, -9], [9, -9], [9, 9], [-9, 9]], "holes": [(2.2 * circle).tolist()]}
    parts = [plate | {"thickness": 10, "fixed": True}, {"name": "pin"} | stem]
    glue = []
    for k, z in enumerate((-4, 10.5) if heads else ()):
        parts.append({"name": f"head{k}", "outline": (3.6 * circle).tolist(), "thickness": 3.5, "at": [0, 0, z]})
        glue.append(f"head{k}")
    file = {"format": "wiggleroom/2", "gap": 0.0, "parts": parts, "glue": [["pin", *glue]] if glue else []}
    found = check_spatial(assemble_spatial(read_spatial(json.dumps(file))))
    assert found.verdict == opening
    assert found.certainty == "proven"


@pytest.mark.parametrize(("heads", "held"), [((-4, 10.5), True), ((-4,), False)])
def test_a_ring_is_held_by_a_rod_of_several_standing_parts(heads: tuple[float, ...], held: bool) -> None:
    """With one head missing it goes straight off."""
    circle = np.column_stack([np.cos(np.arange(12) * np.pi / 6), np.sin(np.arange(12) * np.pi / 6)])
    ring = {"name": "ring", "outline": (6.0 * circle).tolist(), "holes": [(2.2 * circle).tolist()], "thickness": 10}
    stem = {"name": "stem", "outline": (2.0 * circle).tolist(), "thickness": 12, "at": [0, 0, -1], "fixed": True}
    rod = [
        {"name": f"head{k}", "outline": (3.6 * circle).tolist(), "thickness": 3.5, "at": [0, 0, z], "fixed": True}
        for k, z in enumerate(heads)
    ]
    confinement = PairwiseConfinement(prepare_spatial(spatial(ring, stem, *rod)), UNLIMITED)
    assert any(confinement.prove(effort) for effort in EFFORTS[:2]) == held


def test_all_rotations_of_a_cell_lie_within_its_turn() -> None:
    rng = np.random.default_rng(5)
    for _ in range(60):
        cube = int(rng.integers(4))
        low = np.zeros(6)
        low[3:] = rng.uniform(-1, 0.9, 3)
        high = np.minimum(low + rng.uniform(0, 0.4, 6), 1.0)
        q0, q, turn = np.empty(4), np.empty(4), np.empty(3)
        quaternion_of(cube, (low[3:] + high[3:]) / 2, q0)
        turned_within(cube, low, high, q0, turn)
        for _ in range(40):
            quaternion_of(cube, rng.uniform(low[3:], high[3:]), q)
            vector = logarithm((rotation_of(q0).T @ rotation_of(q))[None])[0]
            assert (np.abs(vector) <= turn + 1e-9).all()


def test_cylinders_lie_inside_a_bored_block_and_reach_its_nearest_face() -> None:
    import trimesh

    flat = shapely.difference(box(-5, -4, 6, 7), Polygon([(2, -1), (3, -1), (3, 1), (2, 1)]))
    mesh = trimesh.creation.extrude_polygon(flat, 3.0, engine="manifold")
    from wiggleroom.drawing.model import Surface

    (cylinder,) = inscribed_cylinders(Surface(np.asarray(mesh.vertices), np.asarray(mesh.faces)))
    assert np.linalg.norm(cylinder.corners[:, :2], axis=1).max() == pytest.approx(2.0)
    assert np.ptp(cylinder.corners[:, 2]) == pytest.approx(3.0)


@pytest.mark.slow
@pytest.mark.parametrize("number", [2, 31])
def test_what_is_known_to_come_apart_is_never_proven_to_be_held(number: int, tmp_path) -> None:
    family, made = draw_solids(number)
    assert made.comes_apart, family
    held = PairwiseConfinement(prepare_spatial(wr.read(made.write(tmp_path))), UNLIMITED)
    assert not held.prove(EFFORTS[0])
    assert not held.prove(EFFORTS[1])


def test_beyond_the_edge_of_a_cube_lie_the_same_rotations_in_another_cube() -> None:
    rng = np.random.default_rng(8)
    half_box, box_beyond = 5.0, np.empty(12)
    for side in range(6, 12):
        for cube in range(4):
            low, high = np.full(6, -0.2), np.full(6, 0.3)
            k = side // 2
            low[k], high[k] = (0.6, 1.0) if side % 2 else (-1.0, -0.6)
            other = beyond_face(cube, low, high, side, half_box, box_beyond)
            assert other != cube
            for _ in range(20):
                point = rng.uniform(low[3:], high[3:])
                point[k - 3] = high[k] if side % 2 else low[k]
                q, same = np.empty(4), np.empty(4)
                quaternion_of(cube, point, q)
                scaled = np.delete(q / q[other], other)
                inside = np.clip(scaled, box_beyond[3:6], box_beyond[9:])
                assert np.abs(inside - scaled).max() < 1e-8
                quaternion_of(other, inside, same)
                assert abs(same @ q) == pytest.approx(1.0, abs=1e-12)


def together(P: np.ndarray, Q: np.ndarray) -> bool:
    """Whether the hulls of some corners meet, by linear programming."""
    same = np.zeros((5, len(P) + len(Q)))
    same[:3, : len(P)], same[:3, len(P) :] = P.T, -Q.T
    same[3, : len(P)] = same[4, len(P) :] = 1.0
    return linprog(np.zeros(same.shape[1]), A_eq=same, b_eq=[0, 0, 0, 1, 1], bounds=(0, None)).status == 0


def border(worn: Callable[[np.ndarray], float], at: np.ndarray, along: np.ndarray) -> np.ndarray | None:
    """The last place on the way from one along a direction where pieces overlap for sure; None where they never do, or for ever."""

    def overlap(far: float) -> float:
        return worn(at + far * along)

    if overlap(0.0) <= 0 or overlap(40.0) > 0:
        return None
    return at + brentq(overlap, 0.0, 40.0) * (1 - 1e-6) * along


def test_pieces_meet_at_all_poses_of_a_blocked_cell() -> None:
    rng, blocked = np.random.default_rng(1), 0
    nothing, axis, q0, turn = np.zeros(2, dtype=np.int64), np.empty(3), np.empty(4), np.empty(3)
    for _ in range(400):  # a bar long beside its width pulls back as it turns, and more than in proportion
        size, long, at = np.exp(rng.uniform(-1, 3, 3)), np.exp(rng.uniform(-2, 3, 3)), rng.normal(size=3)
        P, Q = cuboid(-size / 2, size / 2), cuboid(at - long / 2, at + long / 2)
        middle, width = rng.uniform(-0.5, 0.5, 3), np.exp(rng.uniform(-2, 0, 3)) * rng.choice([0, 1], 3)
        low, high = np.append(np.zeros(3), middle - width / 2), np.append(np.zeros(3), middle + width / 2)
        quaternion_of(0, middle, q0)
        turned_within(0, low, high, q0, turn)
        R = rotation_of(q0)
        pieces = packed_pieces([P]), packed_pieces([Q]), nothing
        T = border(partial(_worn, pieces=pieces, R=R, turn=turn, axis=axis), -R @ at, rng.normal(size=3))
        if T is None:
            continue
        blocked += 1
        for _ in range(6):
            q = np.empty(4)
            quaternion_of(0, np.where(rng.random(3) < 0.5, low[3:], high[3:]), q)
            assert together(P.corners, Q.corners @ rotation_of(q).T + T + rng.choice([-0.01, 0.01], 3))
    assert blocked > 100


def _worn(T: np.ndarray, pieces: tuple, R: np.ndarray, turn: np.ndarray, axis: np.ndarray) -> float:
    return worn_by_pair(*pieces, T, R, np.full(3, 0.01), turn, -np.inf, axis)


def test_a_bar_that_turns_out_of_a_wall_does_not_meet_it_at_all_poses() -> None:
    wall, bar = (
        cuboid(np.array([20.0, -50, -50]), np.array([25.0, 50, 50])),
        cuboid(*np.array([[-20.3, -0.2, -0.2], [20.3, 0.2, 0.2]])),
    )
    low, high, q0, turn = np.zeros(6), np.zeros(6), np.array([1.0, 0, 0, 0]), np.empty(3)
    low[5], high[5] = -np.tan(0.125), np.tan(0.125)  # a quarter of a radian either way
    turned_within(0, low, high, q0, turn)
    q = np.empty(4)
    quaternion_of(0, high[3:], q)
    assert together(wall.corners, bar.corners)
    assert not together(wall.corners, bar.corners @ rotation_of(q).T)
    pieces = packed_pieces([wall]), packed_pieces([bar]), np.zeros(2, dtype=np.int64)
    assert worn_by_pair(*pieces, np.zeros(3), np.eye(3), np.zeros(3), turn, -np.inf, np.empty(3)) <= 0


def _behind_a_window(wide: float, high: float, size: np.ndarray, turned: np.ndarray) -> Assembly:
    """A turned cuboid in a case with a rectangular window."""
    w, h = wide / 2, high / 2
    case = [(-13, -13, -13, 13, 13, -12), (-13, -13, -12, -12, 13, 12), (12, -13, -12, 13, 13, 12),
            (-12, -13, -12, 12, -12, 12), (-12, 12, -12, 12, 13, 12), (-13, -13, 12, -w, 13, 13), (w, -13, 12, 13, 13, 13),
            (-w, -13, 12, w, -h, 13), (-w, h, 12, w, 13, 13)]  # fmt: skip
    block = {"name": "block", "boxes": [[*(-size / 2).tolist(), *(size / 2).tolist()]], "rotate": turned.tolist()}
    return spatial({"name": "case", "boxes": case, "fixed": True}, block)


@pytest.mark.parametrize("seed", range(5))
def test_a_cuboid_is_held_by_a_window_that_is_smaller_than_its_least_section(seed: int) -> None:
    """Of all sections through the middle that across the longest edges has the least area and border (Vaaler 1979 for areas)."""
    rng = np.random.default_rng(seed)
    wide, high = rng.uniform(2, 6, 2)
    size = np.array([wide * rng.uniform(0.9, 1.1), high * rng.uniform(0.9, 1.1), rng.uniform(6.7, 8)])
    a, b, _ = np.sort(size)
    assembly = _behind_a_window(wide, high, size, rng.uniform(-90, 90, 3))
    held = PairwiseConfinement(prepare_spatial(assembly), UNLIMITED).prove_by_shape()
    if a < min(wide, high) and b < max(wide, high):
        assert not held
    elif a * b > wide * high or a + b > wide + high:
        assert held


def test_a_cube_half_a_percent_too_large_for_its_window_is_held() -> None:
    assert wr.check(_behind_a_window(4, 4, np.full(3, 4.02), np.zeros(3))).certainty == "proven"
    assert wr.check(_behind_a_window(4, 4, np.full(3, 3.98), np.zeros(3)), every=False).verdict == "comes apart"


@pytest.mark.parametrize("slope", [0, 1e-5, 0.02])
def test_a_bar_that_turns_and_leaves_through_a_leaning_lid_is_not_held(slope: float) -> None:
    """A bar of 12 x 3 x 3 turns in a case of 20 x 20 x 20 and leaves by a window of 4 x 4; one of 12 x 4.5 x 4.5 does not."""
    case = [(-11, -11, -11, 11, 11, -10), (-11, -11, -10, -10, 11, 12), (10, -11, -10, 11, 11, 12),
            (-10, -11, -10, 10, -10, 12), (-10, 10, -10, 10, 11, 12)]  # fmt: skip
    lid = [(-12, -12, 10, -2, 12, 11), (2, -12, 10, 12, 12, 11), (-2, -12, 10, 2, -2, 11), (-2, 2, 10, 2, 12, 11)]
    lean = exponential(slope * np.array([0.0, 1, 0]))
    boxes = [(np.reshape(b, (2, 3)).astype(float), np.eye(3)) for b in case]
    boxes += [(np.reshape(b, (2, 3)).astype(float), lean) for b in lid]
    cage = [cuboid(*corners).placed(turn, np.zeros(3)) for corners, turn in boxes]
    bars = [cuboid(-np.array([6, half, half]), np.array([6, half, half])) for half in (1.5, 2.25)]
    assert not behind_narrow_windows(cage, bars[0])
    assert slope or behind_narrow_windows(cage, bars[1])


@pytest.mark.parametrize("scale", [1e-2, 1.0, 1e3])
def test_cells_are_blocked_by_more_than_the_reach_hides(scale, monkeypatch) -> None:
    """Small where they meet, large besides: what must overlap is a share of the bodies' reach, not of the place where they meet."""
    seen = []
    monkeypatch.setattr("wiggleroom.spatial.proof.confinement.cover", lambda *given: seen.append(given[4:8]) or CLOSED)
    rod = [[0, 0, 0, 400, 1, 1]]
    hook = [[399, -1, -1, 402, 2, -0.1], [399, -1, 1.1, 402, 2, 2], [401, -1, -0.1, 402, 2, 1.1]]
    made = [
        {"name": n, "boxes": (scale * np.array(b, dtype=float)).tolist()} for n, b in (("rod", rod), ("hook", hook))
    ]
    assembly = spatial({**made[0], "fixed": True}, made[1])
    assert PairwiseConfinement(prepare_spatial(assembly), UNLIMITED).prove(EFFORTS[0])
    half_box, *_, margin = seen[0]
    assert half_box > 400 * scale
    assert 1e-7 * half_box < margin < 1e-5 * half_box


def test_room_along_a_line_is_where_the_swept_check_first_finds_an_overlap() -> None:
    rng = np.random.default_rng(3)
    assembly = tray(opening=3.0)
    checker, rest = SweptCheck(assembly), np.zeros((2, 6))
    for direction in rng.normal(size=(12, 3)):
        direction /= np.linalg.norm(direction)
        far = checker.room(rest, [1], direction, 50.0)
        end = rest.copy()
        end[1, :3] = 0.999 * far * direction
        assert not checker.overlaps(rest, end)
        end[1, :3] = 1.001 * far * direction
        assert checker.overlaps(rest, end)
