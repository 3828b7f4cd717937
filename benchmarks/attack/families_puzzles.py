"""Families of puzzles: dials, hooks, tubes, tiles and pegs in slots; what must be done first is seldom what the goal asks for."""

from __future__ import annotations

import numpy as np
import shapely
from shapely import Polygon

from benchmarks.attack import drawing as draw
from benchmarks.attack.drawing import Json, Random
from benchmarks.attack.families_fitted import gap_of


def combination_dials(rng: Random) -> Json:
    """A bolt beside dials that let it pass only where their flats face it."""
    g, count, radius = gap_of(rng, 0.01, 0.04), int(rng.integers(1, 4)), 0.45
    deep = rng.uniform(0.08, 0.16)
    middles = [(1.2 * k, radius - deep) for k in range(count)]
    housing = draw.box(-1.0, -0.9, 1.2 * count + 0.2, 1.2)
    bolt = draw.box(-0.8, -0.5, 1.2 * count - 0.2, 0.0)
    dials = []
    for at in middles:
        round_dial = draw.disc(radius, 20, at, rng.uniform(0, 0.3))
        flat = draw.box(-radius - 0.1, -radius - 0.1, radius + 0.1, -radius + deep + g)
        shown = draw.moved(flat, *at, turn=rng.choice([-1, 1]) * rng.uniform(0.5, 2.5))
        dials.append(draw.cut(round_dial, shown))
        bolt = draw.cut(bolt, draw.disc(radius + g, 20, at, 0.1))
        housing = draw.cut(housing, draw.disc(radius + g, 24, at))
    channel = draw.box(-0.8 - g - rng.uniform(0.0, 0.3), -0.5 - g, 1.2 * count + 0.3, g)
    made = [
        draw.part("housing", max(draw.pieces(draw.cut(housing, channel)), key=lambda p: p.area), fixed=True),
        draw.part("bolt", max(draw.pieces(bolt), key=lambda p: p.area)),
        *(draw.part(f"dial{k}", max(draw.pieces(d), key=lambda p: p.area)) for k, d in enumerate(dials)),
    ]
    return draw.assembly(made, [draw.pull("bolt", (1, 0)) if rng.random() < 0.8 else draw.goal(rng, ["dial0"])])


def tongued_tiles(rng: Random) -> Json:
    """Tiles with tongues and grooves in a frame with one or two places empty."""
    g, nx, ny = gap_of(rng, 0.02, 0.06), int(rng.integers(2, 4)), int(rng.integers(2, 4))
    deep, wide = rng.uniform(0.05, 0.12), rng.uniform(0.15, 0.3)
    cells = [(x, y) for x in range(nx) for y in range(ny)]
    empty = {cells[int(k)] for k in rng.choice(len(cells), int(rng.integers(1, 3)), replace=False)}
    tongue = Polygon([(-0.01, -wide), (deep, -wide * rng.uniform(0.5, 1.0)), (deep, wide * 0.5), (-0.01, wide)])
    frame = draw.box(-0.5, -0.5, nx + 0.5, ny + 0.5)
    tiles = []
    for x, y in cells:
        if (x, y) in empty:
            continue
        tile = draw.union(draw.box(x, y, x + 1, y + 1), draw.moved(tongue, x + 1, y + 0.5))
        tiles.append(draw.cut(tile, draw.moved(tongue, x, y + 0.5)))
    room = draw.union(
        draw.box(0, 0, nx, ny), *(draw.moved(draw.box(0, -wide, deep, wide), nx, y + 0.5) for y in range(ny))
    )
    made = [draw.part("frame", draw.cut(frame, room), fixed=True)]
    made += [draw.part(f"t{k}", draw.wider(t, -g / 2)) for k, t in enumerate(tiles)]
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])])


def nested_hooks(rng: Random) -> Json:
    """Channels in channels, each with lips at its mouth, the mouths to alternate sides."""
    g, wall, count = gap_of(rng, 0.02, 0.08), 0.15, int(rng.integers(2, 5))
    half, made = 1.5, []
    for k in range(count):
        inner = half - wall
        if inner < 0.25:
            break
        lip = rng.uniform(0.3, 0.9) * inner
        ring = draw.cut(draw.box(-half, -half, half, half), draw.box(-inner, -inner, inner, inner))
        mouth = draw.box(inner - 0.05, -inner + lip / 2, half + 0.1, inner - lip / 2 * rng.uniform(0.3, 1.0))
        hook = draw.moved(draw.cut(ring, mouth), turn=np.pi * (k % 2) + (np.pi / 2) * int(rng.random() < 0.3))
        made.append(draw.part(f"h{k}", hook, fixed=k == 0))
        half = inner - g * rng.uniform(1.0, 3.0)
    made.append(
        draw.part("core", draw.moved(draw.box(-half, -half * 0.4, half, half * 0.3), turn=rng.uniform(-0.01, 0.01)))
    )
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])])


