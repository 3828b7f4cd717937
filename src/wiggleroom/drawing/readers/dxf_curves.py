"""Entities of a DXF as strokes in their own plane."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from wiggleroom.drawing.strokes.nurbs import cubics_of
from wiggleroom.drawing.strokes.pathdata import Arc, Cubic, Line, Segment, Subpath
from wiggleroom.drawing.strokes.strokes import bulge_arc, trace

SPLINE_FRAME_FLAG = 16
"""Flag of the vertices of a polyline that only steer its curve."""
FULL_TURN_TOLERANCE = 1e-9
"""A sweep this near to a full turn [rad] is one."""


def stroke_of(entity: Any) -> Subpath | None:
    """Stroke of one entity, or None where it draws nothing: all its points are one.

    Coordinates are those of the entity's own plane for CIRCLE, ARC and flat polylines, those of its layout for the
    others; heights are left out.

    Parameters
    ----------
    entity : ezdxf entity
        Of a kind listed in `STROKES`.

    Raises
    ------
    ValueError
        With a plain reason, where the entity cannot be drawn.
    """
    path = STROKES[entity.dxftype()](entity)
    if path is None or not any(point != path.start for point in trace(path, 2)):
        return None
    return path


def _line(entity: Any) -> Subpath:
    return Subpath(_flat(entity.dxf.start), [Line(_flat(entity.dxf.end))], False)


def _circle(entity: Any) -> Subpath | None:
    if entity.dxf.radius == 0:
        return None
    return _turn(_flat(entity.dxf.center), complex(_radius(entity)), 1j * _radius(entity), 0.0, 2 * math.pi)


def _arc(entity: Any) -> Subpath | None:
    if entity.dxf.radius == 0:
        return None
    first, last = entity.dxf.start_angle, entity.dxf.end_angle
    sweep = math.radians((last - first) % 360.0) or 2 * math.pi
    radius = _radius(entity)
    return _turn(_flat(entity.dxf.center), complex(radius), 1j * radius, math.radians(first), sweep)


def _ellipse(entity: Any) -> Subpath:
    major, minor = _flat(entity.dxf.major_axis), _flat(entity.minor_axis)
    if min(abs(major), abs(minor)) <= 1e-12 * max(abs(major), abs(minor)) or major == 0:
        raise ValueError("an axis is 0; it must be larger")
    first, last = entity.dxf.start_param, entity.dxf.end_param
    sweep = (last - first) % (2 * math.pi)
    return _turn(_flat(entity.dxf.center), major, minor, first, sweep if sweep > FULL_TURN_TOLERANCE else 2 * math.pi)


def _turn(centre: complex, u: complex, v: complex, start: float, sweep: float) -> Subpath:
    closed = sweep >= 2 * math.pi - FULL_TURN_TOLERANCE
    ends = [centre + u * math.cos(a) + v * math.sin(a) for a in (start, start + (0.0 if closed else sweep))]
    return Subpath(ends[0], [Arc(centre, u, v, start, 2 * math.pi if closed else sweep, False, ends[1])], closed)


def _radius(entity: Any) -> float:
    radius = float(entity.dxf.radius)
    if not 0 < radius < math.inf:
        message = f"radius is {radius:g}; it must be larger than 0"
        raise ValueError(message)
    return radius


def _lwpolyline(entity: Any) -> Subpath | None:
    corners = [(complex(x, y), bulge) for x, y, bulge in entity.get_points("xyb")]
    return _polyline(corners, bool(entity.closed))


def _old_polyline(entity: Any) -> Subpath | None:
    drawn = [vertex.dxf for vertex in entity.vertices if not vertex.dxf.flags & SPLINE_FRAME_FLAG]
    bulged = entity.is_2d_polyline
    corners = [(_flat(dxf.location), dxf.get("bulge", 0.0) if bulged else 0.0) for dxf in drawn]
    return _polyline(corners, bool(entity.is_closed))


def _polyline(corners: Sequence[tuple[complex, float]], closed: bool) -> Subpath | None:
    if not corners:
        return None
    ends = [point for point, _ in corners[1:]] + ([corners[0][0]] if closed else [])
    segments = [bulge_arc(here, end, bulge) for (here, bulge), end in zip(corners, ends, strict=False) if here != end]
    return Subpath(corners[0][0], segments, closed) if segments else None


def _spline(entity: Any) -> Subpath | None:
    tool = entity.construction_tool()
    control = np.array([(point.x, point.y) for point in tool.control_points], dtype=float)
    weights = np.array(tool.weights(), dtype=float) if tool.is_rational else np.ones(len(control))
    if np.ptp(control, axis=0).max() == 0:
        return None
    cubics = cubics_of(int(tool.degree), np.array(tool.knots(), dtype=float), control, weights)
    segments: list[Segment] = [Cubic(first, second, end) for _, first, second, end in cubics.tolist()]
    return Subpath(complex(cubics[0, 0]), segments, False)  # where its ends meet it is taken as closed later


def _flat(point: Iterable[float]) -> complex:
    x, y, *_ = point
    return complex(x, y)


STROKES: dict[str, Callable[[Any], Subpath | None]] = {
    "LINE": _line,
    "ARC": _arc,
    "CIRCLE": _circle,
    "ELLIPSE": _ellipse,
    "LWPOLYLINE": _lwpolyline,
    "POLYLINE": _old_polyline,
    "SPLINE": _spline,
}
"""How each kind of entity is drawn."""
