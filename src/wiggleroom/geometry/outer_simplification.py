"""Outlines with fewer corners, of at least the same material: what these can do, the parts that were drawn can do as well."""

from __future__ import annotations

import heapq
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Part, Region
from wiggleroom.drawing.outlines.rings import signed_area
from wiggleroom.errors import Stop, go_on

Floats = NDArray[np.float64]

MIN_CORNERS = 200
"""Outlines of fewer corners stay as they are."""
MAX_CORNERS, MIN_EDGE = 400, 1.5
"""Outlines of at most this many corners whose median edge is longer than this share of the clearance stay as they are too."""
ASKED_EVERY = 5000
"""Corners between two looks at a request to stop."""
NEAR, NEAR_DEPTH = 2.0, 0.1
"""A contact may move by this many clearances, or along an arc until it lies this share of a clearance deeper."""


def is_fine(assembly: Assembly, clearance: float) -> bool:
    """True where some outline has many corners, nearer to each other than a share of the clearance [mm]."""
    return any(_fine(ring, clearance) for part in assembly.parts for ring in _rings(part))


def simplified_outward(
    assembly: Assembly, clearance: float, tolerance: float, near: Floats, finer: float, stop: Stop | None = None
) -> Assembly:
    """The assembly with fewer corners on fine outlines; material is added, never taken away.

    Parameters
    ----------
    assembly : Assembly
    clearance : float [mm]
        Typical clearance between neighbours.
    tolerance : float [mm]
        No point that is added lies further than this from the material that was drawn.
    near : (k, 3) float64
        Part and (x, y) [mm] of places, in the part's own frame, within a clearance or two of which the `finer` tolerance holds.
    finer : float [mm]
    stop : optional
        Anything with `is_set()`, asked now and then.

    Raises
    ------
    StoppedError
        If it was asked to stop.
    """
    parts = []
    for k, part in enumerate(assembly.parts):
        spots = near[near[:, 0] == k, 1:]
        regions = tuple(
            Region(
                _outline(r.outer, clearance, tolerance, spots, finer, stop),
                tuple(_outline(h, clearance, tolerance, spots, finer, stop) for h in r.holes),
            )
            for r in part.regions
        )
        parts.append(replace(part, regions=regions))
    return replace(assembly, parts=tuple(parts))


def simplified_inward(
    wall: shapely.Geometry, clearance: float, tolerance: float, near: Floats, finer: float
) -> shapely.Geometry:
    """Material with fewer corners on fine outlines; some is taken away, none added.

    `near` are places (k, 2) [mm]; all else as for `simplified_outward`.
    """
    pieces = []
    for part in shapely.get_parts(wall):
        # a ring that runs the other way round has free space to its left, to which is added
        outer, *holes = (_outline(ring, clearance, tolerance, near, finer) for ring in _reversed(part))
        pieces.append(shapely.Polygon(outer, holes))
    return shapely.multipolygons(pieces) if len(pieces) > 1 else pieces[0]


def _reversed(part: shapely.Polygon) -> list[Floats]:
    """The rings of a polygon (k, 2) with free space to their left."""
    outer, *holes = (shapely.get_coordinates(ring)[:-1] for ring in (part.exterior, *part.interiors))
    return [outer[::-1] if signed_area(outer) > 0 else outer, *(h if signed_area(h) > 0 else h[::-1] for h in holes)]


def _rings(part: Part) -> list[Floats]:
    return [ring for region in part.regions for ring in (region.outer, *region.holes)]


def _fine(ring: Floats, clearance: float) -> bool:
    if len(ring) < MIN_CORNERS:
        return False
    short = float(np.median(np.hypot(*(np.roll(ring, -1, 0) - ring).T))) < MIN_EDGE * clearance
    return short or len(ring) > MAX_CORNERS


