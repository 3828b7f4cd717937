"""Free translations of B against A at one turn, exactly, and which of them are connected to rest.

An edge of A and an edge of B meet for the translations in one parallelogram. A connected piece of the plane that no
parallelogram covers is therefore wholly free or wholly forbidden: the sides of all parallelograms in a window are cut
at their crossings, the faces between them are collected, and one point per uncovered face decides.
"""

from __future__ import annotations

import bisect

import numba
import numpy as np
import shapely

from .geometry import turn

END = 2e-13  # [rad] how closely the last free turn is found
DEEP = 1e-9  # share of the size, far above rounding, below which what lies inside of a parallelogram is kept
THINNEST = 1e-14  # area / perimeter below which a face is rounding
Faces = list[shapely.Polygon]


def _edges(polygon: shapely.Polygon) -> tuple[np.ndarray, np.ndarray]:
    rings = [shapely.get_coordinates(r)[:-1] for r in (polygon.exterior, *polygon.interiors)]
    return np.concatenate(rings), np.concatenate([np.roll(r, -1, axis=0) for r in rings])


class Slices:
    """All relative motions of B against A that are connected to rest, one turn at a time, remembered.

    B's reference point is its own origin and rests at `D` in A's frame; `step` is the spacing of the first march.
    """

    def __init__(self, A: shapely.Polygon, B: shapely.Polygon, D: tuple[float, float], step: float = 1e-3):
        self.A, self.B, self.D = A, B, np.asarray(D, dtype=float)
        self._a, self._b = _edges(A), _edges(B)
        self._known: dict[float, Faces] = {}
        self._order: list[float] = []
        self.reach = float(np.max(np.hypot(*self._b[0].T)))  # a point of B moves at most this far per radian
        start = shapely.Point(0, 0)
        self._margin = self._first_margin()
        faces = [f for f in self.free_faces(0.0, (0, 0, 0, 0)) if f.intersects(start)]
        if len(faces) != 1:
            raise ValueError("rest is not inside one free piece")
        self._remember(0.0, faces)
        self.low, self.high = (self._march(s * step) for s in (-1, 1))
        self._fold_back()

    def _first_margin(self) -> float:
        placed = shapely.transform(self.B, lambda p: p + self.D)
        return 0.3 * max(shapely.distance(self.A, placed), 1e-6)

    # -- one slice --------------------------------------------------------------------------------------------------
    def _parallelograms(self, phi: float, box: tuple[float, float, float, float]) -> np.ndarray:
        """Corners (k, 4, 2) of those that touch the box."""
        b0, b1 = (p @ turn(phi).T + self.D for p in self._b)
        a0, a1 = self._a
        low = np.minimum(a0, a1)[:, None] - np.maximum(b0, b1)
        high = np.maximum(a0, a1)[:, None] - np.minimum(b0, b1)
        near = (low[..., 0] <= box[2]) & (low[..., 1] <= box[3]) & (high[..., 0] >= box[0]) & (high[..., 1] >= box[1])
        i, j = np.nonzero(near)
        return np.stack([a0[i] - b0[j], a1[i] - b0[j], a1[i] - b1[j], a0[i] - b1[j]], axis=1)

    def free_faces(self, phi: float, bounds: tuple[float, float, float, float]) -> Faces:
        """Free pieces near `bounds`; the window grows until those that meet `bounds` lie wholly inside it."""
        margin = self._margin
        for _ in range(12):
            box = (bounds[0] - margin, bounds[1] - margin, bounds[2] + margin, bounds[3] + margin)
            window, seed = shapely.box(*box), shapely.box(*bounds)
            faces = self._faces_in(phi, box)
            if not any(f.intersects(window.exterior) and f.intersects(seed) for f in faces):
                return faces
            margin *= 2
        raise ValueError("the free space is open: the parts come apart")

    def _faces_in(self, phi: float, box: tuple[float, float, float, float]) -> Faces:
        quads = self._parallelograms(phi, box)
        window = shapely.box(*box)
        closed = np.concatenate([quads, quads[:, :1]], axis=1)
        sides = np.stack([closed[:, :-1], closed[:, 1:]], axis=2).reshape(-1, 2, 2)
        sides = np.unique(np.where(_swapped(sides)[:, None, None], sides[:, ::-1], sides), axis=0)
        sides = _seen(_clipped(sides, box), quads, DEEP * self.reach)
        noded = shapely.union_all(np.append(shapely.linestrings(sides), window.exterior))
        faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))
        faces = faces[shapely.area(faces) > THINNEST * shapely.length(faces)]
        inside = shapely.point_on_surface(faces)
        spots = shapely.get_coordinates(inside)
        open_ = ~_covered(spots, quads) & shapely.contains(window, inside)
        return [f for f, p in zip(faces[open_], spots[open_], strict=True) if self._apart(phi, p)]

    def _apart(self, phi: float, tau: np.ndarray) -> bool:
        placed = shapely.transform(self.B, lambda p: p @ turn(phi).T + self.D + tau)
        return not shapely.intersects(self.A, placed)

    # -- connection through the turn --------------------------------------------------------------------------------
    def _remember(self, phi: float, faces: Faces) -> None:
        self._known[phi] = faces
        bisect.insort(self._order, phi)

    def _beside(self, faces: Faces, phi: float) -> Faces:
        """Free pieces at `phi` that share translations with `faces` of a turn close by."""
        bounds = tuple(shapely.total_bounds(np.array(faces)))
        return [f for f in self.free_faces(phi, bounds) if any(f.intersects(g) for g in faces)]

    def _follow(self, start: float, goal: float) -> float:
        """Follow the free pieces from a known turn towards `goal`; the last turn reached."""
        here, pace = start, goal - start
        while here != goal and abs(pace) > END:
            there = goal if abs(goal - here) <= abs(pace) * 1.5 else here + pace
            faces = self._known.get(there) or self._beside(self._known[here], there)
            if faces:
                if there not in self._known:
                    self._remember(there, faces)
                here, pace = there, pace * 2
            else:
                pace /= 2
        return here

    def _march(self, step: float) -> float:
        here = 0.0
        for i in range(1, int(np.pi / abs(step))):
            there = self._follow(here, i * step)
            if there != i * step:
                return there
            here = there
        raise ValueError("B can turn all the way round")

    def _fold_back(self) -> None:
        """Add pieces at smaller turns that are reached only by turning further and coming back."""
        grown = True
        while grown:
            grown = False
            for order in (self._order, self._order[::-1]):
                for phi, beside in zip(order[1:], order[:-1], strict=True):
                    if abs(phi - beside) < 1e-5:
                        continue
                    mine, theirs = self._known[phi], self._known[beside]
                    extra = [f for f in self._beside(theirs, phi) if not any(f.intersects(g) for g in mine)]
                    if extra:
                        self._known[phi] = mine + extra
                        grown = True

    def at(self, phi: float) -> Faces:
        """Free pieces connected to rest at this turn [rad]; none outside `low` .. `high`."""
        if phi not in self._known:
            if not self.low <= phi <= self.high:
                return []
            i = bisect.bisect(self._order, phi)
            nearest = min(self._order[max(i - 1, 0) : i + 1], key=lambda p: abs(p - phi))
            self._follow(nearest, phi)
        return self._known.get(phi, [])

    def corners(self, phi: float) -> np.ndarray:
        """Corners (k, 2) of the convex hull of the slice: enough for its support function."""
        faces = self.at(phi)
        if not faces:
            return np.empty((0, 2))
        points = shapely.get_coordinates(faces)
        if len(points) > 40:
            points = shapely.get_coordinates(shapely.convex_hull(shapely.multipoints(points)))
        return points


