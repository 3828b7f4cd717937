"""Families of mechanisms: gears, ratchets, linkages, zips."""

from __future__ import annotations

import numpy as np
import shapely
from shapely import Polygon

from benchmarks.attack.drawing import (
    Json,
    Random,
    assembly,
    band,
    box,
    cut,
    disc,
    goal,
    moved,
    part,
    pieces,
    polar,
    pull,
    turn,
    union,
    wider,
)
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
    return cut(moved(shape, *at), disc(radius + g, 20, at)), disc(radius, 20, at)


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
        made += [part(f"axle{k}", axle, fixed=True), part(f"gear{k}", wheel)]
        before = teeth
    return assembly(made, [turn("gear0", str(rng.choice(["cw", "ccw"])))])


def keyed_gears(rng: Random) -> Json:
    """A gear on a shaft with a key, in mesh with a rack that stands."""
    g, teeth = gap_of(rng, 0.01, 0.05), int(rng.integers(7, 13))
    key = box(0.1, -0.06, 0.3, 0.06)
    shaft = cut(disc(0.25, 24), wider(key, g / 2))
    wheel = cut(gear(teeth, 0.5, 0.2), wider(union(disc(0.25, 24), key), g))
    made = [part("shaft", shaft, fixed=True), part("key", wider(key, -g / 4)), part("gear", wheel)]
    goals = [turn("gear", str(rng.choice(["cw", "ccw"])))] if rng.random() < 0.7 else [goal(rng, ["key", "gear"])]
    return assembly(made, goals)


def ratchets(rng: Random) -> Json:
    """A wheel of saw teeth and a pawl that slides in a guide."""
    g, teeth = gap_of(rng, 0.01, 0.06), int(rng.integers(6, 12))
    wheel = polar(np.tile([1.0, 0.75], teeth), 0.0)
    saw = []
    for k in range(teeth):
        a = 2 * np.pi * k / teeth
        saw += [(np.cos(a), np.sin(a)), (0.75 * np.cos(a + 0.05), 0.75 * np.sin(a + 0.05))]
    wheel, axle = on_axle(Polygon(saw), (0.0, 0.0), 0.2, g)
    half = 0.12
    pawl = union(box(0.82, -half, 1.6, half), Polygon([(0.83, -half), (0.83, half * 0.2), (0.72, -half)]))
    pawl = moved(pawl, turn=rng.uniform(0, 2 * np.pi / teeth))
    pawl = cut(pawl, wider(wheel, g))
    pawl = max(pieces(pawl), key=lambda p: p.area)
    x = pawl.bounds[2]
    guide = cut(box(1.15, -0.6, x + rng.uniform(0.05, 0.3), 0.6), wider(pawl, g), box(1.0, -half, 1.3, half))
    guide = [p for p in pieces(guide) if shapely.distance(p, wheel) > 0.01]
    made = [part("axle", axle, fixed=True), part("wheel", wheel), part("pawl", pawl)]
    made += [part(f"guide{k}", p, fixed=True) for k, p in enumerate(guide)]
    return assembly(made, [turn("wheel", str(rng.choice(["cw", "ccw"])))])


def cams(rng: Random) -> Json:
    """A cam on an axle below a follower in a guide."""
    g = gap_of(rng, 0.01, 0.06)
    angle = 2 * np.pi * np.arange(24) / 24
    cam = polar(
        0.7 + rng.uniform(0.1, 0.3) * np.cos(angle) + rng.uniform(0, 0.1) * np.cos(2 * angle), rng.uniform(0, 6)
    )
    cam, axle = on_axle(cam, (0.0, 0.0), 0.15, g)
    top = cam.bounds[3] + g
    follower = union(box(-0.12, top + 0.05, 0.12, top + 1.2), disc(0.15, 12, (0, top + 0.16)))
    follower = cut(follower, wider(cam, g / 2))
    wall = cut(box(-0.6, top + 0.5, 0.6, top + 0.9), wider(box(-0.12, 0, 0.12, 9), g))
    made = [
        part("axle", axle, fixed=True),
        part("cam", cam),
        part("follower", max(pieces(follower), key=lambda p: p.area)),
    ]
    made += [part(f"wall{k}", p, fixed=True) for k, p in enumerate(pieces(wall))]
    if rng.random() < 0.5:
        made.append(part("roof", box(-0.5, top + 1.25, 0.5, top + 1.4), fixed=True))
    return assembly(made, [goal(rng, ["cam", "cam", "follower"]) if rng.random() < 0.5 else turn("cam", "ccw")])


