"""Bodies, shapes they share, pairs that can meet, and classes of congruent pairs."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import shapely
from shapely import affinity

from wiggleroom.assembly import patterns
from wiggleroom.assembly.assembly import Assembly, place
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing, Part, Region
from wiggleroom.geometry.bodies import bodies
from wiggleroom.geometry.congruence_classes import congruence_classes
from wiggleroom.geometry.neighbours import neighbours
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import objective
from wiggleroom.search.prepare import prepare_as_drawn

NONE = np.zeros(0, dtype=np.int64)


def ring(*corners):
    return np.array(corners, dtype=float)


def box(x0, y0, x1, y1):
    return ring((x0, y0), (x1, y0), (x1, y1), (x0, y1))


PLATE = Region(box(-2, -1, 2, 1), (box(-1.5, -0.5, -0.5, 0.5)[::-1], box(0.5, -0.5, 1.5, 0.5)[::-1]))
WEDGE = Region(ring((0, 0), (1, 0.2), (0.3, 0.9)))


def moved(assembly: Assembly, angle: float = np.radians(37), away=(2500.0, -1800.0), seed: int = 0) -> Assembly:
    """The same parts, turned and moved as a whole, every outline stored in a turned and shifted frame of its own."""
    random = np.random.default_rng(seed)

    def one(part: Part) -> Part:
        turn, dx, dy = random.uniform((-3, -5, -5), (3, 5, 5))
        store = lambda points: place(points - (dx, dy), (0.0, 0.0, -turn))  # noqa: E731
        regions = tuple(Region(store(r.outer), tuple(map(store, r.holes))) for r in part.regions)
        origin = place(place(np.array([[dx, dy]]), part.at), (*away, angle))[0]
        return replace(part, regions=regions, at=(*origin, part.at[2] + turn + angle))

    parts = tuple(map(one, assembly.parts))
    return Assembly(parts, replace(assembly.drawing, parts=parts))


def material(assembly: Assembly) -> list[shapely.Geometry]:
    """Every part where it lies, by shapely's own transforms."""
    out = []
    for part in assembly.parts:
        piece = shapely.union_all([shapely.Polygon(r.outer, r.holes) for r in part.regions])
        turned = affinity.rotate(piece, part.at[2], origin=(0, 0), use_radians=True)
        out.append(affinity.translate(turned, *part.at[:2]))
    return out


def plain(*parts: Part, **roles) -> Assembly:
    return assemble(Drawing(parts, **roles))


def mixed() -> Assembly:
    """Holes, several regions, glue, turned parts, one shape in several frames."""
    return plain(
        Part("plate", (PLATE,), (0.0, 0.0, 0.4), fixed=True),
        Part("two", (Region(box(0, 0, 1, 1)), Region(box(2, 0, 3, 1))), (5.0, 3.0, -1.1)),
        Part("plate again", (PLATE,), (10.0, 0.0, 2.0)),
        Part("wedge", (WEDGE,), (0.0, 5.0, 0.0)),
        Part("wedge again", (WEDGE,), (2.0, 5.0, 3.0)),
        Part("loose", (WEDGE,), (-4.0, 5.0, 1.0)),
        glue=(("wedge", "wedge again"),),
    )


ASSEMBLIES = {
    "tees": lambda: patterns.grid(4, 3),
    "jigsaw": lambda: patterns.jigsaw(3, 3, seed=2),
    "revolute chain": lambda: patterns.chain(5, "revolute", 0.02),
    "mixed": mixed,
}
each = pytest.mark.parametrize("name", ASSEMBLIES)
anywhere = pytest.mark.parametrize("change", [lambda a: a, moved], ids=["as it is", "moved"])


@each
@anywhere
def test_placed_is_the_material_of_the_parts(name, change):
    assembly = change(ASSEMBLIES[name]())
    them = bodies(assembly)
    wanted = material(assembly)
    for members, found in zip(them.members, placed(them), strict=True):
        assert shapely.is_valid(found)
        assert shapely.symmetric_difference(found, shapely.union_all([wanted[p] for p in members])).area < 1e-9


def test_mirrored_scaled_and_pierced_copies_are_other_shapes():
    flipped = Region(WEDGE.outer[::-1] * (-1, 1))
    larger = Region(WEDGE.outer * (1 + 1e-8))
    pierced = Region(box(-2, -1, 2, 1), PLATE.holes[:1])
    regions = [WEDGE, flipped, larger, PLATE, pierced, Region(PLATE.outer)]
    parts = tuple(Part(f"p{k}", (r,), (10.0 * k, 0.0, 0.0), fixed=k == 0) for k, r in enumerate(regions))
    assert len(set(bodies(Assembly(parts, Drawing(parts))).shape)) == len(regions)


