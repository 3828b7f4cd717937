"""Parts that turn: ways out by turns and slides, judged by sampled booleans, are never called interlocked; hinges, wheels, bayonets."""

from __future__ import annotations

import itertools
import json
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from benchmarks.attack.families_solid import draw_solids
from benchmarks.attack.judge_solids import SolidGround
from benchmarks.spatial_overlaps import Judge, prisms, worst_on
from scipy.spatial.transform import Rotation, Slerp
from shapely import affinity

import wiggleroom as wr
from tests.test_spatial import ring, sound, spatial
from wiggleroom.spatial.bodies.rotations import exponential
from wiggleroom.spatial.search.spatial_prepare import prepare_spatial
from wiggleroom.spatial.search.turning_in_place import round_centres

manifold3d = pytest.importorskip("manifold3d")

Case = tuple[list[dict], list[list[str]]]
PLAY = 0.12


def walls(size: tuple[float, float, float], *windows: tuple[float, ...]) -> dict:
    """A fixed case, walls of 1, round a cavity from the origin, with windows: lower and upper corners."""
    every = np.array([w[:3] for w in windows] + [w[3:] for w in windows])
    ends = [sorted({-1.0, 0.0, s, s + 1, *every[:, k].clip(-1, s + 1)}) for k, s in enumerate(size)]
    boxes = []
    for cell in itertools.product(*(itertools.pairwise(e) for e in ends)):
        middle = np.mean(cell, axis=1)
        inside = ((middle > 0) & (middle < size)).all()
        if not inside and not any(((middle > w[:3]) & (middle < w[3:])).all() for w in windows):
            boxes.append([*(c[0] for c in cell), *(c[1] for c in cell)])
    return {"name": "case", "boxes": boxes, "fixed": True}


def bar_in_a_case(rng: np.random.Generator) -> Case:
    """It lies across the window that it fits through lengthwise."""
    width, length, height = 1 + rng.uniform(0, 0.5), 3 + rng.uniform(0, 2), rng.uniform(1, 2)
    side, half = np.hypot(width, length) + 0.6, width / 2 + PLAY
    window = (side - 0.01, side / 2 - half, 0, side + 1, side / 2 + half, height + 2 * PLAY)
    bar = [
        side / 2 - width / 2,
        side / 2 - length / 2,
        PLAY,
        side / 2 + width / 2,
        side / 2 + length / 2,
        PLAY + height,
    ]
    return [walls((side, side, height + 2 * PLAY), window), {"name": "bar", "boxes": [bar]}], []


def coin_in_a_money_box(rng: np.random.Generator) -> Case:
    across, thick = rng.uniform(3, 5), rng.uniform(0.5, 1.2)
    side = np.hypot(across, thick) + rng.uniform(0.6, 2)
    m, a, t = side / 2, across / 2 + PLAY, thick / 2 + PLAY
    coin = [m - across / 2, m - across / 2, m - thick / 2, m + across / 2, m + across / 2, m + thick / 2]
    return [
        walls((side, side, side), (m - t, m - a, side, m + t, m + a, side + 1)),
        {"name": "coin", "boxes": [coin]},
    ], []


def key_below_a_lid(rng: np.random.Generator) -> Case:
    """Its head turns, goes along with the stem in a slit, and leaves through a slot further on."""
    long, thick, along = rng.uniform(3, 4), rng.uniform(0.8, 1.1), rng.uniform(0.2, 0.7)
    side, top = long + 2.4, thick + 0.6
    c, t, turn = side / 2, thick / 2 + PLAY, thick / np.sqrt(2) + PLAY
    slot = (c - long / 2 - PLAY + along, c - t, top, c + long / 2 + PLAY + along, c + t, top + 1)
    hole, slit = (
        (c - turn, c - turn, top, c + turn, c + turn, top + 1),
        (c - t, c - t, top, c + t + along, c + t, top + 1),
    )
    head = [c - thick / 2, c - long / 2, 0.3, c + thick / 2, c + long / 2, 0.3 + thick]
    stem = [c - thick / 2, c - thick / 2, 0.3 + thick, c + thick / 2, c + thick / 2, top + 3]
    return [walls((side, side, top), slot, hole, slit), {"name": "key", "boxes": [head, stem]}], []


