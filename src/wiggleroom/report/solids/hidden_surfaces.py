"""Parts in space as they are seen: faces from back to front, hidden ones covered by those before them, edges where faces turn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import Surface
from wiggleroom.report.solids.solid_colours import Colour

Floats = NDArray[np.float64]

LOOK = np.array([-0.6, 0.65, -0.47])
"""Direction in which the picture looks."""
LIGHT = np.array([0.35, -0.55, 0.76])
"""Direction from which the light comes."""
CREASE = 1e-3
"""Edges between faces that turn by more are drawn [rad]."""


@dataclass(frozen=True, eq=False)
class Facet:
    """A flat convex polygon: corners (k, 3), which sides are drawn, its normal, its colour, and its part."""

    corners: Floats
    drawn: tuple[bool, ...]
    normal: Floats
    colour: str
    part: int


def seen_facets(surfaces: Sequence[Surface | None], colours: Sequence[Colour]) -> list[Facet]:
    """Faces of the parts that are there, from back to front."""
    depth = camera()[0]
    found: list[Facet] = []
    for part, (surface, colour) in enumerate(zip(surfaces, colours, strict=True)):
        found += [] if surface is None else _facets(part, surface, colour, depth)
    return _sorted(found)


def drawn_facets(facets: Sequence[Facet], place: Callable[[Floats], Floats]) -> list[str]:
    """Facets as SVG, one after the other; `place` takes points (k, 3) [mm] into the picture (k, 2) [px]."""
    out = []
    for _, group in groupby(facets, key=_plane):
        together = list(group)
        out.append(_filled([place(facet.corners) for facet in together], together[0].colour))
        for facet in together:
            p = place(facet.corners)
            for i, sharp in enumerate(facet.drawn):
                if sharp:
                    (x1, y1), (x2, y2) = p[i], p[(i + 1) % len(p)]
                    out.append(
                        f'<path d="M{x1:.2f} {y1:.2f}L{x2:.2f} {y2:.2f}" stroke="#333" stroke-width="0.9" stroke-linecap="round"/>'
                    )
    return out


def camera() -> tuple[Floats, Floats, Floats]:
    """Unit vectors: away from the eye, to the right, and up in the picture."""
    depth = LOOK / np.linalg.norm(LOOK)
    across = np.cross(depth, [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    return depth, across, np.cross(across, depth)


def creases(surface: Surface) -> list[tuple[Floats, Floats]]:
    """Edges of a surface that are drawn."""
    sharp = _sharp(surface, _normals(surface))
    found = {}
    for face, shown in zip(surface.faces.tolist(), sharp.tolist(), strict=True):
        for k in range(3):
            if shown[k]:
                i, j = face[k], face[(k + 1) % 3]
                found[min(i, j), max(i, j)] = (surface.vertices[i], surface.vertices[j])
    return list(found.values())


def _normals(surface: Surface) -> Floats:
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    return normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]


def _sharp(surface: Surface, normal: Floats) -> NDArray[np.bool_]:
    """Sides (f, 3) of all triangles that are drawn: the faces beside them turn."""
    faces = surface.faces
    sides = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    order = np.lexsort(np.sort(sides, axis=1).T)
    sharp = np.ones(len(sides), dtype=bool)
    pair = order.reshape(-1, 2) if len(order) % 2 == 0 else order[:-1].reshape(-1, 2)
    turn = np.linalg.norm(normal[pair[:, 0] // 3] - normal[pair[:, 1] // 3], axis=1) > CREASE
    sharp[pair[:, 0]], sharp[pair[:, 1]] = turn, turn
    return sharp.reshape(-1, 3)


def _facets(part: int, surface: Surface, colour: Colour, depth: Floats) -> list[Facet]:
    """Triangles of a surface that face the eye."""
    normal = _normals(surface)
    sharp = _sharp(surface, normal)
    light = LIGHT / np.linalg.norm(LIGHT)
    found = []
    for face, n, drawn in zip(surface.faces, normal, sharp.tolist(), strict=True):
        if n @ depth < -1e-9:
            shade = 0.62 + 0.38 * max(0.0, float(n @ light))
            fill = "#" + "".join(f"{min(255, round(c * shade)):02x}" for c in colour)
            found.append(Facet(surface.vertices[face], tuple(drawn), n, fill, part))
    return found


def _sorted(facets: list[Facet]) -> list[Facet]:
    """Facets from back to front; those that cross the plane of another are cut along it.

    Source: the tree of Fuchs, Kedem and Naylor 1980.
    """
    found: list[Facet] = []
    size = max((float(np.abs(f.corners).max()) for f in facets), default=1.0)
    todo: list[tuple[list[Facet], bool]] = [(facets, False)]
    rng = np.random.default_rng(0)
    while todo:
        group, ready = todo.pop()
        if ready or len(group) <= 1:
            found += group
            continue
        pivot = group[int(rng.integers(len(group)))]
        level = pivot.normal @ pivot.corners[0]
        front, same, back = [], [], []
        for facet in group:
            side = facet.corners @ pivot.normal - level
            if np.abs(side).max() <= 1e-9 * size:
                same.append(facet)
            elif side.min() >= -1e-9 * size:
                front.append(facet)
            elif side.max() <= 1e-9 * size:
                back.append(facet)
            else:
                front.append(_cut(facet, side))
                back.append(_cut(facet, -side))
        # the pivot faces the eye, so what is in front of it is nearer; the last put in is taken out first
        todo += [(front, False), (same, True), (back, False)]
    return found


def _cut(facet: Facet, side: Floats) -> Facet:
    """The part of a facet where `side` of its corners is not negative; the new side is not drawn."""
    corners, drawn = [], []
    count = len(side)
    for i in range(count):
        j = (i + 1) % count
        if side[i] >= 0:
            corners.append(facet.corners[i])
            drawn.append(facet.drawn[i] if side[j] >= 0 or side[i] > 0 else False)
        if (side[i] >= 0) != (side[j] >= 0):
            share = side[i] / (side[i] - side[j])
            corners.append(facet.corners[i] + share * (facet.corners[j] - facet.corners[i]))
            drawn.append(False if side[i] >= 0 else facet.drawn[i])
    return replace(facet, corners=np.array(corners), drawn=tuple(drawn))


def _plane(facet: Facet) -> tuple[int, str, float]:
    """Facets that agree in this lie in one plane of one part."""
    return facet.part, facet.colour, round(float(facet.normal @ facet.corners[0]), 6)


def _filled(polygons: Sequence[Floats], colour: str) -> str:
    """Polygons (k, 2) [px] that are drawn one after the other in one colour, as one shape: between two there is no seam."""
    import shapely

    parts: list[shapely.Geometry] = [shapely.Polygon(corners) for corners in polygons]
    if len(parts) > 1:
        whole = shapely.union_all([shapely.make_valid(part) for part in parts], grid_size=1e-3)
        parts = [part for part in shapely.get_parts(whole) if isinstance(part, shapely.Polygon)]
    rings = [ring for part in parts for ring in (part.exterior, *part.interiors)]
    path = "".join("M" + "L".join(f"{x:.2f},{y:.2f}" for x, y in list(ring.coords)[:-1]) + "z" for ring in rings)
    return f'<path d="{path}" fill="{colour}" fill-rule="evenodd" stroke="{colour}" stroke-width="0.8"/>'