def _swapped(sides: np.ndarray) -> np.ndarray:
    first, second = sides[:, 0], sides[:, 1]
    return (first[:, 0] > second[:, 0]) | ((first[:, 0] == second[:, 0]) & (first[:, 1] > second[:, 1]))


def _clipped(sides: np.ndarray, box: tuple[float, float, float, float]) -> np.ndarray:
    """Sides (k, 2, 2) cut off just outside the box (Liang and Barsky 1984); those that miss it are left out."""
    over = 0.02 * (box[2] - box[0])
    start, edge = sides[:, 0], sides[:, 1] - sides[:, 0]
    low, high = np.array(box[:2]) - over - start, np.array(box[2:]) + over - start
    flat = edge == 0
    one, two = (d / np.where(flat, 1, edge) for d in (low, high))
    one[flat] = np.where(low[flat] <= 0, -np.inf, np.inf)
    two[flat] = np.where(high[flat] >= 0, np.inf, -np.inf)
    enter = np.maximum(np.minimum(one, two).max(axis=1), 0)
    leave = np.minimum(np.maximum(one, two).min(axis=1), 1)
    keep = enter < leave
    sides, start, edge, enter, leave = (v[keep] for v in (sides, start, edge, enter[:, None], leave[:, None]))
    return np.stack(
        [np.where(enter == 0, start, start + enter * edge), np.where(leave == 1, sides[:, 1], start + leave * edge)],
        axis=1,
    )


