"""Parts that leave straight, alone or with what they push, from states that a search has reached."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely import affinity

import wiggleroom as wr
from tests.flexing import box, polygon_part
from wiggleroom.assembly.build import assemble
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.drawing.model import Drawing
from wiggleroom.freespace.translations import edges_of_all
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.geometry.translation_blocking import taken_along
from wiggleroom.search.global_search import translational_escape
from wiggleroom.search.incumbent import start_at_rest
from wiggleroom.search.prepare import prepare_as_drawn

TRAY = shapely.box(0, 0, 10, 10) - shapely.box(2, 2, 8, 11)


def swept(shape, direction, far):
    """What a polygon sweeps on a straight path, from the strips of its edges."""
    end = affinity.translate(shape, *(far * np.asarray(direction)))
    ring = np.asarray(shape.exterior.coords)
    ahead = ring + far * np.asarray(direction)
    strips = [
        shapely.MultiPoint([ring[k], ring[k + 1], ahead[k], ahead[k + 1]]).convex_hull for k in range(len(ring) - 1)
    ]
    return shapely.union_all([shape, end, *strips])


@pytest.mark.parametrize("seed", range(3))
def test_what_is_taken_along_is_what_swept_polygons_meet(seed: int) -> None:
    random = np.random.default_rng(seed)
    shapes: list[shapely.Polygon] = []
    while len(shapes) < 9:
        turn, radius = np.linspace(0, 2 * np.pi, 8)[:-1], random.uniform(0.3, 1.4, 7)
        star = shapely.Polygon(np.column_stack([radius * np.cos(turn), radius * np.sin(turn)]))
        shape = affinity.translate(star, *random.uniform(-5, 5, 2))
        if all(shape.distance(other) > 0.05 for other in shapes):
            shapes.append(shape)
    fixed = np.arange(9) >= 8
    edges, first = edges_of_all(np.array(shapes, dtype=object))
    never = np.zeros((9, 9), dtype=np.bool_)
    for angle in random.uniform(0, 2 * np.pi, 20):
        direction = np.array([np.cos(angle), np.sin(angle)])
        for body in range(8):
            truth, waiting = {body}, [body]
            while waiting:
                strip = swept(shapes[waiting.pop()], direction, 40.0)
                met = [k for k in range(9) if k not in truth and strip.intersection(shapes[k]).area > 1e-9]
                truth |= set(met)
                waiting += met
            who = np.zeros(9, dtype=np.bool_)
            who[body] = True
            leaves = taken_along(edges, first, direction, never, fixed, 1e-10, who)
            assert leaves == (8 not in truth)
            if leaves:
                assert set(np.flatnonzero(who).tolist()) == truth


def tray_with_lid(direction: tuple[float, float], roof: bool = False) -> wr.Assembly:
    """A box in a tray that is open at its top, and a lid above it."""
    tray = TRAY | shapely.box(0, 11, 10, 12) | shapely.box(0, 9, 1, 12) | shapely.box(9, 9, 10, 12) if roof else TRAY
    parts = [polygon_part("tray", tray, fixed=True), box("box", 2.1, 2.1, 7.9, 6.1), box("lid", 2.1, 7.5, 7.9, 9.5)]
    return assemble(Drawing(tuple(parts), goals=(wr.Pull("box", direction),), gap=0.0))


def test_a_box_leaves_with_the_lid_that_it_pushes() -> None:
    ready = prepare_as_drawn(tray_with_lid((0, 1)))
    far = translational_escape(ready, ready.objective(ready.assembly.drawing.goals), start_at_rest(ready))
    assert far is not None
    gone = np.flatnonzero(far.inner[:, 1] > 4 * ready.size)
    assert [ready.assembly.names[ready.bodies.members[body][0]] for body in gone] == ["box", "lid"]
    path = of_parts(ready.assembly, ready.bodies, np.array([np.zeros_like(far.inner), far.inner]))
    assert audit_path(ready.assembly, path).free


@pytest.mark.parametrize(("direction", "roof"), [((0, -1), False), ((1, 0), False), ((0, 1), True)])
def test_nothing_leaves_against_walls_or_against_the_pull(direction: tuple[float, float], roof: bool) -> None:
    ready = prepare_as_drawn(tray_with_lid(direction, roof))
    assert translational_escape(ready, ready.objective(ready.assembly.drawing.goals), start_at_rest(ready)) is None


def test_a_box_that_can_be_taken_out_goes_on_downwards_without_end() -> None:
    """Its lid has to go first: no climb does that of itself."""
    answer = wr.flex(tray_with_lid((0, -1)))
    assert answer.verdict == "unbounded"
    assert "box" in answer.leaves
    assert answer.path == "checked"
    assert audit_path(answer.assembly, answer.waypoints).free


def test_a_box_under_a_roof_stays() -> None:
    answer = wr.flex(tray_with_lid((0, -1), roof=True))
    assert answer.objective == pytest.approx(0.1, rel=1e-6)


def test_a_pin_drops_to_the_floor_where_its_key_has_left_the_lock() -> None:
    """The key lifts both pins as it leaves; the tip of the pin is then 0.45 above the floor, and nothing else holds it."""
    body = [
        (1.2, 1.0), (-1.3, 1.0), (-1.3, -0.3), (-0.65, -0.3), (-0.65, 0.9), (-0.35, 0.9), (-0.35, -0.3), (0.15, -0.3), (0.15, 0.7),
        (0.45, 0.7), (0.45, -0.3), (1.0, -0.3), (1.0, -0.8), (-1.3, -0.8), (-1.3, -1.2), (1.2, -1.2),
    ]  # fmt: skip
    key = [
        (0.7, -0.79), (0.7, -0.31), (0.5, -0.31), (0.3, -0.5), (0.1, -0.31), (-0.27, -0.31), (-0.5, -0.41), (-0.73, -0.31),
        (-1.6, -0.31), (-1.6, -0.79),
    ]  # fmt: skip
    long = [(-0.63, -0.29), (-0.5, -0.35), (-0.37, -0.29), (-0.37, 0.5), (-0.63, 0.5)]
    short = [(0.17, -0.29), (0.3, -0.4), (0.43, -0.29), (0.43, 0.2), (0.17, 0.2)]
    parts = (
        polygon_part("body", body, fixed=True), polygon_part("key", key), polygon_part("pin", long), polygon_part("other", short),
    )  # fmt: skip
    answer = wr.flex(assemble(Drawing(parts)), wr.Pull("pin", (0, -1), (-0.5, -0.35)))
    assert answer.objective == pytest.approx(0.45, rel=0.02)
    assert answer.objective >= 0.45 * (1 - 1e-6)
    assert answer.path == "checked"
    assert audit_path(answer.assembly, answer.waypoints).free
