"""The gap: every outline moved inward by half of it, and outward by its part's own offset."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import place
from wiggleroom.assembly.facing import Stretch, facing_stretches, joint_reach, split_ring
from wiggleroom.assembly.loops import (
    Loops,
    are_valid,
    chained,
    cleaned,
    placed_regions,
    polygons,
    region_of,
    region_rings,
    signed_areas,
)
from wiggleroom.assembly.mitre import offset_ring, resolved, sweeps_all
from wiggleroom.drawing.model import Drawing, Flattening, JointGap, Part, Points, Region
from wiggleroom.drawing.outlines.rings import extents


@dataclass(frozen=True, eq=False)
class OutlineShapes:
    """Different outlines to move: parts that share regions and displacement share one shape.

    Parameters
    ----------
    shape : (parts,) int
        Shape of each part.
    first : (shapes,) int
        A part of each shape.
    loops : Loops [mm]
        Outlines of all shapes in their own frames, cleaned.
    region : (loops,) int
        Region of each loop, counted through all shapes.
    owner : (regions,) int
        Shape of each region.
    outward : (loops,) float64 [mm]
        Offset of each loop.
    """

    shape: NDArray[np.int64]
    first: list[int]
    loops: Loops
    region: NDArray[np.int64]
    owner: NDArray[np.int64]
    outward: NDArray[np.float64]

    @property
    def loop_shape(self) -> NDArray[np.int64]:
        """Shape of each loop."""
        return self.owner[self.region]

    @property
    def members(self) -> NDArray[np.int64]:
        """First loop of each shape, and the number of loops (shapes + 1,)."""
        return np.searchsorted(self.loop_shape, np.arange(len(self.first) + 1))

    def on_loop(self, loop: int, stretches: Sequence[Stretch]) -> list[Stretch]:
        """Stretches of a shape's edges that lie on one of its loops, edges counted from the loop's first, the loop's offset applied."""
        before = int(self.loops.starts[loop] - self.loops.starts[self.members[self.loop_shape[loop]]])
        count = int(self.loops.counts[loop])
        out = float(self.outward[loop])
        return [
            replace(s, edge=s.edge - before, inward=s.inward - out) for s in stretches if 0 <= s.edge - before < count
        ]


def apply_gap(drawing: Drawing) -> tuple[tuple[Part, ...], tuple[str, ...]]:
    """Parts as made: gap, offsets and gaps of single joints applied with mitred corners.

    Parameters
    ----------
    drawing : Drawing [mm]
        Sound outlines and known names, see `wiggleroom.assembly.findings`.

    Returns
    -------
    tuple of Part
        Same order; offsets are 0, as they are in the outlines now. Parts that shared a region still do.
        A part that could not be made is left out.
    tuple of str
        One line for each part that vanishes, falls apart or loses a hole, and for each joint that is none.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> parts, _ = apply_gap(Drawing((Part("a", (Region(square),)),), gap=0.5))
    >>> parts[0].regions[0].outer.tolist()
    [[0.25, 0.25], [1.75, 0.25], [1.75, 1.75], [0.25, 1.75]]
    """
    if not drawing.parts:
        return (), ()
    shapes = outline_shapes(drawing)
    loops, amounts, findings = _joints(drawing, shapes, drawing.gap / 2 - shapes.outward)
    own = np.zeros(len(shapes.owner), dtype=bool)
    if drawing.gaps:
        own = np.isin([drawing.parts[i].name for i in shapes.first], [n for j in drawing.gaps for n in j.parts])[
            shapes.owner
        ]
    regions, trouble = _moved_regions(loops, amounts, shapes, own)
    by_shape: list[list[Region]] = [[] for _ in shapes.first]
    for region, shape in zip(regions, shapes.owner, strict=True):
        by_shape[shape] += [region] if region is not None else []
    made_regions = [tuple(r) for r in by_shape]
    findings += [_complaint(drawing, shapes, shape, wrong) for shape, wrong in trouble.items()]
    parts = [
        Part(part.name, made_regions[shape], part.at, part.fixed, 0.0, part.aliases)
        for part, shape in zip(drawing.parts, shapes.shape.tolist(), strict=True)
        if shape not in trouble
    ]
    return tuple(parts), tuple(findings)


