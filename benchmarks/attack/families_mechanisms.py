"""Families of mechanisms: gears, ratchets, linkages, zips."""

from __future__ import annotations

import numpy as np
import shapely
from shapely import Polygon

from benchmarks.attack import drawing as draw
from benchmarks.attack.drawing import Json, Random
from benchmarks.attack.families_fitted import gap_of


def gear(teeth: int, pitch: float, play: float, phase: float = 0.0) -> Polygon:
    """A gear of trapezoid teeth; its pitch circle has a radius of teeth * pitch / 2 pi."""
    r, high = teeth * pitch / (2 * np.pi), 0.3 * pitch
    corners = []
    for k in range(teeth):
        for share, out in ((-0.36, -high * 1.2), (-0.13, high), (0.13, high), (0.36, -high * 1.2)):
            a = 2 * np.pi * (k + share * (1 - play)) / teeth + phase
            corners.append(((r + out) * np.cos(a), (r + out) * np.sin(a)))
    return Polygon(corners)


def on_axle(shape: Polygon, at: tuple[float, float], radius: float, g: float) -> tuple[Polygon, Polygon]:
    """A wheel with a hole at a place, and the axle in it."""
    return draw.cut(draw.moved(shape, *at), draw.disc(radius + g, 20, at)), draw.disc(radius, 20, at)


def gears(rng: Random) -> Json:
    """Two or three gears in mesh on axles."""
    g, pitch, play = gap_of(rng, 0.01, 0.04), 0.5, rng.uniform(0.08, 0.25)
    made, x, before = [], 0.0, 0
    for k in range(int(rng.integers(2, 4))):
        teeth = int(rng.integers(6, 13))
        if k:
            x += (before + teeth) * pitch / (2 * np.pi) + rng.uniform(0.0, 0.05)
        phase = np.pi / teeth + np.pi if k % 2 else 0.0
        wheel, axle = on_axle(gear(teeth, pitch, play, phase if k % 2 else 0.0), (x, 0.0), 0.15, g)
        made += [draw.part(f"axle{k}", axle, fixed=True), draw.part(f"gear{k}", wheel)]
        before = teeth
    return draw.assembly(made, [draw.turn("gear0", str(rng.choice(["cw", "ccw"])))])


def keyed_gears(rng: Random) -> Json:
    """A gear on a shaft with a key, in mesh with a rack that stands."""
    g, teeth = gap_of(rng, 0.01, 0.05), int(rng.integers(7, 13))
    key = draw.box(0.1, -0.06, 0.3, 0.06)
    shaft = draw.cut(draw.disc(0.25, 24), draw.wider(key, g / 2))
    wheel = draw.cut(gear(teeth, 0.5, 0.2), draw.wider(draw.union(draw.disc(0.25, 24), key), g))
    made = [draw.part("shaft", shaft, fixed=True), draw.part("key", draw.wider(key, -g / 4)), draw.part("gear", wheel)]
    goals = (
        [draw.turn("gear", str(rng.choice(["cw", "ccw"])))] if rng.random() < 0.7 else [draw.goal(rng, ["key", "gear"])]
    )
    return draw.assembly(made, goals)