def telescopes(rng: Random) -> Json:
    """Tubes in tubes, flanges behind lips, pushed in to different depths."""
    g, count = gap_of(rng, 0.01, 0.05), int(rng.integers(2, 5))
    half, made, at = 1.0, [], 0.0
    for k in range(count):
        wall, long, collar = 0.08, rng.uniform(1.5, 2.5), 0.1
        tube = draw.cut(draw.box(0, -half, long, half), draw.box(wall, -half + wall, long + 1, half - wall))
        if k < count - 1:  # lips at the mouth
            lip = half - wall - collar
            tube = draw.union(
                tube,
                draw.box(long - 0.1, lip, long, half - wall + 0.001),
                draw.box(long - 0.1, -half + wall - 0.001, long, -lip),
            )
        if k:  # flanges at the back
            back = half + collar - 2 * g
            tube = draw.union(tube, draw.box(0, -back, 0.1, back))
        made.append(draw.part(f"tube{k}", draw.moved(tube, at), fixed=k == 0))
        at += wall + g * rng.uniform(1.0, 4.0)
        half = half - wall - collar - g
    last = made[-1]["name"]
    asked = draw.pull(last, (1, 0)) if rng.random() < 0.6 else draw.goal(rng, [p["name"] for p in made[1:]])
    return draw.assembly(made, [asked])


def tangrams(rng: Random) -> Json:
    """A square cut up by lines through it, one piece of it left out."""
    g = gap_of(rng, 0.01, 0.05)
    left: list[Polygon] = [draw.box(0, 0, 3, 3)]
    for _ in range(int(rng.integers(3, 6))):
        angle, off = rng.uniform(0, np.pi), rng.uniform(-0.8, 0.8)
        n = np.array([np.cos(angle), np.sin(angle)])
        t, on = np.array([-n[1], n[0]]), np.array([1.5, 1.5]) + off * n
        side = Polygon([on + 9 * t, on - 9 * t, on - 9 * t + 9 * n, on + 9 * t + 9 * n])
        widest = max(range(len(left)), key=lambda k: left[k].area)
        cut_all = rng.random() < 0.4
        left = [
            piece
            for k, p in enumerate(left)
            for piece in (
                [p]
                if k != widest and not cut_all
                else draw.pieces(draw.cut(p, side)) + draw.pieces(shapely.intersection(p, side))
            )
        ]
    shrunk = [draw.wider(p, -g / 2) for p in left]
    shrunk = [p for p in shrunk if p.geom_type == "Polygon" and p.area > 0.05]
    out = int(rng.integers(len(shrunk)))
    tray = draw.cut(draw.box(-0.4, -0.4, 3.4, 3.4), draw.box(0, 0, 3, 3))
    made = [draw.part("tray", tray, fixed=True), *(draw.part(f"p{k}", p) for k, p in enumerate(shrunk) if k != out)]
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])])


def pegs_in_slots(rng: Random) -> Json:
    """A part of two pegs, each in a bent slot of its own."""
    width = rng.uniform(0.25, 0.4)
    peg = width / 2 - gap_of(rng, 0.01, 0.05)
    apart = rng.uniform(1.6, 2.4)
    slots = []
    for k in range(2):
        points = [np.array([apart * k, 0.0])]
        quarter = int(rng.integers(4))
        for _ in range(int(rng.integers(2, 5))):
            quarter = (quarter + int(rng.choice([-1, 1]))) % 4
            angle = quarter * np.pi / 2 + rng.uniform(-0.3, 0.3)
            points.append(points[-1] + rng.uniform(0.2, 0.6) * np.array([np.cos(angle), np.sin(angle)]))
        slots.append(draw.band(points, width))
    room = draw.union(*slots)
    plate = draw.cut(draw.wider(room.envelope, 0.4), room)
    pegs = shapely.union_all([draw.disc(peg, int(rng.integers(6, 16)), (apart * k, 0.0)) for k in range(2)])
    made = [draw.part("plate", max(draw.pieces(plate), key=lambda p: p.area), fixed=True), draw.part("pegs", pegs)]
    return draw.assembly(made, [draw.goal(rng, ["pegs"])])
