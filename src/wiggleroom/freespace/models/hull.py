"""The paper's model of one pair: the convex hull of the free slices at nc, 0 and pc.

A stands; B is centred in its slice, then turned in place until it first touches, both ways: the angles nc and pc. The
slices at nc, 0 and pc are those pieces of the free translations that hold B. Their convex hull over (x, y, angle) is
neither inside nor outside the free space.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.compiled.scipy_extensions import qhull
from wiggleroom.freespace.models.bounded_slices import bounded
from wiggleroom.freespace.models.pair_models import Hull
from wiggleroom.freespace.slices import PairOutlines, Slice, slice_near, slice_sequence
from wiggleroom.geometry.relative_pose import rotated

Floats = NDArray[np.float64]

CONTACT_TOLERANCE = 1e-7
"""B touches where it is nearer than this share of the clearance at rest."""
MIN_CENTRING_GAIN = 1e-3
"""Rest is kept where no other place has this share more room."""
MAX_MARCH_STEPS = 2000
"""Steps of the march to the first touch at most."""


@dataclass(frozen=True, eq=False)
class PairHull:
    """Polyhedron N g + D <= 0 over (shift of the pivot, turn) of B against A.

    Parameters
    ----------
    normal : (m, 3) float64
    offset : (m,) float64 [mm]
    slices : tuple of Slice [mm]
        What it is the hull of: closed pieces as they are, open ones bounded.
    ends : (nc, pc) [rad]
    closed : bool
        True where all slices end by themselves.
    """

    normal: Floats
    offset: Floats
    slices: tuple[Slice, ...]
    ends: tuple[float, float]
    closed: bool


def pair_hull(pair: PairOutlines, model: Hull, reach: float) -> PairHull | None:
    """Hull of a pair at rest, or None where rest is not free.

    Parameters
    ----------
    pair : PairOutlines
        Its pivot is the point that B turns about.
    model : Hull
    reach : float [mm]
        Open slices are followed this far.

    Examples
    --------
    >>> from wiggleroom.freespace.slices import pair_outlines
    >>> peg, ring = shapely.box(-0.9, -0.9, 0.9, 0.9), shapely.box(-3, -3, 3, 3) - shapely.box(-1, -1, 1, 1)
    >>> hull = pair_hull(pair_outlines(ring, peg), Hull(), reach=1.0)
    >>> len(hull.offset), round(hull.ends[1], 5)  # two pyramids on a square, a lid on each; 0.9 (cos + sin) = 1
    (10, 0.11839)

    Source: Mind the Gap, sections 4.1 and 4.2.
    """
    rest = slice_near(pair, 0.0, shapely.Point(0, 0))
    limit = np.inf
    if rest is not None and not rest.closed:
        limit = reach
        rest = slice_near(pair, 0.0, shapely.Point(0, 0), limit)
    if rest is None:
        return None
    centre = _centre(pair, rest)
    if model.slices == 3:
        ends = (_first_touch(pair, centre, -1.0), _first_touch(pair, centre, 1.0))
        found = [_slice(pair, phi, centre, limit) for phi in ends]
        slices = [found[0], rest, found[1]]
    else:
        space = slice_sequence(pair, reach)
        ends, limit = space.ends, space.limit
        angles = np.linspace(*ends, model.slices)
        slices = [s for phi in angles if (s := space.at(float(phi))) is not None]
    closed = all(s.closed for s in slices)
    slices = [s if s.closed else bounded(pair, s, centre, min(limit, pair.far)) for s in slices]
    return PairHull(*_polyhedron(slices, pair.clearance), tuple(slices), ends, closed)


def _centre(pair: PairOutlines, rest: Slice) -> Floats:
    """Translation (2,) [mm] that leaves B as much room as there is; open pairs are taken to rest there."""
    if not rest.closed:
        return np.zeros(2)
    widest = shapely.maximum_inscribed_circle(rest.region, tolerance=0.1 * MIN_CENTRING_GAIN * pair.clearance)
    here = shapely.distance(shapely.Point(0, 0), shapely.boundary(rest.region))
    if here >= (1 - MIN_CENTRING_GAIN) * shapely.length(widest):
        return np.zeros(2)
    return shapely.get_coordinates(widest)[0]


def _first_touch(pair: PairOutlines, centre: Floats, sense: float) -> float:
    """Angle [rad] up to which B turns about the pivot, moved to `centre`, before it first touches A; half a turn where it never does.

    No point of B moves further than radius times angle, so a turn by distance over radius is free.
    """
    a, b = pair.material
    angle = 0.0
    for _ in range(MAX_MARCH_STEPS):
        moved = shapely.transform(b, lambda p: rotated(p, np.array([sense * angle])) + centre)  # noqa: B023
        apart = float(shapely.distance(a, moved))
        if apart < CONTACT_TOLERANCE * pair.clearance or angle >= np.pi:
            break
        angle += apart / pair.radius
    return sense * min(angle, np.pi)


def _slice(pair: PairOutlines, phi: float, centre: Floats, limit: float) -> Slice:
    """Slice that holds B at `centre`; that one point where there is no more room than to touch on all sides."""
    spot = shapely.Point(centre)
    found = slice_near(pair, phi, spot, limit)
    if found is None and limit == np.inf:
        return Slice(phi, spot, True, 0.0)
    return found if found is not None else Slice(phi, spot, True, 0.0)


def _polyhedron(slices: list[Slice], clearance: float) -> tuple[Floats, Floats]:
    """Faces N (m, 3) and D (m,) of the convex hull of slices."""
    points = np.vstack(
        [np.insert(shapely.get_coordinates(shapely.convex_hull(s.region)), 2, s.angle, axis=1) for s in slices]
    )
    unit = np.array([clearance, clearance, np.abs(points[:, 2]).max()])
    equations = qhull().ConvexHull(points / unit).equations
    faces = np.unique(np.round(equations, 10), axis=0)  # triangles of one face are one row
    return faces[:, :3] * clearance / unit, faces[:, 3] * clearance
