"""Parts that touch at rest, or nearly: drawn so that it is known by construction whether they come apart."""

from __future__ import annotations

import json

import numpy as np
import pytest
import shapely
from shapely import Polygon, box
from shapely.affinity import affine_transform

import wiggleroom as wr
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import JointGap
from wiggleroom.form_closure.closure_bound import closure_bound

PLACES = [(0.7, 0.01, (3.0, -5.0)), (2.5, 250.0, (1e5, 3e6))]
"""Turn [rad], scale and shift [mm]: where coordinates are small and a little off, large and far from the origin."""
EXACT = 0.0, 1.0, (0.0, 0.0)


def drawn(shapes: dict[str, Polygon], place: tuple, gap: float = 0.0, gaps: tuple = ()) -> Assembly:
    turn, scale, (x, y) = place
    c, s = scale * np.cos(turn), scale * np.sin(turn)
    parts = []
    for name, shape in shapes.items():
        put = shapely.orient_polygons(affine_transform(shape, [c, -s, s, c, x, y]))
        rings = [np.array(r.coords)[:-1] for r in (put.exterior, *put.interiors)]
        parts.append(wr.Part(name, (wr.Region(rings[0], tuple(rings[1:])),), fixed=name == "g"))
    joints = tuple(JointGap((a, b), g * scale) for a, b, g in gaps)
    return wr.assemble(wr.Drawing(tuple(parts), gap=gap * scale, gaps=joints))


def head(over: float) -> Polygon:
    """A neck of width 1 and length 1 with a head that is wider by `over` on either side."""
    return box(1, 2, 2, 3) | box(1 - over, 3, 2 + over, 4)


def key(slant: float) -> Polygon:
    return Polygon([(1, 2), (2, 2), (2 + slant, 3), (1 - slant, 3)])


def thin_hook(over: float, play: float) -> dict[str, Polygon]:
    """A head that is wider than its neck by `over`, in a hole that is wider than both by `play` on every side."""
    hole = box(1 - play, 2, 2 + play, 3) | box(1 - over - play, 3 - play, 2 + over + play, 4 + play)
    return {"g": box(0, -5, 3, 2 - play) | head(over) | box(1, 2 - play, 2, 2.1), "p": box(0, 2, 3, 5) - hole}


BODY, PEG = box(0, 0, 3, 2), box(0.2, 0.2, 0.8, 1.2)
LEDGE = [(1, 1), (3, 1), (3, 3), (0, 3), (0, 2), (1, 2)]
COMES_APART: dict[str, tuple[dict[str, Polygon], dict]] = {
    "block in a slot": ({"g": box(-1, -1, 2, 1) - box(0, 0, 1, 1), "p": box(0, 0, 1, 1.5)}, {}),
    "block on a floor": ({"g": box(0, 0, 4, 1), "p": box(1, 1, 2, 2)}, {}),
    "step on a step": ({"g": Polygon([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (0, 2)]), "p": Polygon(LEDGE)}, {}),
    "key that widens downwards": ({"g": BODY | key(-0.2), "p": box(0, 2, 3, 4) - key(-0.2)}, {}),
    "block in a channel with one end": ({"g": box(-1, -1, 6, 2) - box(0, 0, 6, 1), "p": box(0, 0, 3, 1)}, {}),
    "head thinner than its gap, beside a block that touches": (
        {"g": BODY | head(0.1), "p": box(0, 2, 3, 5) - head(0.1), "q": box(0, -1, 3, 0)},
        {"gap": 0.3, "gaps": (("g", "q", 0.0),)},
    ),
    "head thinner than its gap, beside a peg that is locked tight": (
        {"g": (BODY | head(0.1)) - PEG, "p": box(0, 2, 3, 5) - head(0.1), "q": PEG},
        {"gap": 0.15, "gaps": (("g", "q", 0.0),)},
    ),
    "hook shorter than a play that counts as touching": (thin_hook(4e-6, 4.4e-6), {}),
    "hook that two plays together free": (thin_hook(8e-6, 8.1e-6), {}),
}
INTERLOCKED: dict[str, tuple[dict[str, Polygon], dict]] = {
    "block in a pocket": ({"g": box(0, 0, 4, 4) - box(1, 1, 2, 3), "p": box(1, 1, 2, 3)}, {}),
    "dovetail": ({"g": BODY | key(0.2), "p": box(0, 2, 3, 4) - key(0.2)}, {}),
    "dovetail with a small gap, beside a peg that is locked tight": (
        {"g": (BODY | key(0.3)) - PEG, "p": box(0, 2, 3, 4) - key(0.3), "q": PEG},
        {"gap": 0.02, "gaps": (("g", "q", 0.0),)},
    ),
    "hook longer than its play, but shorter than a little gap": (thin_hook(8e-5, 4e-6), {}),
    "chain with a tight and a loose joint": (
        {
            "g": BODY | key(0.3),
            "m": (box(0, 2, 3, 4) - key(0.3)) | shapely.transform(key(0.3), lambda p: p + np.array([0, 2])),
            "q": box(0, 4, 3, 6) - shapely.transform(key(0.3), lambda p: p + np.array([0, 2])),
        },
        {"gap": 0.02, "gaps": (("g", "m", 0.0),)},
    ),
}


