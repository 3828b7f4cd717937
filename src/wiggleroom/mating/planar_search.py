"""Search for the places of parts in the plane: the longest contact first, neighbours fitted by least squares."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import affinity

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.mating.contour_matching import (
    ContourContact,
    ContourMatch,
    PlanarPose,
    SampledContour,
    clearance,
    closest,
    contact,
    contour_matches,
    sampled,
)
from wiggleroom.mating.cutting_sheet import CHORD_ERROR
from wiggleroom.mating.panel_outline import inset

Floats = NDArray[np.float64]

_TOLERANCE = 0.01
"""Outlines that belong together may miss each other by this share of a part's usual size."""
_KEPT = 0.7
"""A finer tolerance is taken while most parts keep this share of their best contact."""
_WINDOW = 0.05
"""Arc to either side of a sample that a descriptor sees, as share of the usual outline."""
_SAMPLES = 240
"""On an outline of usual length."""
MIN_CONTACT = 1.5
"""Bent contact below this many windows puts nothing together."""
_RIVAL = 0.9
"""Another place that has this share of the contact makes an assembly doubtful."""
_ASIDE = 0.05
"""A sample faces a neighbour whose nearest point is aside by no more than this share of the tolerance."""
_REFINEMENTS = 30
"""Steps of the least squares at most."""


@dataclass(eq=False)
class _Candidate:
    """A place for one part beside a body that grows.

    Parameters
    ----------
    row : int
    pose : PlanarPose
    match : float [mm]
        Bent contact with the part beside which it was found.
    salient : float [mm]
        Bent contact with all parts of the body.
    clear : int
        So many of the body's first parts it is known not to overlap.
    overlaps : bool
        Whether it overlaps one of the body.
    """

    row: int
    pose: PlanarPose
    match: float
    salient: float
    clear: int = 0
    overlaps: bool = False


class PlanarSearch:
    """The parts, their contours and the poses in which two of them fit; caches what is asked again."""

    def __init__(self, polygons: list[shapely.Polygon], context: Context = UNLIMITED) -> None:
        lengths = [polygon.length for polygon in polygons]
        usual = float(np.median(lengths))
        self.tolerance = _TOLERANCE * float(np.median([np.sqrt(polygon.convex_hull.area) for polygon in polygons]))
        self.window = _WINDOW * usual
        self.contours: list[SampledContour] = [sampled(polygon, usual / _SAMPLES, self.window) for polygon in polygons]
        found = contour_matches(self.contours, self.tolerance, context)
        self.clearance = self._clearance(found)
        self.tolerance = self._fit(found, context)
        self.cores = [inset(polygon, self.tolerance) for polygon in polygons]
        self.matches: dict[int, list[tuple[int, PlanarPose, ContourMatch]]] = {}
        for match in self._refined(found, context):
            a, b = match.parts
            self.matches.setdefault(a, []).append((b, match.pose, match))
            self.matches.setdefault(b, []).append((a, match.pose.inverse(), match))

    def _clearance(self, found: list[ContourMatch]) -> float:
        """Gap [mm] that outlines that belong together leave to each other as they are drawn."""
        best: dict[int, ContourMatch] = {}
        for match in found:
            for row in match.parts:
                if row not in best or match.salient > best[row].salient:
                    best[row] = match
        gaps = [
            clearance(self.contours[match.parts[0]], self.contours[match.parts[1]], match.pose, self.tolerance)
            for match in set(best.values())
        ]
        return float(np.median(gaps)) if gaps else 0.0

    def _fit(self, found: list[ContourMatch], context: Context) -> float:
        """How closely [mm] outlines that belong together fit on this sheet: as fine as keeps most parts' best contact."""
        loose = self._best(found, self.tolerance)
        tolerance = self.tolerance
        while loose and tolerance > 2 * CHORD_ERROR:
            context.go_on()
            finer = self._best(found, 0.5 * tolerance)
            if np.median([finer[row] / loose[row] for row in loose]) < _KEPT:
                break
            tolerance *= 0.5
        return tolerance

    def _best(self, found: list[ContourMatch], tolerance: float) -> dict[int, float]:
        """Longest bent contact of every part."""
        best: dict[int, float] = {}
        for match in found:
            a, b = match.parts
            salient = contact(self.contours[a], self.contours[b], match.pose, tolerance).salient
            for row in (a, b):
                best[row] = max(best.get(row, 0.0), salient)
        return {row: salient for row, salient in best.items() if salient}

    def _refined(self, found: list[ContourMatch], context: Context) -> list[ContourMatch]:
        """Matches fitted at the sheet's tolerance."""
        refined = []
        for match in found:
            context.go_on()
            a, b = (self.contours[row] for row in match.parts)
            pose = closest(a, b, match.pose, self.tolerance)
            salient = contact(a, b, pose, self.tolerance).salient
            if salient:
                refined.append(ContourMatch(match.parts, pose, salient))
        return refined

    def first(self, left: set[int]) -> ContourMatch | None:
        """The two parts with the longest bent contact that do not overlap."""
        found = {match for row in left for other, _, match in self.matches.get(row, []) if other in left}
        for match in sorted(found, key=lambda match: (-match.salient, match.parts)):
            if match.salient < MIN_CONTACT * self.window:
                return None
            a, b = match.parts
            if not self.overlap({a: PlanarPose()}, b, match.pose):
                return match
        return None

    def overlap(self, body: dict[int, PlanarPose], row: int, pose: PlanarPose) -> bool:
        """Whether a part overlaps a body by more than the tolerance."""
        near = self._near(body, row, pose)
        core = moved(self.cores[row], pose)
        return any(core.intersects(moved(self.cores[other], body[other])) for other in near)

    def touching(self, body: dict[int, PlanarPose], row: int, pose: PlanarPose) -> dict[int, ContourContact]:
        """Contacts of a part with the parts of a body."""
        found = {}
        for other in self._near(body, row, pose):
            place = body[other].inverse().after(pose)
            touch = contact(self.contours[other], self.contours[row], place, self.tolerance)
            if len(touch.first):
                found[other] = touch
        return found

    def salient(self, body: dict[int, PlanarPose], row: int, pose: PlanarPose) -> float:
        """Bent contact of a part with a body [mm]."""
        return sum(touch.salient for touch in self.touching(body, row, pose).values())

    def _near(self, body: dict[int, PlanarPose], row: int, pose: PlanarPose) -> list[int]:
        """Parts of a body whose circles come near that of a part."""
        reach = self.contours[row].radius + self.tolerance + self.contours[0].step
        return [
            other
            for other, place in body.items()
            if np.hypot(place.x - pose.x, place.y - pose.y) < reach + self.contours[other].radius
        ]

    def nearest(self, row: int, pose: PlanarPose, points: Floats) -> Floats:
        """Points (n, 2) of a placed part's outline, exactly, that are nearest to others."""
        local = shapely.points(pose.inverse().of(points))
        polygon = self.contours[row].polygon
        rings = [polygon.exterior, *polygon.interiors]
        ring = np.argmin([shapely.distance(ring, local) for ring in rings], axis=0)
        found = np.empty((len(points), 2))
        for k, line in enumerate(rings):
            here = ring == k
            places = shapely.line_locate_point(line, local[here])
            found[here] = shapely.get_coordinates(shapely.line_interpolate_point(line, places))
        return pose.of(found)

    def candidates(self, body: dict[int, PlanarPose], newest: int, left: set[int]) -> list[_Candidate]:
        """Places of loose parts beside the newest part of a body."""
        found = []
        for row, pose, match in self.matches.get(newest, []):
            if row in left:
                place = body[newest].after(pose)
                found.append(_Candidate(row, place, match.salient, self.salient(body, row, place)))
        return found