def bar_that_turns_twice(rng: np.random.Generator) -> Case:
    """Its longest side must come to lie along z and its middle one along x: turns about two axes."""
    a, b, c = 4 + rng.uniform(0, 1), 2.6 + rng.uniform(0, 0.4), 0.8 + rng.uniform(0, 0.4)
    side = np.hypot(a, b) + 0.5
    m = side / 2
    window = (m - b / 2 - PLAY, m - c / 2 - PLAY, side, m + b / 2 + PLAY, m + c / 2 + PLAY, side + 1)
    bar = [m - a / 2, m - b / 2, m - c / 2, m + a / 2, m + b / 2, m + c / 2]
    return [walls((side, side, side), window), {"name": "bar", "boxes": [bar]}], []


def coin_below_an_oblique_slot(rng: np.random.Generator) -> Case:
    across, thick, angle = rng.uniform(4, 6), rng.uniform(0.8, 1.2), rng.uniform(15, 80)
    room = across / 2 + 1.2
    outer, chamber = shapely.box(-room - 1, -room - 1, room + 1, room + 1), shapely.box(-room, -room, room, room)
    slot = shapely.box(-across / 2 - PLAY, -thick / 2 - PLAY, across / 2 + PLAY, thick / 2 + PLAY)
    lid = outer.difference(affinity.rotate(slot, angle))
    parts = [
        plate("floor", outer, -1, 0, fixed=True),
        plate("wall", outer.difference(chamber), 0, across, fixed=True),
        plate("lid", lid, across, across + 1, fixed=True),
        {"name": "coin", "boxes": [[-across / 2, -thick / 2, 0.2, across / 2, thick / 2, across - 0.2]]},
    ]
    return parts, [["floor", "wall", "lid"]]


def solids_of(parts: list[dict]) -> list:
    """Solids of the boolean library from the drawn boxes and plates."""
    found = []
    for part in parts:
        if "boxes" in part:
            cubes = [
                manifold3d.Manifold.cube(tuple(np.subtract(b[3:], b[:3]))).translate(tuple(b[:3]))
                for b in part["boxes"]
            ]
            found.append(manifold3d.Manifold.batch_boolean(cubes, manifold3d.OpType.Add))
        else:
            section = manifold3d.CrossSection([part["outline"], *part["holes"]], manifold3d.FillRule.EvenOdd)
            found.append(section.extrude(part["thickness"]).translate(tuple(part["at"])))
    return found


def worst_overlap(parts: list[dict], reference: np.ndarray, path: np.ndarray, mover: int) -> float:
    """Largest volume [mm3] that the moved part shares with the others at ten moments of every step."""
    solids, worst = solids_of(parts), 0.0
    own = solids[mover].translate(tuple(-reference[mover]))
    for one, two in itertools.pairwise(path[:, mover]):
        turn = Slerp([0, 1], Rotation.from_rotvec([one[3:], two[3:]]))
        for t in np.linspace(0, 1, 11):
            place = np.column_stack([turn(t).as_matrix(), reference[mover] + (1 - t) * one[:3] + t * two[:3]])
            moved = own.transform(place)
            worst = max(worst, *((moved ^ solid).volume() for k, solid in enumerate(solids) if k != mover))
    return worst


FAMILIES = [
    bar_in_a_case, coin_in_a_money_box, key_below_a_lid, coin_below_an_oblique_slot,
    pytest.param(bar_that_turns_twice, marks=pytest.mark.slow),
]  # fmt: skip


@pytest.mark.parametrize("family", FAMILIES)
def test_what_turns_and_slides_out_is_found(family) -> None:
    parts, glue = family(np.random.default_rng(0))
    assembly = spatial(*parts, glue=glue)
    found = wr.check(assembly)
    assert found.verdict == "comes apart"
    (escape,) = found.escapes
    mover = len(parts) - 1
    assert escape.parts == (parts[mover]["name"],)
    path = escape.path
    assert np.abs(np.delete(path, mover, axis=1)).max() == 0
    assert worst_overlap(parts, assembly.reference, path, mover) < 1e-6
    far = assembly.reference[mover] + path[-1, mover, :3]
    assert np.abs(far - assembly.reference[mover]).max() > 2 * assembly.size


def stick_round_a_corner(rng: np.random.Generator) -> Case:
    """It must turn and slide at once."""
    width, thick, arm = 2.0, 0.4, 8.0
    long = 0.9 * (2 * np.sqrt(2) * width - 2 * thick)
    outer = shapely.box(-1, -1, arm + 1, arm + 1)
    wall = outer.difference(shapely.union_all([shapely.box(0, 0, arm, width), shapely.box(0, 0, width, arm + 2)]))
    parts = [plate("floor", outer, -1, 0, fixed=True), plate("lid", outer, 0.6, 1.6, fixed=True)]
    parts += [plate(f"wall{k}", w, 0, 0.6, fixed=True) for k, w in enumerate(shapely.get_parts(wall))]
    glue, y = [[p["name"] for p in parts]], rng.uniform(0.3, 1.2)
    return [*parts, {"name": "stick", "boxes": [[arm - 0.2 - long, y, 0.1, arm - 0.2, y + thick, 0.5]]}], glue


