"""Caging surfaces: closed surfaces in (tau, phi) round rest, every point of which is forbidden, with the edges that show it.

A caging surface is a stack of closed loops of translations, each at its own angle. It ends in a point (or a line there and back) on
either side. Neighbouring loops are joined by tracks, straight lines from a corner of one to a corner of the other; between two tracks
that follow each other one edge of A crosses one edge of B at every angle. So no path from rest leaves the surface, B is caged in it,
and the corners of its loops bound what lies inside. The proof rests on the surface alone, not on how it was found.

Chords are straight segments inside a part, a little behind its edges: where a chord of A crosses a chord of B, A and B overlap. They run on
beyond the ends of their edge until they meet the boundary, so that at a corner there is always one that crosses.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.deadline import WorkBudget
from wiggleroom.freespace.outer.contour_stitching import Crossings, Loop, Seam, deepest, loop_of, stitched
from wiggleroom.freespace.outer.outer_region import ReachedSlices, slice_work
from wiggleroom.freespace.outer.outer_slices import PairMaterial, core, corners_of, forbidden, uncovered
from wiggleroom.geometry.relative_pose import rotated

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LOOP_OUTSETS = ((3e-4, 1.0), *((3e-4 * 2**k, 2.0 ** (-8 - k)) for k in range(1, 4)))
"""Loops run so far behind the walls, as shares of the clearance: the first that can be joined; the others for small steps only."""
LOOP_SLICES = 1.2
"""A loop takes the work of so many slices of both outlines."""
CLOSING_STEP = 2.0**-12
"""A surface ends by a step no longer than this share of the turn, where shorter steps can be found: chains add up where it ends."""
FIRST_ANGLE_STEP, MIN_ANGLE_STEP = 1 / 64, 2.0**-20
"""The first step of the angle, and the least, as shares of the range of turns."""
MIN_CROSSING_DEPTH = 0.01
"""Along a loop edges cross at least so deep, as a share of its outset: so neighbouring loops can still be joined."""
MAX_MITRE = 10.0
"""Acute corners of loops are extended by at most this many outsets."""
CLOSING_ANGLES = (0.0, 2.0**-14, 2.0**-12, 2.0**-10, 2.0**-8)
"""A loop may shrink to a point this share of the whole turn further, where walls have closed well over it."""
CHORD_SETTINGS = ((0.1, True), (1e-3, True), (1e-3, False), (1e-4, False), (1e-2, False), (0.1, False))
"""Chords lie so far inside their part, as shares of the least outset, and loops have few corners or many; the first that one is
found with. Few corners are quick and fit curves; where one step cannot be joined to the next, many may."""
KEPT_STEP, MAX_KEPT_LOOPS = 2.0**-14, 100
"""Where no step leads on, so many loops, at steps of this share of the turn, may go round what the one before went round, too."""
MAX_DENSE_STEP = 2.0**-9
"""Where few corners are wanted, many are tried for steps up to this share of the turn only: longer steps are halved sooner."""
MAX_LOOPS = 1200
"""Loops of one surface at most: it is given up then."""

END_MARGIN = 0.02
"""Distance of a chord's ends from the boundary, as a share of its depth behind its edge."""


@dataclass(frozen=True, eq=False)
class CagingSurface:
    """Closed surface round all that a pair can reach; it takes the place of `OuterRegion` where facets are asked for.

    Parameters
    ----------
    material : PairMaterial
    crossings : Crossings
        The chords that the seams name.
    loops : tuple of Loop
        From the least angle to the greatest.
    seams : tuple of Seam
        Between each loop and the next.
    """

    material: PairMaterial
    crossings: Crossings
    loops: tuple[Loop, ...]
    seams: tuple[Seam, ...]

    @property
    def turns(self) -> tuple[float, float]:
        """Least and largest turn [rad]."""
        return self.loops[0].angle, self.loops[-1].angle

    @cached_property
    def _corners(self) -> Floats:
        return np.vstack([np.column_stack([p.at, np.full(len(p.at), p.angle)]) for p in self.loops])

    @cached_property
    def _angles(self) -> Floats:
        return np.array([loop.angle for loop in self.loops])

    @property
    def far(self) -> float:
        """Largest motion of the pivot [mm]."""
        return float(np.hypot(*self._corners[:, :2].T).max()) + 4 * self.material.margin

    def points(self, low: float = -np.inf, high: float = np.inf) -> tuple[Floats, Ints]:
        """Corners (M, 3) of the loops between two turns and where tracks pass these; none has an interval of its own (M,)."""
        turns = self._corners[:, 2]
        found = [self._corners[(turns >= low) & (turns <= high)]]
        for level in (low, high):
            k = int(np.searchsorted(self._angles, level)) - 1
            if 0 <= k < len(self.seams) and level < self._angles[k + 1]:
                one, two, tracks = self.loops[k], self.loops[k + 1], self.seams[k].tracks
                share = (level - one.angle) / (two.angle - one.angle)
                at = (1 - share) * one.at[tracks[:, 0]] + share * two.at[tracks[:, 1]]
                found.append(np.column_stack([at, np.full(len(at), level)]))
        points = np.vstack(found)
        return points, np.zeros(len(points), dtype=np.int64)


