"""The gap of one joint in space: where faces of two parts face each other they move inward by half of it.

A region of a face that moves further in than the rest is cut away, one that moves less is built up: by convex bodies between the depth
of the face and that of the region. Towards another face they end where its own moved plane is, so that corners are mitred; inside a face
they end at right angles to it, in a step.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.facing import joint_reach
from wiggleroom.drawing.model import Drawing, MadeSolid, Part, Plate, Surface
from wiggleroom.spatial.solids.facing_faces import FlatFace, facing_regions, flat_faces
from wiggleroom.spatial.solids.made_solids import drawn_surface
from wiggleroom.spatial.solids.mesh_pieces import convex_pieces
from wiggleroom.spatial.solids.solid_boolean import (
    behind_planes,
    connected_solids,
    is_sound,
    solid_of,
    surface_of,
    union_of,
)

Floats = NDArray[np.float64]

SAME = 1e-8
"""Lines and depths nearer than this share of the size are the same."""
MAX_CELLS = 400
"""A region that needs more convex cells is refused."""
CRUMB = 1e-12
"""Smaller shares of the volume that a cut leaves behind are rounding."""
MARGIN = 0.02
"""How far bodies that are cut away or built up stand out of the face and beyond mitres, as a share of what moves."""


@dataclass(frozen=True, eq=False)
class FacePatch:
    """A region of a face of a part as drawn that has a gap of its own.

    Parameters
    ----------
    face : int
    region : shapely.MultiPolygon [mm]
        In the plane of the face.
    gap : float [mm]
    joint : int
        Number of the joint among those of the drawing.
    """

    face: int
    region: shapely.Geometry
    gap: float
    joint: int


@dataclass(frozen=True, eq=False)
class PatchedSolid:
    """A part as drawn: its faces, and the regions of them that have a gap of their own."""

    faces: tuple[FlatFace, ...]
    patches: tuple[FacePatch, ...]


@dataclass(frozen=True)
class _Side:
    """What a side of a cell ends at: nothing but the rest of the face, or another face, at some depth of that."""

    other: int = -1
    reflex: bool = False
    depth: float = 0.0


def patched_solids(drawing: Drawing) -> tuple[dict[str, PatchedSolid], list[str]]:
    """Parts with a joint that has a gap of its own, by name; and a line for each joint that is none."""
    if not drawing.gaps:
        return {}, []
    part = {p.name: p for p in drawing.parts}
    names = list(dict.fromkeys(name for joint in drawing.gaps for name in joint.parts))
    surface = {name: drawn_surface(part[name]) for name in names}
    faces = {name: tuple(flat_faces(surface[name])) for name in names}
    patches: dict[str, list[FacePatch]] = {name: [] for name in names}
    findings = []
    for number, joint in enumerate(drawing.gaps):
        one, other = joint.parts
        drawn, deep = _apart(part[one], surface[one], part[other], surface[other])
        size = min(float(np.ptp(surface[name].vertices, axis=0).max()) for name in joint.parts)
        reach, slack = joint_reach(drawn, deep, size)
        for name, across in ((one, other), (other, one)):
            seen = flat_faces(_seen(part[name], part[across], surface[across]))
            regions = facing_regions(faces[name], seen, reach, slack)
            if not regions:
                findings.append(f'gaps: parts "{one}" and "{other}" face each other nowhere: name two neighbours')
            for k, region in regions.items():
                kept = [
                    replace(p, region=shapely.difference(p.region, region)) if p.face == k else p for p in patches[name]
                ]  # where regions overlap the last one counts
                patches[name] = [*kept, FacePatch(k, region, joint.gap, number)]
    return {name: PatchedSolid(faces[name], tuple(patches[name])) for name in names}, list(dict.fromkeys(findings))


def _seen(part: Part, other: Part, surface: Surface) -> Surface:
    """The surface of another part in the frame of a part, both at rest."""
    return Surface((surface.vertices @ other.R.T + other.at - part.at) @ part.R, surface.faces)


def _apart(part: Part, surface: Surface, other: Part, across: Surface) -> tuple[float, float]:
    """How far apart two parts are drawn [mm], and how deep they overlap."""
    seen = _seen(part, other, across)
    far = float(np.ptp(np.vstack([surface.vertices, seen.vertices]), axis=0).max())
    one, two = solid_of(surface), solid_of(seen)
    drawn = float(one.min_gap(two, 2 * far))
    common = connected_solids(one ^ two) if drawn == 0 else []
    return drawn, max((6 * c.volume() / c.surface_area() for c in common if c.volume() > 0), default=0.0)


def with_joint_gaps(
    part: Part, made: MadeSolid, patched: PatchedSolid, gap: float, inward: float
) -> tuple[MadeSolid | None, list[str]]:
    """A part as made, with the gaps of its joints; and what is wrong with it.

    Parameters
    ----------
    made : MadeSolid
        The part with its faces moved inward by gap / 2, and `inward` further.
    gap, inward : float [mm]
    """
    if made.overshoot > 0:
        return None, [
            "is covered by larger pieces, as its faces cannot all move inward: a joint of it has no gap of its own"
        ]
    faces = patched.faces
    if any(part.outline_offsets):
        return None, ["has an outline with an offset of its own: a joint of it has no gap of its own"]
    moved = [not isinstance(part.solid, Plate) or abs(f.normal[2]) < 0.5 for f in faces]
    further = np.array([inward - (part.offset if its else 0.0) for its in moved])
    depth = gap / 2 + further
    size = float(np.ptp(made.surface.vertices, axis=0).max())
    far = 4 * float(np.abs(made.surface.vertices).max())
    cells = _Cells(faces, patched.patches, depth, further, SAME * size, far)
    pads: list[Any] = []
    cuts: list[Any] = []
    steps: list[Floats] = []
    for patch in patched.patches:
        own = patch.gap / 2 + float(further[patch.face])
        if abs(own - depth[patch.face]) <= SAME * size:
            continue
        found = cells.of(patch)
        if found is None:
            return None, [
                "meets another one in a region of too many corners for a gap of its own: simpler faces would do"
            ]
        for ring, sides, free in found:
            body, walls = cells.body(patch.face, own, ring, sides, free)
            if body is not None:
                (pads if own < depth[patch.face] else cuts).append(body)
                steps += walls
    if not pads and not cuts:
        return made, []
    solid = solid_of(made.surface)
    lumps = len(connected_solids(solid))
    solid = union_of([solid, *pads]) if pads else solid
    solid = solid - union_of(cuts) if cuts else solid
    complaint = f"at gap {gap:g} and the gaps of its joints: a smaller gap would leave it whole"
    if not is_sound(solid) or solid.volume() <= 0:
        return None, [f"vanishes {complaint}"]
    parts = [piece for piece in connected_solids(solid) if piece.volume() > CRUMB * solid.volume()]
    solid = union_of(parts) if len(parts) > 1 else parts[0]
    if len(parts) > lumps:
        return None, [f"falls into {len(parts)} pieces {complaint}"]
    pieces = convex_pieces(solid)
    if pieces is None:
        return None, [f"cannot be cut into convex pieces exactly {complaint}"]
    still = np.array(steps, dtype=float).reshape(-1, 4)
    return MadeSolid(tuple(pieces), surface_of(solid), made.volume, made.centroid, still), []


@dataclass(frozen=True, eq=False)
class _Cells:
    """Convex cells of regions of faces, and the bodies between two depths over them."""

    faces: tuple[FlatFace, ...]
    patches: tuple[FacePatch, ...]
    depth: Floats
    further: Floats
    near: float
    far: float

    def of(self, patch: FacePatch) -> list[tuple[Floats, list[_Side], list[bool]]] | None:
        """Convex cells as corners (k, 2), counter-clockwise, what their sides end at, and which sides end inside the face.

        Cuts go on along the sides of corners that are not convex, and across sides where what these end at changes.
        """
        todo = list(shapely.get_parts(patch.region))
        rim = patch.region.boundary
        found: list[tuple[Floats, list[_Side], list[bool]]] = []
        while todo:
            polygon = shapely.orient_polygons(todo.pop().simplify(self.near))
            if polygon.area <= self.near * polygon.length:
                continue
            cut = _along_reflex(polygon, self.near)
            sides: list[_Side] = []
            if cut is None:
                ring = _straight(np.asarray(polygon.exterior.coords)[:-1], self.near)
                for start, end in zip(ring, np.roll(ring, -1, axis=0), strict=True):
                    side = self._side(patch.face, start, end)
                    if not isinstance(side, _Side):
                        cut = side
                        break
                    sides.append(side)
            if cut is not None:
                if len(todo) + len(found) > MAX_CELLS:
                    return None
                todo += _halves(polygon, *cut)
                continue
            middles = (ring + np.roll(ring, -1, axis=0)) / 2
            inside = [
                s.other < 0 and rim.distance(shapely.Point(m)) <= self.near for s, m in zip(sides, middles, strict=True)
            ]
            found.append((ring, sides, inside))
        return found

    def _side(self, k: int, start: Floats, end: Floats) -> _Side | tuple[Floats, Floats]:
        """What a side of a cell on face k ends at; where that changes along it, a point and a direction to cut at."""
        length = float(np.linalg.norm(end - start))
        along = (end - start) / length
        across = np.array([-along[1], along[0]])
        borders = [
            b for b in self.faces[k].borders
            if max(abs((b.start - start) @ across), abs((b.end - start) @ across)) <= self.near
        ]  # fmt: skip
        at = [float((x - start) @ along) for b in borders for x in (b.start, b.end)]
        for b in borders:
            for patch in self.patches:
                if patch.face == b.other:
                    corners = self._from(b.other, k, shapely.get_coordinates(patch.region)) - start
                    at += (corners @ along)[np.abs(corners @ across) <= self.near].tolist()
        stops = np.unique([0.0, *(t for t in at if self.near < t < length - self.near), length])
        stops = stops[np.concatenate([[True], np.diff(stops) > self.near])]
        kinds = [self._end(k, borders, start + along * (s + e) / 2) for s, e in pairwise(stops)]
        for stop, (one, other) in zip(stops[1:], pairwise(kinds), strict=False):
            if one != other:
                return start + along * stop, across
        return kinds[0]

    def _end(self, k: int, borders: Sequence[Any], at: Floats) -> _Side:
        """What a region ends at, at a point of its border."""
        for b in borders:
            if shapely.LineString([b.start, b.end]).distance(shapely.Point(at)) <= self.near:
                depth = float(self.depth[b.other])
                there = shapely.Point(self._from(k, b.other, at[None])[0])
                for patch in self.patches:
                    if patch.face == b.other and patch.region.distance(there) <= self.near:
                        depth = patch.gap / 2 + float(self.further[b.other])
                return _Side(b.other, b.reflex, depth)
        return _Side()

    def _from(self, one: int, other: int, points: Floats) -> Floats:
        """Points (k, 2) of one face in the coordinates of another, if they lie in both."""
        f, g = self.faces[one], self.faces[other]
        return np.asarray((points @ f.frame + f.normal * f.level) @ g.frame.T)

    def body(
        self, k: int, own: float, ring: Floats, sides: Iterable[_Side], free: Iterable[bool]
    ) -> tuple[Any | None, list[Floats]]:
        """Solid of the library over a cell of face k, between the depth of the face and its own; and its steps (4,) inside the face."""
        face, depth = self.faces[k], float(self.depth[k])
        cut, margin = own > depth, abs(own - depth)
        high = depth - MARGIN * margin if cut else own
        low = own if cut else depth + margin
        rows = [np.array([*face.normal, face.level - high]), np.array([*-face.normal, low - face.level])]
        steps = []
        origin = face.normal * face.level
        for corner, after, side, step in zip(ring, np.roll(ring, -1, axis=0), sides, free, strict=True):
            if side.other < 0:
                out = np.array([after[1] - corner[1], corner[0] - after[0]]) @ face.frame
                out /= np.linalg.norm(out)
                rows.append(np.array([*out, out @ (origin + corner @ face.frame)]))
                if step:
                    steps.append(-rows[-1] if cut else rows[-1])
                continue
            # the mitre: a plane through the edges where both faces meet before and after
            n, level, before = (
                self.faces[side.other].normal,
                self.faces[side.other].level,
                float(self.depth[side.other]),
            )
            mitre = (side.depth - before) * face.normal - (own - depth) * n
            across = (own - depth) * (level - before) - (side.depth - before) * (face.level - depth)
            sign = (1.0 if cut else -1.0) * (-1.0 if side.reflex else 1.0) / float(np.linalg.norm(mitre))
            rows.append(np.array([*(-sign * mitre), sign * across + MARGIN * margin]))
            if side.reflex:
                rows.append(np.array([*-n, side.depth + (0.0 if cut else margin) - level]))
            else:
                rows.append(np.array([*n, level - (min(before, side.depth) - MARGIN * margin if cut else side.depth)]))
        planes = np.array(rows)
        return behind_planes(planes[:, :3], planes[:, 3], self.far), steps


def _along_reflex(polygon: shapely.Polygon, near: float) -> tuple[Floats, Floats] | None:
    """A corner that is not convex, and the direction of a side there; None where all are."""
    for loop in (polygon.exterior, *polygon.interiors):
        ring = _straight(np.asarray(loop.coords)[:-1], near)
        before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
        turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        bad = np.flatnonzero(turn < 0)
        if len(bad):
            k = int(bad[0])
            return ring[k], before[k] / np.linalg.norm(before[k])
    return None


def _straight(ring: Floats, near: float) -> Floats:
    """The ring without corners that lie on the line between their neighbours."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return ring[np.abs(turn) > near * np.linalg.norm(after + before, axis=1)]


def _halves(polygon: shapely.Polygon, at: Floats, along: Floats) -> list[shapely.Polygon]:
    """Both sides of a line through a polygon."""
    far = 4 * float(np.abs(np.subtract(polygon.bounds, [*at, *at])).max())
    across = far * np.array([-along[1], along[0]])
    ends = at - far * along, at + far * along
    found = []
    for side in (across, -across):
        half = shapely.Polygon([*ends, ends[1] + side, ends[0] + side])
        found += [p for p in shapely.get_parts(shapely.intersection(polygon, half)) if p.geom_type == "Polygon"]
    return found
