"""Families of parts that go round bends: bayonets with two steps, keys in curved slots, chains of ball joints."""

from __future__ import annotations

import numpy as np
from shapely import Polygon

from benchmarks.attack import drawing as draw
from benchmarks.attack.drawing import Json, Random
from benchmarks.attack.families_fitted import gap_of


def stepped_bayonets(rng: Random) -> Json:
    """A pin, longer than wide, in a slot with two steps; in some the last one goes back under the first."""
    g, stem = gap_of(rng, 0.01, 0.08), rng.uniform(0.2, 0.3)
    first, down = rng.uniform(0.4, 0.7), rng.uniform(0.4, 0.7)
    second = first + rng.choice([-1, 1]) * rng.uniform(0.4, 0.7)
    lean = rng.uniform(-0.1, 0.1)
    slot = draw.band([(0, 1.2), (0, 0), (first, lean), (first + lean, lean - down), (second, -down)], stem)
    plate = draw.cut(draw.box(-1.2, -1.2, 2.0, 1.0), draw.wider(slot, g / 2))
    plate = max(draw.pieces(plate), key=lambda p: p.area)
    long = stem * rng.uniform(0.8, 1.25)
    pin = draw.union(draw.disc(stem / 2, int(rng.integers(8, 20))), draw.box(-stem / 2, 0, stem / 2, long - stem / 2))
    begin = draw.moved(pin, 0.0, float(rng.uniform(0.1, 0.5)))
    return draw.assembly([draw.part("plate", plate, fixed=True), draw.part("pin", begin)], [draw.goal(rng, ["pin"])])


def _sector(inner: float, outer: float, begin: float, end: float, count: int) -> Polygon:
    """Piece of a ring between two angles."""
    angle = np.linspace(begin, end, count)
    arc = np.column_stack([np.cos(angle), np.sin(angle)])
    return Polygon(np.concatenate([outer * arc, inner * arc[::-1]]))


def keys_in_curved_slots(rng: Random) -> Json:
    """One or two keys with a head, in a slot with a neck that goes along an arc."""
    g, radius = gap_of(rng, 0.01, 0.05), rng.uniform(1.5, 3.0)
    head, neck = rng.uniform(0.2, 0.4), rng.uniform(0.1, 0.25)
    span, corners = rng.uniform(0.8, 2.2), int(rng.integers(8, 30))
    lip = rng.uniform(0.08, 0.2)
    slot = draw.union(
        _sector(radius, radius + head, 0, span, corners),
        _sector(radius + head / 2, radius + head + 1, lip, span - lip, corners),
    )
    block = _sector(radius - 0.5, radius + head + neck, -0.3, span + 0.3, corners)
    body = max(draw.pieces(draw.cut(block, slot)), key=lambda p: p.area)
    keys: list[Polygon] = []
    at = lip + 0.02
    for _ in range(int(rng.integers(1, 3))):
        wide = rng.uniform(0.15, 0.3) * span
        if at + wide > span - lip:
            break
        side = rng.uniform(0.02, 0.06)
        key = draw.union(
            _sector(radius, radius + head, at - side, at + wide + side, int(rng.integers(3, 9))),
            _sector(radius + head / 2, radius + head + neck + 0.3, at, at + wide, int(rng.integers(3, 9))),
        )
        keys.append(draw.wider(key, -g))
        at += wide + rng.uniform(0.15, 0.5)
    made = [draw.part("block", body, fixed=True), *(draw.part(f"key{k}", key) for k, key in enumerate(keys))]
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])] if keys else [])


def ball_joints(rng: Random) -> Json:
    """A chain of links, each with a ball in the socket of the one before."""
    g, radius = gap_of(rng, 0.01, 0.05), rng.uniform(0.25, 0.4)
    mouth = rng.uniform(0.75, 0.95) * radius
    count = int(rng.integers(2, 5))
    links = []
    for k in range(count):
        x = 1.2 * k
        link = draw.box(x, -0.5, x + 1, 0.5)
        if k:
            ball = draw.disc(radius - g / 2, int(rng.integers(12, 30)), at=(x - 0.5, 0), phase=rng.uniform(0, 1))
            link = draw.union(link, ball, draw.box(x - 0.5, -0.6 * mouth, x + 0.2, 0.6 * mouth))
        if k + 1 < count:
            socket = draw.disc(radius + g / 2, int(rng.integers(12, 30)), at=(x + 0.7, 0), phase=rng.uniform(0, 1))
            link = draw.cut(link, socket, draw.box(x + 0.7, -mouth, x + 2, mouth))
        links.append(max(draw.pieces(link), key=lambda p: p.area))
    made = [draw.part(f"link{k}", link, fixed=k == 0) for k, link in enumerate(links)]
    return draw.assembly(made, [draw.goal(rng, [p["name"] for p in made[1:]])])
