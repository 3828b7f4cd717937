"""Families of parts that close rings or open ways for each other: frames, doors, toggles, keyholes, couplings, carousels."""

from __future__ import annotations

import numpy as np
import shapely
from shapely import Polygon

from benchmarks.attack import drawing as draw
from benchmarks.attack.drawing import Json, Random
from benchmarks.attack.families_fitted import gap_of, tabs


def _movable(made: list[Json]) -> list[str]:
    return [p["name"] for p in made if not p.get("fixed")]


def closed_rings(rng: Random) -> Json:
    """Links in a closed ring, each with a tab in the next, some round a post."""
    g, count = gap_of(rng, 0.01, 0.04), int(rng.integers(4, 8))
    angle, long = 2 * np.pi / count, 1.0
    reach = long / 2 / np.tan(angle / 2)
    wedge = Polygon(
        [(0, 0), (9 * np.sin(-angle / 2), -9 * np.cos(angle / 2)), (9 * np.sin(angle / 2), -9 * np.cos(angle / 2))]
    )
    band = draw.cut(
        draw.disc(reach + 0.7, count * 2, phase=np.pi / count), draw.disc(reach - 0.4, count, phase=np.pi / count)
    )
    link = shapely.intersection(band, wedge)
    at = (reach + 0.15) * np.array([np.sin(angle / 2), -np.cos(angle / 2)])
    knob = draw.moved(draw.moved(tabs(rng), turn=angle / 2), *at)
    links = []
    for k in range(count):
        one = draw.union(link, knob)
        one = draw.cut(one, draw.moved(knob, turn=-angle))
        links.append(draw.wider(draw.moved(one, turn=k * angle), -g / 2))
    made = [
        draw.part(f"link{k}", max(draw.pieces(p), key=lambda q: q.area), fixed=k == 0 and rng.random() < 0.6)
        for k, p in enumerate(links)
    ]
    if rng.random() < 0.5 or not any(p.get("fixed") for p in made):
        made.append(draw.part("post", draw.disc((reach - 0.4) * rng.uniform(0.3, 0.8), 10), fixed=True))
    return draw.assembly(made, [draw.goal(rng, _movable(made))])


def doors_with_bolts(rng: Random) -> Json:
    """A door on a hinge in a frame, and a bolt that slides behind it."""
    g, r = gap_of(rng, 0.01, 0.05), 0.15
    door = draw.cut(draw.union(draw.box(0, -0.15, 2, 0.15), draw.disc(0.3, 16)), draw.disc(r + g, 14))
    jamb = draw.box(2 + g + rng.uniform(0.02, 0.05), -0.15, 2.6, 0.15)
    x = rng.uniform(1.5, 1.9)
    bolt = draw.box(x, 0.15 + g, 2.5, 0.35)
    keeper = draw.cut(
        draw.box(2.1, 0.15 + g, 2.6, 0.7), draw.wider(draw.box(x, 0.15, 2.5 + rng.uniform(0.0, 0.7), 0.35), g)
    )
    made = [
        draw.part("axle", draw.disc(r, 14), fixed=True),
        draw.part("door", door),
        draw.part("jamb", jamb, fixed=True),
        draw.part("bolt", bolt),
    ]
    made += [draw.part(f"keeper{k}", p, fixed=True) for k, p in enumerate(draw.pieces(keeper))]
    made.append(draw.part("sill", draw.box(0.6, -0.5, 2.6, -0.15 - g), fixed=True))
    return draw.assembly(made, [draw.turn("door", "ccw") if rng.random() < 0.6 else draw.goal(rng, ["bolt", "door"])])


def toggles(rng: Random) -> Json:
    """Two bars, end to end and bent, between a wall and a slider that may give way."""
    g, bend = gap_of(rng, 0.02, 0.05), rng.uniform(-0.3, 0.3)
    knee, end = np.array([1.2 * np.cos(bend), 1.2 * np.sin(bend)]), np.array([2.4 * np.cos(bend), 0.0])
    bars = [
        shapely.buffer(shapely.LineString(p), 0.12, quad_segs=3)
        for p in (((0.15, 0.15 * np.tan(bend)), knee * 0.88), (knee + (end - knee) * 0.12, end - (0.15, 0)))
    ]
    slider = draw.box(end[0] + 0.02 + g, -0.3, end[0] + 0.6, 0.3)
    still = draw.cut(
        draw.box(-0.6, -1.0, end[0] + 1.0, 1.0),
        draw.box(0.0, -0.3 - g, end[0] + 0.6 + rng.uniform(0.02, 0.3), 0.3 + g),
        draw.box(0.0, -0.7, end[0] - 0.2, 0.7),
    )
    made = [
        draw.part(
            "still",
            max(draw.pieces(draw.cut(still, *(draw.wider(b, g) for b in bars))), key=lambda p: p.area),
            fixed=True,
        )
    ]
    made += [draw.part(f"bar{k}", b) for k, b in enumerate(bars)] + [draw.part("slider", slider)]
    return draw.assembly(made, [draw.goal(rng, ["slider", "bar0", "bar1"])])


