"""Parts of a sheet put together in the plane: the longest contact first, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import affinity

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.drawing.model import Drawing, Part, Region
from wiggleroom.errors import InputError
from wiggleroom.mating.contour_matching import PlanarPose, contact
from wiggleroom.mating.cutting_sheet import CHORD_ERROR, CuttingSheet, check_burn
from wiggleroom.mating.panel_outline import inset
from wiggleroom.mating.planar_search import (
    MIN_CONTACT,
    PlanarSearch,
    first_names,
    grow_body,
    least_squares_poses,
    moved,
)
from wiggleroom.mating.sheet_settings import SETTINGS

Floats = NDArray[np.float64]

_FREE = 1e-9
"""Area [mm2] that two parts may share through rounding, for every mm of the smaller outline's length."""
_FINEST = 1e-6
"""Reliefs are found to this length at least [mm]."""
_SKIN = 2e-6
"""Added to the relief that was found to be enough [mm]."""
_APART = 20.0
"""Bodies are laid side by side this far apart [mm]."""


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
    bodies : tuple of dict of int to PlanarPose
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
    bodies: tuple[dict[int, PlanarPose], ...]
    joints: tuple[PlanarJoint, ...]
    open: dict[int, Floats]
    unplaced: tuple[int, ...]
    burn: float
    relief: float
    doubts: tuple[str, ...]
    notes: tuple[str, ...]
    source: str

    def drawing(self) -> Drawing:
        """Parts that were placed, as cut, where they belong."""
        parts = []
        for row, pose in sorted(((k, v) for body in self.bodies for k, v in body.items()), key=lambda item: item[0]):
            polygon = self.outlines[row]
            holes = tuple(shapely.get_coordinates(ring)[:-1] for ring in polygon.interiors)
            region = Region(shapely.get_coordinates(polygon.exterior)[:-1], holes)
            parts.append(Part(self.names[row], (region,), at=(pose.x, pose.y, pose.angle)))
        return Drawing(tuple(parts), source=self.source)

    @property
    def sure(self) -> bool:
        """Whether all parts are placed in one body and no other place came near any of theirs."""
        return not self.doubts


def assemble_plane(sheet: CuttingSheet, *, burn: float | None = None, context: Context = UNLIMITED) -> PlanarAssembly:
    """Parts of a sheet put together in the plane where bent pieces of their outlines fit.

    Parameters
    ----------
    sheet : CuttingSheet
    burn : float [mm], optional
        By how much outlines were drawn larger; by default what the sheet says, else 0.

    Raises
    ------
    InputError
        If there are fewer than two parts, or the burn uses one up.

    Notes
    -----
    Parts are turned and shifted, never turned over. A part is put where most of its bent outline fits what stands already.
    """
    if len(sheet.panels) < 2:
        parts = "only one part" if sheet.panels else "no parts"
        finding = f"{sheet.source}: has {parts}; at least two are needed to put a puzzle together"
        raise InputError(finding)
    known = burn if burn is not None else sheet.burn
    taken = known or 0.0
    check_burn(sheet, taken)
    drawn = [inset(panel.polygon, taken) for panel in sheet.panels]
    centres = np.array([shapely.get_coordinates(polygon.centroid)[0] for polygon in drawn])
    polygons = [affinity.translate(p, -x, -y) for p, (x, y) in zip(drawn, centres.tolist(), strict=True)]
    names = tuple(panel.name for panel in sheet.panels)
    work = PlanarSearch(polygons, context)
    pressing = max(0.0, -work.clearance)
    notes = [*sheet.notes]
    if abs(work.clearance) > 2 * CHORD_ERROR:  # closed for the search: poses are those of the parts as they are
        notes.append(_clearance_note(sheet.source, work.clearance))
        work = PlanarSearch([inset(polygon, -work.clearance / 2) for polygon in polygons], context)
    left = set(range(len(polygons)))
    bodies: list[dict[int, PlanarPose]] = []
    doubts: list[str] = []
    while (match := work.first(left)) is not None:
        body, said = grow_body(work, match, left, names, context)
        bodies.append(body)
        doubts += said
        left -= set(body)
    bodies = [least_squares_poses(work, body, context=context) for body in bodies]
    bodies, relief, pressed = _relieved(polygons, bodies, work.tolerance + pressing)
    unplaced = sorted({*left, *pressed})
    doubts += [f'part "{names[row]}" overlaps others where its outline fits, and is left out' for row in pressed]
    if relief > 1e-3:
        notes.append(f"{sheet.source}: outlines pressed on each other at rest and are moved inward by {relief:.3g} mm")
    if relief > (CHORD_ERROR if known is not None else SETTINGS.max_burn):
        doubts.append(
            f"parts press on each other as cut: they fit since outlines are moved inward by {relief:.3g} mm more"
        )
    if len(bodies) > 1:
        doubts.append(f"the parts make {len(bodies)} bodies that do not fit each other")
    joints, still = _joints(work, bodies, centres)
    if unplaced:
        doubts.append("not placed: " + first_names([names[row] for row in unplaced]))
    return PlanarAssembly(
        names, tuple(inset(polygon, relief) for polygon in polygons), centres, tuple(_side_by_side(polygons, bodies)),
        tuple(joints), still, tuple(unplaced), taken, relief, tuple(dict.fromkeys(doubts)), tuple(notes), sheet.source,
    )  # fmt: skip


