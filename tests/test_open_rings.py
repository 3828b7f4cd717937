"""Open rings in closed ones: held where the opening is narrower than the bars, and never said to be where a path out is known."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import wiggleroom as wr
from wiggleroom.assembly.assembly import placed_surface
from wiggleroom.cli.compile import OPEN_RING
from wiggleroom.spatial.overlaps.surface_distance import surface_distances
from wiggleroom.spatial.proof.linking_number import RingBody, held_by_opening
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.solids.spatial_file import read_spatial
from wiggleroom.verdict import Certainty, Separability


def assembled(parts, glue=()):
    return assemble_spatial(read_spatial(json.dumps({"format": "wiggleroom/2", "parts": parts, "glue": list(glue)})))


def outline(sides, thick, opening, phase):
    """A ring of radius 10 with an opening about an angle, or closed."""
    angles = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    half = np.arcsin(opening / 2 / (10 - thick / 2)) if opening else 0
    angles = phase + (np.linspace(half, 2 * np.pi - half, sides) if opening else angles)
    rings = [np.column_stack([np.cos(angles), np.sin(angles)]) * r for r in (10 + thick / 2, 10 - thick / 2)]
    if opening:
        return np.vstack([rings[0], rings[1][::-1]]).tolist(), []
    return rings[0].tolist(), [rings[1].tolist()]


def assembly(opening, phase=1.0, seed=0, shift=15.5):
    """A closed ring of bars 3 thick, and one with an opening that stands in it, both turned anywhere."""
    whole = Rotation.random(random_state=seed)
    parts = []
    for name, turn, at, wide in (("eye", 0, [0, 0, 0], 0), ("hook", 90, [shift, 0, 0], opening)):
        R = whole * Rotation.from_euler("x", turn, degrees=True)
        ring, holes = outline(13, 3.0, wide, phase)
        corner = whole.apply(at) - R.apply([0, 0, 1.5])
        rotate = R.as_euler("xyz", degrees=True).tolist()
        parts.append(
            {"name": name, "outline": ring, "holes": holes, "thickness": 3, "at": corner.tolist(), "rotate": rotate}
        )
    parts[0]["fixed"] = True
    return assembled(parts)


def held(found, rings=((1,), (0,))):
    bodies = []
    for parts in rings:
        placed = [(found.parts[k], found.solids[k]) for k in parts]
        pieces = [p.placed(part.R, part.at) for part, made in placed for p in made.pieces]
        bodies.append(RingBody(pieces, [placed_surface(part, made.surface) for part, made in placed]))
    return held_by_opening(*bodies)


@pytest.mark.parametrize(("seed", "opening", "phase"), [(1, 1.0, 0.7), (2, 2.0, -1.0), (3, 2.2, 1.9)])
def test_a_hook_with_a_narrow_opening_is_held(seed, opening, phase):
    found = wr.check(assembly(opening, phase, seed))
    assert (found.verdict, found.certainty) == (Separability.INTERLOCKED, Certainty.PROVEN)


@pytest.mark.parametrize(("opening", "phase"), [(3.1, 0.4), (3.6, 1.2), (4.5, 2.0)])
def test_nothing_is_said_of_a_wider_opening_than_the_bars(opening, phase):
    assert not held(assembly(opening, phase))


def test_nothing_is_said_of_a_ring_beside_the_other():
    assert held(assembly(1.0))
    assert not held(assembly(1.0), rings=((0,), (1,)))
    assert not held(assembly(1.0, shift=27.0))


def test_a_hook_of_boxes_is_held():
    found = wr.check(assembled(OPEN_RING))
    assert (found.verdict, found.certainty) == (Separability.INTERLOCKED, Certainty.PROVEN)


@pytest.mark.parametrize(("seam", "narrow"), [(0.1, True), (1.4, True), (2.1, False)])
def test_two_glued_halves_are_a_ring_where_their_seams_are_narrower_than_the_bars(seam, narrow):
    half = [(-12, -7.5, -2, -seam, -3.5, 2), (-12, 3.5, -2, -seam, 7.5, 2), (-12, -3.5, -2, -8, 3.5, 2)]
    other = [(-x1, y0, z0, -x0, y1, z1) for x0, y0, z0, x1, y1, z1 in half]
    bars = [
        (-12, -2, -7.5, 12, 2, -3.5),
        (-12, -2, 3.5, 12, 2, 7.5),
        (-12, -2, -3.5, -8, 2, 3.5),
        (8, -2, -3.5, 12, 2, 3.5),
    ]
    parts = [
        {"name": "h1", "boxes": half, "fixed": True},
        {"name": "h2", "boxes": other},
        {"name": "link", "boxes": bars, "at": [14, 0, 0]},
    ]
    chain = assembled(parts, [["h1", "h2"]])
    assert held(chain, rings=[[0, 1], [2]]) == narrow
    if narrow:
        found = wr.check(chain)
        assert (found.verdict, found.certainty) == (Separability.INTERLOCKED, Certainty.PROVEN)


def test_distances_from_a_surface_are_those_of_another_library():
    import trimesh

    draw = np.random.default_rng(4)
    triangles, points = draw.normal(size=(40, 3, 3)), 2 * draw.normal(size=(60, 3))
    away = np.empty_like(points)
    found = surface_distances(triangles, points, away)
    each = np.array([trimesh.triangles.closest_point(triangles, np.tile(p, (40, 1))) for p in points])
    far = np.linalg.norm(each - points[:, None], axis=2)
    nearest = each[np.arange(60), far.argmin(axis=1)]
    assert found == pytest.approx(far.min(axis=1), abs=1e-6)
    assert (found <= far.min(axis=1) + 1e-12).all()
    assert away == pytest.approx((points - nearest) / far.min(axis=1)[:, None], abs=1e-3)