def ratchets(rng: Random) -> Json:
    """A wheel of saw teeth and a pawl that slides in a guide."""
    g, teeth = gap_of(rng, 0.01, 0.06), int(rng.integers(6, 12))
    wheel = draw.polar(np.tile([1.0, 0.75], teeth), 0.0)
    saw = []
    for k in range(teeth):
        a = 2 * np.pi * k / teeth
        saw += [(np.cos(a), np.sin(a)), (0.75 * np.cos(a + 0.05), 0.75 * np.sin(a + 0.05))]
    wheel, axle = on_axle(Polygon(saw), (0.0, 0.0), 0.2, g)
    half = 0.12
    pawl = draw.union(draw.box(0.82, -half, 1.6, half), Polygon([(0.83, -half), (0.83, half * 0.2), (0.72, -half)]))
    pawl = draw.moved(pawl, turn=rng.uniform(0, 2 * np.pi / teeth))
    pawl = draw.cut(pawl, draw.wider(wheel, g))
    pawl = max(draw.pieces(pawl), key=lambda p: p.area)
    x = pawl.bounds[2]
    guide = draw.cut(
        draw.box(1.15, -0.6, x + rng.uniform(0.05, 0.3), 0.6), draw.wider(pawl, g), draw.box(1.0, -half, 1.3, half)
    )
    guide = [p for p in draw.pieces(guide) if shapely.distance(p, wheel) > 0.01]
    made = [draw.part("axle", axle, fixed=True), draw.part("wheel", wheel), draw.part("pawl", pawl)]
    made += [draw.part(f"guide{k}", p, fixed=True) for k, p in enumerate(guide)]
    return draw.assembly(made, [draw.turn("wheel", str(rng.choice(["cw", "ccw"])))])


def cams(rng: Random) -> Json:
    """A cam on an axle below a follower in a guide."""
    g = gap_of(rng, 0.01, 0.06)
    angle = 2 * np.pi * np.arange(24) / 24
    cam = draw.polar(
        0.7 + rng.uniform(0.1, 0.3) * np.cos(angle) + rng.uniform(0, 0.1) * np.cos(2 * angle), rng.uniform(0, 6)
    )
    cam, axle = on_axle(cam, (0.0, 0.0), 0.15, g)
    top = cam.bounds[3] + g
    follower = draw.union(draw.box(-0.12, top + 0.05, 0.12, top + 1.2), draw.disc(0.15, 12, (0, top + 0.16)))
    follower = draw.cut(follower, draw.wider(cam, g / 2))
    wall = draw.cut(draw.box(-0.6, top + 0.5, 0.6, top + 0.9), draw.wider(draw.box(-0.12, 0, 0.12, 9), g))
    made = [
        draw.part("axle", axle, fixed=True),
        draw.part("cam", cam),
        draw.part("follower", max(draw.pieces(follower), key=lambda p: p.area)),
    ]
    made += [draw.part(f"wall{k}", p, fixed=True) for k, p in enumerate(draw.pieces(wall))]
    if rng.random() < 0.5:
        made.append(draw.part("roof", draw.box(-0.5, top + 1.25, 0.5, top + 1.4), fixed=True))
    return draw.assembly(
        made, [draw.goal(rng, ["cam", "cam", "follower"]) if rng.random() < 0.5 else draw.turn("cam", "ccw")]
    )


def latches(rng: Random) -> Json:
    """Hooks that hold each other in a frame; the first has to give way before the next."""
    g, count = gap_of(rng, 0.02, 0.08), int(rng.integers(2, 4))
    frame, made = draw.box(-0.5, -0.5, 2.5, count + 0.3), []
    for k in range(count):
        hook = draw.union(draw.box(0, k, 1.2 + 0.2 * rng.random(), k + 0.4), draw.box(0.2, k + 0.3, 0.5, k + 0.7))
        room = draw.union(draw.box(-0.0, k - 0.0, 2.0, k + 0.4), draw.box(0.2, k + 0.3, rng.uniform(0.7, 1.4), k + 0.7))
        frame = draw.cut(frame, draw.wider(room, g / 2))
        made.append(draw.part(f"hook{k}", draw.wider(hook, -g / 2)))
        if k and rng.random() < 0.6:
            frame = draw.cut(frame, draw.box(0.5, k - 0.5, 0.9, k + 0.1))
    exits = draw.box(1.5, -0.0, 3.0, 0.4)
    frame = draw.cut(frame, draw.wider(exits, g / 2)) if rng.random() < 0.5 else frame
    solid = [p for p in draw.pieces(frame) if p.area > 0.05]
    made = [*(draw.part(f"frame{k}", p, fixed=True) for k, p in enumerate(solid)), *made]
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[len(solid) :]])])