@numba.njit(cache=True)
def _seen(sides: np.ndarray, quads: np.ndarray, deep: float) -> np.ndarray:
    """Pieces (m, 2, 2) of sides (k, 2, 2), cut off where they lie `deep` or more inside of a parallelogram.

    Nothing is free on either side of what is cut off, so no free face is bounded by it.
    """
    pieces = [(0.0, 0.0, 0.0, 0.0) for _ in range(0)]
    inside = np.empty((len(quads), 2))
    for k in range(len(sides)):
        x, y = sides[k, 0, 0], sides[k, 0, 1]
        dx, dy = sides[k, 1, 0] - x, sides[k, 1, 1] - y
        count = 0
        for q in quads:
            enter, leave = 0.0, 1.0
            for here, there, far in ((0, 1, 3), (0, 3, 1)):
                ex, ey = q[there, 0] - q[here, 0], q[there, 1] - q[here, 1]
                long = np.hypot(ex, ey)
                if long == 0:
                    leave = -1.0
                    break
                width = (ex * (q[far, 1] - q[here, 1]) - ey * (q[far, 0] - q[here, 0])) / long
                begin = (ex * (y - q[here, 1]) - ey * (x - q[here, 0])) / long
                slope = (ex * dy - ey * dx) / long
                if width < 0:
                    width, begin, slope = -width, -begin, -slope
                if slope == 0:
                    if not deep < begin < width - deep:
                        leave = -1.0
                        break
                    continue
                one, two = (deep - begin) / slope, (width - deep - begin) / slope
                if width < 2 * deep:
                    leave = -1.0
                    break
                enter, leave = max(enter, min(one, two)), min(leave, max(one, two))
                if enter >= leave:
                    break
            if enter < leave:
                inside[count] = enter, leave
                count += 1
        at = 0.0
        order = np.argsort(inside[:count, 0])
        for i in order:
            if inside[i, 0] > at:
                pieces.append((x + at * dx, y + at * dy, x + inside[i, 0] * dx, y + inside[i, 0] * dy))
            at = max(at, inside[i, 1])
        if at == 0:
            pieces.append((x, y, sides[k, 1, 0], sides[k, 1, 1]))
        elif at < 1:
            pieces.append((x + at * dx, y + at * dy, sides[k, 1, 0], sides[k, 1, 1]))
    found = np.empty((len(pieces), 2, 2))
    for k, piece in enumerate(pieces):
        found[k] = np.array(piece).reshape(2, 2)
    return found


@numba.njit(cache=True)
def _covered(points: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Which points (k, 2) lie in at least one parallelogram (m, 4, 2)."""
    found = np.zeros(len(points), dtype=np.bool_)
    for q in quads:
        ex, ey = q[1, 0] - q[0, 0], q[1, 1] - q[0, 1]
        fx, fy = q[3, 0] - q[0, 0], q[3, 1] - q[0, 1]
        area = ex * fy - ey * fx
        if abs(area) <= 1e-300:
            continue
        for k in range(len(points)):
            rx, ry = points[k, 0] - q[0, 0], points[k, 1] - q[0, 1]
            s, t = (rx * fy - ry * fx) / area, (ex * ry - ey * rx) / area
            found[k] |= 0 < s < 1 and 0 < t < 1
    return found
