"""Figures of assemblies in space: closed forms, chains, a box of six panels, a burr of six pieces, interlocking tetrahedra, a round pin.

`python -m benchmarks.spatial_figures` prints them all; names after it choose: pegs, chains, box, burr, tetrahedra, many, pin,
starts.
"""

from __future__ import annotations

import itertools
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import shapely
from scipy.optimize import brentq
from scipy.spatial import ConvexHull, HalfspaceIntersection

import wiggleroom as wr
from benchmarks.attack.families_solid import draw_solids
from benchmarks.spatial_burrs import STEPS, STICKS, assembled, connected
from benchmarks.spatial_overlaps import Judge, finger_box, prisms, voxel_judge, worst_on
from benchmarks.spatial_overlaps import box as corners
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Boxes, Drawing, Goal, Part, Plate, Pull, Region, Surface, Turn
from wiggleroom.search.answer import Answer
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.spatial_flex import flex_spatial
from wiggleroom.verdict import Verdict

FAMILIES = ("tee", "swallowtail", "dovetail", "finger", "jigsaw", "revolute")
PLANAR = frozenset({"z", "rx", "ry"})


def part(name: str, solid: Plate | Boxes | Surface, at=(0.0, 0.0, 0.0), fixed=False, lock=frozenset()) -> Part:
    return Part(name, at=at, fixed=fixed, solid=solid, lock=lock)


def square(side: float) -> np.ndarray:
    return side / 2 * np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])


def polygon(count: int, radius: float) -> np.ndarray:
    angle = 2 * np.pi * np.arange(count) / count
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def plate(hole: np.ndarray, thick: float) -> Part:
    return part("plate", Plate((Region(square(40.0), (hole[::-1],)),), thick), (0, 0, -thick / 2), fixed=True)


def timed(assembly: Assembly, goal: Goal) -> tuple[Answer, float]:
    began = time.process_time()
    return flex_spatial(assembly, goal), time.process_time() - began


def line(what: str, answer: Answer, seconds: float, truth: float | None = None) -> None:
    value = "" if answer.objective is None else f"{answer.objective:.8f}"
    off = (
        ""
        if truth is None or answer.objective is None
        else f", off the closed form by {abs(answer.objective - truth):.1e}"
    )
    print(f"{what}: {answer.verdict} {value}{off}, {answer.iterations} iterations, path {answer.path}, {seconds:.2f} s")


def pegs() -> None:
    """Square peg of 10 in a hole of 10.4, 12 thick: shift, tilt, twist."""
    peg = part("peg", Boxes(np.array([[[-5.0, -5, -20], [5, 5, 20]]])))
    assembly = assemble_spatial(Drawing((plate(square(10.4), 12.0), peg)))
    tilt = brentq(lambda a: 10 / np.cos(a) + 12 * np.tan(a) - 10.4, 1e-4, 0.3)
    twist = brentq(lambda a: 10 * (np.cos(a) + np.sin(a)) - 10.4, 1e-3, 0.3)
    locked = assemble_spatial(Drawing((plate(square(10.4), 12.0), replace(peg, lock=frozenset({"rx", "ry", "rz"})))))
    line("peg, shift", *timed(locked, Pull("peg", (1, 0, 0))), 0.2)
    line("peg, tilt", *timed(assembly, Turn("peg", (1, 0, 0))), tilt)
    line("peg, twist", *timed(assembly, Turn("peg", (0, 0, 1))), twist)


def chains() -> None:
    """Ten links of every joint family, as plates locked in their plane."""
    for joint in FAMILIES:
        flat = wr.patterns.chain(10, joint=joint, gap=0.01)
        last = flat.drawing.parts[-1]
        truth = wr.flex(flat, wr.Pull(last.name, (0, 1)), search=0).objective
        links = tuple(
            part(p.name, Plate(p.regions, 0.4), (*p.at[:2], 0.0), p.fixed, PLANAR) for p in flat.drawing.parts
        )
        assembly = assemble_spatial(Drawing(links, 0.01))
        line(f"chain of ten, {joint}", *timed(assembly, Pull(last.name, (0, 1, 0), (*last.at[:2], 0.2))), truth)


