"""Flanks: the short straight edges, as long as a plate is thick, at which panels hold each other.

The side of a tab, the end of a hole and the bottom of a slot are the same thing: a segment in the plane of one panel
that stands square on the plane of its partner. So finger edges, rows of holes and cross laps need no code of their own.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.polygon import orient

from wiggleroom.mating.contact import ASKEW_LENGTH_TOLERANCE
from wiggleroom.mating.panel_outline import inset, same_outline, sharpened, without_reliefs

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class FlankSettings:
    """Which edges of an outline count as flanks.

    Parameters
    ----------
    length_tolerance : float in (0, 1)
        A flank's length differs from a thickness by at most this share of it: kerf and play change it.
    corner_edge : float > 0 [mm]
        Edges shorter than this round a corner.
    spike_width : float > 0 [mm]
        Spikes narrower than this are taken off.
    max_square_cosine : float in (0, 1)
        A neighbouring edge stands square on a flank where the cosine of their angle is below this.
    max_straight_cosine : float in (0, 1)
        An edge that goes on almost straight, the cosine of the angle above this, is a piece of a longer one and no flank.
    relief_width : float in (0, 1)
        Reliefs at corners (dog bones) up to twice this share of the thickness wide are filled before flanks are sought.
    even_stretch : float > 1
        A tab or gap longer than this many times the usual one of its line separates two rows of fingers.
    long_stretch : float > 1
        And so does a tab as many times longer than the usual gap, or a gap than the usual tab.
    double_flanks : int
        As many edges of an outline twice as long as a plate is thick are the sides of notches for two plates on each other.
    """

    length_tolerance: float = 0.15
    corner_edge: float = 0.05
    spike_width: float = 0.04
    max_square_cosine: float = 0.1
    max_straight_cosine: float = 0.97
    relief_width: float = 0.3
    even_stretch: float = 1.25
    long_stretch: float = 3.0
    double_flanks: int = 4


FLANKS = FlankSettings()


@dataclass(frozen=True, eq=False)
class FlankLine:
    """Flanks of one panel that lie on one line along which a partner's plane can cut the panel's.

    Parameters
    ----------
    along, across : (2,) float64
        Unit direction of the line and its left normal.
    outward : float
        1 where the panel lies right of the line, along its edge, -1 where it lies left, 0 where it lies on both sides.
    offset : float [mm]
        Of the line along `across`.
    at : (n,) float64 [mm]
        Places of the flanks along the line, ascending.
    sense : (n,) float64
        1 where material follows the flank in the line's direction, -1 where it precedes it.
    length : (n,) float64 [mm]
    rows : (n,) int
        Which flanks of the panel they are.
    """

    along: Floats
    across: Floats
    outward: float
    offset: float
    at: Floats
    sense: Floats
    length: Floats
    rows: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SheetPlate:
    """A panel in its own frame: the origin in its centroid, the middle of its thickness at z = 0.

    Parameters
    ----------
    name : str
    polygon : shapely.Polygon [mm]
        As cut: burn removed.
    thickness : float [mm]
        Nominal: what the slots of its partners are made for.
    centre : (2,) float64 [mm]
        Where on the sheet its origin lies.
    middle, inward, along : (n, 2) float64
        Of every flank: its midpoint [mm], the direction into the material, its own direction.
    length : (n,) float64 [mm]
    neighbours : (n, 2) int
        Flanks that share a corner with it, else -1.
    needed : (n,) bool
        Whether a flank should meet another: a lone step of an outline need not.
    lines : tuple of FlankLine
    joint_rows : (n,) int
        Which row of fingers, or of holes for them, every flank belongs to.
    kind : int
        The same for congruent panels.
    """

    name: str
    polygon: shapely.Polygon
    thickness: float
    centre: Floats
    middle: Floats
    inward: Floats
    along: Floats
    length: Floats
    neighbours: NDArray[np.int64]
    needed: NDArray[np.bool_]
    lines: tuple[FlankLine, ...]
    joint_rows: NDArray[np.int64]
    kind: int

    @property
    def radius(self) -> float:
        """Of the circle about the origin that holds the panel [mm]."""
        return float(np.linalg.norm(shapely.get_coordinates(self.polygon), axis=1).max())


def plates_with(
    names: list[str], polygons: list[shapely.Polygon], thickness: list[float], burn: float, angles: Floats
) -> tuple[SheetPlate, ...]:
    """Plates of the panels of a sheet whose fingers are as long as right angles ask and as `angles` do.

    Parameters
    ----------
    names : list of str
    polygons : list of shapely.Polygon [mm]
        As drawn on the sheet.
    thickness : list of float [mm]
        Nominal, one a panel.
    burn : float [mm]
        By how much outlines were drawn larger.
    angles : (k,) float64 [rad]
        By which plates may turn at a joint.
    """
    wanted = np.unique(thickness)
    kinds: list[SheetPlate] = []
    plates: list[SheetPlate] = []
    for name, polygon, thick in zip(names, polygons, thickness, strict=True):
        cut = inset(inset(polygon, burn + FLANKS.spike_width / 2), -FLANKS.spike_width / 2)
        cut = sharpened(cut, max(FLANKS.corner_edge, 2 * burn))
        centre = np.array(cut.centroid.coords[0])
        cut = shapely.transform(cut, lambda points, centre=centre: points - centre)
        alike = next((first for first in kinds if first.thickness == thick and same_outline(cut, first.polygon)), None)
        if alike is None:
            plates.append(_plate(name, cut, thick, centre, wanted, angles, len(kinds)))
            kinds.append(plates[-1])
        else:
            plates.append(replace(alike, name=name, centre=centre))
    return tuple(plates)


def _plate(
    name: str, cut: shapely.Polygon, thick: float, centre: Floats, wanted: Floats, angles: Floats, kind: int
) -> SheetPlate:
    smooth = without_reliefs(cut, FLANKS.relief_width * float(wanted.min()))
    middle, inward, along, length, neighbours, bottom, jointed = _flanks(smooth, wanted, thick * np.sin(angles))
    lines = _lines(cut, middle, inward, length, thick)
    for line in lines:  # a line's direction and place are known better than those of one flank
        inward[line.rows] = line.sense[:, None] * line.along
        middle[line.rows] = line.at[:, None] * line.along + line.offset * line.across
    along = np.column_stack([inward[:, 1], -inward[:, 0]])
    rows = _joint_rows(lines, len(length), 0.1 * thick)
    needed = (bottom | _within_rows(lines, rows)) & jointed
    return SheetPlate(name, cut, thick, centre, middle, inward, along, length, neighbours, needed, lines, rows, kind)


def _within_rows(lines: tuple[FlankLine, ...], rows: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Flanks that belong to a row of fingers for certain: of an odd number the first or last may be a step of the outline."""
    found: NDArray[np.bool_] = np.zeros(len(rows), dtype=np.bool_)
    for line in lines:
        for row in np.unique(rows[line.rows]):
            flanks = line.rows[rows[line.rows] == row]
            found[flanks] = len(flanks) > 1
            if len(flanks) % 2:
                found[flanks[[0, -1]]] = False
    return found