def outline_shapes(drawing: Drawing) -> OutlineShapes:
    """Different shapes of a drawing, cleaned; a part with a joint gap of its own is a shape of its own."""
    alone = {name for joint in drawing.gaps for name in joint.parts}
    keys: dict[tuple[object, ...], int] = {}
    shape: list[int] = []
    first: list[int] = []
    for i, part in enumerate(drawing.parts):
        key = (part.name,) if part.name in alone else (*map(id, part.regions), part.offset, part.outline_offsets)
        if key not in keys:
            keys[key] = len(first)
            first.append(i)
        shape.append(keys[key])
    chosen = [drawing.parts[i] for i in first]
    rings, region = region_rings([r for p in chosen for r in p.regions])
    owner = np.repeat(np.arange(len(chosen)), [len(p.regions) for p in chosen])
    counts = [sum(1 + len(r.holes) for r in p.regions) for p in chosen]
    sizes, index = np.zeros(len(chosen)), np.array(region)
    np.maximum.at(sizes, owner, extents([r.outer for p in chosen for r in p.regions]).max(axis=1))
    loops = _oriented(cleaned(chained(rings), sizes[owner[index]]), index)
    outward = [p.offset + more for p, k in zip(chosen, counts, strict=True) for more in p.outline_offsets or (0.0,) * k]
    return OutlineShapes(np.array(shape), first, loops, index, owner, np.array(outward))


def _oriented(loops: Loops, region: NDArray[np.int64]) -> Loops:
    """Outer loops counter-clockwise, holes clockwise, however they were drawn."""
    outer = np.diff(region, prepend=-1) > 0
    wrong = (signed_areas(loops) > 0) != outer
    if not wrong.any():
        return loops
    return chained([ring[::-1] if w else ring for ring, w in zip(loops.rings(), wrong, strict=True)])


def _joints(drawing: Drawing, shapes: OutlineShapes, inward: NDArray[np.float64]) -> tuple[Loops, Points, list[str]]:
    """Outlines split where a joint's own gap begins and ends, and the displacement of every edge (n,) [mm]."""
    loops = shapes.loops
    if not drawing.gaps:
        return loops, np.repeat(inward, loops.counts), []
    stretches, findings = joint_stretches(drawing, shapes)
    rings, amounts = [], []
    for k, (ring, shape) in enumerate(zip(loops.rings(), shapes.loop_shape.tolist(), strict=True)):
        mine = shapes.on_loop(k, stretches.get(shape, []))
        points, moves = ring, np.full(len(ring), inward[k])
        if mine:
            points, moves = split_ring(ring, float(inward[k]), mine)
        rings.append(points)
        amounts.append(moves)
    return chained(rings), np.concatenate(amounts), findings


def joint_stretches(drawing: Drawing, shapes: OutlineShapes) -> tuple[dict[int, list[Stretch]], list[str]]:
    """Stretches of edges that a joint's own gap moves, by shape; edges count through all loops of the shape, and offsets do not."""
    index = {part.name: i for i, part in enumerate(drawing.parts)}
    stretches: dict[int, list[Stretch]] = defaultdict(list)
    findings = []
    rings = shapes.loops.rings()
    for number, joint in enumerate(drawing.gaps):
        pair = [drawing.parts[index[name]] for name in joint.parts]
        of = [int(shapes.shape[index[name]]) for name in joint.parts]
        a, b = (
            chained([place(ring, part.at) for ring in rings[shapes.members[s] : shapes.members[s + 1]]])
            for s, part in zip(of, pair, strict=True)
        )
        reach, slack = _reach(pair, drawing.flattening)
        both = facing_stretches(a, b, reach, slack), facing_stretches(b, a, reach, slack)
        if not all(both):
            findings.append(_apart(joint))
        for found, s in zip(both, of, strict=True):
            stretches[s] += [Stretch(e, low, high, joint.gap / 2, number) for e, low, high in found]
    return stretches, findings


