"""Parts of a sheet put together in the plane: the longest contact first, and how sure that is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import affinity

from wiggleroom.errors import Stop, go_on
from wiggleroom.mating.contour_matching import (
    Contact,
    ContourMatch,
    Pose,
    SampledContour,
    clearance,
    closest,
    contact,
    contour_matches,
    sampled,
)
from wiggleroom.mating.cutting_sheet import FLATTEN, CuttingSheet
from wiggleroom.mating.flanks import inset

Floats = NDArray[np.float64]

_TOLERANCE = 0.01
"""Outlines that belong together may miss each other by this share of a part's usual size."""
_KEPT = 0.7
"""A finer tolerance is taken while most parts keep this share of their best contact."""
_WINDOW = 0.05
"""Arc to either side of a sample that a descriptor sees, as share of the usual outline."""
_SAMPLES = 240
"""On an outline of usual length."""
_LEAST = 1.5
"""Bent contact below this many windows puts nothing together."""
_RIVAL = 0.9
"""Another place that has this share of the contact makes an assembly doubtful."""
_FREE = 1e-9
"""Area [mm2] that two parts may share through rounding, for every mm of the smaller outline's length."""
_FINEST = 1e-6
_SKIN = 2e-6
"""Added to the relief that was found to be enough [mm]."""
_APART = 20.0
_REFINEMENTS = 6


@dataclass(frozen=True, eq=False)
class PlanarJoint:
    """Two parts whose outlines fit.

    Parameters
    ----------
    parts : (int, int)
    length : float [mm]
        Of the outline along which they touch.
    on_sheet : ((2,), (2,)) float64 [mm]
        Middle of the contact on the one and the other, where the sheet shows it.
    """

    parts: tuple[int, int]
    length: float
    on_sheet: tuple[Floats, Floats]


@dataclass(frozen=True, eq=False)
class PlanarAssembly:
    """What became of a sheet in the plane.

    Parameters
    ----------
    names : tuple of str
    outlines : tuple of shapely.Polygon [mm]
        As cut and relieved, centroids at the origin.
    centres : (n, 2) float64 [mm]
        Centroids on the sheet.
    bodies : tuple of dict of int to Pose
        Parts placed, body beside body.
    joints : tuple of PlanarJoint
    open : dict of int to (k, 2) float64 [mm]
        By part, where on the sheet a bent outline meets nothing.
    unplaced : tuple of int
    burn, relief : float [mm]
        Taken off every outline: as the cut does, and so that nothing presses at rest.
    doubts, notes : tuple of str
    source : str
    """

    names: tuple[str, ...]
    outlines: tuple[shapely.Polygon, ...]
    centres: Floats
    bodies: tuple[dict[int, Pose], ...]
    joints: tuple[PlanarJoint, ...]
    open: dict[int, Floats]
    unplaced: tuple[int, ...]
    burn: float
    relief: float
    doubts: tuple[str, ...]
    notes: tuple[str, ...]
    source: str

    @property
    def sure(self) -> bool:
        """Whether all parts are placed in one body and no other place came near any of theirs."""
        return not self.doubts


@dataclass(frozen=True)
class _Choice:
    """A place for one part and the bent contact that it has there."""

    row: int
    pose: Pose
    salient: float