def test_glue_passes_on_and_one_fixed_part_fixes_all():
    parts = tuple(Part(f"p{k}", (WEDGE,), (3.0 * k, 0.0, 0.0), fixed=k == 4) for k in range(6))
    them = bodies(plain(*parts, glue=(("p5", "p2"), ("p4", "p2"), ("p0", "p1"))))
    assert them.members == ((0, 1), (2, 4, 5), (3,))
    assert them.fixed.tolist() == [False, True, False]


@each
@pytest.mark.parametrize("reach", [0.012, 3.0])
def test_neighbours_are_all_pairs_within_reach(name, reach):
    them = bodies(ASSEMBLIES[name]())
    solid = placed(them)
    found = neighbours(them, solid, reach, ignored=NONE)
    wanted = {(i, j): shapely.distance(solid[i], solid[j]) for i, j in combinations(range(len(solid)), 2)}
    wanted = {pair: d for pair, d in wanted.items() if d <= reach and not them.fixed[list(pair)].all()}
    assert dict(zip(zip(found.a, found.b, strict=True), found.clearance, strict=True)) == pytest.approx(wanted)
    assert list(zip(found.a, found.b, strict=True)) == sorted(wanted)


@anywhere
def test_the_cell_of_one_pair_serves_its_whole_class(change):
    ready = prepare_as_drawn(change(patterns.grid(5, 4)))
    them, cells = ready.bodies, ready.cells
    _, label = congruence_classes(them, cells.a, cells.b, relative_pose(them, cells.a, cells.b))
    assert len(cells.a) > 20
    goal = objective(ready.assembly, them, ready.assembly.goals)
    rows = build_program(them, cells, goal, length=1.0).values(np.zeros(3 * int((~them.fixed).sum())))
    for k in range(label.max() + 1):
        one, *others = [rows[cells.row[p] : cells.row[p + 1]] for p in np.flatnonzero(label == k)]
        assert one.min() > 0.001
        for other in others:
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-9)


def test_overlaps_of_some_bodies_are_those_that_polygons_of_all_have_with_one_of_them():
    assembly = patterns.grid(6, 5, joint="tee", gap=0.02)
    them, random = bodies(assembly), np.random.default_rng(3)
    found = 0
    for _ in range(6):
        motion = random.normal(0, (0.1, 0.1, 0.05), (len(them.fixed), 3))
        only = random.random(len(them.fixed)) < 0.2
        made = placed(them, motion)
        pairs = [
            (a, b)
            for a, b in combinations(range(len(made)), 2)
            if (only[a] or only[b])
            and not (them.fixed[a] and them.fixed[b])
            and shapely.area(shapely.intersection(made[a], made[b])) > 0
        ]
        seen = overlaps(them, motion, NONE, only)
        assert sorted(zip(seen.a.tolist(), seen.b.tolist(), strict=True)) == pairs
        found += len(pairs)
    assert found > 10
    assert not len(overlaps(them, motion, NONE, np.zeros(len(them.fixed), dtype=bool)).a)


def test_edges_have_material_on_their_left():
    for name in ASSEMBLIES:
        them = bodies(ASSEMBLIES[name]())
        shapes = them.shapes
        middle = (shapes.corner + shapes.corner[shapes.after]) / 2
        for s in range(len(shapes.radius)):
            who = int(np.flatnonzero(them.shape == s)[0])
            solid = placed(them)[who]
            for k in range(shapes.first[s], shapes.first[s + 1]):
                tip = place((middle[k] + 1e-5 * shapes.normal[k])[None], tuple(them.rest[who]))[0]
                root = place((middle[k] - 1e-5 * shapes.normal[k])[None], tuple(them.rest[who]))[0]
                assert not shapely.contains_xy(solid, *tip)
                assert shapely.contains_xy(solid, *root)


@each
@anywhere
def test_placed_moves_bodies_about_their_own_origin(name, change):
    them = bodies(change(ASSEMBLIES[name]()))
    motion = np.random.default_rng(1).uniform(-1, 1, (len(them.fixed), 3))
    for before, after, rest, (dx, dy, angle) in zip(placed(them), placed(them, motion), them.rest, motion, strict=True):
        turned = affinity.rotate(before, angle, origin=tuple(rest[:2]), use_radians=True)
        assert shapely.symmetric_difference(after, affinity.translate(turned, dx, dy)).area < 1e-9
