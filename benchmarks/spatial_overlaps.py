"""Random assemblies in space: no overlap at any end nor on any checked path, judged by the collision library python-fcl.

`python -m benchmarks.spatial_overlaps 200 1` judges 200 assemblies from seed 1, families in turn; every other one of those whose parts
are made of boxes is also asked whether it comes apart, and all states on the escape paths are judged. The judge makes its own shapes from
the numbers that the assembly was drawn with; it shares neither pieces nor axes nor waypoints' neighbours with the program.

Every third one has random roles besides: locked freedoms, which must stand still at every moment looked at, parts that are glued and
must lie to each other as at rest (between waypoints to 1e-4 of the size), and a pull at a point away from the reference point.
`python -m benchmarks.spatial_overlaps 1 7001 35` judges assembly 35 of seed 7001 alone.
"""

from __future__ import annotations

import itertools
import sys
import time
from collections import Counter
from dataclasses import replace

import fcl
import numpy as np
import shapely
import shapely.affinity
import trimesh
from scipy.spatial import ConvexHull, HalfspaceIntersection, Voronoi
from scipy.spatial.transform import Rotation

import wiggleroom as wr
from wiggleroom.drawing.model import AXES, UNTURNED, Boxes, Drawing, Part, Plate, Pull, Region, Surface, Turn
from wiggleroom.errors import InputError
from wiggleroom.spatial.escapes.spatial_disassembly import check_spatial
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.spatial_flex import flex_spatial

SHALLOW = 1e-6
"""Overlaps that are shallower count as touching for the library."""
BETWEEN = 4
"""Moments looked at between two waypoints."""


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
    return Part(name, at=at, fixed=fixed, solid=solid, R=UNTURNED if R is None else R)


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
    return Drawing(tuple(drawn), gap), [voxel_judge(v, gap / 2) for v in parts]


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
    return Drawing(drawn), [clipped, [_upright(peg, -length / 2, length / 2) @ R.T]]


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
    return Drawing(tuple(drawn)), judged


def prisms(polygon, low, high, gap, R, at):
    """Triangular prisms whose union is an extruded polygon with every face moved inward by half the gap."""
    inner = polygon.buffer(-gap / 2, join_style="mitre", mitre_limit=50)
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(inner))
    return [
        _upright(np.array(t.exterior.coords)[:3], low + gap / 2, high - gap / 2) @ R.T + at
        for t in triangles
        if t.area > 1e-12
    ]


def extruded(polygon, low, high):
    """Closed surface of an extruded polygon."""
    mesh = trimesh.creation.extrude_polygon(polygon, high - low, engine="manifold")
    return Surface(np.array(mesh.vertices) + np.array([0, 0, low]), np.array(mesh.faces, dtype=np.int64))


def joints(rng):
    """Two to four links of a chain, turned anywhere, their joints of any family, read as meshes or plates."""
    family = str(rng.choice(["tee", "swallowtail", "dovetail", "finger", "jigsaw"]))
    gap = float(rng.choice([0.01, 0.02, 0.04]))
    flat = wr.patterns.chain(int(rng.integers(2, 5)), joint=family, gap=gap)
    R = Rotation.random(random_state=int(rng.integers(1 << 30))).as_matrix()
    thick = float(rng.uniform(0.1, 0.8))
    as_mesh = family not in ("jigsaw",) and rng.random() < 0.6
    drawn, judged = [], []
    for k, p in enumerate(flat.drawing.parts):
        ring = p.regions[0].outer
        polygon = shapely.Polygon(ring)
        at = R @ [p.at[0], p.at[1], 0.0]
        solid = extruded(polygon, 0.0, thick) if as_mesh else Plate((Region(ring),), thick)
        drawn.append(part(f"l{k}", solid, at, R, fixed=k == 0))
        judged.append(prisms(polygon, 0.0, thick, gap, R, at))
    return Drawing(tuple(drawn), gap), judged


def crate(rng):
    """Boards with slots from above across boards with slots from below."""
    thick, height, pitch = float(rng.uniform(2, 5)), float(rng.uniform(15, 40)), float(rng.uniform(12, 30))
    gap, across, along = float(rng.uniform(0.05, 0.6)), int(rng.integers(1, 3)), int(rng.integers(1, 3))

    def board(slots, above):
        whole = shapely.box(0, 0, (slots + 1) * pitch, height)
        low, high = (height / 2, height) if above else (0, height / 2)
        cuts = [shapely.box((k + 1) * pitch - thick / 2, low, (k + 1) * pitch + thick / 2, high) for k in range(slots)]
        return whole.difference(shapely.union_all(cuts))

    upright = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    turned = Rotation.from_euler("z", 90, degrees=True).as_matrix() @ upright
    drawn, judged = [], []
    for count, slots, above, R, offset in (
        (across, along, True, upright, lambda k: [0, (k + 1) * pitch + thick / 2, 0]),
        (along, across, False, turned, lambda k: [(k + 1) * pitch - thick / 2, 0, 0]),
    ):
        for k in range(count):
            polygon, at = board(slots, above), np.array(offset(k), float)
            solid = Plate((Region(np.array(polygon.exterior.coords)[:-1]),), thick)
            drawn.append(part(f"b{len(drawn)}", solid, at, R, fixed=not drawn))
            judged.append(prisms(polygon, 0.0, thick, gap, R, at))
    return Drawing(tuple(drawn), gap), judged