class _Sheet:
    """The parts, their contours and the poses in which two of them fit; caches what is asked again."""

    def __init__(self, polygons: list[shapely.Polygon]) -> None:
        lengths = [polygon.length for polygon in polygons]
        usual = float(np.median(lengths))
        self.tolerance = _TOLERANCE * float(np.median([np.sqrt(polygon.convex_hull.area) for polygon in polygons]))
        self.window = _WINDOW * usual
        self.contours: list[SampledContour] = [sampled(polygon, usual / _SAMPLES, self.window) for polygon in polygons]
        found = contour_matches(self.contours, self.tolerance)
        self.clearance = self._clearance(found)
        self.tolerance = self._fit(found)
        self.cores = [inset(polygon, self.tolerance) for polygon in polygons]
        self.matches: dict[int, list[tuple[int, Pose, ContourMatch]]] = {}
        for match in self._refined(found):
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

    def _fit(self, found: list[ContourMatch]) -> float:
        """How closely [mm] outlines that belong together fit on this sheet: as fine as keeps most parts' best contact."""
        loose = self._best(found, self.tolerance)
        tolerance = self.tolerance
        while loose and tolerance > 2 * FLATTEN:
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

    def _refined(self, found: list[ContourMatch]) -> list[ContourMatch]:
        """Matches fitted at the sheet's tolerance."""
        refined = []
        for match in found:
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
            if match.salient < _LEAST * self.window:
                return None
            a, b = match.parts
            if not self.overlap({a: Pose()}, b, match.pose):
                return match
        return None

    def overlap(self, body: dict[int, Pose], row: int, pose: Pose) -> bool:
        """Whether a part overlaps a body by more than the tolerance."""
        core = moved(self.cores[row], pose)
        return any(core.intersects(moved(self.cores[other], place)) for other, place in body.items())

    def touching(self, body: dict[int, Pose], row: int, pose: Pose) -> dict[int, Contact]:
        """Contacts of a part with the parts of a body."""
        reach = self.tolerance + self.contours[0].step
        box = shapely.box(*_grown(moved(self.contours[row].polygon, pose).bounds, reach))
        found = {}
        for other, place in body.items():
            if not box.intersects(shapely.box(*moved(self.contours[other].polygon, place).bounds)):
                continue
            touch = contact(self.contours[other], self.contours[row], place.inverse().after(pose), self.tolerance)
            if len(touch.first):
                found[other] = touch
        return found

    def nearest(self, row: int, pose: Pose, points: Floats) -> Floats:
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

    def choices(self, body: dict[int, Pose], newest: int, left: set[int]) -> list[_Choice]:
        """Places of loose parts beside the newest part of a body."""
        return [
            _Choice(row, body[newest].after(pose), match.salient)
            for row, pose, match in self.matches.get(newest, [])
            if row in left
        ]


def moved(polygon: shapely.Polygon, pose: Pose) -> shapely.Polygon:
    """Polygon moved by a pose."""
    (a, b), (c, d) = pose.rotation.tolist()
    return affinity.affine_transform(polygon, [a, b, c, d, pose.x, pose.y])


def _grown(bounds: tuple[float, float, float, float], by: float) -> tuple[float, float, float, float]:
    return bounds[0] - by, bounds[1] - by, bounds[2] + by, bounds[3] + by


def assemble_plane(
    sheet: CuttingSheet,
    *,
    burn: float | None = None,
    stop: Stop | None = None,
    progress: Callable[[int], None] | None = None,
) -> PlanarAssembly:
    """Parts of a sheet put together in the plane where bent pieces of their outlines fit.

    Parameters
    ----------
    sheet : CuttingSheet
    burn : float [mm], optional
        By how much outlines were drawn larger; by default what the sheet says, else 0.

    Notes
    -----
    Parts are turned and shifted, never turned over. A part is put where most of its bent outline fits what stands already.
    """
    taken = burn if burn is not None else sheet.burn or 0.0
    drawn = [inset(panel.polygon, taken) for panel in sheet.panels]
    centres = np.array([shapely.get_coordinates(polygon.centroid)[0] for polygon in drawn])
    polygons = [affinity.translate(p, -x, -y) for p, (x, y) in zip(drawn, centres.tolist(), strict=True)]
    names = tuple(panel.name for panel in sheet.panels)
    work = _Sheet(polygons)
    notes = [*sheet.notes]
    if abs(work.clearance) > 2 * FLATTEN:  # closed for the search: poses are those of the parts as they are
        notes.append(_clearance_note(sheet.source, work.clearance))
        work = _Sheet([inset(polygon, -work.clearance / 2) for polygon in polygons])
    left = set(range(len(polygons)))
    bodies: list[dict[int, Pose]] = []
    doubts: list[str] = []
    while (match := work.first(left)) is not None:
        body, said = _grow(work, match, left, names, stop, progress)
        bodies.append(body)
        doubts += said
        left -= set(body)
    bodies = [_settled(work, body) for body in bodies]
    bodies, relief, pressed = _relieved(polygons, bodies, work.tolerance)
    unplaced = sorted({*left, *pressed})
    doubts += [f'part "{names[row]}" overlaps others where its outline fits, and is left out' for row in pressed]
    if relief > 1e-3:
        notes.append(f"{sheet.source}: outlines pressed on each other at rest and are moved inward by {relief:.3g} mm")
    if len(bodies) > 1:
        doubts.append(f"the parts make {len(bodies)} bodies that do not fit each other")
    joints, still = _joints(work, bodies, centres)
    if unplaced:
        doubts.append("not placed: " + _listed([names[row] for row in unplaced]))
    return PlanarAssembly(
        names, tuple(inset(polygon, relief) for polygon in polygons), centres, tuple(_side_by_side(polygons, bodies)),
        tuple(joints), still, tuple(unplaced), taken, relief, tuple(dict.fromkeys(doubts)), tuple(notes), sheet.source,
    )  # fmt: skip


