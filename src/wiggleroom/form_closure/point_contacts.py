"""Where parts drawn tight touch each other: point contacts with a normal, for questions without a gap."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, place
from wiggleroom.assembly.gaps import apply_gap
from wiggleroom.assembly.loops import Loops, chained, region_rings
from wiggleroom.assembly.overlaps import CONTACT_TOLERANCE
from wiggleroom.drawing.model import Part
from wiggleroom.drawing.writers.glue_groups import glue_groups
from wiggleroom.errors import InputError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ANGLE_TOLERANCE = 1e-6
"""Directions that differ by less are the same [rad]."""


@dataclass(frozen=True, eq=False)
class PointContacts:
    """Point contacts between bodies: no point of `b` at `point` may move against `normal` as seen from `a`.

    A stretch along which two edges lie on each other is two contacts, at its ends; a corner in a corner is one contact for
    each edge. Two outward corners that only just meet are no contact: they may pass on either side.

    Parameters
    ----------
    names : tuple of str
        The parts.
    body_of : (parts,) int64
        Body of each part: glued parts are one body, all fixed parts are another.
    ground : int
        The body that stands: the fixed parts, or the largest one where none is fixed.
    a, b : (k,) int64
        The touching bodies.
    point : (k, 2) float64 [mm]
        Assembly coordinates at rest.
    edge : (k, 2, 2) float64 [mm]
        Start and end of the edge that gives the contact its normal, a's material on its left; b's own edge the other way round.
    reference : (parts, 2) float64 [mm]
        Reference points of the parts.
    size : float [mm]
        Longer side of the box round everything.
    reach : (parts,) float64 [mm]
        Largest distance of a corner from the part's reference point.
    """

    names: tuple[str, ...]
    body_of: Ints
    ground: int
    a: Ints
    b: Ints
    point: Floats
    edge: Floats
    reference: Floats
    size: float
    reach: Floats

    @cached_property
    def count(self) -> int:
        """Number of bodies."""
        return int(self.body_of.max()) + 1

    @cached_property
    def normal(self) -> Floats:
        """Unit normals (k, 2), from a into b."""
        x, y = (self.edge[:, 1] - self.edge[:, 0]).T
        return np.column_stack([y, -x]) / np.hypot(x, y)[:, None]

    @cached_property
    def members(self) -> tuple[tuple[str, ...], ...]:
        """Names of the parts of every body."""
        found: list[list[str]] = [[] for _ in range(self.count)]
        for name, body in zip(self.names, self.body_of.tolist(), strict=True):
            found[body].append(name)
        return tuple(map(tuple, found))


def point_contacts(assembly: Assembly, within: float | None = None) -> PointContacts:
    """Contacts of the parts as drawn tight.

    An assembly with a gap is taken as it was drawn, before gap and offsets; one without as it is.

    Parameters
    ----------
    assembly : Assembly
    within : float, optional [mm]
        Outlines closer than this touch; by default a millionth of the drawing's size. With a larger value the parts of a
        drawing that holds its clearance count as touching, where edges face each other.

    Raises
    ------
    InputError
        If `within` is no length.

    Examples
    --------
    >>> from wiggleroom.assembly.patterns import chain
    >>> found = point_contacts(chain(2, "swallowtail"))
    >>> len(found.a), found.normal[1].round(3).tolist()
    (10, [-0.371, 0.928])
    """
    if within is not None and not (np.isfinite(within) and within > 0):
        message = f"within is {within:g}: it must be more than 0"
        raise InputError(message)
    parts = _as_drawn(assembly)
    body_of, ground = rigid_bodies(assembly, parts)
    loops, owner = placed_outlines(parts)
    size = float(np.ptp(loops.points, axis=0).max())
    tolerance = CONTACT_TOLERANCE * size if within is None else within
    body = body_of[owner]
    found = OutlineEdges(loops, body, ignored_parts(assembly), owner)
    rows = [_flush(found, tolerance), _corners(found, tolerance)]
    a, b, point, edge = (np.concatenate([r[i] for r in rows]) for i in range(4))
    keep = _once(a, b, point / tolerance / 10, edge)
    reference = np.array([p.at[:2] for p in parts]).reshape(-1, 2)
    reach = np.zeros(len(parts))
    np.maximum.at(reach, owner, np.hypot(*(loops.points - reference[owner]).T))
    return PointContacts(
        assembly.names, body_of, ground, a[keep], b[keep], point[keep], edge[keep], reference, size, reach
    )


@dataclass(frozen=True, eq=False)
class OutlineEdges:
    """All outlines in assembly coordinates; edge and corner k share a number."""

    loops: Loops
    body: Ints
    ignored: NDArray[np.int64]
    part: Ints

    @property
    def start(self) -> Floats:
        """Where each edge begins (e, 2) [mm]."""
        return self.loops.points

    @property
    def end(self) -> Floats:
        """Where each edge ends (e, 2) [mm]."""
        return self.loops.points[self.loops.after]

    @property
    def along(self) -> Floats:
        """Unit directions of the edges (e, 2)."""
        direction = self.end - self.start
        return direction / np.hypot(*direction.T)[:, None]

    @property
    def outward(self) -> NDArray[np.bool_]:
        """Corners whose material fills less than half a turn."""
        before, ahead = self.along[self.loops.before], self.along
        return before[:, 0] * ahead[:, 1] - before[:, 1] * ahead[:, 0] > 0

    def met(self, i: Ints, j: Ints) -> NDArray[np.bool_]:
        """Pairs of edges whose bodies differ and are not told to ignore each other."""
        n = int(self.part.max()) + 1
        low, high = np.minimum(self.part[i], self.part[j]), np.maximum(self.part[i], self.part[j])
        return (self.body[i] != self.body[j]) & ~np.isin(low * n + high, self.ignored)


Rows = tuple[Ints, Ints, Floats, Floats]


def _flush(them: OutlineEdges, tolerance: float) -> Rows:
    """Contacts at the ends of stretches along which two edges lie on each other."""
    lines = shapely.linestrings(np.stack([them.start, them.end], axis=1))
    i, j = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=tolerance)
    along = them.along
    keep = (them.body[i] < them.body[j]) & ((along[i] * along[j]).sum(1) < 0)
    i, j = i[keep], j[keep]
    keep = them.met(i, j)
    i, j = i[keep], j[keep]
    t = along[i]
    out = np.column_stack([t[:, 1], -t[:, 0]])
    length = np.hypot(*(them.end[i] - them.start[i]).T)
    # the other edge runs backwards: it begins far along this one
    far, near = them.start[j] - them.start[i], them.end[j] - them.start[i]
    s_far, s_near = (far * t).sum(1), (near * t).sum(1)
    h_far, h_near = (far * out).sum(1), (near * out).sum(1)
    low, high = np.maximum(s_near, 0.0), np.minimum(s_far, length)
    span = np.maximum(s_far - s_near, 1e-300)
    height = [h_near + (h_far - h_near) * (s - s_near) / span for s in (low, high)]
    good = (high - low > tolerance) & (np.abs(height[0]) <= tolerance) & (np.abs(height[1]) <= tolerance)
    i, j, s_near, s_far, length = i[good], j[good], s_near[good], s_far[good], length[good]
    first = np.where((s_near > 0)[:, None], them.end[j], them.start[i])
    last = np.where((s_far < length)[:, None], them.start[j], them.end[i])
    edge = np.stack([them.start[i], them.end[i]], axis=1)
    two = np.r_[0 : len(i), 0 : len(i)]
    return them.body[i][two], them.body[j][two], np.vstack([first, last]), edge[two]


def _corners(them: OutlineEdges, tolerance: float) -> Rows:
    """Contacts of an outward corner with the inside of an edge, or with both edges of the inward corner it fills."""
    corner = np.flatnonzero(them.outward)
    lines = shapely.linestrings(np.stack([them.start, them.end], axis=1))
    k, j = shapely.STRtree(lines).query(shapely.points(them.start[corner]), predicate="dwithin", distance=tolerance)
    k = corner[k]
    keep = them.met(k, j)
    k, j = k[keep], j[keep]
    t = them.along[j]
    out = np.column_stack([t[:, 1], -t[:, 0]])
    foot = ((them.start[k] - them.start[j]) * t).sum(1)
    length = np.hypot(*(them.end[j] - them.start[j]).T)
    inward = ~them.outward
    inside = (foot > tolerance) & (foot < length - tolerance)
    filled = ((foot <= tolerance) & inward[j]) | ((foot >= length - tolerance) & inward[them.loops.after[j]])
    ahead, back = them.along[k], -them.along[them.loops.before[k]]
    clear = ((ahead * out).sum(1) > -ANGLE_TOLERANCE) & ((back * out).sum(1) > -ANGLE_TOLERANCE)
    good = (inside | filled) & clear
    k, j = k[good], j[good]
    swap = them.body[j] > them.body[k]  # the normal leaves the edge's body; a is the body of lower number
    a, b = np.where(swap, them.body[k], them.body[j]), np.where(swap, them.body[j], them.body[k])
    edge = np.stack([them.start[j], them.end[j]], axis=1)
    edge[swap] = edge[swap, ::-1]
    return a, b, them.start[k], edge


def _once(a: Ints, b: Ints, point: Floats, edge: Floats) -> Ints:
    """Rows that say something new."""
    if not len(a):
        return np.zeros(0, dtype=np.int64)
    direction = edge[:, 1] - edge[:, 0]
    direction = direction / np.hypot(*direction.T)[:, None]
    key = np.column_stack([a, b, np.round(point), np.round(direction / (10 * ANGLE_TOLERANCE))]) + 0.0
    return np.sort(np.unique(key, axis=0, return_index=True)[1])


def _as_drawn(assembly: Assembly) -> tuple[Part, ...]:
    if assembly.gap == 0:
        return assembly.parts
    drawn = tuple(replace(p, offset=0.0) for p in assembly.drawing.parts)
    return apply_gap(replace(assembly.drawing, parts=drawn, gap=0.0, gaps=()))[0]


def rigid_bodies(assembly: Assembly, parts: tuple[Part, ...]) -> tuple[Ints, int]:
    """Body of every part, and the one that stands."""
    group = glue_groups(assembly.drawing.glue)
    stands = {group[p.name] for p in parts if p.fixed and p.name in group}
    key = [
        ("fixed", 0)
        if p.fixed or group.get(p.name) in stands
        else ("glue", group[p.name])
        if p.name in group
        else ("part", i)
        for i, p in enumerate(parts)
    ]
    number = {k: n for n, k in enumerate(dict.fromkeys(key))}
    body_of = np.array([number[k] for k in key], dtype=np.int64)
    if ("fixed", 0) in number:
        return body_of, number["fixed", 0]
    area = np.zeros(len(number))
    shapes = [sum(shapely.Polygon(r.outer, r.holes).area for r in p.regions) for p in parts]
    np.add.at(area, body_of, shapes)
    return body_of, int(area.argmax())


def placed_outlines(parts: tuple[Part, ...]) -> tuple[Loops, Ints]:
    """Every outline where it lies at rest, and the part of every corner."""
    rings, _ = region_rings([r for p in parts for r in p.regions])
    counts = [sum(1 + len(r.holes) for r in p.regions) for p in parts]
    owner = np.repeat(np.arange(len(parts)), counts)
    loops = chained([place(ring, parts[p].at) for ring, p in zip(rings, owner.tolist(), strict=True)])
    return loops, np.repeat(owner, loops.counts)


def ignored_parts(assembly: Assembly) -> Ints:
    """Pairs of parts that never collide, as numbers low * n + high."""
    index = {name: k for k, name in enumerate(assembly.names)}
    pairs = [sorted((index[one], index[other])) for one, other in assembly.drawing.ignore]
    return np.array([low * len(index) + high for low, high in pairs], dtype=np.int64)
