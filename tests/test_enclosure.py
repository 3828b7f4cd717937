"""What lies in a closed hole is held; frames that open, wide mouths and parts that pass through are not taken for closed."""

from __future__ import annotations

import time

import numpy as np
import pytest
import shapely
from shapely import affinity
from shapely.ops import voronoi_diagram

import wiggleroom as wr
from tests.flexing import part_at
from tests.oracle import collision
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.disassembly.enclosure import cages
from wiggleroom.drawing.model import Drawing


def tangram(**more: shapely.Geometry) -> dict[str, shapely.Geometry]:
    corners = [
        [(0, 0), (4, 0), (2, 2)], [(0, 0), (2, 2), (0, 4)], [(4, 0), (4, 2), (3, 1)], [(3, 1), (4, 2), (3, 3), (2, 2)],
        [(2, 2), (3, 3), (1, 3)], [(0, 4), (1, 3), (3, 3), (2, 4)], [(4, 2), (4, 4), (2, 4)],
    ]  # fmt: skip
    return {f"t{k}": shapely.Polygon(25 * np.array(c)) for k, c in enumerate(corners)} | more


box = shapely.box
INNER = box(0, 0, 100, 100)


def made(gap: float, fixed: str = "", glue: tuple = (), ignore: tuple = (), **shapes: shapely.Geometry) -> Assembly:
    """An assembly of polygons; those whose name begins with `fixed` stand."""
    parts = [
        part_at(n, s, (*s.centroid.coords[0], 0.0), bool(fixed) and n.startswith(fixed)) for n, s in shapes.items()
    ]
    return assemble(Drawing(tuple(parts), gap=gap, glue=glue, ignore=ignore))


def voronoi(count: int, seed: int) -> dict[str, shapely.Geometry]:
    points = shapely.MultiPoint(np.random.default_rng(seed).uniform(0, 100, (count, 2)))
    cells = voronoi_diagram(points, envelope=INNER).geoms
    return {f"v{k}": cell.intersection(INNER) for k, cell in enumerate(cells)}


TRAY = box(-10, -10, 110, 110) - INNER


@pytest.mark.parametrize("scale", [1e-5, 1.0, 1e4])
def test_a_puzzle_in_a_frame_is_held_at_once(scale):
    shapes = voronoi(13, 1) | {"frame": TRAY}
    shapes = {n: affinity.scale(s, scale, scale, origin=(0, 0)) for n, s in shapes.items()}
    found = wr.check(made(0.4 * scale, "frame", **shapes), every=False)
    assert (found.verdict, found.certainty) == ("interlocked", "proven")


@pytest.mark.parametrize(
    ("slot", "verdict"),
    [
        (box(40, -20, 60, 10), "comes apart"),  # as wide as a block and more
        (box(46, -20, 54, 10), "interlocked"),  # narrower than both blocks
    ],
    ids=["wide", "narrow"],
)
def test_a_hole_with_a_slot(slot, verdict):
    shapes = {"wall": TRAY - slot, "a": box(43, 20, 57, 34), "b": box(20, 60, 80, 75)}
    found = wr.check(made(0.2, "wall", **shapes), every=False)
    assert (found.verdict, found.certainty) == (verdict, "proven")


def test_a_frame_of_loose_bars_opens():
    bars = {
        "s": box(-10, -10, 110, 0),
        "n": box(-10, 100, 110, 110),
        "w": box(-10, 0, 0, 100),
        "e": box(100, 0, 110, 100),
    }
    found = wr.check(made(0.2, **bars, block=box(20, 20, 80, 80)))
    assert found.verdict == "comes apart"