def _clearance_note(source: str, clearance: float) -> str:
    if clearance > 0:
        return f"{source}: outlines that fit leave {clearance:.3g} mm between them; parts are put in the middle"
    return f"{source}: outlines that fit overlap by {-clearance:.3g} mm, as if the width of the cut were added (--burn)"


def _listed(names: list[str]) -> str:
    return ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")


def _grow(
    work: _Sheet,
    match: ContourMatch,
    left: set[int],
    names: tuple[str, ...],
    stop: Stop | None,
    progress: Callable[[int], None] | None,
) -> tuple[dict[int, Pose], list[str]]:
    """A body of the parts that are left, from its first two on, and why it may be wrong."""
    a, b = match.parts
    body = {a: Pose()}
    left = left - {a}
    doubts: list[str] = []
    choices = work.choices(body, a, left)
    while choices:
        go_on(stop)
        choices = [choice for choice in choices if choice.row in left]
        best: list[_Choice] = []
        for choice in sorted(choices, key=lambda choice: -choice.salient):
            touching = work.touching(body, choice.row, choice.pose)
            salient = sum(touch.salient for touch in touching.values())
            if best and salient < _RIVAL * best[0].salient:
                continue
            if salient >= _LEAST * work.window and not work.overlap(body, choice.row, choice.pose):
                best = sorted([*best, _Choice(choice.row, choice.pose, salient)], key=lambda c: -c.salient)
        if not best:
            break
        chosen = best[0]
        rivals = [c for c in best[1:] if c.salient >= _RIVAL * chosen.salient and _conflict(work, chosen, c)]
        if rivals:
            others = dict.fromkeys(names[c.row] for c in rivals)
            doubts.append(f'"{names[chosen.row]}" fits in more than one way, or {_listed([*others])} as well there')
        body[chosen.row] = _pressed_on(work, body, chosen)
        left = left - {chosen.row}
        choices = [c for c in choices if c.row in left] + work.choices(body, chosen.row, left)
        if progress:
            progress(len(body))
    return body, doubts


def _conflict(work: _Sheet, one: _Choice, other: _Choice) -> bool:
    """Whether two choices exclude each other and end in another assembly."""
    shapes = [moved(work.contours[choice.row].polygon, choice.pose) for choice in (one, other)]
    if shapes[0].symmetric_difference(shapes[1]).area < 2 * work.tolerance * shapes[0].length:
        return False  # congruent parts in the same place, or one part turned into itself
    if one.row == other.row:
        return True
    cores = [moved(work.cores[choice.row], choice.pose) for choice in (one, other)]
    return bool(cores[0].intersects(cores[1]))


def _pressed_on(work: _Sheet, body: dict[int, Pose], choice: _Choice) -> Pose:
    """Pose of a choice after it is fitted to all its neighbours."""
    return _settled(work, body | {choice.row: choice.pose}, only=choice.row)[choice.row]


def _settled(work: _Sheet, body: dict[int, Pose], only: int | None = None) -> dict[int, Pose]:
    """Poses by least squares over all contacts (Gauss-Newton); the first part stays, or all but one."""
    rows = list(body)
    free = [only] if only is not None else rows[1:]
    place = {row: k for k, row in enumerate(free)}
    for _ in range(_REFINEMENTS):
        lines: list[Floats] = []
        wanted: list[Floats] = []
        for k, row in enumerate(rows):
            others = {other: body[other] for other in rows[:k]}
            if only is not None and row != only:
                others = {only: body[only]} if rows.index(only) < k else {}
            for other, touch in work.touching(others, row, body[row]).items():
                points = body[row].of(work.contours[row].points[touch.second])
                tangents = work.contours[other].tangents[touch.first] @ body[other].rotation.T
                normals = np.column_stack([-tangents[:, 1], tangents[:, 0]])
                there = work.nearest(other, body[other], points) if only is None else body[other].of(
                    work.contours[other].points[touch.first]
                )
                matrix = np.zeros((len(points), 3 * len(free)))
                for sign, part, at in ((1.0, row, points), (-1.0, other, there)):
                    if part in place:
                        arm = at - (body[part].x, body[part].y)
                        turn = arm[:, 0] * normals[:, 1] - arm[:, 1] * normals[:, 0]
                        matrix[:, 3 * place[part] : 3 * place[part] + 3] = sign * np.column_stack([normals, turn])
                lines.append(matrix)
                wanted.append(np.einsum("nd,nd->n", there - points, normals))
        if not lines:
            return body
        whole, right = np.concatenate(lines), np.concatenate(wanted)
        light = 1e-9 * len(whole) * np.diag(np.tile([1.0, 1.0, work.window**2], len(free)))
        step = np.linalg.solve(whole.T @ whole + light, whole.T @ right).reshape(-1, 3)
        body = body | {
            row: Pose(body[row].x + dx, body[row].y + dy, body[row].angle + turn)
            for row, (dx, dy, turn) in zip(free, step.tolist(), strict=True)
        }
        if np.abs(step[:, :2]).max() < 1e-10:
            break
    return body