def finger_box(rng):
    """Six panels with fingers as long as they are thick; what two or three panels share goes to one of them."""
    cells = rng.integers(4, 8, 3)
    thick, gap = float(rng.uniform(2, 5)), float(rng.uniform(0.05, 0.4))
    panels: list[set] = [set() for _ in range(6)]
    for v in itertools.product(*[range(n) for n in cells]):
        who = [2 * axis + side for axis in range(3) for side in (0, 1) if v[axis] == (0, cells[axis] - 1)[side]]
        if len(who) == 1:
            panels[who[0]].add(v)
        elif len(who) == 2:
            panels[who[sum(v) % 2]].add(v)
        elif who:
            panels[who[0]].add(v)
    frames = [
        np.roll(np.eye(3), axis, axis=1).T for axis in (1, 2, 0)
    ]  # columns: two axes of the panel, and its normal
    drawn, judged = [], []
    for k, voxels in enumerate(panels):
        axis, side = divmod(k, 2)
        R = frames[axis]
        flat = {tuple(int(x) for x in np.array(v) @ R[:, :2]) for v in voxels}
        polygon = shapely.union_all([shapely.box(x, y, x + 1, y + 1) for x, y in flat])
        polygon = max(shapely.get_parts(polygon), key=lambda g: g.area)
        polygon = shapely.affinity.scale(polygon, thick, thick, origin=(0, 0)).simplify(0)
        at = np.eye(3)[axis] * (side * (cells[axis] - 1) * thick)
        solid = Plate((Region(np.array(polygon.exterior.coords)[:-1]),), thick)
        drawn.append(part(f"s{k}", solid, at, R, fixed=k == 0))
        judged.append(prisms(polygon, 0.0, thick, gap, R, at))
    return Drawing(tuple(drawn), gap), judged


FAMILIES = (burr, pegs, cells, joints, crate, finger_box)
ALSO_APART = (burr, crate, finger_box, joints)


class Judge:
    """Collisions of parts that lie where their corners say, moved about their reference points."""

    def __init__(self, shapes, reference, fixed, glued=()):
        self.reference, self.fixed, self.glued = reference, fixed, glued
        self.corners = [[points - r for points in pieces] for pieces, r in zip(shapes, reference, strict=True)]
        self.shapes = [[convex(points - r) for points in pieces] for pieces, r in zip(shapes, reference, strict=True)]

    def depth(self, motion):
        place = [
            (Rotation.from_rotvec(m[3:]).as_matrix(), r + m[:3]) for m, r in zip(motion, self.reference, strict=True)
        ]
        low, high = [], []
        for corners, (R, t) in zip(self.corners, place, strict=True):
            moved = [c @ R.T + t for c in corners]
            low.append(np.array([c.min(axis=0) for c in moved]))
            high.append(np.array([c.max(axis=0) for c in moved]))
        deepest = 0.0
        for i, j in itertools.combinations(range(len(place)), 2):
            if (self.fixed[i] and self.fixed[j]) or (i, j) in self.glued:
                continue
            meets = ((low[i][:, None] <= high[j][None]) & (high[i][:, None] >= low[j][None])).all(axis=2)
            for p, q in np.argwhere(meets).tolist():
                a = fcl.CollisionObject(self.shapes[i][p], fcl.Transform(*place[i]))
                b = fcl.CollisionObject(self.shapes[j][q], fcl.Transform(*place[j]))
                request = fcl.CollisionRequest(num_max_contacts=4, enable_contact=True)
                result = fcl.CollisionResult()
                if fcl.collide(a, b, request, result):
                    deepest = max(deepest, *(c.penetration_depth for c in result.contacts))
        return deepest


def between(start, end, share):
    turn = Rotation.from_rotvec(start[:, 3:])
    change = (turn.inv() * Rotation.from_rotvec(end[:, 3:])).as_rotvec()
    moved = (turn * Rotation.from_rotvec(share * change)).as_rotvec()
    return np.hstack([start[:, :3] + share * (end[:, :3] - start[:, :3]), moved])


def with_roles(rng, drawing):
    """The drawing with locked freedoms of a free part, and sometimes with two other parts glued."""
    free = [k for k, p in enumerate(drawing.parts) if not p.fixed]
    order = rng.permutation(free).tolist()
    parts = list(drawing.parts)
    locked = frozenset(rng.choice(AXES, int(rng.integers(1, 5)), replace=False).tolist())
    parts[order[0]] = replace(parts[order[0]], lock=locked)
    glue = ()
    if len(order) > 2 and rng.random() < 0.5:
        glue = ((parts[order[1]].name, parts[order[2]].name),)
    return replace(drawing, parts=tuple(parts), glue=glue)