def _joint_rows(lines: tuple[FlankLine, ...], count: int, tolerance: float) -> NDArray[np.int64]:
    """Number of the row (count,) to which every flank belongs: a line's flanks as far as they follow each other evenly."""
    found: NDArray[np.int64] = np.zeros(count, dtype=np.int64)
    first = 0
    for line in lines:
        stretch, material = np.diff(line.at), line.sense[:-1] > 0
        uneven: NDArray[np.bool_] = np.zeros(len(stretch), dtype=np.bool_)
        for kind in (material, ~material):
            if kind.any():
                uneven |= kind & (stretch > FLANKS.even_stretch * np.median(stretch[kind]) + tolerance)
            if not kind.all():
                uneven |= kind & (stretch > FLANKS.long_stretch * np.median(stretch[~kind]))
        number = first + np.append(0, np.cumsum(uneven))
        found[line.rows] = number
        first = int(number[-1]) + 1
    return found


def _flanks(
    polygon: shapely.Polygon, wanted: Floats, askew: Floats
) -> tuple[Floats, Floats, Floats, Floats, NDArray[np.int64], NDArray[np.bool_], NDArray[np.bool_]]:
    """Midpoints, inward and own directions, lengths, corner neighbours; which are bottoms of slots or holes, and no window's.

    A hole that is no rectangle is a window, for a switch or a lamp: a tab cannot fill it.
    """
    middle: list[Floats] = []
    inward: list[Floats] = []
    along: list[Floats] = []
    length: list[float] = []
    neighbours: list[NDArray[np.int64]] = []
    bottom: list[bool] = []
    jointed: list[bool] = []
    for place, ring in enumerate((polygon.exterior, *polygon.interiors)):
        here = shapely.get_coordinates(ring)[:-1]
        there = np.roll(here, -1, axis=0)
        size = np.hypot(*(there - here).T)
        unit = (there - here) / np.maximum(size, 1e-9)[:, None]
        cosine = (unit * np.roll(unit, 1, axis=0)).sum(1)
        square = np.abs(cosine) < FLANKS.max_square_cosine
        square |= np.roll(square, -1)
        corner = cosine < FLANKS.max_straight_cosine
        bend = corner & np.roll(corner, -1)
        turn = np.roll(unit[:, 0], 1) * unit[:, 1] - np.roll(unit[:, 1], 1) * unit[:, 0]
        convex = turn > 0
        reflex_end = ~convex | ~np.roll(convex, -1)  # the tip of a tab, convex at both ends, holds nothing
        fits = (np.abs(size[:, None] - wanted) < FLANKS.length_tolerance * wanted).any(1)
        fits |= (np.abs(size[:, None] - askew) < ASKEW_LENGTH_TOLERANCE * wanted.min()).any(1)
        fits &= square & bend & reflex_end
        double = _notches_for_two(size, square & bend & (convex ^ np.roll(convex, -1)), fits, float(wanted.min()))
        number: NDArray[np.int64] = np.full(len(here), -1, dtype=np.int64)
        number[fits] = np.arange(fits.sum()) + len(middle)
        window = place > 0 and np.count_nonzero(corner) != 4
        # The side of a notch for two plates on each other is two flanks; such a notch need not be filled.
        for edges, share, part in ((fits, 0.5, 1.0), (double, 0.25, 0.5), (double, 0.75, 0.5)):
            middle += list((here + share * (there - here))[edges])
            inward += list(np.column_stack([-unit[edges, 1], unit[edges, 0]]))
            along += list(unit[edges])
            length += list(part * size[edges])
            neighbours += list(np.column_stack([np.roll(number, 1)[edges], np.roll(number, -1)[edges]]))
            bottom += list(~convex[edges] & ~np.roll(convex, -1)[edges])
            jointed += [not window and part == 1.0] * int(edges.sum())
    rows = len(middle)
    two = [np.array(values, dtype=float).reshape(rows, 2) for values in (middle, inward, along)]
    corners = np.array(neighbours, dtype=np.int64).reshape(rows, 2)
    flags = np.array(bottom, dtype=bool), np.array(jointed, dtype=bool)
    return two[0], two[1], two[2], np.array(length, dtype=float), corners, *flags


