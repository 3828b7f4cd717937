"""Families of random assemblies in space, and the drawing of one by its number."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import shapely
from scipy.spatial import HalfspaceIntersection
from scipy.spatial.transform import Rotation
from shapely import Polygon, affinity, box

from benchmarks.attack.solids import Block, Random, Solids, cut, hull, joined, ngon, turned

Drawn = tuple[list[Block], bool | None]
"""Parts, and whether they come apart where that is known."""


def hinges(rng: Random) -> Drawn:
    """Two leaves with knuckles round a pin, with heads or without."""
    sides, c = int(rng.choice([6, 8, 12, 16])), float(rng.choice([0.1, 0.2, 0.4]))
    length, high, phase = float(rng.uniform(15, 40)), float(rng.uniform(6, 12)), float(rng.choice([0, 0.5]))
    heads = rng.random() < 0.5
    whole = ngon(sides, 5.0, 0.5)
    knuckle = cut(whole, ngon(sides, 2.5, phase))
    arm = cut(box(0, -1.5, length, 1.5), whole)
    z = [0, high, high + c, 2 * high + c, 2 * high + 2 * c, 3 * high + 2 * c]
    left = joined(affinity.scale(knuckle, -1, 1, origin=(0, 0)), affinity.scale(arm, -1, 1, origin=(0, 0)))
    one = [(left, z[0], z[1]), (left, z[4], z[5]), (box(-length, -1.5, -6, 1.5), z[0], z[5])]
    other = [(joined(knuckle, arm), z[2], z[3]), (box(6, -1.5, length, 1.5), z[0], z[5])]
    pin = [(ngon(sides, 2.5 - c, phase), -2 - c, z[5] + 2 + c)]
    if heads:
        pin += [(ngon(sides, 3.5, phase), -2 - c, -c), (ngon(sides, 3.5, phase), z[5] + c, z[5] + 2 + c)]
    return [Block("one", tuple(one), fixed=True), Block("other", tuple(other)), Block("pin", tuple(pin))], not heads


def drawers(rng: Random) -> Drawn:
    """A case that is open in front, and a drawer; some with a rim that narrows the opening before a stem."""
    w, d, h = rng.uniform(20, 60, 3).tolist()
    t, c, stop = float(rng.uniform(2, 5)), float(rng.choice([0.2, 0.5, 1.0])), rng.random() < 0.5
    outer = box(-t, -t, w + t, h + t)
    case = [(cut(outer, box(0, 0, w, h)), 0.0, d), (outer, -t, 0.0)]
    inner = [(box(c, c, w - c, h - c), c, d - c - 2 * t)]
    if stop:
        case.append((cut(outer, box(w / 4, h / 4, 3 * w / 4, 3 * h / 4)), d, d + t))
        inner.append((box(w / 4 + c, h / 4 + c, 3 * w / 4 - c, 3 * h / 4 - c), c, d + 3 * t))
    return [Block("case", tuple(case), fixed=True), Block("drawer", tuple(inner))], not stop


def bayonets(rng: Random) -> Drawn:
    """A stem with lugs below a plate, which lets them through where they stand at its slots; some have no slots."""
    sides, c, lugs = int(rng.choice([12, 16, 24])), float(rng.choice([0.1, 0.2, 0.3])), int(rng.choice([1, 2]))
    r, wide, long, t, high = 5.0, 1.0 + rng.random(), 1.5, 2.0, 3.0
    lift, has_slots = float(rng.uniform(0.3, 2.0)), rng.random() < 0.7
    to_side = np.cos(np.pi / sides)
    bore, chamber = ngon(sides, (r + c) / to_side), ngon(sides, (r + long + 2 * c) / to_side)
    outer = box(-10, -10, 10, 10)

    def spokes(length: float, half: float, phase: float) -> list[Polygon]:
        spoke = box(0, -half, length, half)
        return [affinity.rotate(spoke, 360 / lugs * k + phase, origin=(0, 0)) for k in range(lugs)]

    top = cut(outer, bore, *(spokes(r + long + c, wide + c, 0.0) if has_slots else []))
    socket = [
        (outer, -t, 0.0),
        (cut(outer, chamber), 0.0, high + c + lift),
        (top, high + c + lift, high + c + lift + t),
    ]
    angle = float(rng.uniform(50, 90) if lugs == 2 else rng.uniform(60, 180))
    stem = ngon(sides, r)
    lug = shapely.union_all(spokes(r + long, wide, angle)).intersection(ngon(sides, r + long))
    key = [(joined(stem, lug), c, high), (stem, c, high + c + lift + t + 6)]
    return [Block("socket", tuple(socket), fixed=True), Block("key", tuple(key))], has_slots


def dovetails(rng: Random) -> Drawn:
    """Dovetails along a slide that is open, has one end or both."""
    a, lean, high = float(rng.uniform(2, 8)), float(rng.uniform(0.5, 3)), float(rng.uniform(3, 8))
    c, long, count = float(rng.choice([0.05, 0.1, 0.3])), float(rng.uniform(10, 30)), int(rng.integers(1, 3))
    pitch, ends = 2 * (a + lean) + 4, int(rng.integers(3))
    tails = shapely.union_all(
        [
            Polygon([(x - a, 0), (x + a, 0), (x + a + lean, high), (x - a - lean, high)])
            for x in pitch * np.arange(count)
        ]
    )
    right = pitch * count - pitch / 2
    base = cut(box(-pitch / 2 - 1, 0, right + 1, high + 3), tails)
    if base.bounds[0] > -pitch / 2:
        base = joined(base, box(-pitch / 2 - 1, high + 0.5, right + 1, high + 3))
    male = joined(tails, box(-pitch / 2, -5, right, 0)).buffer(-c, join_style="mitre")
    slabs = [(base, -c, long + c)]
    slabs += [(box(*base.bounds), -3.0, -c)] if ends > 0 else []
    slabs += [(box(*base.bounds), long + c, long + 3)] if ends > 1 else []
    return [Block("base", tuple(slabs), fixed=True), Block("tail", ((male, 0.0, long),))], ends < 2


def hooked_lids(rng: Random) -> Drawn:
    """A lid whose feet reach below a plate when it is slid; some slots are too short to let them out."""
    w, h = rng.uniform(25, 50, 2).tolist()
    t, c, s = 2.0, float(rng.choice([0.1, 0.2, 0.5])), float(rng.uniform(1.5, 3))
    free = rng.random() < 0.6
    long = (2 if free else 1) * s + 2 * c
    slots = [box(5, 5, 5 + long, 9), box(w - 5 - long, h - 9, w - 5, h - 5)]
    whole = box(0, 0, w, h)
    base = [(cut(whole, *slots), 0.0, t), (cut(whole, box(1, 3, w - 1, h - 3)), -6.0, 0.0), (whole, -8.0, -6.0)]
    lid = [(whole, t + c, 2 * t + c)]
    for slot in slots:
        x, y0, _, y1 = slot.bounds
        lid += [(box(x + c, y0 + c, x + s, y1 - c), -c - 1.5, t + c)]
        lid += [(box(x - s + 2 * c, y0 + c, x + s, y1 - c), -c - 1.5, -c)]
    return [Block("base", tuple(base), fixed=True), Block("lid", tuple(lid))], True if free else None


def barbs(rng: Random) -> Drawn:
    """A stud through a plate with a barb behind it."""
    w, b, c, t = rng.uniform(2, 4), rng.uniform(0.2, 1.0), rng.choice([0.05, 0.1, 0.2]), rng.uniform(1, 4)
    plate = cut(box(-12, -12, 12, 12), box(-w - c, -w - c, w + c, w + c))
    back = 0.0 if rng.random() < 0.5 else b
    stud = [(box(-w, -w, w, w), -3 - c, t + c + 2), (box(-w - 3, -w - 3, w + 3, w + 3), -3 - c, -c)]
    stud += [(box(-w - back, -w, w + b, w), t + c, t + c + 1.5)]
    return [Block("plate", ((plate, 0.0, t),), fixed=True), Block("stud", tuple(stud))], None


def leaning_tenons(rng: Random) -> Drawn:
    """Plates that lean, each with a tenon in a hole of a base that is as much wider as they lean."""
    t, c, count = float(rng.uniform(2, 4)), float(rng.choice([0.1, 0.3])), int(rng.integers(1, 4))
    base = box(0, 0, 40 * count, 40)
    parts = []
    for k in range(count):
        phi, tilt = float(rng.uniform(-40, 40)), float(rng.uniform(-30, 30))
        need = (t / 2 + t / 2 * abs(np.sin(np.radians(tilt))) + c) / np.cos(np.radians(tilt))
        hole = affinity.rotate(box(-8 - c, -need, 8 + c, need), phi, origin=(0, 0))
        base = cut(base, affinity.translate(hole, 40 * k + 20, 20))
        profile = joined(box(-15, t / 2 + 1.5, 15, 20), box(-8, -t - 3, 8, t / 2 + 2))
        R = Rotation.from_euler("xz", [90 + tilt, phi], degrees=True).as_matrix()
        at = np.array([40 * k + 20, 20, t / 2]) - R @ [0, 0, t / 2]
        parts.append(Block(f"leaf{k}", ((profile, 0.0, t),), R=R, at=at.tolist()))
    return [Block("base", ((base, 0.0, t),), fixed=True), *parts], True


def cross_laps(rng: Random) -> Drawn:
    """Two boards crossed at any angle, each with a slot for the other."""
    t, angle, c = float(rng.uniform(2, 4)), float(rng.uniform(35, 90)), float(rng.choice([0.1, 0.2]))
    high, long = float(rng.uniform(10, 25)), 20.0
    wide = t / np.sin(np.radians(angle)) + t / np.tan(np.radians(angle)) + 2 * c
    upper = cut(box(-long, 0, long, high), box(-wide / 2, high / 2 - c, wide / 2, high + 1))
    lower = cut(box(-long, 0, long, high), box(-wide / 2, -1, wide / 2, high / 2 + c))
    up = Rotation.from_euler("x", 90, degrees=True).as_matrix()
    across = Rotation.from_euler("z", angle, degrees=True).as_matrix() @ up
    middle = [0, 0, t / 2]
    return [
        Block("a", ((upper, 0.0, t),), R=up, at=(-up @ middle).tolist(), fixed=True),
        Block("b", ((lower, 0.0, t),), R=across, at=(-across @ middle).tolist()),
    ], True


def lidded_boxes(rng: Random) -> Drawn:
    """A box, a lid whose lip stands in it, and something loose inside."""
    w, d, h = rng.uniform(15, 40, 3).tolist()
    t, c, lip = float(rng.uniform(1, 3)), float(rng.choice([0.1, 0.2, 0.5])), float(rng.uniform(1, 6))
    outer, inner = box(-t, -t, w + t, d + t), box(0, 0, w, d)
    lid = [(outer, h + c, h + c + t), (inner.buffer(-c, join_style="mitre"), h - lip, h + c)]
    sides, r = int(rng.integers(3, 9)), 0.4 * min(w, d)
    loose = affinity.translate(ngon(sides, r, rng.random()), w / 2, d / 2)
    return [
        Block("box", ((outer, -t, 0.0), (cut(outer, inner), 0.0, h)), fixed=True),
        Block("lid", tuple(lid)),
        Block("loose", ((loose, c, c + (h - lip - 2 * c) * float(rng.uniform(0.3, 1.0))),)),
    ], True


def hexagon_keys(rng: Random) -> Drawn:
    """A round head with a socket of some corners, and a bent key in it."""
    corners, sides, c = int(rng.integers(3, 8)), int(rng.choice([12, 24, 32])), float(rng.choice([0.1, 0.2, 0.4]))
    r, deep, arm = float(rng.uniform(3, 6)), float(rng.uniform(4, 12)), float(rng.uniform(15, 40))
    head = [(cut(ngon(sides, 10), ngon(corners, r)), 0.0, deep), (ngon(sides, 10), -4.0, 0.0)]
    small = ngon(corners, r - c / np.cos(np.pi / corners))
    key = [(small, c, deep + 4), (box(-1, -r / 2, arm, r / 2), deep + 4, deep + 8)]
    return [Block("head", tuple(head), fixed=True), Block("key", tuple(key))], True


def cages(rng: Random) -> Drawn:
    """A round body inside a frame of bars, which lets it out where a window is wider."""
    w, bar, c = float(rng.uniform(10, 20)), float(rng.uniform(1, 4)), float(rng.choice([0.2, 0.5]))
    directions = rng.normal(size=(int(rng.integers(12, 40)), 3))
    body = (w / 2 - c) * directions / np.linalg.norm(directions, axis=1)[:, None] + w / 2
    outer, inner = box(-bar, -bar, w + bar, w + bar), box(0, 0, w, w)
    posts = [box(x, y, x + bar, y + bar) for x, y in itertools.product((-bar, w), repeat=2)]
    ring = cut(outer, inner.buffer(-bar / 2, join_style="mitre"))
    slabs = [(ring, -bar, 0.0), (ring, w, w + bar), *((post, 0.0, w) for post in posts)]
    return [Block("cage", tuple(slabs), fixed=True), Block("body", corners=hull(body))], None


def tetrahedra(rng: Random) -> Drawn:
    """Bodies on squares whose sides lean in and out by turns, in a frame of others."""
    lean, e = float(rng.uniform(0.2, 0.8)), float(rng.uniform(0.005, 0.03))
    inside, high = int(rng.integers(1, 3)), float(rng.uniform(0.3, 0.6))
    parts = []
    for i, j in itertools.product(range(inside + 2), range(3)):
        rows = [[0, 0, 1, -high], [0, 0, -1, -high]]
        for axis, sign in itertools.product((0, 1), (1.0, -1.0)):
            n = np.array([0, 0, lean if (axis + i + j) % 2 else -lean])
            n[axis] = sign
            length = np.linalg.norm(n)
            rows.append([*(n / length), -(0.5 / length - e)])
        corners = HalfspaceIntersection(np.array(rows), np.zeros(3)).intersections
        held = i in (0, inside + 1) or j in (0, 2)
        parts.append(Block(f"t{i}{j}", corners=hull(np.unique(corners.round(12), axis=0)), at=(i, j, 0), fixed=held))
    return parts, None


def tabs_and_slots(rng: Random) -> Drawn:
    """A tray: a floor with slots, walls with tabs in it, and some with a cover of the same slots."""
    w, t, c = float(rng.uniform(30, 60)), float(rng.uniform(2, 5)), float(rng.choice([0.05, 0.15, 0.4]))
    h, tab, cover = float(rng.uniform(10, 30)), float(rng.uniform(3, 8)), rng.random() < 0.5
    wall = joined(box(2, 0, w - 2, h), box(w / 2 - tab, -t - 1, w / 2 + tab, h + t + 1))
    floor = box(0, 0, w, w)
    up = Rotation.from_euler("x", 90, degrees=True).as_matrix()
    walls = []
    for k, y in enumerate(np.linspace(8, w - 8, int(rng.integers(2, 4))).tolist()):
        floor = cut(floor, box(w / 2 - tab - c, y - t - c, w / 2 + tab + c, y + c))
        walls.append(Block(f"wall{k}", ((wall, 0.0, t),), R=up, at=(0.0, y, c)))
    parts = [Block("floor", ((floor, -t, 0.0),), fixed=True), *walls]
    return ([*parts, Block("cover", ((floor, h + 2 * c, h + 2 * c + t),))] if cover else parts), True


def oblique_bolts(rng: Random) -> Drawn:
    """Prisms of any outline through a block, aslant to its faces, beside a second one across."""
    c, lean = float(rng.choice([0.1, 0.3])), float(rng.uniform(0, 35))
    R = Rotation.from_euler("xz", [lean, float(rng.uniform(0, 360))], degrees=True).as_matrix()
    count, r = int(rng.integers(3, 9)), float(rng.uniform(2, 4))
    hole = ngon(count, r, rng.random())
    nut = [(cut(ngon(6, 12), hole), -6.0, 6.0)]
    bolt = [(hole.buffer(-c, join_style="mitre"), -20.0, 7.0)]
    if rng.random() < 0.5:
        bolt.append((ngon(8, r + 3), 6.0 + c, 9.0))
    return [Block("nut", tuple(nut), R=R, fixed=True), Block("bolt", tuple(bolt), R=R)], True


FAMILIES: tuple[Callable[[Random], Drawn], ...] = (
    hinges,
    drawers,
    bayonets,
    dovetails,
    hooked_lids,
    barbs,
    leaning_tenons,
    cross_laps,
    lidded_boxes,
    hexagon_keys,
    cages,
    tetrahedra,
    tabs_and_slots,
    oblique_bolts,
)


def draw_solids(number: int) -> tuple[str, Solids]:
    """Family and assembly of a number: turned anywhere or not, as meshes or in the form that fits, pulled or turned."""
    family = FAMILIES[number % len(FAMILIES)]
    rng = np.random.default_rng([number, 3])
    parts, comes_apart = family(rng)
    R = np.eye(3) if rng.random() < 0.4 else Rotation.random(random_state=int(rng.integers(1 << 30))).as_matrix()
    meshes = rng.random() < 0.4
    free = [p.name for p in parts if not p.fixed]
    along = np.eye(3)[rng.integers(3)] * rng.choice([-1, 1]) if rng.random() < 0.6 else rng.normal(size=3)
    direction = (R @ along / np.linalg.norm(along)).tolist()
    asked = {"part": free[int(rng.integers(len(free)))], "turn" if rng.random() < 0.4 else "direction": direction}
    return family.__name__, Solids(turned(parts, R), asked, meshes, comes_apart)
