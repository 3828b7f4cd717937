"""Pictures of assemblies in space: SVG and PNG with hidden surfaces taken away, and GLB for viewers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.drawing.model import Surface
from wiggleroom.errors import InputError
from wiggleroom.files import write_whole
from wiggleroom.planning.steps import Step
from wiggleroom.report.pictures.arrows import Mark, bent_arrow, numbered
from wiggleroom.report.pictures.file_endings import ending
from wiggleroom.report.pictures.palette import FONT, INK, PAPER, SUBDUED
from wiggleroom.report.results.answer_words import certainty, headline
from wiggleroom.report.solids.hidden_surfaces import camera, creases, drawn_facets, seen_facets
from wiggleroom.report.solids.solid_colours import Colour, moved_surfaces, part_colours
from wiggleroom.report.solids.spatial_model_file import glb
from wiggleroom.report.solids.spatial_path import in_sight
from wiggleroom.search.answer import Answer, Contact

Floats = NDArray[np.float64]

WIDTH, HEIGHT, MARGIN = 800.0, 600.0, 40.0
EXPLODED = 0.7
"""Parts that leave are shown no further away than this share of the size."""
STILL_SIGHT = 0.5
"""The same in the picture of a step."""
ROOM = 130.0
"""Numbers and arrows are as large as on a part of so many pixels."""


def draw_spatial(answer: Answer, path: Path) -> None:
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
    write_moved_parts(answer.assembly, motion, path, lines, Shown(answer.contacts), answer.waypoints)


@dataclass(frozen=True, eq=False)
class WayOut:
    """The way that a part goes in a picture.

    Parameters
    ----------
    part : int
    number : int
        In the order of leaving.
    track : (k, 3) float64 [mm]
        Its reference point along the path.
    """

    part: int
    number: int
    track: Floats


@dataclass(frozen=True, eq=False)
class Shown:
    """What a picture shows besides the parts where they are.

    Parameters
    ----------
    contacts : sequence of Contact
    colours : sequence of colours, optional
        Of the parts; by default those of their roles.
    names : sequence of str
        Of the parts, written upon them; none where it is empty.
    ways : sequence of WayOut
    frame : (2,) float64 twice, optional [mm]
        Lower and upper corner of what of the picture's plane is in it; by default all parts, and where they were.
    before : (n, 6) float64, optional [mm, rad]
        Where those that move were: their outlines are dashed; by default at rest.
    there : (n,) bool, optional
        Parts that are in the picture; by default all.
    """

    contacts: Sequence[Contact] = ()
    colours: Sequence[Colour] | None = None
    names: Sequence[str] = ()
    ways: Sequence[WayOut] = ()
    frame: tuple[Floats, Floats] | None = None
    before: Floats | None = None
    there: NDArray[np.bool_] | None = None


def draw_separation(found: Interlock, path: Path, lines: Sequence[str] = ()) -> None:
    """Write a picture of what comes apart, under other lines where some are given: parts that left stand beside; .svg, .png or .glb.

    A number and an arrow on each that leaves say when, and which way.
    """
    assembly = found.assembly
    motion, ways = np.zeros((len(assembly.parts), 6)), []
    for k, e in enumerate(found.escapes):
        for name in e.parts:
            who = assembly.names.index(name)
            motion[who] = e.path[-1, who]
            far = np.linalg.norm(motion[who, :3])
            share = EXPLODED * assembly.size * (1 + 0.3 * (len(found.escapes) - 1 - k)) / max(float(far), 1e-300)
            motion[who, :3] *= min(1.0, share)
            ways.append(WayOut(who, k + 1, assembly.reference[who] + e.path[:, who, :3]))
    said = [f"{found.verdict} at gap {assembly.gap:g} mm"]
    said += [", then ".join(" and ".join(e.parts) for e in found.escapes)] if found.escapes else []
    write_moved_parts(assembly, motion, path, lines or said, Shown(names=assembly.names, ways=ways))


def step_svg(assembly: Assembly, step: Step, number: int, lines: Sequence[str]) -> str:
    """Picture of a step of a plan: where it begins in dashed lines, where it ends or leaves sight, and arrows along the way."""
    path = step.path.copy()
    path[:, :, :3] -= step.path[0, :, :3]
    end = in_sight(path, STILL_SIGHT * assembly.size) if step.leaves else path[-1].copy()
    end[:, :3] += step.path[0, :, :3]
    moving = [k for k, name in enumerate(assembly.names) if name in step.parts]
    ways = [WayOut(k, number, assembly.reference[k] + step.path[:, k, :3]) for k in moving]
    shown = Shown(names=assembly.names, ways=ways, before=step.path[0], there=step.there)
    return spatial_svg(assembly, end, lines, shown)


def write_moved_parts(
    assembly: Assembly,
    motion: Floats,
    path: Path,
    lines: Sequence[str],
    shown: Shown,
    waypoints: Floats | None = None,
) -> None:
    """Write parts at a motion (n, 6) with lines of text above them; .svg, .png or .glb, there with the path (k, n, 6).

    Raises
    ------
    InputError
        If the name has another ending.
    """
    kind = ending(path)
    if kind == ".glb":
        write_whole(path, glb(assembly, motion, shown.colours, waypoints))
    elif kind in (".svg", ".png"):
        svg = spatial_svg(assembly, motion, lines, shown)
        if kind == ".svg":
            write_whole(path, svg)
        else:
            from wiggleroom.report.pictures.png import png

            write_whole(path, png(svg))
    else:
        message = f"picture {path}: the name must end in .svg, .png or .glb"
        raise InputError(message)


def spatial_svg(
    assembly: Assembly,
    motion: Floats,
    lines: Sequence[str],
    shown: Shown,
) -> str:
    """Picture of parts at a motion (n, 6), seen from the front, right and above."""
    _, across, up = camera()
    names, ways, frame = shown.names, shown.ways, shown.frame
    before = np.zeros_like(motion) if shown.before is None else shown.before
    there = np.ones(len(motion), dtype=bool) if shown.there is None else shown.there
    rest, moved = moved_surfaces(assembly, before), moved_surfaces(assembly, motion)
    low, high = frame or frame_of([s for some in (rest, moved) for s, its in zip(some, there, strict=True) if its])
    room = np.array([WIDTH - 2 * MARGIN, HEIGHT - 2 * MARGIN - 40])
    scale = float((room / np.maximum(high - low, 1e-12)).min())
    middle = (low + high) / 2

    def place(points: Floats) -> Floats:
        x = np.column_stack([points @ across, points @ up])
        return np.column_stack(
            [WIDTH / 2 + scale * (x[:, 0] - middle[0]), HEIGHT / 2 + 20 - scale * (x[:, 1] - middle[1])]
        )

    seen = [surface if its else None for surface, its in zip(moved, there, strict=True)]
    facets = seen_facets(seen, shown.colours or part_colours(assembly))
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:g}" height="{HEIGHT:g}" viewBox="0 0 {WIDTH:g} {HEIGHT:g}">',
        f'<rect width="{WIDTH:g}" height="{HEIGHT:g}" fill="{PAPER}"/>',
    ]
    for k, line in enumerate(lines):
        size, shade = (18, INK) if k == 0 else (13, SUBDUED)
        out.append(
            f'<text x="20" y="{28 + 22 * k}" font-family="{FONT}" font-size="{size}" fill="{shade}">{escape(line)}</text>'
        )
    out += drawn_facets(facets, place)
    for k, surface in enumerate(rest):
        if there[k] and not np.array_equal(motion[k], before[k]):
            for one, other in creases(surface):
                (x1, y1), (x2, y2) = place(np.array([one, other]))
                out.append(
                    f'<path d="M{x1:.2f} {y1:.2f}L{x2:.2f} {y2:.2f}" stroke="#999" stroke-width="0.6" stroke-dasharray="3 3" fill="none"/>'
                )
    for contact in shown.contacts:
        at = np.array(contact.point)
        (x, y), (u, v) = place(np.array([at, at + 14 / scale * np.array(contact.normal)]))
        out.append(f'<path d="M{x:.2f} {y:.2f}L{u:.2f} {v:.2f}" stroke="#c1272d" stroke-width="2"/>')
        out.append(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="3.5" fill="#c1272d"/>')
    if names or ways:
        places = _visible_places([(f.part, place(f.corners)) for f in facets])
        out += _labels(places, names, {way.part: (way.number, place(way.track)) for way in ways})
    return "\n".join([*out, "</svg>", ""])


def _labels(
    seen: dict[int, tuple[float, float]], names: Sequence[str], ways: dict[int, tuple[int, Floats]]
) -> list[str]:
    """Names on the parts that are seen, and on those that leave a number and an arrow along their way (k, 2) [px]."""
    out = []
    for k, (number, track) in ways.items():
        if k in seen:
            start = np.array(seen[k])
            arrow = (
                bent_arrow(start, track, ROOM)
                if np.ptp(track, axis=0).max() > 1.0
                else Mark("", (np.array([start, start]),))
            )
            out.append(numbered(arrow, number, ROOM).svg)
    for k, (x, y) in seen.items():
        if names:
            low = y + 4.0 + (22.0 if k in ways else 0.0)
            out.append(
                f'<text x="{x:.2f}" y="{low:.2f}" text-anchor="middle" font-family="{FONT}" font-size="13" fill="{INK}" stroke="{PAPER}" '
                f'stroke-width="3" paint-order="stroke">{escape(names[k])}</text>'
            )
    return out


def frame_of(surfaces: Sequence[Surface]) -> tuple[Floats, Floats]:
    """Lower and upper corner (2,) [mm] of surfaces in the plane of the picture."""
    _, across, up = camera()
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
            found[part] = (float(middle.x), float(middle.y))
    return found