@pytest.mark.parametrize("name", COMES_APART)
@pytest.mark.parametrize("place", PLACES, ids=["small", "far"])
def test_what_comes_apart_is_never_said_to_interlock(name, place) -> None:
    shapes, more = COMES_APART[name]
    found = wr.check(drawn(shapes, place, **more))
    assert found.verdict == "comes apart"


@pytest.mark.parametrize("name", INTERLOCKED)
@pytest.mark.parametrize("place", PLACES, ids=["small", "far"])
def test_what_interlocks_is_proven_to(name, place) -> None:
    shapes, more = INTERLOCKED[name]
    found = wr.check(drawn(shapes, place, **more))
    assert (found.verdict, found.certainty) == ("interlocked", "proven")


def test_a_lid_that_only_rounding_draws_holds_nothing() -> None:
    """The cut leaves a lid over the half disc that is 1e-16 thick."""
    angle = np.linspace(0, np.pi, 12)
    half = Polygon(np.column_stack([np.cos(angle), -np.sin(angle)]))
    found = wr.check(drawn({"g": box(-2, -2, 2, 0) - half, "p": half}, EXACT))
    assert found.verdict != "interlocked"


@pytest.mark.parametrize("play", [0.0, 1e-9, 1e-8, 1e-7])
def test_parts_locked_by_contacts_get_as_far_as_their_play(play) -> None:
    """A block in a pocket that is wider by its play on every side gets as far as that, and its corners further when it turns."""
    assembly = drawn({"g": box(0, 0, 4, 4) - box(1 - play, 1 - play, 2 + play, 3 + play), "p": box(1, 1, 2, 3)}, EXACT)
    found = closure_bound(assembly)
    assert found.all_locked
    assert np.sqrt(2) * play <= found.far[1] < 100 * play + 1e-6


@pytest.mark.parametrize("play", [1e-7, 1e-6, 3e-6])
@pytest.mark.parametrize("share", [0.3, 0.9, 1.0])
def test_a_hook_shorter_than_its_play_locks_nothing(play, share) -> None:
    found = closure_bound(drawn(thin_hook(share * play, play), EXACT))
    assert not found.all_locked


@pytest.mark.parametrize(("x", "size", "depth"), [(8.0, 10.0, 2), (2.0, 3.0, 3)])
def test_an_assembly_read_with_overlaps_is_refused_as_overlapping(x: float, size: float, depth: int, tmp_path) -> None:
    square = lambda x, y, s: [[x, y], [x + s, y], [x + s, y + s], [x, y + s]]  # noqa: E731
    parts = [{"name": "a", "fixed": True, "outline": square(0, 0, 10)}, {"name": "b", "outline": square(x, 2, size)}]
    (tmp_path / "two.json").write_text(json.dumps({"format": "wiggleroom/1", "unit": "mm", "gap": 0.0, "parts": parts}))
    assembly = wr.read(tmp_path / "two.json", overlapping=True)
    for ask in (
        lambda: wr.flex(assembly, wr.Pull("b", (1, 0)), search=0),
        lambda: wr.check(assembly),
        lambda: wr.prepare(assembly),
    ):
        with pytest.raises(wr.TouchingError, match=f'parts "a" and "b" overlap by {depth} mm at rest') as refused:
            ask()
        assert refused.value.clearance == pytest.approx(-depth)
        assert len(refused.value.findings) == 1