def caging_surface(whole: PairMaterial, slices: ReachedSlices, budget: WorkBudget) -> CagingSurface | None:
    """CagingSurface round rest; None where none was found, for example where a slice has several pieces, or the budget ended first."""
    window = 1.2 * max(float(np.abs(shapely.bounds(p)).max()) for p in slices.pieces)
    first, last = float(slices.low[0]), float(slices.high[-1])
    material = whole.near(3 * window + 2 * np.sin(min(max(-first, last), np.pi) / 2) * whole.radius)
    for inset, few in CHORD_SETTINGS:
        depth = inset * LOOP_OUTSETS[0][0] * material.clearance
        crossings = Crossings(*(chords(g, depth, material.clearance) for g in (material.a, material.b)))
        start = _loop(
            material, crossings, _pieces(material, 0.0, window, shapely.Point(0, 0)), 0.0, LOOP_OUTSETS[0][0], few
        )
        if start is None or budget.spend(2 * LOOP_SLICES * slice_work(material.a, material.b)):
            continue
        strip = _Strip(material, crossings, window, few)
        up = _half(strip, start, last, budget)
        down = None if up is None else _half(strip, start, first, budget)
        if up is not None and down is not None:
            loops = (*(p for p, _ in reversed(down)), start, *(p for p, _ in up))
            return CagingSurface(
                whole, crossings, loops, (*(s.reversed() for _, s in reversed(down)), *(s for _, s in up))
            )
    return None


@dataclass(frozen=True, eq=False)
class _Strip:
    """Where loops run.

    Parameters
    ----------
    material : PairMaterial
    crossings : Crossings
    window : float [mm]
        How far from rest material counts.
    few : bool
        True where loops go round with few points.
    """

    material: PairMaterial
    crossings: Crossings
    window: float
    few: bool


def _half(strip: _Strip, start: Loop, end: float, budget: WorkBudget) -> list[tuple[Loop, Seam]] | None:
    """Loops from rest to the end of the turn on one side, each with its seam to the one before."""
    done: list[tuple[Loop, Seam]] = []
    ended: list[tuple[Loop, Seam]] | None = None  # as far as it went when a longer step would already have ended it
    here, step, kept = start, FIRST_ANGLE_STEP * end, 0
    work = LOOP_SLICES * slice_work(strip.material.a, strip.material.b)
    while not budget.spend(work) and len(done) < MAX_LOOPS and abs(here.angle) < 2 * abs(end) + 0.1:
        if abs(step) <= MIN_ANGLE_STEP * abs(end):
            if ended is not None or kept:
                break
            step, kept = KEPT_STEP * end, MAX_KEPT_LOOPS
        found = _next(strip, here, here.angle + step, abs(step / end), end)
        if found is not None:
            kept = 0
        elif kept > 1:
            found = _next(strip, here, here.angle + step, abs(step / end), end, keep=True)
            kept -= found is not None
        if found is None:
            step /= 2
            continue
        if len(found[0].at) <= 2:
            ended = [*done, found]
            if abs(step) <= CLOSING_STEP * abs(end):
                return ended
            step /= 2  # not further than needed
            continue
        done.append(found)
        longest = (KEPT_STEP if kept else FIRST_ANGLE_STEP) * abs(end)
        here, step = found[0], min(1.5 * abs(step), longest) * np.sign(end)
    return ended