@pytest.mark.slow
def test_what_is_not_found_is_not_called_interlocked() -> None:
    parts, glue = stick_round_a_corner(np.random.default_rng(0))
    assert wr.check(spatial(*parts, glue=glue)).verdict != "interlocked"


# -- hinges, wheels and bayonets -------------------------------------------------------------------------------------


HINGE_PLAY = 0.05


def plate(name: str, shape: shapely.Polygon, low: float, high: float, **more: object) -> dict:
    """A plate between two heights."""
    outline, *holes = [np.array(r.coords)[:-1].tolist() for r in (shape.exterior, *shape.interiors)]
    return {"name": name, "outline": outline, "holes": holes, "thickness": high - low, "at": [0, 0, low], **more}


def disc(count: int, radius: float) -> shapely.Polygon:
    return shapely.Polygon(ring(count, radius))


def flag() -> list[dict]:
    """An arm that swings about a pin of 16 sides, as far as a block with the same sides, 2.5 rad further on."""
    arm = shapely.box(8, -1, 30, 1)
    swinging = disc(16, 9).union(arm).difference(disc(16, (4 + HINGE_PLAY) / np.cos(np.pi / 16)))
    block = affinity.rotate(arm.intersection(shapely.box(9.2, -2, 30, 2)), 2.5, origin=(0, 0), use_radians=True)
    return [
        plate("arm", swinging, 0, 3),
        plate("pin", disc(16, 4), -5, 8, fixed=True),
        plate("block", block, -5, 8, fixed=True),
        plate("below", shapely.box(-40, -40, 40, 40).difference(disc(16, 4)), -6, -0.1, fixed=True),
        plate("above", shapely.box(-40, -40, 40, 40).difference(disc(16, 4)), 3.1, 9, fixed=True),
    ]


@pytest.mark.parametrize("lean", [0.0, 0.4], ids=["along its axis", "leaning"])
def test_an_arm_swings_as_far_as_its_stop(lean: float) -> None:
    parts, glue = flag(), [["pin", "block", "below", "above"]]
    found = sound(wr.flex(spatial(*parts, glue=glue), wr.Turn("arm", (lean, 0, 1))))
    assert found.verdict == "optimal"
    assert found.iterations < 150
    if not lean:  # both sides meet at their inner corners, mirrored on the line between arm and block
        assert found.objective == pytest.approx(2.5 - 2 * np.arctan(1 / 9.2), abs=4 * HINGE_PLAY / 9.2)
    assert np.degrees(found.turn[0]) == pytest.approx(np.degrees(2.5 - 2 * np.arctan(1 / 9.2)), abs=2)


def bayonet(slotted: bool, turned: float) -> tuple[list[dict], list[list]]:
    """A key with one lug in a round chamber below a lid, and the shapes that the judge sees."""
    stem, lug = disc(24, 5), shapely.box(0, -1.2, 6.5, 1.2).intersection(disc(24, 6.5))
    outer, around = shapely.box(-10, -10, 10, 10), 1 / np.cos(np.pi / 24)
    hole = disc(24, 5.2 * around).union(shapely.box(0, -1.4, 6.7, 1.4)) if slotted else disc(24, 5.2 * around)
    foot = stem.union(affinity.rotate(lug, turned, origin=(0, 0)))
    solids = {
        "floor": [(outer, -2.0, 0.0)],
        "wall": [(outer.difference(disc(24, 6.9 * around)), 0.0, 4.0)],
        "lid": [(outer.difference(hole), 4.0, 6.0)],
        "foot": [(foot, 0.3, 3.7)],
        "stem": [(stem, 3.7, 12.0)],
    }
    parts = [
        plate(name, *slabs[0], **({} if name in ("foot", "stem") else {"fixed": True}))
        for name, slabs in solids.items()
    ]
    shapes = [prisms(shape, low, high, 0.0, np.eye(3), 0.0) for ((shape, low, high),) in solids.values()]
    return parts, shapes


GLUE = [["floor", "wall", "lid"], ["foot", "stem"]]


def test_a_wheel_whose_centroid_lies_off_its_axis_turns_without_limit() -> None:
    parts, _ = bayonet(True, 77.0)
    found = sound(wr.flex(spatial(*parts, glue=GLUE), wr.Turn("stem", (0, 0, -1))))
    assert found.verdict == "unbounded"
    assert found.turns == ("foot", "stem")
    assert not found.leaves


