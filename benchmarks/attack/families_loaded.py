"""Families in which several contacts share a load, and layers pass over each other: bolted plates, beams, yokes, links, arches."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import shapely
from shapely import Polygon

from benchmarks.attack import drawing as draw
from benchmarks.attack.drawing import Json, Random
from benchmarks.attack.families_fitted import gap_of


def _layers(*names: str) -> list[list[str]]:
    """Pairs of parts that lie over each other."""
    return [list(pair) for pair in combinations(names, 2)]


def _movable(made: list[Json]) -> list[str]:
    return [p["name"] for p in made if not p.get("fixed")]


def bolted_plates(rng: Random) -> Json:
    """Plates over each other with one bolt, or two, through all of them."""
    g, count, corners = gap_of(rng, 0.02, 0.06), int(rng.integers(2, 4)), int(rng.integers(5, 17))
    spots = [(0.0, 0.0), (1.5, 0.0)][: int(rng.integers(1, 3))]
    phase = float(rng.choice([0.0, np.pi / corners, rng.uniform(0, 1)]))
    made = []
    for k in range(count):
        wide = g * rng.choice([1.0, 1.0, 1.7]) / np.cos(np.pi / corners)
        holes = [draw.disc(0.3 + wide, corners, at, phase) for at in spots]
        sheet = draw.cut(draw.box(-0.8, -0.8, 0.8 + 1.5 * (len(spots) - 1), 0.8), *holes)
        made.append(draw.part(f"plate{k}", sheet, fixed=k == 0))
    made += [draw.part(f"bolt{k}", draw.disc(0.3, corners, at, phase)) for k, at in enumerate(spots)]
    plates = [f"plate{k}" for k in range(count)]
    return draw.assembly(made, [draw.goal(rng, plates[1:])], ignore=_layers(*plates))


def beams_on_posts(rng: Random) -> Json:
    """A beam on posts, flat or pointed, with a keel between two stops."""
    g, count, play = gap_of(rng, 0.01, 0.05), int(rng.integers(2, 5)), rng.uniform(0.05, 0.4)
    beam = draw.union(draw.box(-2, g, 2, 0.5), draw.box(-0.1, -0.8, 0.1, 0.1))
    made = [draw.part("beam", beam)]
    xs = rng.choice([-1.7, -1.3, -0.9, 0.9, 1.3, 1.7], count, replace=False) + rng.uniform(-0.05, 0.05, count)
    for k, x in enumerate(xs):
        flat = rng.choice([0.0, 0.05])
        top = [(x + flat, 0.0), (x - flat, 0.0)] if flat else [(x, 0.0)]
        made.append(draw.part(f"post{k}", Polygon([(x - 0.1, -1), (x + 0.1, -1), *top]), fixed=rng.random() < 0.8))
    stops = draw.box(-0.4 - play, -1, -0.1 - play, -0.3), draw.box(0.1 + play, -1, 0.4 + play, -0.3)
    made += [draw.part(f"stop{k}", p, fixed=True) for k, p in enumerate(stops)]
    made.append(draw.part("floor", draw.box(-2.2, -1.3, 2.2, -1.02), fixed=True))
    asked = draw.pull("beam", (rng.uniform(-0.2, 0.2), -1.0)) if rng.random() < 0.7 else draw.goal(rng, ["beam"])
    return draw.assembly(made, [asked])


def scotch_yokes(rng: Random) -> Json:
    """A crank whose pin drives a slotted yoke between two rails."""
    g, r, arm = gap_of(rng, 0.01, 0.04), 0.12, rng.uniform(0.4, 0.7)
    angle = rng.uniform(0, 2 * np.pi)
    at = arm * np.array([np.cos(angle), np.sin(angle)])
    wheel = draw.cut(draw.disc(0.3, 16), draw.disc(r + g, 14))
    crank = draw.cut(
        draw.union(wheel, draw.band([(0, 0), at], 0.2)), draw.disc(r + g, 14), draw.disc(r * 0.7 + g, 14, at)
    )
    high = arm + 0.5
    yoke = draw.cut(
        draw.box(at[0] - 0.4, -high, at[0] + 0.4, high), draw.box(at[0] - r - g, -high + 0.2, at[0] + r + g, high - 0.2)
    )
    rails = [draw.box(-2, high + g, 2, high + 0.3), draw.box(-2, -high - 0.3, 2, -high - g)]
    made = [
        draw.part("axle", draw.disc(r, 14), fixed=True),
        draw.part("crank", max(draw.pieces(crank), key=lambda p: p.area)),
    ]
    made += [draw.part("pin", draw.disc(r * 0.7, 14, at)), draw.part("yoke", yoke)]
    made += [draw.part(f"rail{k}", p, fixed=True) for k, p in enumerate(rails)]
    if rng.random() < 0.6:
        made.append(draw.part("wall", draw.box(1.2 + rng.uniform(0, 0.6), -0.2, 2.2, 0.2), fixed=True))
    ignore = (
        [["crank", "yoke"], ["axle", "yoke"], ["crank", "wall"]]
        if made[-1]["name"] == "wall"
        else [["crank", "yoke"], ["axle", "yoke"]]
    )
    ignore += [["crank", f"rail{k}"] for k in range(2)]
    return draw.assembly(
        made,
        [draw.turn("crank", str(rng.choice(["cw", "ccw"]))) if rng.random() < 0.5 else draw.pull("yoke", (1, 0))],
        ignore=ignore,
    )


def oldham_couplings(rng: Random) -> Json:
    """A tongue in a slot of a disc, whose own tongue lies in another slot, crosswise."""
    g, wide = gap_of(rng, 0.01, 0.05), rng.uniform(0.15, 0.3)
    lean = float(rng.choice([np.pi / 2, rng.uniform(0.8, 2.0)]))
    low, high = draw.box(-0.7, -wide, 0.7, wide), draw.moved(draw.box(-0.7, -wide, 0.7, wide), turn=lean)
    made = [draw.part("tongue", low, fixed=True)]
    made.append(draw.part("disc", draw.cut(draw.disc(1, 16), draw.wider(draw.union(low, high), g))))
    made.append(draw.part("key", high))
    return draw.assembly(made, [draw.goal(rng, ["key", "disc"])], ignore=[["tongue", "key"]])


def wedge_stacks(rng: Random) -> Json:
    """Wedges on each other between two walls under a lid."""
    g, count = gap_of(rng, 0.01, 0.05), int(rng.integers(2, 5))
    made, y, left = [], 0.0, 0.0
    for k in range(count):
        a, b = rng.uniform(0.3, 0.7, 2)
        lean = rng.uniform(-0.15, 0.15)
        low = [(0.0, y + left), (1.5, y - left)]
        y, left = y + (a + b) / 2, lean
        made.append(draw.part(f"wedge{k}", draw.wider(Polygon([*low, (1.5, y - left), (0.0, y + left)]), -g / 2)))
    walls = draw.cut(
        draw.box(-0.5, -0.5, 2.0, y + 0.8), draw.box(-rng.uniform(0, 0.05), 0, 1.5, y + rng.uniform(0.2, 0.4))
    )
    if rng.random() < 0.4:
        walls = draw.cut(walls, draw.box(1.4, 0.05, 3, 0.3))
    return draw.assembly(
        [draw.part("walls", max(draw.pieces(walls), key=lambda p: p.area), fixed=True), *made],
        [draw.goal(rng, _movable(made))],
    )


def marbles_in_channels(rng: Random) -> Json:
    """Discs in a row in a bent channel: the first pushes all."""
    wide, count = rng.uniform(0.4, 0.6), int(rng.integers(2, 6))
    line = shapely.LineString(
        [(0, 0), (rng.uniform(1, 2), 0), (rng.uniform(1.5, 2.5), rng.uniform(0.6, 1.5)), (rng.uniform(3, 4), 1.5)]
    )
    channel = shapely.buffer(line, wide / 2, cap_style="square", join_style="mitre")
    block = draw.cut(draw.wider(channel.envelope, 0.3), channel)
    made, at, before = [draw.part("block", max(draw.pieces(block), key=lambda p: p.area), fixed=True)], 0.0, 0.0
    for k in range(count):
        r = wide / 2 - gap_of(rng, 0.01, 0.06)
        at += (before + r + rng.uniform(0.02, 0.15)) if k else 0.0
        before = r
        if at > line.length:
            break
        spot = line.interpolate(at)
        made.append(
            draw.part(f"marble{k}", draw.disc(r, int(rng.integers(6, 16)), (spot.x, spot.y), rng.uniform(0, 1)))
        )
    return draw.assembly(made, [draw.goal(rng, _movable(made))])


def combs(rng: Random) -> Json:
    """Two combs with their teeth between each other, some with barbs."""
    g, count, pitch = gap_of(rng, 0.01, 0.06), int(rng.integers(2, 6)), 0.5
    one, other = draw.box(-0.3, -0.4, count * pitch + 0.3, 0), draw.box(-0.3, 1.2, count * pitch + 0.3, 1.6)
    for k in range(count):
        thick = rng.uniform(0.08, 0.12)
        x = (k + 0.25) * pitch
        one = draw.union(one, draw.box(x - thick, -0.1, x + thick, 1.0))
        if rng.random() < 0.4:
            one = draw.union(one, Polygon([(x, 0.9), (x, 0.6), (x + thick + rng.uniform(0.05, 0.12), 0.7)]))
    space = draw.cut(draw.box(-0.3, 0.2, count * pitch + 0.3, 1.3), draw.wider(one, g))
    other = draw.union(other, space)
    made = [draw.part("one", one, fixed=True)]
    made += [draw.part(f"other{k}", p) for k, p in enumerate(draw.pieces(other))]
    return draw.assembly(made, [draw.goal(rng, _movable(made))])


def spirals(rng: Random) -> Json:
    """A spiral wall, and another between its turns."""
    turns, many = rng.uniform(0.8, 1.6), int(rng.integers(16, 30))
    angle = np.linspace(0, 2 * np.pi * turns, many)
    wide, room = 0.1, rng.uniform(0.32, 0.45)

    def wall(phase: float, count: int) -> Polygon:
        r = 0.4 + room * angle[:count] / (2 * np.pi) * 1.6
        line = np.column_stack([r * np.cos(angle[:count] + phase), r * np.sin(angle[:count] + phase)])
        return shapely.buffer(shapely.LineString(line), wide / 2, cap_style="flat", join_style="mitre")

    made = [
        draw.part("still", wall(0.0, many), fixed=True),
        draw.part("loose", wall(np.pi, int(rng.integers(many // 2, many)))),
    ]
    return draw.assembly(made, [draw.goal(rng, ["loose"])])


def linked_hooks(rng: Random) -> Json:
    """Hooks like the letter S, each round the end of the one before."""
    g, count = gap_of(rng, 0.03, 0.08), int(rng.integers(2, 5))
    thick, open_ = 0.18, rng.uniform(0.1, 0.3)
    hook = draw.union(draw.box(0, 0, thick, 1), draw.box(0, 0, 0.8, thick), draw.box(0.8 - thick, 0, 0.8, 1 - open_))
    made = []
    for k in range(count):
        flipped = draw.moved(hook, turn=np.pi, about=(0.4, 0.5)) if k % 2 else hook
        shifted = draw.moved(flipped, k * (0.8 - 2 * thick - g - rng.uniform(0, 0.08)), 0.3 if k % 2 else 0.0)
        made.append(draw.part(f"hook{k}", shifted, fixed=k == 0))
    return draw.assembly(made, [draw.goal(rng, _movable(made))])


def arches(rng: Random) -> Json:
    """Stones of an arch between two feet, a lid over some of them."""
    g, count = gap_of(rng, 0.01, 0.05), int(rng.integers(3, 7))
    cuts = np.linspace(0.25, np.pi - 0.25, count + 1) + np.concatenate([[0], rng.uniform(-0.08, 0.08, count - 1), [0]])

    def stone(a: float, b: float) -> Polygon:
        turn = np.linspace(a, b, 4)
        arc = np.column_stack([np.cos(turn), np.sin(turn)])
        return draw.wider(Polygon(np.concatenate([1.5 * arc, arc[::-1]])), -g / 2)

    made = [draw.part(f"stone{k}", stone(a, b)) for k, (a, b) in enumerate(pairwise(cuts))]
    feet = [stone(-0.4, 0.25), stone(np.pi - 0.25, np.pi + 0.4)]
    made += [draw.part(f"foot{k}", p, fixed=True) for k, p in enumerate(feet)]
    if rng.random() < 0.6:
        lid = draw.cut(draw.box(-2.2, -0.3, 2.2, 2.2), draw.disc(1.5 + rng.uniform(0.02, 0.2), 20))
        lid = draw.cut(lid, draw.wider(draw.union(*feet), 0.05), draw.box(-3, -1, 3, 0.2))
        made.append(draw.part("lid", max(draw.pieces(lid), key=lambda p: p.area), fixed=True))
    return draw.assembly(made, [draw.goal(rng, _movable(made))])