def flank_lengths(outlines: Sequence[shapely.Polygon]) -> list[float]:
    """Lengths [mm] that sides and bottoms of notches share, the most frequent ones first, the sides before; rounded to 0.01 mm.

    Examples
    --------
    >>> flank_lengths([shapely.box(0, 0, 40, 30).difference(shapely.box(10, 0, 20, 2.85)).difference(shapely.box(28, 0, 35, 2.85))])
    [2.85]
    """
    counts: dict[float, int] = {}
    for ring in (ring for outline in map(orient, outlines) for ring in (outline.exterior, *outline.interiors)):
        here = shapely.get_coordinates(shapely.simplify(ring, 1e-3))[:-1]
        edge = np.roll(here, -1, axis=0) - here
        size = np.hypot(*edge.T)
        unit = edge / np.maximum(size, 1e-9)[:, None]
        before = np.roll(unit, 1, axis=0)
        square = np.abs((unit * before).sum(1)) < FLANKS.max_square_cosine
        convex = before[:, 0] * unit[:, 1] - before[:, 1] * unit[:, 0] > 0
        sides = square & np.roll(square, -1) & ~(convex & np.roll(convex, -1))
        for length, both in zip(np.round(size[sides], 2).tolist(), (convex | np.roll(convex, -1))[sides], strict=True):
            counts[length] = counts.get(length, 0) + 1 + bool(both)
    return sorted((length for length in counts if counts[length] > 1), key=lambda length: (-counts[length], length))


