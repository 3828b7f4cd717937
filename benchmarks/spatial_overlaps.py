"""Random assemblies in space: no overlap at any end nor on any checked way, judged by the collision library python-fcl.

`python -m benchmarks.spatial_overlaps 200 1` judges 200 assemblies from seed 1. The judge makes its own shapes from the numbers that
the assembly was drawn with; it shares neither pieces nor axes nor way-points' neighbours with the program.
"""

from __future__ import annotations

import itertools
import sys
import time
from collections import Counter

import fcl
import numpy as np
from scipy.spatial import ConvexHull, HalfspaceIntersection, Voronoi
from scipy.spatial.transform import Rotation

from wiggleroom.drawing.model import Region
from wiggleroom.errors import InputError
from wiggleroom.spatial.spatial_assembly import assemble_spatial
from wiggleroom.spatial.spatial_flex import flex_spatial
from wiggleroom.spatial.spatial_model import (
    Boxes,
    Plate,
    SpatialDrawing,
    SpatialPart,
    SpatialPull,
    SpatialTurn,
    Surface,
)

SHALLOW = 1e-6
"""Overlaps that are shallower count as touching for the library."""
BETWEEN = 4
"""Moments looked at between two way-points."""


def convex(points: np.ndarray) -> fcl.Convex:
    hull = ConvexHull(points)
    faces = []
    for simplex, equation in zip(hull.simplices, hull.equations, strict=True):
        a, b, c = points[simplex]
        ring = simplex if np.cross(b - a, c - a) @ equation[:3] > 0 else simplex[::-1]
        faces += [3, *map(int, ring)]
    return fcl.Convex(points.copy(), len(hull.simplices), np.array(faces))


def box(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    return np.array(list(itertools.product(*np.column_stack([low, high]))))


def part(name, solid, at, R=None, fixed=False):
    return SpatialPart(name, solid, np.array(at, float), np.eye(3) if R is None else R, fixed)


def voxel_judge(voxels: set, e: float) -> list[np.ndarray]:
    """Boxes whose union is a set of unit cubes shrunk by e: cores, and bridges over every block that is wholly there."""
    found = []
    for v in voxels:
        for span in itertools.product((0, 1), repeat=3):
            block = itertools.product(*[range(s + 1) for s in span])
            if all((v[0] + i, v[1] + j, v[2] + k) in voxels for i, j, k in block):
                found.append(box(np.array(v) + e, np.array(v) + 1 + np.array(span) - e))
    return found


def burr(rng):
    """Three crossed sticks whose common cubes go to one of them, each connected."""
    sticks = [
        set(itertools.product(*[range(a, b) for a, b in ranges]))
        for ranges in ([(-3, 3), (-1, 1), (-1, 1)], [(-1, 1), (-3, 3), (-1, 1)], [(-1, 1), (-1, 1), (-3, 3)])
    ]
    owners: dict = {}
    for k, stick in enumerate(sticks):
        for v in stick:
            owners.setdefault(v, []).append(k)
    parts = [set() for _ in sticks]
    for v, who in owners.items():
        parts[rng.choice(who)].add(v)
    gap = float(rng.choice([0.02, 0.1]))
    drawn = [
        part(f"p{k}", Boxes(np.array([[v, np.add(v, 1)] for v in sorted(voxels)], float)), [0, 0, 0], fixed=k == 0)
        for k, voxels in enumerate(parts)
    ]
    return SpatialDrawing(tuple(drawn), gap), [voxel_judge(v, gap / 2) for v in parts]


def pegs(rng):
    """A plate with a hole, turned anywhere, and a peg of convex outline with some clearance in it."""
    count = int(rng.integers(3, 8))
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    while np.diff(np.r_[angle, angle[0] + 2 * np.pi]).max() > 2.6:
        angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    ring = 6 * np.column_stack([np.cos(angle), np.sin(angle)])
    peg = ring * rng.uniform(0.9, 0.99)
    thick, length = rng.uniform(2, 15), rng.uniform(5, 40)
    R = Rotation.random(random_state=int(rng.integers(1 << 30))).as_matrix()
    outer = np.array([[-9.0, -9], [9, -9], [9, 9], [-9, 9]])
    drawn = (
        part("plate", Plate((Region(outer, (ring[::-1],)),), thick), R @ [0, 0, -thick / 2], R, True),
        part("peg", Plate((Region(peg),), length), R @ [0, 0, -length / 2], R),
    )
    walls = []
    for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):  # the plate by cones beyond every side of the hole
        flat = np.array([a, b, 4 * b, 4 * a])
        walls.append(_upright(flat, -thick / 2, thick / 2) @ R.T)
    clipped = []
    for wall in walls:  # clipped to the square
        hull = ConvexHull(wall @ R)
        sides = np.array([[1, 0, 0, -9], [-1, 0, 0, -9], [0, 1, 0, -9], [0, -1, 0, -9.0]])
        inner = (wall @ R).mean(axis=0) * 0.6
        rows = np.vstack([hull.equations, sides])
        if (rows[:, :3] @ inner + rows[:, 3] < -1e-9).all():
            clipped.append(HalfspaceIntersection(rows, inner).intersections @ R.T)
        else:
            clipped.append(wall)
    return SpatialDrawing(drawn), [clipped, [_upright(peg, -length / 2, length / 2) @ R.T]]


