"""Pictures of assemblies in space: SVG and PNG with hidden surfaces taken away, and GLB for viewers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.errors import InputError
from wiggleroom.files import write_whole
from wiggleroom.report.pictures.file_endings import ending
from wiggleroom.report.pictures.palette import FONT, INK, PAPER, SUBDUED
from wiggleroom.report.results.answer_words import certainty, headline
from wiggleroom.report.solids.solid_colours import Colour, moved_surfaces, part_colours
from wiggleroom.report.solids.spatial_model_file import glb
from wiggleroom.report.solids.spatial_path import in_sight
from wiggleroom.search.answer import Answer, Contact
from wiggleroom.spatial.solids.spatial_model import SpatialAssembly, Surface

Floats = NDArray[np.float64]

WIDTH, HEIGHT, MARGIN = 800.0, 600.0, 40.0
LOOK = np.array([-0.6, 0.65, -0.47])
"""Direction in which the picture looks."""
LIGHT = np.array([0.35, -0.55, 0.76])
"""Direction from which the light comes."""
CREASE = 1e-3
"""Edges between faces that turn by more are drawn [rad]."""
EXPLODED = 0.7
"""Parts that leave are shown no further away than this share of the size."""


@dataclass(frozen=True, eq=False)
class _Facet:
    """A flat convex polygon: corners (k, 3), which sides are drawn, its normal, its colour, and its part."""

    corners: Floats
    drawn: tuple[bool, ...]
    normal: Floats
    colour: str
    part: int


def draw_spatial(answer: Answer[SpatialAssembly], path: Path) -> None:
    """Write an answer: a page (.html), or a picture of moved parts over their outlines at rest, with contacts (.svg, .png, .glb).

    Raises
    ------
    InputError
        If the name has another ending.
    """
    facts = f"{answer.verdict}, gap {answer.assembly.gap:g} mm, {certainty(answer)}"
    motion = answer.motion
    if answer.leaves and ending(path) != ".glb":
        motion = in_sight(answer.waypoints, EXPLODED * answer.assembly.size)
        facts += ", shown while it is in sight"
    lines = [headline(answer), facts]
    write_moved_parts(answer.assembly, motion, path, lines, answer.contacts, waypoints=answer.waypoints)


def draw_separation(found: Interlock[SpatialAssembly], path: Path) -> None:
    """Write a picture of what comes apart: parts that left stand beside the others; .svg, .png or .glb."""
    motion = np.zeros((len(found.assembly.parts), 6))
    for k, e in enumerate(found.escapes):
        for name in e.parts:
            who = found.assembly.names.index(name)
            motion[who] = e.path[-1, who]
            far = np.linalg.norm(motion[who, :3])
            share = EXPLODED * found.assembly.size * (1 + 0.3 * (len(found.escapes) - 1 - k)) / max(float(far), 1e-300)
            motion[who, :3] *= min(1.0, share)
    lines = [f"{found.verdict} at gap {found.assembly.gap:g} mm"]
    lines += [", then ".join(" and ".join(e.parts) for e in found.escapes)] if found.escapes else []
    write_moved_parts(found.assembly, motion, path, lines)


def write_moved_parts(
    assembly: SpatialAssembly,
    motion: Floats,
    path: Path,
    lines: Sequence[str],
    contacts: Sequence[Contact] = (),
    colours: Sequence[Colour] | None = None,
    names: Sequence[str] = (),
    waypoints: Floats | None = None,
) -> None:
    """Write parts at a motion (n, 6) with lines of text above them, and names upon them; .svg, .png or .glb, there with the path (k, n, 6).

    Raises
    ------
    InputError
        If the name has another ending.
    """
    kind = ending(path)
    if kind == ".glb":
        write_whole(path, glb(assembly, motion, colours, waypoints))
    elif kind in (".svg", ".png"):
        svg = spatial_svg(assembly, motion, lines, contacts, colours, names)
        if kind == ".svg":
            write_whole(path, svg)
        else:
            from wiggleroom.report.pictures.png import png

            write_whole(path, png(svg))
    else:
        message = f"picture {path}: the name must end in .svg, .png or .glb"
        raise InputError(message)


def spatial_svg(
    assembly: SpatialAssembly,
    motion: Floats,
    lines: Sequence[str],
    contacts: Sequence[Contact] = (),
    colours: Sequence[Colour] | None = None,
    names: Sequence[str] = (),
    frame: tuple[Floats, Floats] | None = None,
) -> str:
    """Picture of parts at a motion (n, 6), seen from the front, right and above.

    `names` are written upon them; `frame` is what of the picture's plane is in it.
    """
    depth, across, up = _camera()
    rest, moved = moved_surfaces(assembly, np.zeros_like(motion)), moved_surfaces(assembly, motion)
    low, high = frame or frame_of([*rest, *moved])
    room = np.array([WIDTH - 2 * MARGIN, HEIGHT - 2 * MARGIN - 40])
    scale = float((room / np.maximum(high - low, 1e-12)).min())
    middle = (low + high) / 2

    def place(points: Floats) -> Floats:
        x = np.column_stack([points @ across, points @ up])
        return np.column_stack(
            [WIDTH / 2 + scale * (x[:, 0] - middle[0]), HEIGHT / 2 + 20 - scale * (x[:, 1] - middle[1])]
        )

    facets = []
    for part, (surface, colour) in enumerate(zip(moved, colours or part_colours(assembly), strict=True)):
        facets += _facets(part, surface, colour, depth)
    facets = _sorted(facets)
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:g}" height="{HEIGHT:g}" viewBox="0 0 {WIDTH:g} {HEIGHT:g}">',
        f'<rect width="{WIDTH:g}" height="{HEIGHT:g}" fill="{PAPER}"/>',
    ]
    for k, line in enumerate(lines):
        size, shade = (18, INK) if k == 0 else (13, SUBDUED)
        out.append(
            f'<text x="20" y="{28 + 22 * k}" font-family="{FONT}" font-size="{size}" fill="{shade}">{escape(line)}</text>'
        )
    for facet in facets:
        p = place(facet.corners)
        points = " ".join(f"{x:.2f},{y:.2f}" for x, y in p)
        out.append(f'<polygon points="{points}" fill="{facet.colour}" stroke="{facet.colour}" stroke-width="0.8"/>')
        for i, shown in enumerate(facet.drawn):
            if shown:
                (x1, y1), (x2, y2) = p[i], p[(i + 1) % len(p)]
                out.append(
                    f'<path d="M{x1:.2f} {y1:.2f}L{x2:.2f} {y2:.2f}" stroke="#333" stroke-width="0.9" stroke-linecap="round"/>'
                )
    for k, surface in enumerate(rest):
        if motion[k].any():
            for one, other in _creases(surface):
                (x1, y1), (x2, y2) = place(np.array([one, other]))
                out.append(
                    f'<path d="M{x1:.2f} {y1:.2f}L{x2:.2f} {y2:.2f}" stroke="#999" stroke-width="0.6" stroke-dasharray="3 3" fill="none"/>'
                )
    for contact in contacts:
        at = np.array(contact.point)
        (x, y), (u, v) = place(np.array([at, at + 14 / scale * np.array(contact.normal)]))
        out.append(f'<path d="M{x:.2f} {y:.2f}L{u:.2f} {v:.2f}" stroke="#c1272d" stroke-width="2"/>')
        out.append(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="3.5" fill="#c1272d"/>')
    seen = _visible_places([(f.part, place(f.corners)) for f in facets]) if names else {}
    out += [
        f'<text x="{x:.2f}" y="{y:.2f}" text-anchor="middle" font-family="{FONT}" font-size="13" fill="{INK}" stroke="{PAPER}" '
        f'stroke-width="3" paint-order="stroke">{escape(names[k])}</text>'
        for k, (x, y) in seen.items()
    ]
    return "\n".join([*out, "</svg>", ""])


def frame_of(surfaces: Sequence[Surface]) -> tuple[Floats, Floats]:
    """Lower and upper corner (2,) [mm] of surfaces in the plane of the picture."""
    _, across, up = _camera()
    everything = np.vstack([s.vertices for s in surfaces])
    flat = np.column_stack([everything @ across, everything @ up])
    return flat.min(axis=0), flat.max(axis=0)


def _visible_places(drawn: list[tuple[int, Floats]]) -> dict[int, tuple[float, float]]:
    """A point well inside the largest region in which each part is seen, of polygons (k, 2) from back to front."""
    import shapely

    covered: shapely.Geometry = shapely.Polygon()
    seen: dict[int, list[shapely.Geometry]] = {}
    for part, corners in reversed(drawn):
        polygon = shapely.Polygon(corners).buffer(0)
        seen.setdefault(part, []).append(polygon.difference(covered))
        covered = covered.union(polygon)
    found = {}
    for part, regions in seen.items():
        largest = max(shapely.get_parts(shapely.union_all(regions, grid_size=1e-3)), key=shapely.area, default=None)
        if largest is not None and largest.area > 1.0:
            middle = shapely.get_point(shapely.maximum_inscribed_circle(largest, tolerance=1.0), 0)
            found[part] = (float(middle.x), float(middle.y) + 4.0)
    return found


def _camera() -> tuple[Floats, Floats, Floats]:
    """Unit vectors: away from the eye, to the right, and up in the picture."""
    depth = LOOK / np.linalg.norm(LOOK)
    across = np.cross(depth, [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    return depth, across, np.cross(across, depth)


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


def _creases(surface: Surface) -> list[tuple[Floats, Floats]]:
    """Edges of a surface that are drawn."""
    sharp = _sharp(surface, _normals(surface))
    found = {}
    for face, shown in zip(surface.faces.tolist(), sharp.tolist(), strict=True):
        for k in range(3):
            if shown[k]:
                i, j = face[k], face[(k + 1) % 3]
                found[min(i, j), max(i, j)] = (surface.vertices[i], surface.vertices[j])
    return list(found.values())


def _facets(part: int, surface: Surface, colour: Colour, depth: Floats) -> list[_Facet]:
    """Triangles of a surface that face the eye."""
    normal = _normals(surface)
    sharp = _sharp(surface, normal)
    light = LIGHT / np.linalg.norm(LIGHT)
    found = []
    for face, n, drawn in zip(surface.faces, normal, sharp.tolist(), strict=True):
        if n @ depth < -1e-9:
            shade = 0.62 + 0.38 * max(0.0, float(n @ light))
            fill = "#" + "".join(f"{min(255, round(c * shade)):02x}" for c in colour)
            found.append(_Facet(surface.vertices[face], tuple(drawn), n, fill, part))
    return found


def _sorted(facets: list[_Facet]) -> list[_Facet]:
    """Facets from back to front; those that cross the plane of another are cut along it.

    Source: the tree of Fuchs, Kedem and Naylor 1980.
    """
    found: list[_Facet] = []
    size = max((float(np.abs(f.corners).max()) for f in facets), default=1.0)
    todo: list[tuple[list[_Facet], bool]] = [(facets, False)]
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


def _cut(facet: _Facet, side: Floats) -> _Facet:
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