def between_plates() -> None:
    """Ten links of every family with all six freedoms between two plates: the motion in the plane is the truth.

    Straight fingers slide apart, so a chain of them is without end in the plane too; python-fcl judges the way out.
    """
    low, high, thick, gap = np.array([-2.0, -8]), np.array([12.0, 8]), 0.4, 0.01
    for joint in FAMILIES:
        flat = wr.patterns.chain(10, joint=joint, gap=gap)
        last = flat.drawing.parts[-1]
        truth = wr.flex(flat, wr.Pull(last.name, (0, 1)), search=0)
        links = [part(p.name, Plate(p.regions, thick), (*p.at[:2], 0.0), p.fixed) for p in flat.drawing.parts]
        covers = [
            part(name, Boxes(np.array([[[*low, z], [*high, z + thick]]])), fixed=True)
            for name, z in (("below", -thick), ("above", thick))
        ]
        assembly = assemble_spatial(Drawing((*links, *covers), gap))
        answer, seconds = timed(assembly, Pull(last.name, (0, 1, 0), (*last.at[:2], thick / 2)))
        line(f"chain of ten between plates, {joint}", answer, seconds, truth.objective)
        if answer.verdict is Verdict.UNBOUNDED:
            shapes = [
                prisms(shapely.Polygon(p.regions[0].outer), 0.0, thick, gap, np.eye(3), np.array([*p.at[:2], 0.0]))
                for p in flat.drawing.parts
            ]
            shapes += [
                [corners(np.array([*low, z + gap / 2]), np.array([*high, z + thick - gap / 2]))]
                for z in (-thick, thick)
            ]
            judge = Judge(shapes, assembly.reference, [p.fixed for p in assembly.drawing.parts])
            print(f"  {truth.verdict} in the plane too; overlaps on the way out: {worst_on(judge, answer.waypoints):g}")


def box() -> None:
    """A box of six panels with fingers: one panel is lifted off, another is pulled along."""
    drawing, _ = finger_box(np.random.default_rng(1))
    assembly = assemble_spatial(drawing)
    for direction in ((1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0)):
        line(f"box of six panels, {direction}", *timed(assembly, Pull("s1", direction)))


def keyed_burr(seed: int) -> list[set]:
    """Six crossed sticks of which the first alone can move, by whole cells, and all the others are blocked by it."""
    rng = random.Random(seed)
    owners: dict = {}
    for k, (low, high) in enumerate(STICKS[6]):
        for v in itertools.product(*[range(a, b) for a, b in zip(low, high, strict=True)]):
            owners.setdefault(v, []).append(k)
    while True:
        parts: list[set] = [set() for _ in range(6)]
        for v, who in owners.items():
            parts[0 if 0 in who else rng.choice(who)].add(v)
        if all(connected(p) for p in parts):
            free = {frozenset(carried(parts, p, s)) for p in range(6) for s in STEPS}
            free.discard(frozenset(range(6)))
            if free and free <= {frozenset([0]), frozenset(range(1, 6))}:
                return parts


def carried(parts: list[set], first: int, step: tuple[int, int, int]) -> set[int]:
    """Pieces that must move along when one moves by a cell."""
    own = {v: k for k, cells in enumerate(parts) for v in cells}
    group, todo = {first}, [first]
    while todo:
        k = todo.pop()
        for v in parts[k]:
            other = own.get((v[0] + step[0], v[1] + step[1], v[2] + step[2]))
            if other is not None and other not in group:
                group.add(other)
                todo.append(other)
    return group


def burr(gap: float = 0.05) -> None:
    """Six-piece burr with a key: every piece pulled along all axes, and all ways out judged by python-fcl.

    At rest only the key can go a whole step, along x. Without it p3 goes straight up and out, so there are ways out of other pulls too.
    """
    cells = keyed_burr(1)
    assembly = assemble_spatial(assembled(cells, gap).drawing, fix=("p1",))
    judge = Judge(
        [voxel_judge(v, gap / 2) for v in cells], assembly.reference, [p.fixed for p in assembly.drawing.parts]
    )
    seen: Counter = Counter()
    iterations, ways, began = [], [], time.process_time()
    for k, step in itertools.product((0, 2, 3, 4, 5), STEPS):
        answer = flex_spatial(assembly, Pull(f"p{k}", tuple(map(float, step))))
        seen[f"{'key' if k == 0 else 'others'} {answer.verdict}, path {answer.path}"] += 1
        iterations.append(answer.iterations)
        if answer.verdict is Verdict.UNBOUNDED:
            ways.append((f"p{k} along {step}", answer.waypoints))
    print("six-piece burr, 30 pulls: " + "; ".join(f"{n} {what}" for what, n in sorted(seen.items())))
    print(
        f"  iterations: median {np.median(iterations):g}, most {max(iterations)}; {time.process_time() - began:.1f} s"
    )
    for who, path in ways:
        key_out = int(np.argmax(np.abs(path[:, 0, 0]) > 6)) or None  # its length is 6
        print(
            f"  {who} leaves, the key is out from waypoint {key_out} of {len(path)}: overlaps {worst_on(judge, path):g}"
        )