@pytest.mark.slow
def test_a_bayonet_comes_apart_by_a_turn() -> None:
    parts, shapes = bayonet(True, 77.0)
    assembly = spatial(*parts, glue=GLUE)
    found = wr.check(assembly)
    assert found.verdict == "comes apart"
    (escape,) = found.escapes
    glued = [(0, 1), (0, 2), (1, 2), (3, 4)]
    judge = Judge(shapes, assembly.reference, [p.fixed for p in assembly.parts], glued)
    assert worst_on(judge, escape.path) < 1e-6


@pytest.mark.slow
def test_two_that_turn_only_together_are_not_called_interlocked() -> None:
    """A bar across a slot, and a peg in its window: each keeps the other from turning, and turned as one they leave."""
    case = [
        [-40, -40, -20, 40, 40, -10], [-40, -40, -20, -30, 40, 30], [30, -40, -20, 40, 40, 30], [-40, -40, -20, 40, -30, 30],
        [-40, 30, -20, 40, 40, 30], [-40, 5, 10, 40, 40, 30], [-40, -40, 10, 40, -5, 30], [-40, -40, 10, -15, 40, 30],
        [15, -40, 10, 40, 40, 30],
    ]  # fmt: skip
    bar = [[-5, 8, -10, 5, 15, 0], [-5, -15, -10, 5, -8, 0], [-5, -8, -10, -4, 8, 0], [4, -8, -10, 5, 8, 0]]
    parts = (
        {"name": "case", "boxes": case, "fixed": True}, {"name": "bar", "boxes": bar},
        {"name": "peg", "boxes": [[-4, -8, -10, 4, 8, 10]]},
    )  # fmt: skip
    assert wr.check(spatial(*parts, gap=0.2)).verdict == "unknown"
    assert wr.check(spatial(*parts, gap=0.2, glue=[["bar", "peg"]])).verdict == "comes apart"


def test_a_barb_that_passes_by_a_tilt_of_less_than_a_degree_comes_apart() -> None:
    base = [
        (-45, -10, -3.6, 110, 50, -2.4), (-35, 0, -2.4, 14, 40, -0.3), (86, 5, -2.4, 90, 35, 2.7),
        (45, 17, -2.4, 50, 23, 7.5), (-1, -10, -2.4, 13, -1, 3.6), (-1, 41, -2.4, 13, 50, 3.6),
        (-1, -1, 2.1, 13, 11, 3.6), (-1, 29, 2.1, 13, 41, 3.6), (84, 5, 5.4, 104, 35, 6.3),
        (104, 5, -2.4, 108, 35, 6.3),
    ]  # fmt: skip
    lid = [
        (0, 0, 0, 12, 40, 1.8), (12, 12, 0, 44, 28, 1.8), (44, 12, 0, 77, 16, 1.8), (44, 24, 0, 77, 28, 1.8),
        (77, 12, 0, 82, 28, 1.8), (78, 12, 1.8, 82, 28, 4.2), (82, 12, 3, 100, 28, 4.2), (91, 12, 2.1, 100, 28, 3),
    ]  # fmt: skip
    latch = spatial({"name": "base", "boxes": base, "fixed": True}, {"name": "lid", "boxes": lid})
    found = wr.check(latch)
    assert [escape.parts for escape in found.escapes] == [("lid",)]
    corners = [[np.array(list(product(*np.reshape(box, (2, 3)).T.tolist()))) for box in boxes] for boxes in (base, lid)]
    judge = Judge(corners, latch.reference, [True, False])
    assert worst_on(judge, found.escapes[0].path) < 1e-9 * latch.size


@pytest.mark.slow
def test_what_leaves_by_tilts_of_two_degrees_with_slides_is_not_called_interlocked() -> None:
    """A key was moved by slides of at most 0.6 mm with tilts of at most 2.5 degrees, then out; the boxes were grown where it never was."""
    assembly = wr.read(Path(__file__).parent / "solids" / "tilting_key.json")
    assert wr.check(assembly).verdict != "interlocked"