def _outline(
    ring: Floats, clearance: float, tolerance: float, spots: Floats, finer: float, stop: Stop | None = None
) -> Floats:
    if not _fine(ring, clearance):
        return ring
    allowed = np.full(len(ring), tolerance)
    if len(spots):
        away = np.hypot(*(ring[:, None] - spots).transpose(2, 0, 1)).min(axis=1)
        reach = max(NEAR * clearance, 2 * np.sqrt(2 * clearance * np.ptp(ring, axis=0).max() * NEAR_DEPTH))
        allowed[away < reach] = finer
    out = _simplified(ring, allowed, stop)
    old, new = shapely.Polygon(ring), shapely.Polygon(out)
    more = shapely.difference(old, new) if signed_area(ring) > 0 else shapely.difference(new, old)
    return out if new.is_valid and more.area < 1e-9 * old.area else ring


def _simplified(ring: Floats, allowed: Floats, stop: Stop | None) -> Floats:
    """A ring, material to its left, with reflex corners left out and convex edges replaced by the tip of their neighbours."""
    n = len(ring)
    place = [tuple(p) for p in ring.tolist()]
    limit, error = allowed.tolist(), [0.0] * n
    after, before = [(k + 1) % n for k in range(n)], [k - 1 if k else n - 1 for k in range(n)]
    stamp, left = [0] * n, n
    queue: list[tuple[float, int, int, tuple[float, float] | None]] = []

    def offer(k: int) -> None:
        """The cheaper of leaving out corner k, and of putting a tip in place of the edge that begins there."""
        stamp[k] += 1
        p, a, b, q = place[before[k]], place[k], place[after[k]], place[after[after[k]]]
        if _cross(p, a, b) <= 0:
            height = _off(a, p, b)
            if height + error[k] <= min(limit[before[k]], limit[k], limit[after[k]]):
                heapq.heappush(queue, (height + error[k], k, stamp[k], None))
        elif _cross(a, b, q) > 0:
            tip = _meeting(p, a, b, q)
            if tip is not None:
                cost = _off(tip, a, b) + max(error[k], error[after[k]])
                if cost <= min(limit[k], limit[after[k]]):
                    heapq.heappush(queue, (cost, k, stamp[k], tip))

    for k in range(n):
        if not k % ASKED_EVERY:
            go_on(stop)
        offer(k)
    steps = 0
    while queue and left > 4:
        steps += 1
        if not steps % ASKED_EVERY:
            go_on(stop)
        cost, k, when, tip = heapq.heappop(queue)
        if when != stamp[k]:
            continue
        if tip is None:
            one, other = before[k], after[k]
            after[one], before[other] = other, one
            error[one], error[other] = max(error[one], cost), max(error[other], cost)
        else:
            gone, other = after[k], after[after[k]]
            place[k], error[k] = tip, cost
            limit[k] = min(limit[k], limit[gone])
            after[k], before[other] = other, k
            stamp[gone] = -1
            one = k
        stamp[k] = -1 if tip is None else stamp[k]
        left -= 1
        for j in {before[before[one]], before[one], one, after[one], after[after[one]]}:
            offer(j)
    begin = next(k for k in range(n) if stamp[k] >= 0)
    out, k = [place[begin]], after[begin]
    while k != begin:
        out.append(place[k])
        k = after[k]
    return np.array(out)


Point = tuple[float, float]


def _cross(p: Point, a: Point, b: Point) -> float:
    return (a[0] - p[0]) * (b[1] - a[1]) - (a[1] - p[1]) * (b[0] - a[0])


def _off(a: Point, p: Point, q: Point) -> float:
    """Distance of a from the line through p and q."""
    long = float(np.hypot(q[0] - p[0], q[1] - p[1]))
    return abs(_cross(p, q, a)) / long if long else float("inf")


def _meeting(p: Point, a: Point, b: Point, q: Point) -> Point | None:
    """Where p a, gone on with, meets q b, gone on with; None where they part."""
    ux, uy, vx, vy = a[0] - p[0], a[1] - p[1], b[0] - q[0], b[1] - q[1]
    turn = ux * vy - uy * vx
    if turn >= 0:
        return None
    share = ((b[0] - a[0]) * vy - (b[1] - a[1]) * vx) / turn
    return (a[0] + share * ux, a[1] + share * uy) if share > 0 else None