def _reach(pair: list[Part], flattening: Flattening | None) -> tuple[float, float]:
    """How far apart edges of a joint may lie [mm], and how far behind each other, with room for flattened curves."""
    shapes, owner = placed_regions(pair)
    one, other = shapes[owner == 0], shapes[owner == 1]
    drawn = float(shapely.distance(one[:, None], other).min())
    deep = 0.0
    if drawn == 0:
        common = shapely.get_parts(shapely.intersection(one[:, None], other).ravel())
        common = common[shapely.area(common) > 0]
        deep = float((4 * shapely.area(common) / shapely.length(common)).max(initial=0.0))
    size = min(float(np.ptp(shapely.total_bounds(some).reshape(2, 2), axis=0).max()) for some in (one, other))
    error = 0.0 if flattening is None else flattening.error
    return joint_reach(drawn, deep, size, 2 * error)


def _moved_regions(
    loops: Loops, amounts: NDArray[np.float64], shapes: OutlineShapes, own: NDArray[np.bool_]
) -> tuple[list[Region | None], dict[int, str]]:
    """Every region as made, and what went wrong by shape; `own` (regions,) names those with a joint that has a gap of its own."""
    new, forward = offset_ring(loops, amounts)
    forward_regions = np.ones(len(shapes.owner), dtype=bool)
    np.logical_and.at(forward_regions, shapes.region, forward)
    made = polygons(new, shapes.region)
    fine = forward_regions & are_valid(made)
    rings = new.rings()
    members = np.searchsorted(shapes.region, np.arange(len(fine) + 1))
    regions: list[Region | None] = []
    trouble: dict[int, str] = {}
    for i, (low, high) in enumerate(pairwise(members)):
        if fine[i] and not own[i]:
            regions.append(Region(rings[low], tuple(rings[low + 1 : high])))
            continue
        chosen = (shapes.region[loops.owner] == i).nonzero()[0]
        drawn = Loops(loops.points[chosen], loops.counts[low:high])
        if fine[i] and sweeps_all(drawn, amounts[chosen], made[i]):
            regions.append(Region(rings[low], tuple(rings[low + 1 : high])))
            continue
        pieces = resolved(drawn, amounts[chosen])
        wrong = _what_went_wrong(pieces, high - low - 1)
        regions.append(None if wrong else region_of(pieces[0]))
        if wrong:
            trouble.setdefault(int(shapes.owner[i]), wrong)
    return regions, trouble


def _what_went_wrong(pieces: Sequence[shapely.Polygon], holes: int) -> str:
    """Why pieces are not one region with as many holes as before; empty where they are."""
    if not pieces:
        return "vanishes"
    if len(pieces) > 1:
        return f"falls into {len(pieces)} pieces"
    left = len(pieces[0].interiors)
    if left < holes:
        return "loses a hole" if holes - left == 1 else f"loses {holes - left} holes"
    return "closes round a new hole" if left > holes else ""


def _complaint(drawing: Drawing, shapes: OutlineShapes, shape: int, wrong: str) -> str:
    """One line about a shape that the gap destroys."""
    part = drawing.parts[shapes.first[shape]]
    others = int((shapes.shape == shape).sum()) - 1
    who = f'part "{part.name}"' + (f" (and {others} more of this shape)" if others else "")
    if drawing.gap / 2 < part.offset:
        return f"{who} {wrong} at offset {part.offset:g}: a smaller offset would leave it whole"
    own = f", offset {part.offset:g}" if part.offset else ""
    own += ", the gaps of its joints" if any(part.name in joint.parts for joint in drawing.gaps) else ""
    cause = "a smaller gap" if drawing.gap / 2 >= -part.offset else "an offset nearer to 0"
    return f"{who} {wrong} at gap {drawing.gap:g}{own}: {cause} would leave it whole"


def _apart(joint: JointGap) -> str:
    """One line about a joint whose parts do not face each other."""
    return f'gaps: parts "{joint.parts[0]}" and "{joint.parts[1]}" face each other nowhere: name two neighbours'