def notched_rings(rng: Random) -> Json:
    """A toothed disc in a ring with notches."""
    g, count = gap_of(rng, 0.01, 0.08), int(rng.integers(2, 7))
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    teeth = [draw.moved(draw.box(0.9, -0.12, 1.25, 0.12), turn=a) for a in angle]
    wheel = draw.union(draw.disc(1.0, 24), *teeth)
    wide = rng.uniform(0.01, 0.12)
    room = draw.union(
        draw.disc(1.0, 24), *(draw.moved(draw.box(0.9, -0.12 - wide, 1.25, 0.12 + wide), turn=a) for a in angle)
    )
    ring = draw.cut(draw.disc(1.8, 16), draw.wider(room, g))
    made = [draw.part("ring", ring, fixed=True), draw.part("wheel", wheel)]
    return draw.assembly(made, [draw.turn("wheel", "cw") if rng.random() < 0.6 else draw.goal(rng, ["wheel"])])


def ball_and_socket(g: float, around: float, long: float, r: float = 0.2) -> Polygon:
    """A bar along x with a ball at its right end and a socket, open to the left, at its left end."""
    ball = draw.union(draw.disc(r, 16, (long, 0)), draw.box(r * 1.6, -r * 0.45, long, r * 0.45))
    shell = draw.cut(draw.disc(r * 1.75, 18), draw.disc(r + g, 18))
    mouth = Polygon(
        [(0, 0), (-9 * np.cos(around), 9 * np.sin(around)), (-9, 0), (-9 * np.cos(around), -9 * np.sin(around))]
    )
    return draw.union(draw.cut(shell, mouth), draw.cut(ball, draw.disc(r * 1.65, 18)))


def linkages(rng: Random) -> Json:
    """Bars with balls in sockets, in a row."""
    g, r, made = gap_of(rng, 0.01, 0.04), 0.2, []
    at, angle = np.zeros(2), 0.0
    for k in range(int(rng.integers(2, 6))):
        long = rng.uniform(1.0, 1.6)
        bar = ball_and_socket(g, rng.uniform(0.6, 0.9), long, r)
        made.append(draw.part(f"bar{k}", draw.moved(draw.moved(bar, turn=angle), *at), fixed=k == 0))
        at = at + long * np.array([np.cos(angle), np.sin(angle)])
        angle += rng.uniform(-0.3, 0.3)
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])])


def four_bars(rng: Random) -> Json:
    """Bars on pins in holes, in two layers that pass each other."""
    g, r = gap_of(rng, 0.01, 0.05), 0.1
    a = np.array([0.0, 0.0])
    d = np.array([rng.uniform(1.5, 2.2), 0.0])
    b = a + rng.uniform(0.5, 0.9) * np.array([np.cos(t := rng.uniform(0.5, 2.2)), np.sin(t)])
    c = d + rng.uniform(0.9, 1.4) * np.array([np.cos(t := rng.uniform(1.0, 2.2)), np.sin(t)])
    spots = {"a": a, "b": b, "c": c, "d": d}

    def bar(one: str, other: str) -> Polygon:
        solid = shapely.buffer(shapely.LineString([spots[one], spots[other]]), 0.2, quad_segs=3)
        return draw.cut(solid, *(draw.disc(r + g, 16, spots[s]) for s in (one, other)))

    made = [draw.part("crank", bar("a", "b")), draw.part("rod", bar("b", "c")), draw.part("rocker", bar("c", "d"))]
    made += [draw.part(f"pin{s}", draw.disc(r, 16, spots[s]), fixed=s in "ad") for s in spots]
    ignore = [["crank", "rod"], ["rod", "rocker"], ["crank", "rocker"]]
    ignore += [
        ["rod", "pina"],
        ["rod", "pind"],
        ["crank", "pinc"],
        ["crank", "pind"],
        ["rocker", "pina"],
        ["rocker", "pinb"],
    ]
    return draw.assembly(made, [draw.turn("crank", str(rng.choice(["cw", "ccw"])))], ignore=ignore)