def latches(rng: Random) -> Json:
    """Hooks that hold each other in a frame; the first has to give way before the next."""
    g, count = gap_of(rng, 0.02, 0.08), int(rng.integers(2, 4))
    frame, made = box(-0.5, -0.5, 2.5, count + 0.3), []
    for k in range(count):
        hook = union(box(0, k, 1.2 + 0.2 * rng.random(), k + 0.4), box(0.2, k + 0.3, 0.5, k + 0.7))
        room = union(box(-0.0, k - 0.0, 2.0, k + 0.4), box(0.2, k + 0.3, rng.uniform(0.7, 1.4), k + 0.7))
        frame = cut(frame, wider(room, g / 2))
        made.append(part(f"hook{k}", wider(hook, -g / 2)))
        if k and rng.random() < 0.6:
            frame = cut(frame, box(0.5, k - 0.5, 0.9, k + 0.1))
    exits = box(1.5, -0.0, 3.0, 0.4)
    frame = cut(frame, wider(exits, g / 2)) if rng.random() < 0.5 else frame
    solid = [p for p in pieces(frame) if p.area > 0.05]
    made = [*(part(f"frame{k}", p, fixed=True) for k, p in enumerate(solid)), *made]
    return assembly(made, [goal(rng, [p["name"] for p in made[len(solid) :]])])


def notched_rings(rng: Random) -> Json:
    """A toothed disc in a ring with notches."""
    g, count = gap_of(rng, 0.01, 0.08), int(rng.integers(2, 7))
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    teeth = [moved(box(0.9, -0.12, 1.25, 0.12), turn=a) for a in angle]
    wheel = union(disc(1.0, 24), *teeth)
    wide = rng.uniform(0.01, 0.12)
    room = union(disc(1.0, 24), *(moved(box(0.9, -0.12 - wide, 1.25, 0.12 + wide), turn=a) for a in angle))
    ring = cut(disc(1.8, 16), wider(room, g))
    made = [part("ring", ring, fixed=True), part("wheel", wheel)]
    return assembly(made, [turn("wheel", "cw") if rng.random() < 0.6 else goal(rng, ["wheel"])])


def ball_and_socket(g: float, around: float, long: float, r: float = 0.2) -> Polygon:
    """A bar along x with a ball at its right end and a socket, open to the left, at its left end."""
    ball = union(disc(r, 16, (long, 0)), box(r * 1.6, -r * 0.45, long, r * 0.45))
    shell = cut(disc(r * 1.75, 18), disc(r + g, 18))
    mouth = Polygon(
        [(0, 0), (-9 * np.cos(around), 9 * np.sin(around)), (-9, 0), (-9 * np.cos(around), -9 * np.sin(around))]
    )
    return union(cut(shell, mouth), cut(ball, disc(r * 1.65, 18)))


def linkages(rng: Random) -> Json:
    """Bars with balls in sockets, in a row."""
    g, r, made = gap_of(rng, 0.01, 0.04), 0.2, []
    at, angle = np.zeros(2), 0.0
    for k in range(int(rng.integers(2, 6))):
        long = rng.uniform(1.0, 1.6)
        bar = ball_and_socket(g, rng.uniform(0.6, 0.9), long, r)
        made.append(part(f"bar{k}", moved(moved(bar, turn=angle), *at), fixed=k == 0))
        at = at + long * np.array([np.cos(angle), np.sin(angle)])
        angle += rng.uniform(-0.3, 0.3)
    return assembly(made, [goal(rng, [p["name"] for p in made[1:]])])


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
        return cut(solid, *(disc(r + g, 16, spots[s]) for s in (one, other)))

    made = [part("crank", bar("a", "b")), part("rod", bar("b", "c")), part("rocker", bar("c", "d"))]
    made += [part(f"pin{s}", disc(r, 16, spots[s]), fixed=s in "ad") for s in spots]
    ignore = [["crank", "rod"], ["rod", "rocker"], ["crank", "rocker"]]
    ignore += [
        ["rod", "pina"],
        ["rod", "pind"],
        ["crank", "pinc"],
        ["crank", "pind"],
        ["rocker", "pina"],
        ["rocker", "pinb"],
    ]
    return assembly(made, [turn("crank", str(rng.choice(["cw", "ccw"])))], ignore=ignore)


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
        holes = [disc(r + g, 14, at) for at, who in pins.values() if name in who]
        made.append(part(name, cut(solid, *holes)))
    made += [part(name, disc(r, 14, at), fixed=name == "foot") for name, (at, _) in pins.items()]
    names = list(bars)
    ignore = [[one, other] for k, one in enumerate(names) for other in names[k + 1 :]]
    ignore += [[b, p] for p, (_, who) in pins.items() for b in names if b not in who]
    rail = box(-0.5, -0.35, 3.5, -0.22)
    if rng.random() < 0.6:
        made.append(part("rail", rail, fixed=True))
    return assembly(made, [goal(rng, names)], ignore=ignore)