def broken_role(drawing, reference, waypoints):
    """Largest motion of what is locked [mm or rad], and of glued parts against each other [mm], at waypoints and between them."""
    worst = np.zeros(2)
    names = [p.name for p in drawing.parts]
    for one, other in [*itertools.pairwise(waypoints), (waypoints[-1], waypoints[-1])]:
        for share in np.linspace(0, 1, BETWEEN, endpoint=False):
            motion = between(one, other, share)
            broken = [abs(m[AXES.index(axis)]) for p, m in zip(drawing.parts, motion, strict=True) for axis in p.lock]
            for group in drawing.glue:
                a, b = (names.index(n) for n in group)
                R = Rotation.from_rotvec(motion[a, 3:])
                arm = reference[b] - reference[a]
                broken.append(np.abs(motion[b, :3] - motion[a, :3] - R.apply(arm) + arm).max())
                broken.append((R.inv() * Rotation.from_rotvec(motion[b, 3:])).magnitude())
            worst[int(share > 0)] = max(worst[int(share > 0)], *broken)
    return worst


def worst_on(judge, waypoints):
    """Deepest overlap along a path, its end included."""
    worst = judge.depth(waypoints[-1])
    for one, other in itertools.pairwise(waypoints):
        for share in np.linspace(0, 1, BETWEEN, endpoint=False):
            worst = max(worst, judge.depth(between(one, other, share)))
    return worst


def main(count: int, seed: int, first: int) -> None:
    seen: Counter = Counter()
    began = time.process_time()
    for number in range(first, first + count):
        rng = np.random.default_rng((seed, number))
        family = FAMILIES[number % len(FAMILIES)]
        drawing, shapes = family(rng)
        free = [p.name for p in drawing.parts if not p.fixed]
        name, direction = free[rng.integers(len(free))], tuple(rng.normal(size=3))
        if number // len(FAMILIES) % 3 == 2:
            drawing = with_roles(rng, drawing)
        goal = Turn(name, direction) if rng.random() < 0.3 else Pull(name, direction)
        where = f"assembly {number} ({family.__name__}) of seed {seed}"
        try:
            assembly = assemble_spatial(drawing)
            if number // len(FAMILIES) % 3 == 2 and isinstance(goal, Pull):
                at = assembly.reference[[p.name for p in drawing.parts].index(name)]
                goal = replace(goal, point=tuple((at + rng.normal(size=3) * 0.2 * assembly.size).tolist()))
            answer = flex_spatial(assembly, goal)
        except InputError as problem:
            seen[f"{family.__name__} refused: {str(problem)[:60]}"] += 1
            continue
        names = [p.name for p in drawing.parts]
        glued = [tuple(sorted(names.index(n) for n in group)) for group in drawing.glue]
        judge = Judge(shapes, assembly.reference, [p.fixed for p in drawing.parts], glued)
        waypoints = answer.waypoints if answer.path == "checked" else answer.waypoints[-1:]
        worst = worst_on(judge, waypoints)
        if drawing.glue or any(p.lock for p in drawing.parts):
            broken = broken_role(drawing, assembly.reference, waypoints)
            reach = max(assembly.size, np.abs(waypoints[..., :3]).max())
            if broken[0] > 1e-9 * reach or broken[1] > (1e-4 if drawing.glue else 1e-9) * reach:
                seen["BROKEN ROLES"] += 1
                print(f"{where}: {goal} moves what is locked or glued by {broken}", flush=True)
        seen[f"{family.__name__} {answer.verdict} {answer.path}"] += 1
        seen["iterations"] += answer.iterations
        if worst > SHALLOW:
            seen["OVERLAPS"] += 1
            print(f"{where}: {goal} overlaps by {worst:g} mm", flush=True)
        if answer.path != "checked" or answer.verdict == "stopped":
            print(f"{where}: {goal} {answer.verdict}, path {answer.path}", flush=True)
        if family in ALSO_APART and number // len(FAMILIES) % 2:
            found = check_spatial(assembly)
            seen[f"{family.__name__} check: {found.verdict}"] += 1
            gone: list[int] = []
            for escape in found.escapes:
                stays = [k for k in range(len(assembly.parts)) if k not in gone]
                rest = Judge(
                    [shapes[k] for k in stays], assembly.reference[stays], [drawing.parts[k].fixed for k in stays]
                )
                deep = worst_on(rest, escape.path[:, stays])
                gone += [assembly.names.index(n) for n in escape.parts]
                if deep > SHALLOW:
                    seen["OVERLAPS ON A WAY OUT"] += 1
                    print(f"{where}: way out of {escape.parts} overlaps by {deep:g} mm")
        if (number - first) % 50 == 49:
            print(f"{number - first + 1} judged, {time.process_time() - began:.0f} s", flush=True)
    for key, value in sorted(seen.items()):
        print(f"{value:6d} {key}")
    print(f"{time.process_time() - began:.0f} s of processor time")


if __name__ == "__main__":
    main(int(sys.argv[1]), *(int(sys.argv[k]) if len(sys.argv) > k else default for k, default in ((2, 1), (3, 0))))
