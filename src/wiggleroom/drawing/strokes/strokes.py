"""Strokes of the pen, mapped, turned round, and looked at from their ends."""

from __future__ import annotations

import cmath
import math

from wiggleroom.drawing.strokes.pathdata import Arc, Cubic, Line, Segment, Subpath
from wiggleroom.drawing.strokes.transforms import Affine


def bulge_arc(start: complex, end: complex, bulge: float) -> Segment:
    """Arc of a polyline between two corners; `bulge` is the tangent of a quarter of its sweep, positive to the left.

    The ends are put in order first, so that an arc and its reverse are the same circle to the last bit.

    Examples
    --------
    >>> arc = bulge_arc(0j, 2 + 0j, 1.0)
    >>> arc.centre, arc.sweep == math.pi
    ((1+0j), True)
    """
    if abs(bulge) < 1e-12 or start == end:
        return Line(end)
    flipped = (end.real, end.imag) < (start.real, start.imag)
    a, b, bend = (end, start, -bulge) if flipped else (start, end, bulge)
    centre = (a + b) / 2 + 1j * (b - a) * ((1 - bend) * (1 + bend) / (4 * bend))
    radius = abs(b - a) * (bend * bend + 1) / (4 * abs(bend))
    return Arc(centre, complex(radius), 1j * radius, cmath.phase(a - centre), 4 * math.atan(bend), flipped, end)


def mapped(path: Subpath, matrix: Affine) -> Subpath:
    """Map a subpath.

    Examples
    --------
    >>> mapped(Subpath(0j, [Line(2 + 0j)], False), Affine(e=1.0)).segments
    [Line(end=(3+0j))]
    """
    segments: list[Segment] = []
    for segment in path.segments:
        end = matrix.point(segment.end)
        if isinstance(segment, Cubic):
            segments.append(Cubic(matrix.point(segment.first), matrix.point(segment.second), end))
        elif isinstance(segment, Arc):
            u, v = matrix.vector(segment.u), matrix.vector(segment.v)
            segments.append(segment._replace(centre=matrix.point(segment.centre), u=u, v=v, end=end))
        else:
            segments.append(Line(end))
    return Subpath(matrix.point(path.start), segments, path.closed)


def backward(path: Subpath) -> Subpath:
    """Return the same stroke from its other end.

    Examples
    --------
    >>> backward(Subpath(0j, [Line(1 + 0j), Line(2 + 1j)], False))
    Subpath(start=(2+1j), segments=[Line(end=(1+0j)), Line(end=0j)], closed=False)
    """
    starts = [path.start, *(segment.end for segment in path.segments[:-1])]
    turned: list[Segment] = []
    for segment, end in zip(reversed(path.segments), reversed(starts), strict=True):
        if isinstance(segment, Cubic):
            turned.append(Cubic(segment.second, segment.first, end))
        elif isinstance(segment, Arc):
            turned.append(segment._replace(flipped=not segment.flipped, end=end))
        else:
            turned.append(Line(end))
    return Subpath(path.segments[-1].end, turned, path.closed)


def point_on(start: complex, segment: Segment, t: float) -> complex:
    """Point of a segment at parameter 0..1, from its start on.

    Examples
    --------
    >>> point_on(0j, Line(4 + 0j), 0.25)
    (1+0j)
    """
    if isinstance(segment, Cubic):
        s = 1 - t
        return s**3 * start + 3 * s * s * t * segment.first + 3 * s * t * t * segment.second + t**3 * segment.end
    if isinstance(segment, Arc):
        angle = segment.start + segment.sweep * (1 - t if segment.flipped else t)
        return segment.centre + segment.u * math.cos(angle) + segment.v * math.sin(angle)
    return start + t * (segment.end - start)


def trace(path: Subpath, steps: int = 8) -> list[complex]:
    """Points along a subpath, both ends included, `steps` a curve and one a straight line.

    Examples
    --------
    >>> trace(Subpath(0j, [Line(1 + 0j)], False))
    [0j, (1+0j)]
    """
    points, here = [path.start], path.start
    for segment in path.segments:
        count = 1 if isinstance(segment, Line) else steps
        points += [point_on(here, segment, (i + 1) / count) for i in range(count - 1)]
        points.append(segment.end)
        here = segment.end
    return points


def longer_side(path: Subpath) -> float:
    """Longer side of the box round a subpath [mm], curves by a few points.

    Examples
    --------
    >>> longer_side(Subpath(0j, [Line(3 - 4j)], False))
    4.0
    """
    points = trace(path, 4)
    real, imag = [point.real for point in points], [point.imag for point in points]
    return max(max(real) - min(real), max(imag) - min(imag))


def largest_coordinate(path: Subpath) -> float:
    """Largest coordinate of the points that define a subpath; infinite where one is no number.

    Examples
    --------
    >>> largest_coordinate(Subpath(0j, [Line(3 - 4j)], False))
    4.0
    """
    points = [path.start]
    for segment in path.segments:
        points.append(segment.end)
        if isinstance(segment, Cubic):
            points += [segment.first, segment.second]
        elif isinstance(segment, Arc):
            points += [segment.centre, segment.u, segment.v, complex(segment.start, segment.sweep)]
    numbers = [abs(number) for point in points for number in (point.real, point.imag)]
    return max(numbers) if all(map(math.isfinite, numbers)) else math.inf