def _clearance_note(source: str, clearance: float) -> str:
    if clearance > 0:
        return f"{source}: outlines that fit leave {clearance:.3g} mm between them; parts are put in the middle"
    return f"{source}: outlines that fit overlap by {-clearance:.3g} mm, as if the width of the cut were added (--burn)"


def _relieved(
    polygons: list[shapely.Polygon], bodies: list[dict[int, PlanarPose]], most: float
) -> tuple[list[dict[int, PlanarPose]], float, list[int]]:
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


def _overlapping(polygons: list[shapely.Polygon], body: dict[int, PlanarPose], relief: float) -> list[tuple[int, int]]:
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
    work: PlanarSearch, bodies: list[dict[int, PlanarPose]], centres: Floats
) -> tuple[list[PlanarJoint], dict[int, Floats]]:
    """Contacts of all bodies, and where bent outlines of placed parts meet nothing inside the hull of their body."""
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
                        PlanarJoint((other, row), len(touch.second) * work.contours[row].step, (middle[0], middle[1]))
                    )
    still = {}
    for body in bodies:
        hull = shapely.union_all([moved(work.contours[row].polygon, pose) for row, pose in body.items()]).convex_hull
        for row, pose in body.items():
            contour = work.contours[row]
            inner = shapely.distance(hull.exterior, shapely.points(pose.of(contour.points))) > work.tolerance
            away = contour.salient & ~met[row] & inner
            if away.sum() * contour.step > MIN_CONTACT * work.window:
                still[row] = contour.points[away] + centres[row]
    return joints, still


def _side_by_side(polygons: list[shapely.Polygon], bodies: list[dict[int, PlanarPose]]) -> list[dict[int, PlanarPose]]:
    """Bodies turned upright and moved apart along x, from the origin on."""
    result, reach = [], 0.0
    for body in bodies:
        upright = _upright([moved(polygons[row], pose) for row, pose in body.items()])
        body = {row: upright.after(pose) for row, pose in body.items()}
        low, bottom, high, _ = shapely.total_bounds([moved(polygons[row], pose) for row, pose in body.items()])
        shift = PlanarPose(reach - low, -bottom)
        reach += high - low + _APART
        result.append({row: shift.after(pose) for row, pose in body.items()})
    return result


def _upright(shapes: list[shapely.Polygon]) -> PlanarPose:
    """Turn that lays the smallest box round the shapes along the axes, the long side across."""
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(shapely.union_all(shapes)))
    sides = np.diff(corners, axis=0)
    longest = sides[int(np.argmax(np.hypot(*sides.T)))]
    return PlanarPose(angle=-float(np.arctan2(longest[1], longest[0])))