def keyhole_plates(rng: Random) -> Json:
    """A hung plate: a keyhole over a head that stands, or two keyholes over two."""
    g, wide, deep = gap_of(rng, 0.01, 0.05), rng.uniform(0.1, 0.2), rng.uniform(0.4, 0.9)
    r = wide * rng.uniform(1.3, 2.0)
    spots = [0.0, 1.4][: int(rng.integers(1, 3))]
    holes = [draw.union(draw.disc(r + g, 16, (x, 0)), draw.box(x - wide - g, 0, x + wide + g, deep)) for x in spots]
    plate = draw.cut(draw.box(-0.7, -0.7, spots[-1] + 0.7, deep + 0.4), *holes)
    pegs = [
        draw.disc(
            wide * rng.uniform(0.8, 1.0),
            int(rng.integers(8, 16)),
            (x, deep - wide * 1.1 - g if rng.random() < 0.4 else 0.0),
        )
        for x in spots
    ]
    made = [draw.part("plate", plate)]
    made += [draw.part(f"peg{k}", p, fixed=k == 0 or rng.random() < 0.5) for k, p in enumerate(pegs)]
    return draw.assembly(made, [draw.goal(rng, ["plate"])])


def claw_couplings(rng: Random) -> Json:
    """An inner star and an outer ring with claws, rubber cushions between them."""
    g, count = gap_of(rng, 0.01, 0.06), int(rng.integers(2, 5))
    step = 2 * np.pi / count
    inner = draw.union(
        draw.disc(0.5, 20), *(draw.moved(draw.box(0.4, -0.1, 1.0, 0.1), turn=k * step) for k in range(count))
    )
    outer = draw.cut(draw.disc(1.5, 20), draw.disc(1.0 + g + 0.02, 20))
    outer = draw.union(
        outer, *(draw.moved(draw.box(0.5 + 3 * g, -0.1, 1.2, 0.1), turn=(k + 0.5) * step) for k in range(count))
    )
    made = [draw.part("outer", outer, fixed=True), draw.part("inner", inner)]
    for k in range(2 * count):
        if rng.random() < 0.5:
            size = 0.5 * np.sin(step / 4) * rng.uniform(0.4, 0.8)
            at = 0.78 * np.array([np.cos((k + 0.5) * step / 2), np.sin((k + 0.5) * step / 2)])
            made.append(draw.part(f"cushion{k}", draw.disc(min(size, 0.18), int(rng.integers(5, 10)), at)))
    return draw.assembly(made, [draw.turn("inner", "ccw") if rng.random() < 0.6 else draw.goal(rng, _movable(made))])


def whippletrees(rng: Random) -> Json:
    """A bar that pushes two others, each of which pushes two blocks in shafts of different depth."""
    g = gap_of(rng, 0.01, 0.05)
    body, made = draw.box(-0.4, -1.6, 4.4, 2.4), []
    for k in range(4):
        deep = rng.uniform(0.2, 0.8)
        body = draw.cut(body, draw.box(k + 0.2, -0.2 - deep, k + 0.8, 0.5))
        made.append(draw.part(f"block{k}", draw.box(k + 0.2 + g, 0.0, k + 0.8 - g, 0.6)))
    body = draw.cut(body, draw.box(0.0, 0.4, 4.0, 2.5))
    for k in range(2):
        made.append(
            draw.part(
                f"bar{k}",
                draw.union(
                    draw.box(2 * k + 0.1, 0.62 + g, 2 * k + 1.9, 0.85), draw.box(2 * k + 0.95, 0.8, 2 * k + 1.05, 1.0)
                ),
            )
        )
    made.append(draw.part("top", draw.union(draw.box(0.3, 1.02 + g, 3.7, 1.3), draw.box(1.95, 1.2, 2.05, 1.7))))
    return draw.assembly(
        [draw.part("body", body, fixed=True), *made],
        [draw.pull("top", (0, -1)) if rng.random() < 0.6 else draw.goal(rng, _movable(made))],
    )