def scissors(rng: Random) -> Json:
    """Crossed bars on loose pins, as many crosses as fit."""
    g, r, count = gap_of(rng, 0.01, 0.04), 0.08, int(rng.integers(1, 3))
    lean, made, bars, pins = rng.uniform(0.5, 0.9), [], {}, {}
    for k in range(count):
        x = 1.2 * k * np.cos(lean) * 1.0
        up, down = (x, 0.0), (x, 1.2 * np.sin(lean))
        after = x + 1.2 * np.cos(lean)
        bars[f"u{k}"] = [up, (after, 1.2 * np.sin(lean))]
        bars[f"d{k}"] = [down, (after, 0.0)]
        pins[f"m{k}"] = ((x + after) / 2, 0.6 * np.sin(lean)), (f"u{k}", f"d{k}")
        if k:
            pins[f"l{k}"] = up, (f"u{k}", f"d{k - 1}")
            pins[f"h{k}"] = down, (f"d{k}", f"u{k - 1}")
    pins["foot"] = bars["u0"][0], ("u0",)
    for name, ends in bars.items():
        solid = shapely.buffer(shapely.LineString(ends), 0.18, quad_segs=3)
        holes = [draw.disc(r + g, 14, at) for at, who in pins.values() if name in who]
        made.append(draw.part(name, draw.cut(solid, *holes)))
    made += [draw.part(name, draw.disc(r, 14, at), fixed=name == "foot") for name, (at, _) in pins.items()]
    names = list(bars)
    ignore = [[one, other] for k, one in enumerate(names) for other in names[k + 1 :]]
    ignore += [[b, p] for p, (_, who) in pins.items() for b in names if b not in who]
    rail = draw.box(-0.5, -0.35, 3.5, -0.22)
    if rng.random() < 0.6:
        made.append(draw.part("rail", rail, fixed=True))
    return draw.assembly(made, [draw.goal(rng, names)], ignore=ignore)


def hinges(rng: Random) -> Json:
    """A leaf that turns in a socket until it meets a stop."""
    g, r = gap_of(rng, 0.01, 0.06), 0.3
    stop = rng.uniform(0.4, 1.3)
    leaf = draw.union(draw.disc(r, 20), draw.box(0, -0.12, 1.2, 0.12))
    shell = draw.cut(draw.disc(r * 1.8, 20), draw.disc(r + g, 20))
    mouth = Polygon(
        [
            (0, 0),
            (9 * np.cos(stop), 9 * np.sin(stop)),
            (9, 9 * np.sin(stop)),
            (9, -9 * np.sin(stop)),
            (9 * np.cos(stop), -9 * np.sin(stop)),
        ]
    )
    frame = draw.cut(draw.union(shell, draw.box(-1.2, -0.3, -0.4, 0.3)), mouth, draw.wider(leaf, g))
    made = [draw.part("frame", max(draw.pieces(frame), key=lambda p: p.area), fixed=True), draw.part("leaf", leaf)]
    if rng.random() < 0.4:
        bolt = draw.disc(0.1, 10, (1.0, 0.12 + 0.1 + g))
        made.append(draw.part("bolt", bolt, fixed=rng.random() < 0.5))
    return draw.assembly(
        made, [draw.turn("leaf", str(rng.choice(["cw", "ccw"]))) if rng.random() < 0.6 else draw.goal(rng, ["leaf"])]
    )


