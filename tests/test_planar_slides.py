"""Ways out by translations: keyholes, slides and mazes, whose paths the collision library judges; distances of pieces."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely
from benchmarks.spatial_overlaps import Judge, prisms, worst_on
from numpy.typing import NDArray
from scipy.optimize import linprog, nnls
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation
from shapely import affinity, box

import wiggleroom as wr
from tests.test_spatial import spatial
from tests.test_spatial_turning import disc, plate
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.spatial.escapes.planar_slides import TranslationSpace
from wiggleroom.spatial.overlaps.difference_section import minkowski_difference, slab_shadow
from wiggleroom.spatial.search.spatial_prepare import prepare_spatial
from wiggleroom.spatial.solids.separating_axis import distance

Slabs = dict[str, tuple[shapely.Polygon, float, float]]


def keyhole(pins: int, wide: float, travel: float = 9.0) -> Slabs:
    """A plate 0.1 before a wall, hung on pins with heads of radius 3 in slots that end in holes of radius `wide`."""
    outer = box(-20, -20, 30 * pins - 10, 20)
    hung, slabs = outer, {"wall": (outer, -4.0, 0.0)}
    for k in range(pins):
        x = 30 * k
        hole = affinity.translate(disc(12, wide / np.cos(np.pi / 12)), x, -travel)
        hung = hung.difference(hole.union(box(x - 1.8, -travel, x + 1.8, 1.8)))
        slabs[f"stem{k}"] = (affinity.translate(disc(12, 1.5), x, 0), 0.0, 3.1)
        slabs[f"head{k}"] = (affinity.translate(disc(12, 3.0), x, 0), 3.1, 5.0)
    return {"hung": (hung, 0.1, 3.0), **slabs}


def drawn(slabs: Slabs, moves: str) -> Assembly:
    """Plates, of which one moves; the others are glued."""
    parts = [plate(name, *slab, **({} if name == moves else {"fixed": True})) for name, slab in slabs.items()]
    return spatial(*parts, gap=0, glue=[[name for name in slabs if name != moves]])


def depth(slabs: Slabs, assembly: Assembly, path: np.ndarray, moves: str) -> float:
    """Deepest overlap on a path [mm], by the collision library."""
    shapes = [prisms(shape, low, high, 0.0, np.eye(3), 0.0) for shape, low, high in slabs.values()]
    still = [k for k, name in enumerate(slabs) if name != moves]
    glued = [(i, j) for i in still for j in still if i < j]
    return worst_on(Judge(shapes, assembly.reference, [name != moves for name in slabs], glued), path)


@pytest.mark.parametrize("pins", [1, 3])
def test_a_plate_leaves_its_pins_where_their_heads_fit_through(pins: int) -> None:
    slabs = keyhole(pins, wide=3.3)
    assembly = drawn(slabs, "hung")
    found = wr.check(assembly)
    assert (found.verdict, found.certainty) == ("comes apart", "proven")
    (escape,) = found.escapes
    assert escape.parts == ("hung",)
    assert depth(slabs, assembly, escape.path, "hung") < 1e-6


def test_no_translation_leads_out_of_a_keyhole_too_small_for_the_head() -> None:
    ready = prepare_spatial(drawn(keyhole(1, wide=2.8), "hung"))
    rest, body = np.zeros((4, 6)), int(np.flatnonzero(ready.grouping.bodies.moves)[0])
    assert TranslationSpace(ready, rest, body).way_out() is None


def maze(slit: float) -> Slabs:
    """A knob below two plates, whose mouths lie apart, with a slit between them for its neck."""
    outer = box(0, 0, 40, 20)
    first = outer.difference(box(2, 7, 8, 13).union(box(5, 10 - slit, 34, 10 + slit)))
    second = outer.difference(box(31, 7, 37, 13).union(box(2, 9, 34, 11)))
    chamber = outer.difference(box(1, 6, 39, 14))
    return {
        "knob": (box(20, 7.5, 25, 12.5).union(box(22, 9.5, 23, 10.5)), 0.5, 2.0),
        "floor": (outer, -2.0, 0.0),
        "low": (chamber, 0.0, 3.0),
        "first": (first, 3.0, 4.0),
        "high": (chamber, 4.0, 7.0),
        "second": (second, 7.0, 8.0),
    }


def test_a_knob_leaves_a_maze_of_two_floors_by_both_mouths() -> None:
    slabs = maze(slit=1.0)
    assembly = drawn(slabs, "knob")
    ready = prepare_spatial(assembly)
    body = int(np.flatnonzero(ready.grouping.bodies.moves)[0])
    found = TranslationSpace(ready, np.zeros((6, 6)), body).way_out()
    assert found is not None
    path, axis = found
    assert depth(slabs, assembly, path, "knob") < 1e-6
    assert abs(axis[2]) == pytest.approx(1.0)
    assert path[-1, 0, 2] > 7.4
    answer = wr.check(assembly)
    assert answer.verdict == "comes apart"
    assert depth(slabs, assembly, answer.escapes[0].path, "knob") < 1e-6


def test_shadows_of_differences_are_where_pieces_overlap() -> None:
    rng = np.random.default_rng(4)
    asked = 0
    for _ in range(25):
        P, Q = rng.normal(size=(9, 3)), rng.normal(size=(7, 3)) @ Rotation.random(random_state=rng).as_matrix()
        difference = minkowski_difference(P, Q)
        low, high = difference.corners[:, 2].min(), difference.corners[:, 2].max()
        for one, two in pairwise(np.linspace(low, high, 5)):
            shadow = slab_shadow([difference], one, two)
            for _ in range(4):
                t = np.append(rng.uniform(-4, 4, 2), rng.uniform(one, two))
                if together(P, Q + t):
                    assert shadow.buffer(1e-9).contains(shapely.Point(t[:2]))
            t = np.append(rng.uniform(-3, 3, 2), one)
            thin = slab_shadow([difference], one, one + 1e-6)
            if abs(thin.boundary.distance(shapely.Point(t[:2]))) > 1e-3:
                asked += 1
                assert thin.contains(shapely.Point(t[:2])) == together(P, Q + t)
    assert asked > 60


def together(P: np.ndarray, Q: np.ndarray) -> bool:
    """Whether the hulls of some corners meet, by linear programming."""
    same = np.vstack(
        [np.hstack([P.T, -Q.T]), np.r_[np.ones(len(P)), np.zeros(len(Q))], np.r_[np.zeros(len(P)), np.ones(len(Q))]]
    )
    return linprog(np.zeros(same.shape[1]), A_eq=same, b_eq=[0, 0, 0, 1, 1], bounds=(0, None)).status == 0


# -- distances of convex pieces --------------------------------------------------------------------------------------


Floats = NDArray[np.float64]
Piece = tuple[Floats, Floats, Floats]


def piece(points: Floats) -> Piece:
    """Corners, normals of faces and directions of edges of a hull."""
    hull = ConvexHull(points)
    ends = points[hull.simplices[:, [0, 1, 0, 2, 1, 2]]].reshape(-1, 2, 3)
    edges = ends[:, 0] - ends[:, 1]
    edges /= np.linalg.norm(edges, axis=1)[:, None]
    return points[hull.vertices].copy(), hull.equations[:, :3].copy(), edges


def nearest(P: Floats, Q: Floats) -> float:
    """Least distance between points of two hulls: weights of corners that are not negative and add up to one."""
    heavy = 1e6  # of the two sums: what is missing there is of second order
    rows = np.block(
        [[P.T, -Q.T], [heavy * np.ones(len(P)), np.zeros(len(Q))], [np.zeros(len(P)), heavy * np.ones(len(Q))]]
    )
    return float(nnls(rows, np.array([0, 0, 0, heavy, heavy]), maxiter=10_000)[1])


def prism(rng: np.random.Generator) -> Floats:
    """A regular prism of up to 40 sides, lying anyhow."""
    turn = 2 * np.pi * np.arange(k := int(rng.integers(3, 41))) / k
    ring = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(k)])
    return np.vstack([ring, ring + np.array([0, 0, rng.uniform(0.2, 3)])])


@pytest.mark.parametrize(
    "shape", [prism, lambda rng: rng.normal(size=(int(rng.integers(4, 12)), 3))], ids=["prism", "hull"]
)
def test_the_distance_of_pieces_is_that_of_their_nearest_points(shape):
    rng, seen = np.random.default_rng(7), 0
    for _ in range(80):
        P = piece(shape(rng))
        Q = piece(
            shape(rng) @ Rotation.random(random_state=rng).as_matrix().T + rng.normal(size=3) * rng.choice([2.0, 5.0])
        )
        axis = np.zeros(3)
        found, truth = distance(*P, *Q, axis, 1.0), nearest(P[0], Q[0])
        if found <= 0:
            assert truth < 1e-3
            continue
        seen += 1
        assert found == pytest.approx(truth, rel=1e-6)
        assert (Q[0] @ axis).min() - (P[0] @ axis).max() == pytest.approx(found, rel=1e-9)
    assert seen > 30