@pytest.mark.slow
def test_what_turns_where_whole_steps_lead_is_not_called_interlocked() -> None:
    # case and bar slide off a pin together; then the bar turns a quarter, half a step further, and leaves through a window
    frame = [
        (-10, -20, -20, 0, 50, 50), (50, -20, -20, 60, 50, 50), (0, -20, -20, 50, -10, 50), (0, 40, -20, 30, 50, 50),
        (40, 40, -20, 50, 50, 50), (30, 40, -20, 40, 50, 10), (30, 40, 20, 40, 50, 50), (0, -10, -20, 50, 40, -10),
        (0, -10, 40, 50, 40, 50), (0, 10, 10, 20, 20, 20),
    ]  # fmt: skip
    case = [
        (0, -10, -10, 10, 10, 40), (0, 20, -10, 10, 40, 40), (0, 10, -10, 10, 20, 10), (0, 10, 20, 10, 20, 40),
        (20, -10, -10, 30, 40, 40), (10, -10, -10, 20, 0, 40), (10, 30, -10, 20, 40, 10), (10, 30, 20, 20, 40, 40),
        (10, 0, -10, 20, 30, 0), (10, 0, 30, 20, 30, 40),
    ]  # fmt: skip
    bar = [(10, 0, 0, 20, 10, 20)]
    parts = (
        {"name": "frame", "boxes": frame, "fixed": True},
        {"name": "case", "boxes": case},
        {"name": "bar", "boxes": bar},
    )
    assert wr.check(spatial(*parts, gap=0.2)).verdict != "interlocked"


def test_the_axis_of_a_loose_pin_is_that_of_one_of_its_round_parts_and_lies_not_between_them() -> None:
    hole = shapely.box(-15, -15, 15, 15).difference(disc(8, 9))
    shaft, cam = plate("shaft", disc(16, 5), -5, 0), plate("cam", affinity.translate(disc(20, 5), 0.12, 0.05), 0, 5)
    ready = prepare_spatial(
        spatial(plate("frame", hole, -5, 5, fixed=True), shaft, cam, gap=2, glue=[["shaft", "cam"]])
    )
    body = int(np.flatnonzero(ready.grouping.bodies.moves)[0])
    (centre,) = round_centres(ready, body, np.array([0.0, 0, 1]))
    assert (centre + ready.grouping.bodies.at[body])[:2] == pytest.approx([0.12, 0.05], abs=1e-6)


@pytest.mark.parametrize("number", [1086, 14082])
def test_what_gets_loose_is_twisted_for_ever(number: int, tmp_path: Path) -> None:
    """A block with much room in a closed box, a lid that has come off, a wall that has left its slots."""
    _, made = draw_solids(number)
    assembly = wr.read(made.write(tmp_path))
    found = wr.flex(assembly)
    assert found.verdict == "unbounded"
    assert found.turns == (assembly.goals[0].part,)
    assert found.path == "checked"
    k = assembly.names.index(found.turns[0])
    turned, at = exponential(found.waypoints[:, k, 3:]), found.waypoints[:, k, :3]
    again = (np.abs(turned - turned[-1]).max(axis=(1, 2)) < 1e-9) & (np.abs(at - at[-1]).max(axis=1) < 1e-9)
    assert again[:-1].any(), "it has come back to where its last turn began"
    assert not SolidGround(made, assembly.reference).overlap(found.waypoints)


def capped(hole: list[list[float]], peg: list[list[float]]) -> dict[str, Any]:
    """A peg in the hole of a plate, between two lids."""
    square = [[-10, -10], [10, -10], [10, 10], [-10, 10]]
    return {
        "format": "wiggleroom/2", "gap": 0.2,
        "parts": [
            {"name": "plate", "outline": square, "holes": [hole], "thickness": 5, "fixed": True},
            {"name": "peg", "outline": peg, "thickness": 4, "at": [0, 0, 0.5]},
            {"name": "low", "boxes": [[-10, -10, -3, 10, 10, -0.5]], "fixed": True},
            {"name": "top", "boxes": [[-10, -10, 5.5, 10, 10, 8]], "fixed": True},
        ],
    }  # fmt: skip


def regular(count: int, radius: float) -> list[list[float]]:
    return [[radius * np.cos(2 * np.pi * k / count), radius * np.sin(2 * np.pi * k / count)] for k in range(count)]


@pytest.mark.parametrize(
    ("hole", "peg", "spins"),
    [
        (
            regular(24, 4.0),
            regular(24, 3.6),
            ("peg",),
        ),  # the inner radius of the hole is 3.97, the outer one of the peg 3.6
        (regular(4, 4.0), regular(4, 3.6), ()),
        (regular(4, 4.0), regular(4, 2.6), ("peg",)),  # 2.6 is less than the inner radius, 2.83
    ],
)
def test_what_turns_in_place_without_limit_spins(hole, peg, spins, tmp_path: Path) -> None:
    path = tmp_path / "peg.json"
    path.write_text(json.dumps(capped(hole, peg)))
    found = wr.check(wr.read(path))
    assert str(found.verdict) == "interlocked" or (spins and str(found.verdict) == "unknown")
    assert found.spins == spins