def tetrahedron(even: bool, lean: float = np.sqrt(0.5)) -> Surface:
    """Four sides that lean in and out by turns, on a square of 1."""
    rows = []
    for sign, axis in itertools.product((1.0, -1.0), (0, 1)):
        n = np.zeros(3)
        n[axis], n[2] = sign, -lean if (axis == 0) == even else lean
        rows.append([*n, -0.5])
    corners = HalfspaceIntersection(np.array(rows), np.zeros(3)).intersections
    hull = ConvexHull(corners)
    faces = []
    for simplex, equation in zip(hull.simplices, hull.equations, strict=True):
        a, b, c = corners[simplex]
        faces.append(simplex if np.cross(b - a, c - a) @ equation[:3] > 0 else simplex[::-1])
    return Surface(corners, np.array(faces, dtype=np.int64))


def plate_of_tetrahedra(count: int, gap: float) -> Assembly:
    """Tetrahedra that lean on each other; those of the rim stand."""
    solids = (tetrahedron(True), tetrahedron(False))
    rim = (0, count - 1)
    blocks = tuple(
        part(f"t{i}-{j}", solids[(i + j) % 2], (i, j, 0), fixed=i in rim or j in rim)
        for j, i in itertools.product(range(count), repeat=2)
    )
    return assemble_spatial(Drawing(blocks, gap))


def tetrahedra() -> None:
    """Five by five tetrahedra in a frame of others: the middle one is pushed out. Local optima 0.36278, 0.35193, 0.35183 are known."""
    line("5 x 5 tetrahedra", *timed(plate_of_tetrahedra(7, 0.01), Pull("t3-3", (0, 0, 1))), 0.35193)


def many() -> None:
    """The same, 32 by 32."""
    line("32 x 32 tetrahedra", *timed(plate_of_tetrahedra(34, 0.0005), Pull("t17-17", (0, 0, 1))))


def pin() -> None:
    """A pin of 96 sides in a hole of 96, turns locked: along a corner both polygons touch with their sides."""
    hole, inner = polygon(96, 5.2), polygon(96, 5.0)
    stuck = part("peg", Plate((Region(inner),), 8.0), (0, 0, -4), lock=frozenset({"z", "rx", "ry", "rz"}))
    assembly = assemble_spatial(Drawing((plate(hole, 12.0), stuck)))
    line("pin of 96 sides", *timed(assembly, Pull("peg", (1, 0, 0))), 0.2)


def starts() -> None:
    """Random assemblies of benchmarks/attack whose climb from rest ends: how many more climbs move further, by 1 % or without end."""
    ends, further, spent = 0, Counter[int](), Counter[int]()
    for number in range(30_000, 30_140):
        _, made = draw_solids(number)
        with tempfile.TemporaryDirectory() as folder:
            try:
                assembly = wr.read(made.write(Path(folder)))
            except wr.InputError:
                continue
        found = [(more, *clocked(assembly, more)) for more in (0, 2, 4, 8)]
        nearest = found[0][1].objective
        if nearest is None:
            continue
        ends += 1
        for more, answer, seconds in found:
            spent[more] += seconds
            further[more] += answer.objective is None or answer.objective > 1.01 * nearest
    print(f"{ends} random assemblies that end from rest in {spent[0]:.0f} s of processor time:")
    for more in (2, 4, 8):
        print(f"  with {more} more climbs {further[more]} go further, in {spent[more]:.0f} s")


def clocked(assembly: Assembly, more: int) -> tuple[Answer, float]:
    began = time.process_time()
    return wr.flex(assembly, search=more), time.process_time() - began


FIGURES: tuple[Callable[[], None], ...] = (pegs, chains, between_plates, box, burr, tetrahedra, pin, many, starts)


def main(names: list[str]) -> None:
    flex_spatial(plate_of_tetrahedra(3, 0.01), Pull("t1-1", (0, 0, 1)))  # kernels are compiled before anything is timed
    for figure in FIGURES:
        if not names or figure.__name__ in names:
            figure()


if __name__ == "__main__":
    main(sys.argv[1:])