def _next(
    strip: _Strip, here: Loop, angle: float, share: float, whole: float, *, keep: bool = False
) -> tuple[Loop, Seam] | None:
    """Loop at `angle` that can be joined to the one `here`; further behind the walls only where the step is a small `share`.

    To `keep` a strip that closes all along at once, until its walls overlap well enough that a loop can leave it, it goes round what the
    one here goes round, too.
    """
    material, crossings = strip.material, strip.crossings
    pieces = _pieces(material, angle, strip.window, shapely.Polygon(here.at))
    some: Iterable[Loop | None]
    if not len(pieces):
        some = (p for k in CLOSING_ANGLES for p in _ends(crossings, here, angle + k * whole))
    else:
        if keep:
            off = LOOP_OUTSETS[0][0] * material.clearance
            pieces = np.append(pieces, shapely.buffer(shapely.Polygon(here.at), -off, join_style="mitre"))
        some = (
            _loop(material, crossings, pieces, angle, o, seldom)
            for o, most in LOOP_OUTSETS
            if share <= most
            for seldom in ((True, False) if strip.few and share <= MAX_DENSE_STEP else (strip.few,))
        )
    for there in some:
        seam = None if there is None else stitched(crossings, here, there)
        if there is not None and seam is not None:
            return there, seam
    return None


def _pieces(material: PairMaterial, angle: float, window: float, met: shapely.Geometry) -> NDArray[np.object_]:
    """What is free at an angle and meets `met`."""
    turned = shapely.transform(_core(material), lambda p: rotated(p, angle))
    pieces = uncovered(material.a, turned, window)
    pieces = pieces[shapely.dwithin(pieces, met, material.margin)]
    return pieces[~forbidden(material.a, turned, pieces, material.margin)]


@lru_cache(maxsize=4)
def _core(material: PairMaterial) -> shapely.Geometry:
    """B less the margin for rounding."""
    return core(material.b, 0.0, 0.0, material.margin)


def _loop(
    material: PairMaterial, crossings: Crossings, pieces: NDArray[np.object_], angle: float, outset: float, few: bool
) -> Loop | None:
    """Loop a little behind the walls of some free pieces; None where they lie apart or no edges cross somewhere along it."""
    off = outset * material.clearance
    try:
        grown = shapely.buffer(
            shapely.union_all(pieces).simplify(off / 4), off, join_style="mitre", mitre_limit=MAX_MITRE
        )
    except shapely.errors.GEOSException:  # pieces that cross themselves by rounding
        return None
    if grown.geom_type != "Polygon":
        return None
    ring = shapely.get_coordinates(shapely.orient_polygons(grown).exterior)[:-1]
    return loop_of(crossings, ring, angle, MIN_CROSSING_DEPTH * off, few)


def _ends(crossings: Crossings, here: Loop, angle: float) -> list[Loop]:
    """Points and lines to which a loop may shrink."""
    box = shapely.get_coordinates(shapely.minimum_rotated_rectangle(shapely.multipoints(here.at)))
    k = int(np.argmin(np.hypot(*np.diff(box[:3], axis=0).T)))
    ends = np.array([(box[k] + box[k + 1]) / 2, (box[k + 2] + box[(k + 3) % 4]) / 2])
    inmost = deepest(crossings, here, angle)
    found = [] if inmost is None else [inmost[None]]
    found += [ends.mean(0) + share * (ends - ends.mean(0)) for share in (0.98, 0.9, 0.7, 0.4)]
    return [Loop(p, angle) for p in found]


def chords(material: shapely.Geometry, inset: float, beyond: float) -> Floats:
    """Chords (k, 2, 2) [mm], `inset` behind each edge and at most `beyond` longer at either end; none for edges of what is thinner."""
    start, end, _, go = corners_of(material)
    inward = np.column_stack([-go[:, 1], go[:, 0]])
    middle = (start + end) / 2 + inset * inward
    lines = np.stack([start + inset * inward - beyond * go, end + inset * inward + beyond * go], 1)
    pieces, which = shapely.get_parts(shapely.intersection(shapely.linestrings(lines), material), return_index=True)
    mine = shapely.dwithin(pieces, shapely.points(middle)[which], 1e-3 * inset)
    mine &= shapely.get_type_id(pieces) == shapely.GeometryType.LINESTRING
    pieces, which = pieces[mine], which[mine]
    _, first = np.unique(which, return_index=True)
    pieces = pieces[first]
    ends = np.stack([shapely.get_coordinates(shapely.get_point(pieces, k)) for k in (0, -1)], 1)
    edge = ends[:, 1] - ends[:, 0]
    long = np.hypot(*edge.T)
    ends, edge, long = ends[long > inset], edge[long > inset], long[long > inset]
    back = END_MARGIN * inset * edge / long[:, None]
    return np.stack([ends[:, 0] + back, ends[:, 1] - back], 1)
