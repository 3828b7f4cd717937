"""Families of parts that fit into each other: keys, slots, rings and tilings."""

from __future__ import annotations

import numpy as np
import shapely
from scipy.spatial import Voronoi
from shapely import Polygon

from benchmarks.attack import drawing as draw
from benchmarks.attack.drawing import Json, Random


def gap_of(rng: Random, low: float = 0.005, high: float = 0.06) -> float:
    """A gap between low and high, small ones as often as large ones."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def c_rings(rng: Random) -> Json:
    """Two or three open rings, each hooked into another as deep as a few tries find."""
    placed: list[Polygon] = []
    for k in range(int(rng.integers(2, 4))):
        inner = rng.uniform(0.55, 0.7)
        mouth = rng.uniform((1 - inner) * 1.2, 1.5 * inner)
        ring = draw.cut(
            draw.disc(1.0, int(rng.integers(8, 24))),
            draw.disc(inner, int(rng.integers(6, 20))),
            draw.box(0, -mouth / 2, 2, mouth / 2),
        )
        places = [ring] if k == 0 else _poses(ring, placed[-1], rng)
        free = [p for p in places if all(shapely.distance(p, q) > 0.005 for q in placed)]
        if free:
            around = shapely.convex_hull(shapely.union_all(placed)) if placed else ring
            placed.append(max(free, key=lambda p: shapely.intersection(shapely.convex_hull(p), around).area))
    made = [draw.part(f"c{k}", p, fixed=k == 0) for k, p in enumerate(placed)]
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])] if len(made) > 1 else [])


def _poses(shape: Polygon, near: Polygon, rng: Random) -> list[Polygon]:
    """A shape in random poses about another."""
    middle = np.array(near.centroid.coords[0])
    spots = middle + rng.uniform(-1.2, 1.2, (300, 2))
    return [draw.moved(draw.moved(shape, turn=rng.uniform(0, 6.3)), *spot) for spot in spots]


def wedges(rng: Random) -> Json:
    """A frame cut up by slanted lines, one piece of it taken out."""
    g, width = gap_of(rng), rng.uniform(2, 4)
    cuts = np.sort(rng.uniform(0.1, 0.9, int(rng.integers(3, 6)))) * width
    left, block = [], draw.box(0, 0, width, 1)
    for x in cuts:
        slant = rng.uniform(-0.35, 0.35)
        knife = Polygon([(-9, -1), (x - 2 * slant, -1), (x + 3 * slant, 2), (-9, 2)])
        left += draw.pieces(shapely.intersection(block, knife))
        block = draw.cut(block, knife)
    left += draw.pieces(block)
    frame = draw.cut(
        draw.box(-0.4, -0.4, width + 0.4, 1.0 - rng.uniform(0, 0.1)), draw.wider(draw.box(0, 0, width, 1.5), g / 2)
    )
    out = int(rng.integers(len(left))) if len(left) > 4 else -1
    made = [draw.part("frame", frame, fixed=True)]
    made += [
        draw.part(f"b{k}", draw.wider(p, -g / 2))
        for k, p in enumerate(left)
        if k != out and draw.wider(p, -g / 2).area > 0.02
    ]
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])])


def bayonets(rng: Random) -> Json:
    """A pin with a head in a bent slot."""
    g, stem = gap_of(rng, 0.01, 0.08), rng.uniform(0.2, 0.35)
    slot = draw.union(
        draw.band([(0, 0), (0, 1.2)], stem), draw.band([(0, 0), (rng.uniform(0.4, 0.8), rng.uniform(-0.2, 0.3))], stem)
    )
    plate = draw.cut(draw.box(-1.2, -0.8, 1.2, 1.0), draw.wider(slot, g / 2))
    pin = draw.union(
        draw.disc(stem / 2 * rng.uniform(0.9, 1.0), 16), draw.band([(0, 0), (0, rng.uniform(0.2, 0.5))], stem * 0.6)
    )
    return draw.assembly([draw.part("plate", plate, fixed=True), draw.part("pin", pin)], [draw.goal(rng, ["pin"])])


def mazes(rng: Random) -> Json:
    """A slider in a winding channel."""
    width, points = rng.uniform(0.25, 0.4), [np.zeros(2)]
    quarter = rng.integers(4)
    for _ in range(int(rng.integers(3, 7))):
        quarter = (quarter + rng.choice([-1, 1])) % 4
        step = np.array([np.cos(quarter * np.pi / 2), np.sin(quarter * np.pi / 2)]) * rng.uniform(0.6, 1.4)
        points.append(points[-1] + step)
    channel = draw.band(points, width)
    plate = draw.cut(draw.wider(channel.envelope, 0.4), channel)
    slider = draw.wider(
        draw.box(-width / 2, -width / 2, width / 2 * rng.uniform(0.8, 1.3), width / 2), -gap_of(rng, 0.01, 0.04)
    )
    plate = max(draw.pieces(draw.cut(plate, draw.wider(slider, 0.003))), key=lambda p: p.area)
    rider = draw.part("slider", slider)
    return draw.assembly([draw.part("plate", plate, fixed=True), rider], [draw.goal(rng, ["slider"])])


def sliding_blocks(rng: Random) -> Json:
    """Blocks in a tray with some room left."""
    g, nx, ny = gap_of(rng, 0.01, 0.05), int(rng.integers(2, 5)), int(rng.integers(2, 4))
    taken, blocks = np.zeros((nx, ny), dtype=bool), []
    for x in range(nx):
        for y in range(ny):
            if taken[x, y] or rng.random() < 0.2:
                continue
            wide = 2 if x + 1 < nx and not taken[x + 1, y] and rng.random() < 0.4 else 1
            taken[x : x + wide, y] = True
            blocks.append(draw.wider(draw.box(x, y, x + wide, y + 1), -g / 2))
    tray = draw.cut(draw.box(-0.5, -0.5, nx + 0.5, ny + 0.5), draw.box(0, 0, nx, ny))
    if rng.random() < 0.5:
        tray = draw.cut(tray, draw.box(nx - 0.1, 0, nx + 1, 1))
    made = [draw.part("tray", tray, fixed=True), *(draw.part(f"b{k}", b) for k, b in enumerate(blocks))]
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])])


def locks(rng: Random) -> Json:
    """A key with notches under pins that slide in shafts."""
    g, count = gap_of(rng, 0.01, 0.05), int(rng.integers(2, 4))
    xs = np.arange(count) * 0.8 + 0.6
    key = draw.box(-0.6, 0, xs[-1] + 0.4, 0.5)
    pins, body = [], draw.box(-0.2, -0.4, xs[-1] + 0.9, 1.8)
    for x in xs:
        deep, wide = rng.uniform(0.05, 0.2), rng.uniform(0.2, 0.3)
        tip = Polygon([(x - wide / 2, 0.5), (x, 0.5 - deep), (x + wide / 2, 0.5)])
        pin = draw.union(tip, draw.box(x - wide / 2, 0.499, x + wide / 2, rng.uniform(0.9, 1.3)))
        key = draw.cut(key, draw.wider(tip, g))
        pins.append(draw.wider(pin, -g / 2))
        body = draw.cut(body, draw.box(x - wide / 2, 0.2, x + wide / 2, rng.uniform(1.4, 1.7)))
    body = draw.cut(body, draw.box(-0.5, -g / 2, xs[-1] + 0.5 + rng.uniform(0, 0.6), 0.5 + g / 2))
    made = [
        draw.part("body", max(draw.pieces(body), key=lambda p: p.area), fixed=True),
        draw.part("key", max(draw.pieces(key), key=lambda p: p.area)),
    ]
    made += [draw.part(f"pin{k}", p) for k, p in enumerate(pins)]
    return draw.assembly(
        made, [draw.pull("key", rng.choice([(-1, 0), (1, 0)])) if rng.random() < 0.7 else draw.goal(rng, ["pin0"])]
    )


def packed_polygons(rng: Random) -> Json:
    """Cells of a Voronoi diagram in a tray, some taken out."""
    g, count = gap_of(rng, 0.01, 0.08), int(rng.integers(4, 10))
    points = rng.uniform(0, 3, (count, 2))
    mirror = [points * (-1, 1), points * (1, -1), points * (-1, 1) + (6, 0), points * (1, -1) + (0, 6)]
    plan = Voronoi(np.concatenate([points, *mirror]))
    cells = [Polygon(plan.vertices[plan.regions[plan.point_region[k]]]) for k in range(count)]
    cells = [draw.wider(c, -g / 2) for c in cells]
    cells = [c for c in cells if c.geom_type == "Polygon" and c.area > 0.1]
    tray = draw.cut(draw.box(-0.5, -0.5, 3.5, 3.5), draw.box(0, 0, 3, 3))
    made = [draw.part("tray", tray, fixed=True)]
    made += [draw.part(f"p{k}", c) for k, c in enumerate(cells) if rng.random() < 0.85 or k == 0]
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])])


def loose_polygons(rng: Random) -> Json:
    """A few polygons that lie about in a box, or in the open."""
    placed: list[Polygon] = []
    for _ in range(60):
        shape = draw.polar(rng.uniform(0.2, 0.6, int(rng.integers(3, 8))), rng.uniform(0, 6))
        shape = draw.moved(shape, *rng.uniform(0.6, 2.4, 2))
        if shape.is_valid and all(shapely.distance(shape, p) > 0.02 for p in placed):
            placed.append(shape)
    placed = placed[: int(rng.integers(3, 7))]
    made = [draw.part(f"p{k}", p) for k, p in enumerate(placed)]
    if rng.random() < 0.6:
        tray = draw.cut(draw.box(-0.3, -0.3, 3.3, 3.3), draw.box(-0.05, -0.05, 3.05, 3.05))
        made.append(draw.part("tray", tray, fixed=True))
    else:
        made[-1]["fixed"] = True
    names = [p["name"] for p in made if not p.get("fixed")]
    return draw.assembly(made, [draw.goal(rng, names)])


def tabs(rng: Random) -> Polygon:
    """A tab of a random kind on the line x = 0, to the right."""
    kind = int(rng.integers(5))
    a, b, deep = rng.uniform(0.08, 0.16), rng.uniform(0.18, 0.28), rng.uniform(0.18, 0.3)
    if kind == 0:
        return draw.union(draw.box(-0.01, -a, deep / 2, a), draw.box(deep / 2 - 0.001, -b, deep, b))
    if kind == 1:
        return Polygon([(-0.01, -a), (deep, -b), (deep, b), (-0.01, a)])
    if kind == 2:
        return draw.union(draw.box(-0.01, -a * 0.6, deep / 2, a * 0.6), draw.disc(b * 0.8, 14, (deep / 2 + b * 0.5, 0)))
    if kind == 3:
        return draw.union(draw.box(-0.01, -a, deep, a * 0.3), draw.box(deep * 0.6, -a, deep, b))
    return draw.box(-0.01, -b, deep, b)


def random_chains(rng: Random) -> Json:
    """Blocks in a row with one random joint each."""
    g, count = gap_of(rng, 0.005, 0.04), int(rng.integers(2, 7))
    blocks = [draw.box(k, 0, k + 1, 1) for k in range(count)]
    for k in range(count - 1):
        tab = draw.moved(tabs(rng), x=k + 1, y=0.5 + rng.uniform(-0.15, 0.15))
        blocks[k], blocks[k + 1] = draw.union(blocks[k], tab), draw.cut(blocks[k + 1], tab)
    made = [draw.part(f"b{k}", draw.wider(b, -g / 2), fixed=k == 0) for k, b in enumerate(blocks)]
    return draw.assembly(
        made, [draw.goal(rng, [made[-1]["name"]] if rng.random() < 0.7 else [p["name"] for p in made[1:]])]
    )


def grids(rng: Random) -> Json:
    """Blocks in rows with the same joint on all sides."""
    g, nx, ny = gap_of(rng, 0.005, 0.03), int(rng.integers(2, 4)), int(rng.integers(2, 4))
    tab = tabs(rng)
    up = draw.moved(tab, turn=np.pi / 2)
    cells = {(x, y): draw.box(x, y, x + 1, y + 1) for x in range(nx) for y in range(ny)}
    for x, y in list(cells):
        for other, t in (((x + 1, y), draw.moved(tab, x + 1, y + 0.5)), ((x, y + 1), draw.moved(up, x + 0.5, y + 1))):
            if other in cells:
                cells[x, y], cells[other] = draw.union(cells[x, y], t), draw.cut(cells[other], t)
    made = [draw.part(f"b{x}{y}", draw.wider(c, -g / 2), fixed=(x, y) == (0, 0)) for (x, y), c in cells.items()]
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])])


def star_holes(rng: Random) -> Json:
    """A star in a hole of nearly its shape."""
    points = int(rng.integers(3, 8))
    radii = np.tile([1.0, rng.uniform(0.5, 0.85)], points)
    star = draw.polar(radii)
    hole = draw.moved(
        draw.wider(draw.polar(radii * rng.uniform(1.0, 1.15)), gap_of(rng, 0.01, 0.1)), turn=rng.uniform(-0.05, 0.05)
    )
    plate = draw.cut(draw.disc(1.8, 12), hole)
    if shapely.distance(plate, star) < 0.003:
        plate = draw.cut(draw.disc(1.8, 12), draw.wider(star, 0.05))
    made = [draw.part("plate", plate, fixed=True), draw.part("star", star)]
    return draw.assembly(made, [draw.turn("star", "ccw") if rng.random() < 0.5 else draw.goal(rng, ["star"])])


def t_slots(rng: Random) -> Json:
    """Sliders with their heads under the lips of a slot, some with a way out at its end."""
    g, long = gap_of(rng, 0.01, 0.08), rng.uniform(2, 4)
    begin, end = rng.uniform(0.1, 0.5), long - rng.uniform(0.1, 0.5)
    ends = long + (0.6 if rng.random() < 0.4 else 0.0)
    rail = draw.cut(draw.box(-0.4, -0.4, long + 0.4, 0.8), draw.box(0, 0, ends, 0.5), draw.box(begin, 0.4, end, 1.0))
    made, at = [draw.part("rail", max(draw.pieces(rail), key=lambda p: p.area), fixed=True)], 0.05
    for k in range(int(rng.integers(1, 4))):
        wide, stem = rng.uniform(0.4, 0.6), 0.15
        middle = max(at + wide / 2, begin + stem / 2 + g)
        if middle + wide / 2 + g > long or middle + stem / 2 + g > end:
            break
        head = draw.box(middle - wide / 2 + g / 2, g / 2, middle + wide / 2 - g / 2, 0.5 - g / 2)
        slider = draw.union(head, draw.box(middle - stem / 2, 0.4, middle + stem / 2, rng.uniform(0.9, 1.3)))
        made.append(draw.part(f"t{k}", slider))
        at = middle + wide / 2 + rng.uniform(0.0, 0.3)
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])] if len(made) > 1 else [])


def dovetail_sliders(rng: Random) -> Json:
    """A dovetail in its groove, with stops at some ends."""
    g, low, high = gap_of(rng), rng.uniform(0.5, 0.8), rng.uniform(0.2, 0.45)
    tail = Polygon([(-low, 0), (low, 0), (high, 0.6), (-high, 0.6)])
    groove = draw.wider(tail, g)
    base = draw.cut(
        draw.box(-1.3, -0.4, 1.3, 0.45 if rng.random() < 0.5 else 0.6), groove, draw.box(-high - g, 0.3, high + g, 2)
    )
    second = draw.cut(draw.box(-high * 0.8, 0.62 + g, high * 0.8, 1.2), draw.disc(0.1, 8, (0, 0.9)))
    made = [
        draw.part("base", max(draw.pieces(base), key=lambda p: p.area), fixed=True),
        draw.part("tail", tail),
        draw.part("rider", second),
    ]
    return draw.assembly(made, [draw.goal(rng, ["tail", "tail", "rider"])])


def curved_dovetails(rng: Random) -> Json:
    """A curved key in a slot of the same curve."""
    g, r = gap_of(rng, 0.01, 0.06), rng.uniform(0.8, 2.0)
    turn0, many = rng.uniform(0.4, 1.2), 10
    angle = np.linspace(-turn0, turn0, many)
    line = np.column_stack([r * np.cos(angle) - r, r * np.sin(angle)])
    slot = shapely.buffer(shapely.LineString(line), 0.2, cap_style="flat", join_style="mitre")
    plate = draw.cut(draw.box(-2.5, -2.5 if rng.random() < 0.5 else line[0, 1], 1.0, 2.5), draw.wider(slot, g / 2))
    shift = line[2:-2] if rng.random() < 0.5 else line[: many - 3]
    key = shapely.buffer(shapely.LineString(shift), 0.2 - g / 2, cap_style="flat", join_style="mitre")
    made = [
        draw.part("plate", max(draw.pieces(plate), key=lambda p: p.area), fixed=True),
        draw.part("key", draw.wider(key, -0.002)),
    ]
    return draw.assembly(made, [draw.goal(rng, ["key"])])


def half_laps(rng: Random) -> Json:
    """Bars notched into each other side by side."""
    g, count = gap_of(rng), int(rng.integers(2, 5))
    base = draw.box(-0.3, -1, count + 0.3, 0)
    made = []
    for k in range(count):
        wide = rng.uniform(0.25, 0.5)
        foot = draw.moved(
            draw.union(draw.box(-wide / 2, -0.5, wide / 2, 0.7), draw.box(-wide, -0.35, wide, rng.uniform(-0.3, -0.1))),
            x=k + 0.5,
        )
        foot = foot if rng.random() < 0.5 else draw.moved(draw.box(-wide / 2, -0.5, wide / 2, 0.7), x=k + 0.5)
        base = draw.cut(base, draw.wider(foot, g / 2))
        made.append(draw.part(f"bar{k}", draw.wider(foot, -g / 2)))
    made = [draw.part("base", max(draw.pieces(base), key=lambda p: p.area), fixed=True), *made]
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])])


def nested_keys(rng: Random) -> Json:
    """Keys within keys within a slot."""
    g, shape = (
        gap_of(rng, 0.02, 0.06),
        draw.union(draw.box(-1, -0.25, 1, 0.25), draw.box(-0.25, -0.25, 0.25, rng.uniform(0.5, 0.9))),
    )
    made, outer = [], draw.wider(shape, 0.9)
    for k in range(int(rng.integers(2, 4))):
        hole = draw.wider(shape, 0.45 - 0.3 * k)
        if hole.is_empty or hole.geom_type != "Polygon":
            break
        made.append(draw.part(f"k{k}", draw.cut(outer, hole), fixed=k == 0))
        outer = draw.moved(draw.wider(hole, -g), turn=rng.uniform(-0.002, 0.002))
        if rng.random() < 0.3:
            break
    made.append(draw.part("last", outer))
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])])


def glued_packings(rng: Random) -> Json:
    """A grid of squares glued into bodies of several, each with its gap."""
    g, nx, ny = gap_of(rng, 0.01, 0.05), int(rng.integers(3, 5)), int(rng.integers(2, 4))
    label = rng.integers(0, max(2, nx * ny // 3), (nx, ny))
    whole = {
        k: draw.union(*(draw.box(x, y, x + 1, y + 1) for x, y in np.argwhere(label == k))) for k in np.unique(label)
    }
    made, glue = [], []
    for k, shape in whole.items():
        for i, piece in enumerate(draw.pieces(draw.wider(shape, -g / 2))):
            half = piece.envelope.centroid.x
            sides = draw.pieces(draw.cut(piece, draw.box(half, -9, 99, 99))) + draw.pieces(
                shapely.intersection(piece, draw.box(half, -9, 99, 99))
            )
            names = [f"p{k}-{i}-{s}" for s in range(len(sides))]
            made += [draw.part(n, s) for n, s in zip(names, sides, strict=True)]
            if len(names) > 1:
                glue.append(names)
    made[0]["fixed"] = True
    free = [p["name"] for p in made if not any(made[0]["name"] in g and p["name"] in g for g in glue)][1:]
    free = [n for n in free if n != made[0]["name"]]
    if not free:  # all that is left hangs together: nothing stands
        del made[0]["fixed"]
        free = [made[-1]["name"]]
    return draw.assembly(made, [draw.goal(rng, free)], **({"glue": glue} if glue else {}))


def rods_in_rooms(rng: Random) -> Json:
    """A thin rod in a room with corners: it turns fast past them."""
    room = draw.polar(rng.uniform(0.6, 1.4, int(rng.integers(5, 12))), rng.uniform(0, 6))
    long = rng.uniform(0.3, 0.55)
    rod = draw.moved(draw.box(-long, -0.03, long, 0.03), turn=rng.uniform(0, 3))
    room = draw.union(room, draw.wider(rod, 0.03))
    made = [draw.part("room", draw.cut(draw.disc(2, 8), room), fixed=True), draw.part("rod", rod)]
    if rng.random() < 0.5:
        stone = draw.disc(0.08, 6, tuple(rng.uniform(-0.4, 0.4, 2)))
        if shapely.distance(stone, rod) > 0.02 and room.contains(draw.wider(stone, 0.02)):
            made.append(draw.part("stone", stone))
    return draw.assembly(
        made, [draw.turn("rod", str(rng.choice(["cw", "ccw"]))) if rng.random() < 0.6 else draw.goal(rng, ["rod"])]
    )


def rings_in_rings(rng: Random) -> Json:
    """Rings within rings, a pebble in the middle."""
    g, r, made = gap_of(rng, 0.02, 0.15), 2.0, []
    count = int(rng.integers(2, 4))
    for k in range(count):
        made.append(
            draw.part(
                f"r{k}",
                draw.cut(draw.disc(r, int(rng.integers(5, 20))), draw.disc(r * 0.72, int(rng.integers(4, 16)))),
                fixed=k == 0,
            )
        )
        r = r * 0.72 * np.cos(np.pi / 4) - g
    made.append(draw.part("pebble", draw.polar(rng.uniform(0.5, 1.0, 6) * r)))
    return draw.assembly(
        made,
        [
            draw.pull("pebble", draw.anywhere(rng))
            if rng.random() < 0.5
            else draw.goal(rng, [p["name"] for p in made[1:]])
        ],
    )