@pytest.mark.parametrize("how", ["fixed", "glued"])
def test_a_frame_of_bars_that_stand_or_are_glued_holds_behind_its_seams(how):
    bars = {
        "fs": box(-10, -10, 110, 0),
        "fn": box(-10, 100, 110, 110),
        "fw": box(-10, 0, 0, 100),
        "fe": box(100, 0, 110, 100),
    }
    blocks = {"a": box(5, 5, 45, 95), "b": box(50, 5, 95, 95)}
    assembly = made(
        0.4, "f" if how == "fixed" else "fs", glue=(tuple(bars),) if how == "glued" else (), **bars, **blocks
    )
    found = wr.check(assembly, every=False)
    assert (found.verdict, found.certainty) == ("interlocked", "proven")


def halves(neck: float) -> dict[str, shapely.Geometry]:
    """A frame of two halves, joined above and below by tabs with a neck and a head of 6."""
    left = box(-12, -12, 50, 112) - INNER
    tabs = [box(45, y - neck / 2, 53, y + neck / 2) | box(53, y - 3, 57, y + 3) for y in (-6, 106)]
    frame = box(-12, -12, 112, 112) - INNER
    return {"left": shapely.union_all([left, *tabs]), "right": frame - shapely.union_all([left, *tabs])}


@pytest.mark.parametrize(("neck", "verdict"), [(3.0, "interlocked"), (6.0, "comes apart")])
def test_a_frame_of_halves_holds_where_these_interlock(neck, verdict):
    blocks = {"a": box(10, 10, 45, 90), "b": box(55, 10, 90, 90)}
    found = wr.check(made(0.3, "left", **halves(neck), **blocks), every=False)
    assert (found.verdict, found.certainty) == (verdict, "proven")


def test_what_passes_through_its_frame_is_not_held():
    shapes = {"frame": TRAY, "block": box(20, 20, 60, 60)}
    assert wr.check(made(0.2, "frame", ignore=(("frame", "block"),), **shapes)).verdict == "comes apart"


def test_a_hole_within_a_hole_is_no_wall():
    """A body round the wall is not enclosed, though the wall has a hole."""
    post = box(40, 40, 60, 60) - box(45, 45, 55, 55)
    hook = box(20, 20, 80, 80) - box(30, 30, 70, 90)
    assert wr.check(made(0.2, "post", post=post, hook=hook)).verdict == "comes apart"


def _flooded(wall: shapely.Polygon, body: shapely.Polygon, step: float) -> bool:
    """True where a flood over a grid of motions, which reasons about nothing, gets 40 steps away."""
    seen, front = {(0, 0, 0)}, [(0, 0, 0)]
    turn = step / np.hypot(*shapely.get_coordinates(body).T).max()
    moves = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    while front and len(seen) < 60_000:
        around = {tuple(np.add(f, m).tolist()) for f in front for m in moves} - seen
        if not around:
            break
        table = sorted(around)
        hit = collision.overlaps(wall, body, np.array(table) * (step, step, turn), np.zeros(2))
        front = [f for f, h in zip(table, hit, strict=True) if not h]
        seen |= around
        if any(max(abs(x), abs(y)) > 40 for x, y, _ in front):
            return True
    return False


@pytest.mark.parametrize("seed", range(4))
def test_no_flood_leaves_what_is_said_to_hold(seed):
    """Heads behind mouths of random width: said to be held only where a plain flood of motions stays inside."""
    rng = np.random.default_rng(seed)
    mouth = rng.uniform(0.3, 1.6)
    socket = (
        box(-4, -4, 4, 4) - shapely.Point(0, 0).buffer(2, quad_segs=int(rng.integers(1, 6))) - box(-mouth, 0, mouth, 5)
    )
    turned = affinity.rotate(
        box(-rng.uniform(0.8, 1.3), -rng.uniform(0.8, 1.3), 1.0, 0.9), rng.uniform(0, 90), origin=(0, 0)
    )
    neck = box(-mouth / 2, 0, mouth / 2, rng.uniform(0.0, 6.0) + 1)
    body = shapely.union(turned, neck)
    if body.intersects(socket):
        pytest.skip("does not fit")
    if cages(socket, body):
        assert not _flooded(socket, body, 0.1)
    elif mouth > 1.5:
        assert _flooded(socket, body, 0.1)