def _notches_for_two(
    size: Floats, sides: NDArray[np.bool_], fits: NDArray[np.bool_], thickness: float
) -> NDArray[np.bool_]:
    """Which edges of a ring are sides of notches as deep as two plates are thick.

    Parameters
    ----------
    size : (n,) float64 [mm]
    sides : (n,) bool
        Edges square to their neighbours, convex at one end and reflex at the other.
    fits : (n,) bool
        Edges as long as one plate is thick: beside these, such an edge is the bottom or the tip of a common finger.
    thickness : float [mm]
    """
    found = sides & (np.abs(size - 2.0 * thickness) < FLANKS.length_tolerance * thickness)
    found &= ~fits & ~np.roll(fits, 1) & ~np.roll(fits, -1)
    return found if found.sum() >= FLANKS.double_flanks else np.zeros_like(found)


def _lines(
    cut: shapely.Polygon, middle: Floats, inward: Floats, length: Floats, thickness: float
) -> tuple[FlankLine, ...]:
    """Group flanks by the line on which their midpoints and inward directions lie."""
    corners, tolerance = shapely.get_coordinates(cut.exterior), 0.12 * thickness
    left: list[int] = list(range(len(middle)))
    found = []
    while left:
        first = inward[left[0]]
        along = first if first[0] > 1e-6 or (abs(first[0]) <= 1e-6 and first[1] > 0) else -first
        across = np.array([-along[1], along[0]])
        parallel = np.abs(inward[left] @ across) < 0.02
        on = parallel & (np.abs((middle[left] - middle[left[0]]) @ across) < tolerance)
        rows: NDArray[np.int64] = np.array(left, dtype=np.int64)[on]
        at = middle[rows] @ along
        if np.ptp(at) > 20 * tolerance:  # a long line's own direction is known better than that of one flank
            along = _direction(middle[rows], along)
            across = np.array([-along[1], along[0]])
            at = middle[rows] @ along
        order = np.argsort(at)
        rows = rows[order]
        offset = float((middle[rows] @ across).mean())
        beyond = corners @ across - offset
        outward = float(beyond.max() < 0.75 * thickness) - float(beyond.min() > -0.75 * thickness)
        sense = np.sign(inward[rows] @ along)
        found.append(FlankLine(along, across, outward, offset, at[order], sense, length[rows], rows))
        left = [row for row in left if row not in set(rows.tolist())]
    return tuple(found)


def _direction(points: Floats, near: Floats) -> Floats:
    """Unit direction of a line through points; an axis of the sheet where it is one to a thousandth."""
    apart = points - points.mean(axis=0)
    _, _, axes = np.linalg.svd(apart, full_matrices=False)
    along = axes[0] if axes[0] @ near > 0 else -axes[0]
    snapped = np.round(along)
    return snapped if np.abs(along - snapped).max() < 1e-3 and np.abs(snapped).sum() == 1 else along


def bits(flags: NDArray[np.bool_]) -> list[int]:
    """Every row of `flags` (k, n) as an integer whose bit i is flag i.

    Examples
    --------
    >>> bits(np.array([[True, False, True], [False, True, False]]))
    [5, 2]
    """
    packed = np.packbits(flags, axis=1, bitorder="little")
    return [int.from_bytes(row.tobytes(), "little") for row in packed]


def flank_rows(mask: int) -> Iterator[int]:
    """Numbers of the bits that are set, ascending."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low