def carousels(rng: Random) -> Json:
    """A wheel with pockets in a round case with an opening, a stone in each pocket."""
    g, count = gap_of(rng, 0.02, 0.06), int(rng.integers(2, 5))
    step = 2 * np.pi / count
    wheel = draw.disc(1.0, 24)
    wheel = draw.cut(
        wheel,
        *(draw.moved(draw.box(0.45, -0.25, 1.2, 0.25), turn=k * step) for k in range(count)),
        draw.disc(0.15 + g, 14),
    )
    case = draw.cut(draw.disc(1.6, 20), draw.disc(1.0 + g, 24))
    if rng.random() < 0.6:
        case = draw.cut(case, draw.moved(draw.box(0.8, -0.3, 2, 0.3), turn=rng.uniform(0.2, 6)))
    made = [
        draw.part("axle", draw.disc(0.15, 14), fixed=True),
        draw.part("case", max(draw.pieces(case), key=lambda p: p.area), fixed=True),
        draw.part("wheel", wheel),
    ]
    for k in range(count):
        stone = draw.polar(rng.uniform(0.12, 0.22, int(rng.integers(4, 8))))
        made.append(draw.part(f"stone{k}", draw.moved(draw.moved(stone, 0.72), turn=k * step)))
    return draw.assembly(made, [draw.turn("wheel", "cw") if rng.random() < 0.4 else draw.goal(rng, _movable(made))])


def drawers(rng: Random) -> Json:
    """Drawers in a chest with stops, a bar through some of them."""
    g, count = gap_of(rng, 0.01, 0.05), int(rng.integers(2, 4))
    chest, made = draw.box(-0.3, -0.3, 2.3, count + 0.1), []
    for k in range(count):
        lip = rng.uniform(0.05, 0.15)
        room = draw.union(draw.box(0, k, 1.8, k + 0.7), draw.box(1.7, k + lip, 2.5, k + 0.7))
        chest = draw.cut(chest, room)
        tray = draw.union(
            draw.box(0.05, k + lip + g, 2.2, k + 0.7 - g), draw.box(0.05, k + g, 0.05 + rng.uniform(0.2, 1.0), k + 0.5)
        )
        made.append((f"drawer{k}", tray))
    bar = draw.box(0.8, 0.4, 1.0, count - 0.5)
    chest = draw.cut(chest, draw.wider(bar, g))
    slot = rng.uniform(0.05, 0.6)
    shapes = [
        draw.part(n, max(draw.pieces(draw.cut(t, draw.box(0.8 - slot, 0.4 - g, 1.0 + g, count))), key=lambda p: p.area))
        for n, t in made
    ]
    walls = [draw.part(f"chest{k}", p, fixed=True) for k, p in enumerate(draw.pieces(chest))]
    shapes.append(draw.part("bar", bar))
    return draw.assembly([*walls, *shapes], [draw.goal(rng, _movable(shapes))])


def split_sleeves(rng: Random) -> Json:
    """A shaft in two half shells in a bore, keyed to the one or both."""
    g, corners = gap_of(rng, 0.01, 0.05), int(rng.integers(8, 24))
    key = draw.box(0.3, -0.1, 0.55, 0.1)
    shaft = draw.union(draw.disc(0.4, corners), key)
    ring = draw.cut(draw.disc(0.9, corners), draw.wider(shaft, g))
    angle = rng.uniform(0.4, 2.7)
    halves = draw.pieces(draw.cut(ring, draw.moved(draw.box(-2, -g / 2, 2, g / 2), turn=angle)))
    if rng.random() < 0.6:
        pin = draw.moved(draw.box(0.8, -0.08, 1.05, 0.08), turn=angle + 1.5)
        halves = [draw.union(h, pin) if shapely.intersects(h, pin) else h for h in halves]
        bore = draw.union(draw.disc(0.9, corners), pin)
    else:
        bore = draw.disc(0.9, corners)
    made = [draw.part("bore", draw.cut(draw.box(-1.4, -1.4, 1.4, 1.4), draw.wider(bore, g)), fixed=True)]
    made += [draw.part(f"shell{k}", p) for k, p in enumerate(halves)] + [draw.part("shaft", shaft)]
    return draw.assembly(made, [draw.turn("shaft", "ccw") if rng.random() < 0.6 else draw.goal(rng, _movable(made))])
