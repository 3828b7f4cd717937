"""Judge of an assembly file in space that shares nothing with the program: booleans of solids built from the file alone."""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass
from pathlib import Path

import manifold3d
import numpy as np
import shapely


@dataclass(frozen=True)
class Judged:
    """What an assembly file holds.

    Parameters
    ----------
    names : tuple of str
    overlap : float [mm3]
        Material that two plates share.
    touching : set of pairs of names
        Plates whose solids meet when each grows by a twentieth of a millimetre along its normal and in its plane.
    voids, filled : int
        Notches, slots and holes as wide as a plate is thick, and how many of them other plates fill.
    unfilled : set of str
        Panels of whose voids less than 97 % are filled.
    size : (3,) [mm]
        Of the box round everything, ascending.
    """

    names: tuple[str, ...]
    overlap: float
    touching: set[frozenset[str]]
    voids: int
    filled: int
    unfilled: set[str]
    size: tuple[float, ...]


def rotation(degrees: list[float]) -> np.ndarray:
    """Turns about the fixed x, then y, then z axis."""
    (cx, sx), (cy, sy), (cz, sz) = [(np.cos(np.radians(a)), np.sin(np.radians(a))) for a in degrees]
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def judge(path: Path) -> Judged:
    """Look at every pair of plates and every void of an assembly file."""
    parts = json.loads(path.read_text())["parts"]
    solids, grown, bodies = {}, {}, {}
    for part in parts:
        polygon = shapely.Polygon(part["outline"], part.get("holes", []))
        bodies[part["name"]] = polygon
        solids[part["name"]] = _solid(part, polygon, 0.0)
        grown[part["name"]] = _solid(part, polygon.buffer(0.05, join_style="mitre"), 0.05)
    overlap, touching = 0.0, set()
    for a, b in itertools.combinations(solids, 2):
        overlap += (solids[a] ^ solids[b]).volume()
        if (grown[a] ^ grown[b]).volume() > 1e-6:
            touching.add(frozenset({a, b}))
    voids = filled = 0
    unfilled = set()
    for part in parts:
        others = [solid for name, solid in solids.items() if name != part["name"]]
        everything = manifold3d.Manifold.batch_boolean(others, manifold3d.OpType.Add) if others else None
        own = [_solid(part, void, 0.0) for void in _voids(bodies[part["name"]], part["thickness"])]
        full = sum(bool(everything) and (body ^ everything).volume() > 0.75 * body.volume() for body in own)
        if full < 0.97 * len(own):
            unfilled.add(part["name"])
        voids, filled = voids + len(own), filled + full
    bounds = np.array([solid.bounding_box() for solid in solids.values()])
    size = (
        tuple(sorted((bounds[:, 3:].max(axis=0) - bounds[:, :3].min(axis=0)).tolist())) if len(bounds) else (0.0,) * 3
    )
    return Judged(tuple(solids), overlap, touching, voids, filled, unfilled, size)


def _solid(part: dict, polygon: shapely.Polygon, more: float) -> manifold3d.Manifold:
    rings = [np.array(ring.coords)[:-1] for ring in (polygon.exterior, *polygon.interiors)]
    section = manifold3d.CrossSection(rings, manifold3d.FillRule.EvenOdd)
    plate = manifold3d.Manifold.extrude(section, part["thickness"] + 2 * more).translate([0, 0, -more])
    return plate.transform(np.column_stack([rotation(part["rotate"]), part["at"]]))


def _voids(polygon: shapely.Polygon, t: float) -> list[shapely.Polygon]:
    """Rectangular pieces that closing fills and holes, of which one side is as long as the plate is thick."""
    reach = 1.6 * t
    closed = polygon.buffer(reach, join_style="mitre").buffer(-reach, join_style="mitre")
    found = []
    for piece in shapely.get_parts(closed.difference(polygon.buffer(1e-6))):
        if piece.geom_type != "Polygon" or piece.area < 0.5 * t * t:
            continue
        box = piece.minimum_rotated_rectangle
        sides = np.hypot(*np.diff(np.array(box.exterior.coords)[:3], axis=0).T)
        if piece.area > 0.9 * box.area and (np.abs(sides - t) < 0.12 * t).any() and min(sides) > 0.7 * t:
            found.append(piece)
    return found