def moved(polygon: shapely.Polygon, pose: PlanarPose) -> shapely.Polygon:
    """Polygon moved by a pose."""
    (a, b), (c, d) = pose.rotation.tolist()
    return affinity.affine_transform(polygon, [a, b, c, d, pose.x, pose.y])


def grow_body(
    work: PlanarSearch, match: ContourMatch, left: set[int], names: tuple[str, ...], context: Context
) -> tuple[dict[int, PlanarPose], list[str]]:
    """A body of the parts that are left, from its first two on, and why it may be wrong."""
    newest = match.parts[0]
    body = {newest: PlanarPose()}
    left = left - {newest}
    doubts: list[str] = []
    candidates = work.candidates(body, newest, left)
    while best := _longest_contacts(work, body, candidates, context):
        chosen = best[0]
        rivals = [c for c in best[1:] if _conflict(work, chosen, c)]
        if rivals:
            doubts.append(_doubt(names, chosen.row, [c.row for c in rivals]))
        newest = chosen.row
        body[newest] = _pressed_on(work, body, chosen)
        left = left - {newest}
        candidates = [c for c in candidates if c.row in left and not c.overlaps]
        for candidate in candidates:
            context.go_on()
            candidate.salient += work.salient({newest: body[newest]}, candidate.row, candidate.pose)
        candidates += work.candidates(body, newest, left)
        context.tell(len(body))
    return body, doubts


def _longest_contacts(
    work: PlanarSearch, body: dict[int, PlanarPose], candidates: list[_Candidate], context: Context
) -> list[_Candidate]:
    """Candidates that overlap nothing: the one with the longest contact and those that come near it."""
    best: list[_Candidate] = []
    rows = list(body)
    for candidate in sorted(candidates, key=lambda c: (-c.salient, -c.match)):
        context.go_on()
        if candidate.salient < (_RIVAL * best[0].salient if best else MIN_CONTACT * work.window):
            break
        newer = {row: body[row] for row in rows[candidate.clear :]}
        if work.overlap(newer, candidate.row, candidate.pose):
            candidate.overlaps = True
        else:
            candidate.clear = len(rows)
            best.append(candidate)
    return best


