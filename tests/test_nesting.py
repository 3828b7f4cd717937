"""Parts only get smaller as the gap, the gap of any joint or a negative offset grows: random drawings, judged by shapely."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
import shapely.affinity

import wiggleroom as wr
from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.gaps import apply_gap
from wiggleroom.assembly.loops import placed_regions
from wiggleroom.drawing.model import Drawing, JointGap, Part, Region, Tolerance

KINDS = ("slanted", "slight turns", "curve", "tab", "chamfered")


def cut_line(rng: np.random.Generator, kind: str, wide: float, at: float) -> np.ndarray:
    """A line from x = 0 to `wide`, near y = `at`, along which two parts are cut apart."""
    many = {"slanted": 4, "slight turns": 7, "curve": 30}.get(kind, 0)
    x = np.sort(rng.uniform(0, wide, many))
    match kind:
        case "slanted":
            y = rng.uniform(-0.8, 0.8, many)
        case "slight turns":
            y = rng.uniform(-0.1, 0.1, many)
        case "curve":
            x = np.linspace(0, wide, many + 2)[1:-1]
            y = rng.uniform(0.1, 0.7) * np.sin(rng.uniform(2, 9) * x / wide + rng.uniform(0, 6))
        case _:
            half, head, cut = rng.uniform(0.3, 0.9), rng.uniform(0.3, 1.0), 0.1 * (kind == "chamfered")
            neck = half if kind == "chamfered" else rng.uniform(0.3, 0.9)
            out = np.array([-neck, -half, cut - half, half - cut, half, neck])
            x, y = wide / 2 + out, head * np.array([0, 1 - cut, 1, 1, 1 - cut, 0])
    ends = rng.uniform(-0.3, 0.3, 2) * (kind in KINDS[:2])
    return np.vstack([[0, at + ends[0]], np.column_stack([x, at + y]), [wide, at + ends[1]]])


def random_parts(rng: np.random.Generator, kind: str) -> list[Part] | None:
    """Two or three parts, drawn touching, with a clearance, into each other or turned a little, some in turned frames."""
    wide, high = rng.uniform(3, 6, 2)
    line = cut_line(rng, kind, wide, high / 2)
    across = cut_line(rng, KINDS[rng.integers(5)], high, wide / 2)[:, ::-1]
    low, up, right = (
        shapely.Polygon(np.vstack([edge, ends]))
        for edge, ends in (
            (line, [[wide, -1], [0, -1]]),
            (line, [[wide, high], [0, high]]),
            (across, [[3 * wide, high], [3 * wide, 0]]),
        )
    )
    if not (low.is_valid and up.is_valid and right.is_valid):
        return None
    pieces = [low, up.difference(right), up.intersection(right)] if rng.random() < 0.5 else [low, up]
    grown = rng.choice([0.0, -0.03, 0.02])
    pieces = [p.buffer(grown, join_style="mitre", mitre_limit=50) if grown else p for p in pieces]
    if rng.random() < 0.3:
        pieces[1] = shapely.affinity.rotate(pieces[1], rng.uniform(-12, 12), origin=tuple(line[0]))
    if any(p.geom_type != "Polygon" or not p.is_valid or p.interiors for p in pieces):
        return None
    parts = []
    for name, piece in zip("abc", pieces, strict=False):
        ring, at = np.array(shapely.orient_polygons(piece).exterior.coords)[:-1], (0.0, 0.0, 0.0)
        if rng.random() < 0.5:
            at = tuple(rng.uniform(-3, 3, 3).tolist())
            c, s = math.cos(at[2]), math.sin(at[2])
            ring = (ring - at[:2]) @ np.array([[c, -s], [s, c]])
        parts.append(Part(name, (Region(ring),), at))
    return parts


def made(parts: list[Part], gap: float, own: dict[tuple[str, str], float], inward: list[float]) -> list | None:
    """The parts as they are made, as shapely shapes; None where they are not all whole."""
    offset = [replace(part, offset=-some) for part, some in zip(parts, inward, strict=True)]
    new, wrong = apply_gap(Drawing(tuple(offset), gap=gap, gaps=tuple(JointGap(*joint) for joint in own.items())))
    if wrong:
        return None
    polygons, owner = placed_regions(new)
    return [shapely.union_all(polygons[owner == k]) for k in range(len(new))]


@pytest.mark.parametrize("kind", KINDS)
def test_parts_only_get_smaller(kind: str) -> None:
    judged = 0
    for seed in range(12):
        rng = np.random.default_rng([KINDS.index(kind), seed])
        parts = random_parts(rng, kind)
        if parts is None:
            continue
        pairs = [("a", "b"), ("a", "c"), ("b", "c")][: 3 if len(parts) == 3 else 1]
        most = rng.choice([0.05, 0.2, 0.6])
        gap, own = float(rng.uniform(0, most)), dict(zip(pairs, rng.uniform(0, most, 3).tolist(), strict=False))
        inward = (rng.uniform(-most / 2, most / 2, len(parts)) * (rng.random() < 0.5)).tolist()
        which = int(rng.integers(3 + len(pairs)))
        more = float(rng.uniform(0, most)) * np.array(
            [which in (0, 1), *(which in (0, k + 3) for k in range(3)), which in (0, 2)]
        )
        wider = dict(zip(pairs, (np.array(list(own.values())) + more[1 : 1 + len(pairs)]).tolist(), strict=True))
        before = made(parts, gap, own, inward)
        after = made(parts, gap + float(more[0]), wider, [x + float(more[-1]) / 2 for x in inward])
        if before is None or after is None:
            continue
        judged += 1
        for one, other in zip(before, after, strict=True):
            assert shapely.difference(other, one, grid_size=1e-12).area < 1e-10 * one.area, seed
    assert judged > 3


@pytest.mark.parametrize("turn", [5.0, 60.0, 90.0, 130.0])
def test_edges_that_move_differently_take_away_their_strips(turn: float) -> None:
    """The lower edge of a part moves in by 0.3, all others by 0.1."""
    angle = math.radians(turn)
    far = np.array([4 + 3 * math.cos(angle), 3 * math.sin(angle)])
    ring = np.array([[0, 0], [4, 0], far, [0, 3.5]])
    below = np.array([[0, -2], [4, -2], [4, 0], [0, 0]])
    parts = [Part("a", (Region(ring),)), Part("b", (Region(below.astype(float)),))]
    shape = made(parts, 0.2, {("a", "b"): 0.6}, [0.0, 0.0])
    assert shape is not None
    strips = [
        shapely.Polygon([p, q, q + d * n, p + d * n])
        for (p, q), d in zip(zip(ring, np.roll(ring, -1, axis=0), strict=True), [0.3, 0.1, 0.1, 0.1], strict=False)
        for n in [np.array([p[1] - q[1], q[0] - p[0]]) / np.hypot(*(q - p))]
    ]
    truth = shapely.Polygon(ring).difference(shapely.union_all(strips))
    assert shape[0].symmetric_difference(truth).area < 1e-9


def test_a_looser_outline_lies_inside_a_tighter_one_with_a_joint_beside_it() -> None:
    plate = Region(
        np.array([[0.0, 0], [9, 0], [9, 9], [0, 9]]), (np.array([[3.0, 3], [6, 3.2], [6, 6], [3, 6]])[::-1],)
    )
    peg = Region(np.array([[3.0, 3.02], [5.9, 3.2], [5.9, 5.9], [3.0, 5.9]]))
    shapes = []
    for out in (0.2, 0.05, 0.0, -0.1):
        parts = Part("plate", (plate,), outline_offsets=(0.0, out)), Part("peg", (peg,))
        new, wrong = apply_gap(Drawing(parts, gap=0.1, gaps=(JointGap(("plate", "peg"), 0.3),)))
        assert not wrong
        shapes.append(placed_regions(new)[0][0])
    for larger, smaller in pairwise(shapes):
        assert smaller.area < larger.area
        assert smaller.difference(larger).area < 1e-12


def test_the_worst_of_a_joint_on_slanted_edges_is_that_of_its_widest_gap() -> None:
    frame = Region(
        np.array([[-2.0, -1], [7, -1], [7, 5], [-2, 5]]), (np.array([[-1.0, 0], [6, 0], [6, 4], [-1, 4]])[::-1],)
    )
    block = Region(np.array([[0.0, 0], [5, 0.43744331762962], [5, 3.5], [0, 3.5]]))
    parts = Part("a", (frame,), fixed=True), Part("b", (block,))
    drawing = Drawing(parts, gap=0.4, gaps=(JointGap(("a", "b"), 0.2),), goals=(wr.Pull("b", (0, -1)),))
    found = wr.worst_case(assemble(drawing), [Tolerance(("a", "b"), plus=0.05, minus=0.1, nominal=0.2)])
    within = [
        wr.flex(assemble(replace(drawing, gaps=(JointGap(("a", "b"), gap),))), search=0).objective
        for gap in (0.1, 0.15, 0.25)
    ]
    assert found.loosest.objective is not None
    assert found.loosest.objective >= max(within) - 1e-9
