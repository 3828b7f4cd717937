"""Distances between bodies whose outlines have very many corners, against shapely's, which compares all edges."""

from __future__ import annotations

import time

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from wiggleroom.assembly.build import assemble
from wiggleroom.deadline import Deadline
from wiggleroom.errors import StoppedError
from wiggleroom.geometry.outline_distances import OutlineDistances, distance_of_edges, edge_runs
from wiggleroom.search.prepare import typical_clearance


def blob(rng: np.random.Generator, count: int, radius: float) -> np.ndarray:
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    away = radius * (1 + sum(rng.uniform(0, 0.08) * np.cos(k * angle + rng.uniform(0, 6)) for k in range(2, 6)))
    return np.column_stack([away * np.cos(angle), away * np.sin(angle)])


@pytest.mark.parametrize("seed", range(2))
def test_the_distance_is_that_of_all_pairs_of_edges(seed: int) -> None:
    """Discs in holes, beside each other and in two pieces, with few and many corners, straight and curved."""
    rng = np.random.default_rng(seed)
    inner = shapely.Polygon(blob(rng, int(rng.integers(3, 900)), 1.0))
    hole = shapely.buffer(inner, rng.uniform(1e-3, 0.3), quad_segs=int(rng.integers(1, 40)))
    plate = shapely.Polygon(blob(rng, int(rng.integers(3, 50)), 9.0), [shapely.get_coordinates(hole.exterior)])
    aside = shapely.affinity.translate(inner, *rng.uniform(2.5, 9, 2))
    bodies = [
        inner,
        plate,
        shapely.multipolygons([aside, shapely.affinity.translate(aside, 12, 0)]),
        shapely.box(0, 20, 3, 21),
    ]
    bodies += [shapely.boundary(inner), shapely.boundary(plate)]
    for one in bodies:
        for other in bodies:
            if not shapely.intersects(one, other):
                got = distance_of_edges(edge_runs(one), edge_runs(other))
                assert got == pytest.approx(shapely.distance(one, other), rel=1e-12, abs=1e-13)


def test_bodies_of_many_corners_that_meet_have_no_distance() -> None:
    angle = np.linspace(0, 2 * np.pi, 3000, endpoint=False)
    disc = shapely.Polygon(np.column_stack([np.cos(angle), np.sin(angle)]))
    beside = [shapely.affinity.translate(disc, x, 0) for x in (1.9, 9.0)]
    bodies = np.array([disc, shapely.affinity.scale(disc, 0.5, 0.5), *beside])
    assert OutlineDistances(bodies).between([0, 0, 0], [1, 2, 3]).tolist() == pytest.approx([0, 0, 7])


def nested(count: int) -> np.ndarray:
    """A disc of many corners in a hole, the clearance 0.2 all along."""
    angle = 2 * np.pi * np.arange(count) / count
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    return np.array(
        [shapely.Polygon([(-15, -15), (15, -15), (15, 15), (-15, 15)], [10.2 * ring]), shapely.Polygon(10 * ring)]
    )


def test_the_clearance_of_outlines_of_many_corners_is_found_and_can_be_stopped() -> None:
    began = time.process_time()
    assert typical_clearance(0.0, nested(20_000), 30.0) == pytest.approx(0.2, rel=1e-6)
    assert time.process_time() - began < 5  # all pairs of edges take longer by far
    bodies = nested(100_000)
    began = time.process_time()
    with pytest.raises(StoppedError):
        typical_clearance(0.0, bodies, 30.0, Deadline(0.1))
    assert time.process_time() - began < 2


def test_a_question_about_a_drawing_of_many_corners_keeps_its_time() -> None:
    plate, disc = nested(20_000)
    outer, hole, ring = (shapely.get_coordinates(r)[:-1] for r in (plate.exterior, *plate.interiors, disc))
    parts = wr.Part("plate", (wr.Region(outer, (hole,)),), fixed=True), wr.Part("disc", (wr.Region(ring),))
    assembly = assemble(wr.Drawing(parts, goals=(wr.Pull("disc", (1, 0)),)))
    began = time.process_time()
    assert wr.flex(assembly, stop=Deadline(0.2), search=0).verdict == "stopped"
    assert time.process_time() - began < 3


@pytest.mark.parametrize("seed", range(5))
def test_the_nearest_other_body_is_that_of_a_search_of_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    places = rng.uniform(0, 30, (40, 2))
    bodies = np.array([shapely.Polygon(blob(rng, int(rng.integers(4, 30)), 0.8) + p) for p in places])
    bodies[1] = shapely.Polygon(shapely.get_coordinates(bodies[0])[:-1][::-1])  # the same once more is no neighbour
    _, apart = shapely.STRtree(bodies).query_nearest(bodies, exclusive=True, all_matches=False, return_distance=True)
    assert OutlineDistances(bodies).to_nearest(np.arange(40)).tolist() == apart.tolist()