def test_time_is_kept_and_says_what_is_known(command):
    file = "examples/drawings/pyjigsaw_4x5.svg"
    wr.check(wr.patterns.chain(2, joint="swallowtail", gap=0.08))  # compiled
    began = time.process_time()
    found = wr.check(wr.read(file, gap=2.5), seconds=0.2)
    assert time.process_time() - began < 10.0  # well below what the whole answer takes
    assert found.verdict == "unknown"
    assert command("check", file, "--gap", "2.5", "--time", "0.2") == 3
    assert command("check", file, "--time", "0") == 2
    border = wr.largest_gap(wr.read(file, gap=2.0), seconds=0.1)
    assert (border.holds, border.parts_at) == (None, None)


@pytest.mark.parametrize("seed", range(3))
def test_a_disc_is_held_exactly_where_it_is_wider_than_its_mouth(seed):
    """Known to a tenth of a per cent; a polygon is as wide as its inner disc, or wider."""
    rng = np.random.default_rng(seed)
    count, radius, rise = int(rng.integers(40, 200)), rng.uniform(3, 9), rng.uniform(0.3, 0.9)
    hollow = shapely.Point(0, 0).buffer(radius, quad_segs=50)
    claw = shapely.box(-20, -20, 20, rise * radius) - hollow
    corners = shapely.get_coordinates(claw)
    gate = corners[np.abs(corners[:, 1] - rise * radius) < 1e-9, 0]
    half = (gate[gate > 0].min() - gate[gate < 0].max()) / 2
    turn = rng.uniform(0, 7) + 2 * np.pi * np.arange(count) / count
    disc = shapely.Polygon(np.column_stack([np.cos(turn), np.sin(turn)]) / np.cos(np.pi / count))
    for share, held in ((1.001, True), (0.999, False)):
        body = affinity.scale(disc, share * half, share * half, origin=(0, 0))
        assert cages(claw, body) == held


def test_a_ring_does_not_leave_what_stands_in_it():
    ring = shapely.box(-6, -6, 6, 6) - shapely.box(-5, -5, 5, 5)
    cross = shapely.box(-4, -1, 4, 1) | shapely.box(-1, -4, 1, 4)
    post = shapely.Point(3.8, 3).buffer(1, quad_segs=4)
    found = wr.check(
        assemble(Drawing((part_at("ring", ring), part_at("post", post, fixed=True), part_at("cross", cross))))
    )
    assert (found.verdict, found.certainty, found.states) == ("interlocked", "proven", 0)


@pytest.mark.parametrize("gap", [0.0, 0.5])
def test_a_tangram_in_a_tray_says_how_far_at_most(gap):
    found = wr.check(made(gap, **tangram(tray=TRAY)))
    assert (found.verdict, found.certainty) == ("interlocked", "proven")
    if gap:
        assert found.at_most <= 100 * np.sqrt(2) + 1e-9


def test_fixed_parts_that_are_left_are_not_called_interlocked_with_each_other():
    bases = {f"base{k}": box(40 * k, 0, 40 * k + 20, 10) for k in range(5)}
    found = wr.check(made(0.2, "base", **bases, lid=box(0, 10, 60, 20)))
    assert [e.parts for e in found.escapes] == [("lid",)]
    assert found.remains == ()


def test_rings_in_rings_that_all_move():
    ring = [
        shapely.Point(0, 0).buffer(r + 4, quad_segs=4) - shapely.Point(0, 0).buffer(r, quad_segs=4) for r in (5, 12, 20)
    ]
    found = wr.check(made(0.2, a=ring[0], b=ring[1], c=ring[2], peg=box(-2, -2, 2, 2)), every=False)
    assert (found.verdict, found.certainty) == ("interlocked", "proven")
