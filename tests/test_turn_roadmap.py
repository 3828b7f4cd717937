"""Assemblies that come apart by turns and slides: ways out are found and judged by sampled booleans, and none is called interlocked."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import shapely
from scipy.spatial.transform import Rotation, Slerp
from shapely import affinity

import wiggleroom as wr
from tests.test_spatial import spatial
from tests.test_spatial_turning import plate

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


FAMILIES = [bar_in_a_case, coin_in_a_money_box, key_below_a_lid, bar_that_turns_twice, coin_below_an_oblique_slot]


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
@pytest.mark.parametrize("family", FAMILIES)
def test_what_turns_and_slides_out_is_found(family, seed: int) -> None:
    parts, glue = family(np.random.default_rng(seed))
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


def leaning_coin(rng: np.random.Generator) -> Case:
    """A coin that lies askew in the middle of a money box."""
    across, thick = rng.uniform(3, 4), rng.uniform(0.4, 0.8)
    side = np.sqrt(2 * across**2 + thick**2) + 0.6
    m, a, t = side / 2, across / 2 + 0.2, thick / 2 + 0.2
    boxes = [[-across / 2, -across / 2, -thick / 2, across / 2, across / 2, thick / 2]]
    coin = {"name": "coin", "boxes": boxes, "at": [m, m, m], "rotate": rng.uniform(-60, 60, 3).tolist()}
    return [walls((side, side, side), (m - t, m - a, side, m + t, m + a, side + 1)), coin], []


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
@pytest.mark.parametrize("family", [leaning_coin, stick_round_a_corner])
def test_what_is_not_found_is_not_called_interlocked(family) -> None:
    parts, glue = family(np.random.default_rng(0))
    assert wr.check(spatial(*parts, glue=glue)).verdict != "interlocked"