def _upright(flat, low, high):
    return np.vstack([np.column_stack([flat, np.full(len(flat), z)]) for z in (low, high)])


def cells(rng):
    """Cells of a box cut up by random points, each a little smaller; the outer ones stand."""
    count = int(rng.integers(10, 30))
    points = rng.uniform(-5, 5, (count, 3))
    mirrored = [points] + [
        np.where(np.arange(3) == k, 2 * side - points, points) for k in range(3) for side in (-5.0, 5.0)
    ]
    diagram = Voronoi(np.vstack(mirrored))
    e = rng.uniform(0.02, 0.1)
    drawn, judged = [], []
    inner = np.argsort(np.linalg.norm(points, axis=1))[: max(1, count // 4)]
    for k in range(count):
        corners = diagram.vertices[diagram.regions[diagram.point_region[k]]]
        rows = ConvexHull(corners).equations.copy()
        rows[:, 3] += e
        if (rows[:, :3] @ points[k] + rows[:, 3]).max() > -1e-3:
            continue
        corners = HalfspaceIntersection(rows, points[k]).intersections
        hull = ConvexHull(corners)
        faces = []
        for simplex, equation in zip(hull.simplices, hull.equations, strict=True):
            a, b, c = corners[simplex]
            faces.append(simplex if np.cross(b - a, c - a) @ equation[:3] > 0 else simplex[::-1])
        surface = Surface(corners, np.array(faces, dtype=np.int64))
        drawn.append(part(f"c{k}", surface, [0, 0, 0], fixed=k not in inner))
        judged.append([corners])
    return SpatialDrawing(tuple(drawn)), judged


class Judge:
    """Collisions of parts that lie where their corners say, moved about their reference points."""

    def __init__(self, shapes, reference, fixed):
        self.reference, self.fixed = reference, fixed
        self.shapes = [[convex(points - r) for points in pieces] for pieces, r in zip(shapes, reference, strict=True)]

    def depth(self, motion):
        place = [
            fcl.Transform(Rotation.from_rotvec(m[3:]).as_matrix(), r + m[:3])
            for m, r in zip(motion, self.reference, strict=True)
        ]
        deepest = 0.0
        for i, j in itertools.combinations(range(len(place)), 2):
            if self.fixed[i] and self.fixed[j]:
                continue
            for one in self.shapes[i]:
                for other in self.shapes[j]:
                    a, b = fcl.CollisionObject(one, place[i]), fcl.CollisionObject(other, place[j])
                    request = fcl.CollisionRequest(num_max_contacts=4, enable_contact=True)
                    result = fcl.CollisionResult()
                    if fcl.collide(a, b, request, result):
                        deepest = max(deepest, *(c.penetration_depth for c in result.contacts))
        return deepest


def between(start, end, share):
    turn = Rotation.from_rotvec(start[:, 3:])
    way = (turn.inv() * Rotation.from_rotvec(end[:, 3:])).as_rotvec()
    moved = (turn * Rotation.from_rotvec(share * way)).as_rotvec()
    return np.hstack([start[:, :3] + share * (end[:, :3] - start[:, :3]), moved])


def main(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    seen: Counter = Counter()
    began = time.process_time()
    for number in range(count):
        family = (burr, pegs, cells)[number % 3]
        drawing, shapes = family(rng)
        free = [p.name for p in drawing.parts if not p.fixed]
        name, direction = free[rng.integers(len(free))], tuple(rng.normal(size=3))
        goal = SpatialTurn(name, direction) if rng.random() < 0.3 else SpatialPull(name, direction)
        try:
            assembly = assemble_spatial(drawing)
            answer = flex_spatial(assembly, goal)
        except InputError as problem:
            seen[f"{family.__name__} refused: {str(problem)[:60]}"] += 1
            continue
        judge = Judge(shapes, assembly.reference, [p.fixed for p in drawing.parts])
        worst = judge.depth(answer.motion)
        if answer.path == "checked":
            for one, other in itertools.pairwise(answer.waypoints):
                for share in np.linspace(0, 1, BETWEEN, endpoint=False):
                    worst = max(worst, judge.depth(between(one, other, share)))
        seen[f"{family.__name__} {answer.verdict} {answer.path}"] += 1
        seen["iterations"] += answer.iterations
        if worst > SHALLOW:
            seen["OVERLAPS"] += 1
            print(f"assembly {number} ({family.__name__}) of seed {seed}: {goal} overlaps by {worst:g} mm")
        if answer.path != "checked":
            print(f"assembly {number} ({family.__name__}): way not checked, {answer.verdict}")
    for key, value in sorted(seen.items()):
        print(f"{value:6d} {key}")
    print(f"{time.process_time() - began:.0f} s of processor time")


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1)