def hinges(rng: Random) -> Json:
    """A leaf that turns in a socket until it meets a stop."""
    g, r = gap_of(rng, 0.01, 0.06), 0.3
    stop = rng.uniform(0.4, 1.3)
    leaf = union(disc(r, 20), box(0, -0.12, 1.2, 0.12))
    shell = cut(disc(r * 1.8, 20), disc(r + g, 20))
    mouth = Polygon(
        [
            (0, 0),
            (9 * np.cos(stop), 9 * np.sin(stop)),
            (9, 9 * np.sin(stop)),
            (9, -9 * np.sin(stop)),
            (9 * np.cos(stop), -9 * np.sin(stop)),
        ]
    )
    frame = cut(union(shell, box(-1.2, -0.3, -0.4, 0.3)), mouth, wider(leaf, g))
    made = [part("frame", max(pieces(frame), key=lambda p: p.area), fixed=True), part("leaf", leaf)]
    if rng.random() < 0.4:
        bolt = disc(0.1, 10, (1.0, 0.12 + 0.1 + g))
        made.append(part("bolt", bolt, fixed=rng.random() < 0.5))
    return assembly(made, [turn("leaf", str(rng.choice(["cw", "ccw"]))) if rng.random() < 0.6 else goal(rng, ["leaf"])])


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
    left = [moved(head, 0, k * pitch) for k in range(count)]
    right = [
        moved(moved(head, turn=np.pi), 1.0 + g + rng.uniform(0, 0.02), (k + 0.5) * pitch) for k in range(count - 1)
    ]
    tape = union(box(-0.5, -0.3, 0.05, count * pitch), *left)
    x = right[0].bounds[2] if right else 2.0
    made = [part("tape", wider(tape, -g / 4), fixed=True)]
    if rng.random() < 0.5:
        made.append(part("other", wider(union(box(x - 0.05, -0.3, x + 0.4, count * pitch), *right), -g / 4)))
    else:
        made += [part(f"tooth{k}", wider(t, -g / 4)) for k, t in enumerate(right)]
    return assembly(made, [goal(rng, [p["name"] for p in made[1:]])])


def geneva_drives(rng: Random) -> Json:
    """A pin wheel that turns a slotted wheel."""
    g, slots = gap_of(rng, 0.01, 0.05), int(rng.integers(4, 7))
    half = np.pi / slots
    apart, crank, wheel_r = 1.0, np.sin(half), np.cos(half)
    pin = 0.09
    wheel = disc(wheel_r, 8 * slots, phase=np.pi / slots)
    deep = apart - crank - pin - 0.03
    wheel = cut(
        wheel, *(moved(box(deep, -pin - g, 2, pin + g), turn=np.pi + half + 2 * half * k) for k in range(slots))
    )
    wheel, axle = on_axle(wheel, (apart, 0.0), 0.1, g)
    arm = union(
        disc(pin, 14, (crank * np.cos(t := rng.uniform(1.2, 5.0)), crank * np.sin(t))),
        band([(0, 0), (crank * np.cos(t), crank * np.sin(t))], 0.1),
        disc(0.22, 14),
    )
    driver, drive_axle = on_axle(arm, (0.0, 0.0), 0.1, g)
    made = [
        part("axle0", drive_axle, fixed=True),
        part("axle1", axle, fixed=True),
        part("driver", driver),
        part("wheel", wheel),
    ]
    return assembly(made, [turn("driver", str(rng.choice(["cw", "ccw"])))])


def discs_off_centre(rng: Random) -> Json:
    """A disc with an off-centre hole on a peg, or in a round hole, pulled at a point of it."""
    g, count = gap_of(rng, 0.01, 0.08), int(rng.integers(8, 33))
    off = rng.uniform(0.1, 0.5)
    if rng.random() < 0.5:
        wheel = cut(disc(1, count), disc(0.2 + g, 16, (off, 0)))
        made = [part("peg", disc(0.2, 16, (off, 0)), fixed=True), part("wheel", wheel)]
    else:
        made = [
            part("plate", cut(box(-2, -2, 2, 2), disc(1 + g, count)), fixed=True),
            part("wheel", cut(disc(1, count), disc(0.3, 12, (off, 0)))),
        ]
    angle = rng.uniform(0, 6)
    spot = made[1]["at"][:2]
    asked = pull("wheel", (np.cos(angle), np.sin(angle)), (spot[0] + rng.uniform(-0.3, 0.3), spot[1]))
    return assembly(made, [asked if rng.random() < 0.7 else goal(rng, ["wheel"])])
