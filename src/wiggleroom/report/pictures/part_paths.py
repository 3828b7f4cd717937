"""Parts as SVG paths, each different shape written once and used at every place it lies at."""

from __future__ import annotations

import math
from collections.abc import Container
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.model import Part
from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.layout import View

Floats = NDArray[np.float64]

SIMPLIFY_TOLERANCE = 0.04
"""Corners that change an outline by less than this [px] are not written."""


@dataclass(frozen=True, eq=False)
class PartPath:
    """One outline in pixels, about the middle of its box.

    Parameters
    ----------
    key : str
        Its id in the picture.
    polygon : shapely geometry [px]
        The material, y down.
    path : str
        The same as SVG path data.
    """

    key: str
    polygon: shapely.Geometry
    path: str

    @cached_property
    def circle(self) -> tuple[tuple[float, float], float]:
        """Middle and radius [px] of the largest circle inside it."""
        line = shapely.get_coordinates(shapely.maximum_inscribed_circle(self.polygon, tolerance=0.5))
        return (float(line[0, 0]), float(line[0, 1])), float(np.hypot(*(line[1] - line[0])))


@dataclass(eq=False)
class PartPaths:
    """All shapes of one picture; `of` adds a part's shape unless an equal one is there."""

    scale: float
    known: dict[bytes, PartPath] = field(default_factory=dict)

    def of(self, part: Part) -> PartPath:
        """Shape of a part."""
        rings = [[r.outer, *r.holes] for r in part.regions]
        centre = middle(part)
        pixels = [[(ring - centre) * (self.scale, -self.scale) for ring in region] for region in rings]
        key = b"|".join(np.round(ring, 2).tobytes() for region in pixels for ring in region)
        if key not in self.known:
            polygon = shapely.MultiPolygon([(region[0], region[1:]) for region in pixels])
            path = "".join(_ring(ring) for region in pixels for ring in region)
            self.known[key] = PartPath(f"s{len(self.known) + 1}", polygon, path)
        return self.known[key]

    @property
    def definitions(self) -> str:
        """All shapes, for `defs` of the picture."""
        return "".join(f'<path id="{s.key}" d="{s.path}"/>' for s in self.known.values())


def middle(part: Part) -> Floats:
    """Middle of the part's box in its own frame (2,) [mm]."""
    corners = np.vstack([r.outer for r in part.regions])
    return (corners.min(axis=0) + corners.max(axis=0)) / 2


def _ring(points: Floats) -> str:
    ring = shapely.simplify(shapely.LinearRing(points), SIMPLIFY_TOLERANCE)
    corners = shapely.get_coordinates(ring)[:-1]
    return ("M" + "%.2f,%.2f " * len(corners)) % tuple(corners.ravel().tolist()) + "z"


def role(part: Part, pulled: Container[str | None]) -> str:
    """Role of a part, which its colours in `palette.ROLE_COLOURS` are named by."""
    return "fixed" if part.fixed else "pulled" if part.name in pulled else "neutral"


def line_width(room: float) -> float:
    """Width [px] of outlines where the usual part is `room` pixels large."""
    return min(max(0.02 * room, 0.3), 1.2)


def colour_attributes(colours: tuple[str, str], line: float | None = None) -> str:
    """Attributes of SVG for a fill and an outline, `line` pixels wide."""
    width = "" if line is None else f' stroke-width="{line:.2f}"'
    return f'fill="{colours[0]}" fill-opacity="0.85" stroke="{colours[1]}"{width}'


def rest_outlines(uses: str, line: float) -> str:
    """Thin outlines of parts at rest, a little thinner than `line` [px]."""
    style = f'fill="none" stroke="{palette.REST}" stroke-width="{0.8 * line:.2f}" stroke-linejoin="round"'
    return f"<g {style}>{uses}</g>"


def spot(view: View, part: Part, pose: tuple[float, float, float]) -> tuple[float, float, float]:
    """Where a part's shape goes at `pose`: x, y [px] and the angle [deg] as SVG counts it."""
    x, y, angle = pose
    c, s = math.cos(angle), math.sin(angle)
    mx, my = middle(part)
    px, py = view.pixels(np.array([x + c * mx - s * my, y + s * mx + c * my]))
    return float(px), float(py), -math.degrees(angle)


def use(shape: PartPath, place: tuple[float, float, float], title: str = "") -> str:
    """Use element of a shape at a place; `title` shows under the mouse."""
    x, y, turn = place
    turned = f" rotate({turn:.4f})" if abs(turn) > 5e-5 else ""
    head = f'<use xlink:href="#{shape.key}" transform="translate({x:.2f} {y:.2f}){turned}"'
    return f"{head}><title>{title}</title></use>" if title else f"{head}/>"