def _conflict(work: PlanarSearch, one: _Candidate, other: _Candidate) -> bool:
    """Whether two candidates exclude each other and end in another assembly."""
    shapes = [moved(work.contours[c.row].polygon, c.pose) for c in (one, other)]
    if shapes[0].symmetric_difference(shapes[1]).area < 2 * work.tolerance * shapes[0].length:
        return False  # congruent parts in the same place, or one part turned into itself
    if one.row == other.row:
        return True
    cores = [moved(work.cores[c.row], c.pose) for c in (one, other)]
    return bool(cores[0].intersects(cores[1]))


def _doubt(names: tuple[str, ...], row: int, rivals: list[int]) -> str:
    """Why the place of a part is not sure: it has rivals of its own, others have, or both."""
    ways = ["in more than one way"] if row in rivals else []
    others = [names[other] for other in dict.fromkeys(rivals) if other != row]
    if others:
        ways.append(f"where {first_names(others)} would fit as well")
    return f'"{names[row]}" fits {", and ".join(ways)}'


def _pressed_on(work: PlanarSearch, body: dict[int, PlanarPose], chosen: _Candidate) -> PlanarPose:
    """PlanarPose of a candidate after it is fitted to all its neighbours."""
    return least_squares_poses(work, body | {chosen.row: chosen.pose}, only=chosen.row)[chosen.row]


def least_squares_poses(
    work: PlanarSearch, body: dict[int, PlanarPose], only: int | None = None, context: Context = UNLIMITED
) -> dict[int, PlanarPose]:
    """Poses by least squares over all contacts (Gauss-Newton); the first part stays, or all but one."""
    rows = list(body)
    free = [only] if only is not None else rows[1:]
    place = {row: slice(3 * k, 3 * k + 3) for k, row in enumerate(free)}
    for _ in range(_REFINEMENTS):
        normal, right, count = np.zeros((3 * len(free), 3 * len(free))), np.zeros(3 * len(free)), 0
        for row in free if only is not None else rows:
            context.go_on()
            others = {o: body[o] for o in (rows if only is not None else rows[: rows.index(row)]) if o != row}
            for other, touch in work.touching(others, row, body[row]).items():
                points, there, normals = _facing(work, body, (other, row), touch, exact=only is None)
                missing = np.einsum("nd,nd->n", there - points, normals)
                sides = [
                    (place[part], sign * _moves(body[part], at, normals))
                    for sign, part, at in ((1.0, row, points), (-1.0, other, there))
                    if part in place
                ]
                for mine, jacobian in sides:
                    right[mine] += jacobian.T @ missing
                    for theirs, beside in sides:
                        normal[mine, theirs] += jacobian.T @ beside
                count += len(points)
        if not count:
            return body
        light = 1e-9 * count * np.diag(np.tile([1.0, 1.0, work.window**2], len(free)))
        step = np.linalg.solve(normal + light, right).reshape(-1, 3)
        body = body | {
            row: PlanarPose(body[row].x + dx, body[row].y + dy, body[row].angle + turn)
            for row, (dx, dy, turn) in zip(free, step.tolist(), strict=True)
        }
        if np.abs(step[:, :2]).max() < 1e-10:
            break
    return body


def _facing(
    work: PlanarSearch, body: dict[int, PlanarPose], pair: tuple[int, int], touch: ContourContact, *, exact: bool
) -> tuple[Floats, Floats, Floats]:
    """Samples of the second part of a pair, points of the first that they should lie on, and normals there, each (n, 2)."""
    other, row = pair
    points = body[row].of(work.contours[row].points[touch.second])
    tangents = work.contours[other].tangents[touch.first] @ body[other].rotation.T
    normals = np.column_stack([-tangents[:, 1], tangents[:, 0]])
    if not exact:
        return points, body[other].of(work.contours[other].points[touch.first]), normals
    there = work.nearest(other, body[other], points)
    # beyond a corner of the neighbour nothing is asked of a sample
    facing = np.abs(np.einsum("nd,nd->n", there - points, tangents)) <= _ASIDE * work.tolerance
    return points[facing], there[facing], normals[facing]


def _moves(pose: PlanarPose, points: Floats, normals: Floats) -> Floats:
    """How far points (n, 2) of a part go along normals as x, y and angle of its pose change, (n, 3)."""
    arm = points - (pose.x, pose.y)
    return np.column_stack([normals, arm[:, 0] * normals[:, 1] - arm[:, 1] * normals[:, 0]])


def first_names(names: list[str]) -> str:
    """The first few names, and how many more there are."""
    return ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