def _relieved(
    polygons: list[shapely.Polygon], bodies: list[dict[int, Pose]], most: float
) -> tuple[list[dict[int, Pose]], float, list[int]]:
    """Bodies in which no parts overlap, the relief that takes [mm], and parts that had to be left out."""
    result, relief, pressed = [], 0.0, []
    for body in bodies:
        while len(body) > 1:
            bad = _overlapping(polygons, body, most)
            if not bad:
                break
            rows = [row for pair in bad for row in pair]
            worst = max(sorted(body), key=lambda row: (rows.count(row), -polygons[row].area))
            pressed.append(worst)
            body = {row: pose for row, pose in body.items() if row != worst}
        if len(body) < 2:
            pressed += body
            continue
        low, high = 0.0, most
        if _overlapping(polygons, body, 0.0):
            while high - low > max(_FINEST, 1e-3 * high):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if _overlapping(polygons, body, middle) else (low, middle)
            relief = max(relief, high + _SKIN)
        result.append(body)
    return result, relief, pressed


def _overlapping(polygons: list[shapely.Polygon], body: dict[int, Pose], relief: float) -> list[tuple[int, int]]:
    """Pairs of parts that share area when all outlines are moved inward."""
    rows = list(body)
    shapes = [moved(inset(polygons[row], relief), body[row]) for row in rows]
    tree = shapely.STRtree(shapes)
    found = []
    for i, j in tree.query(shapes, predicate="intersects").T.tolist():
        if i < j:
            least = min(shapes[i].length, shapes[j].length)
            if shapely.intersection(shapes[i], shapes[j]).area > _FREE * least:
                found.append((rows[i], rows[j]))
    return found


def _joints(
    work: _Sheet, bodies: list[dict[int, Pose]], centres: Floats
) -> tuple[list[PlanarJoint], dict[int, Floats]]:
    """Contacts of all bodies, and where bent outlines of placed parts meet nothing."""
    joints = []
    met = {row: np.zeros(len(work.contours[row].points), dtype=bool) for body in bodies for row in body}
    for body in bodies:
        rows = list(body)
        for k, row in enumerate(rows):
            for other, touch in work.touching({o: body[o] for o in rows[:k]}, row, body[row]).items():
                met[row][touch.second] = met[other][touch.first] = True
                back = contact(
                    work.contours[row], work.contours[other], body[row].inverse().after(body[other]), work.tolerance
                )
                met[other][back.second] = True
                if len(touch.second) * work.contours[row].step >= work.window:
                    middle = [
                        work.contours[part].points[at].mean(axis=0) + centres[part]
                        for part, at in ((other, touch.first), (row, touch.second))
                    ]
                    joints.append(
                        PlanarJoint(
                            (other, row), len(touch.second) * work.contours[row].step, (middle[0], middle[1])
                        )
                    )
    still = {}
    for row, flags in met.items():
        away = work.contours[row].salient & ~flags
        if away.sum() * work.contours[row].step > _LEAST * work.window:
            still[row] = work.contours[row].points[away] + centres[row]
    return joints, still


def _side_by_side(polygons: list[shapely.Polygon], bodies: list[dict[int, Pose]]) -> list[dict[int, Pose]]:
    """Bodies moved apart along x, from the origin on."""
    result, reach = [], 0.0
    for body in bodies:
        low, bottom, high, _ = shapely.total_bounds([moved(polygons[row], pose) for row, pose in body.items()])
        shift = Pose(reach - low, -bottom)
        reach += high - low + _APART
        result.append({row: shift.after(pose) for row, pose in body.items()})
    return result