def zips(rng: Random) -> Json:
    """Two rows of teeth with heads, in each other, each row glued or loose."""
    g, count = gap_of(rng, 0.01, 0.04), int(rng.integers(2, 5))
    head = Polygon(
        [
            (0, -0.1),
            (0.5, -0.1),
            (0.55, -0.22),
            (0.75, -0.22),
            (0.85, 0),
            (0.75, 0.22),
            (0.55, 0.22),
            (0.5, 0.1),
            (0, 0.1),
        ]
    )
    pitch = 0.72 + g + rng.uniform(0, 0.05)
    left = [draw.moved(head, 0, k * pitch) for k in range(count)]
    right = [
        draw.moved(draw.moved(head, turn=np.pi), 1.0 + g + rng.uniform(0, 0.02), (k + 0.5) * pitch)
        for k in range(count - 1)
    ]
    tape = draw.union(draw.box(-0.5, -0.3, 0.05, count * pitch), *left)
    x = right[0].bounds[2] if right else 2.0
    made = [draw.part("tape", draw.wider(tape, -g / 4), fixed=True)]
    if rng.random() < 0.5:
        made.append(
            draw.part("other", draw.wider(draw.union(draw.box(x - 0.05, -0.3, x + 0.4, count * pitch), *right), -g / 4))
        )
    else:
        made += [draw.part(f"tooth{k}", draw.wider(t, -g / 4)) for k, t in enumerate(right)]
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])])


def geneva_drives(rng: Random) -> Json:
    """A pin wheel that turns a slotted wheel."""
    g, slots = gap_of(rng, 0.01, 0.05), int(rng.integers(4, 7))
    half = np.pi / slots
    apart, crank, wheel_r = 1.0, np.sin(half), np.cos(half)
    pin = 0.09
    wheel = draw.disc(wheel_r, 8 * slots, phase=np.pi / slots)
    deep = apart - crank - pin - 0.03
    wheel = draw.cut(
        wheel,
        *(draw.moved(draw.box(deep, -pin - g, 2, pin + g), turn=np.pi + half + 2 * half * k) for k in range(slots)),
    )
    wheel, axle = on_axle(wheel, (apart, 0.0), 0.1, g)
    arm = draw.union(
        draw.disc(pin, 14, (crank * np.cos(t := rng.uniform(1.2, 5.0)), crank * np.sin(t))),
        draw.band([(0, 0), (crank * np.cos(t), crank * np.sin(t))], 0.1),
        draw.disc(0.22, 14),
    )
    driver, drive_axle = on_axle(arm, (0.0, 0.0), 0.1, g)
    made = [
        draw.part("axle0", drive_axle, fixed=True),
        draw.part("axle1", axle, fixed=True),
        draw.part("driver", driver),
        draw.part("wheel", wheel),
    ]
    return draw.assembly(made, [draw.turn("driver", str(rng.choice(["cw", "ccw"])))])


def discs_off_centre(rng: Random) -> Json:
    """A disc with an off-centre hole on a peg, or in a round hole, pulled at a point of it."""
    g, count = gap_of(rng, 0.01, 0.08), int(rng.integers(8, 33))
    off = rng.uniform(0.1, 0.5)
    if rng.random() < 0.5:
        wheel = draw.cut(draw.disc(1, count), draw.disc(0.2 + g, 16, (off, 0)))
        made = [draw.part("peg", draw.disc(0.2, 16, (off, 0)), fixed=True), draw.part("wheel", wheel)]
    else:
        made = [
            draw.part("plate", draw.cut(draw.box(-2, -2, 2, 2), draw.disc(1 + g, count)), fixed=True),
            draw.part("wheel", draw.cut(draw.disc(1, count), draw.disc(0.3, 12, (off, 0)))),
        ]
    angle = rng.uniform(0, 6)
    spot = made[1]["at"][:2]
    asked = draw.pull("wheel", (np.cos(angle), np.sin(angle)), (spot[0] + rng.uniform(-0.3, 0.3), spot[1]))
    return draw.assembly(made, [asked if rng.random() < 0.7 else draw.goal(rng, ["wheel"])])
