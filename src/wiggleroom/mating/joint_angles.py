"""Angles at which plates meet, and the plates of a sheet, whose fingers are as long as these angles ask.

Walls that stand upright on two edges of a panel meet at the angle between these edges. Walls that lean do not: there the angles of
three faces at a corner say the angles between the faces (spherical law of cosines). Which corners belong together is not known
yet: those do whose edges have as many fingers, as long, on all three edges, as these angles ask.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.mating.contact import ASKEW_LENGTH_TOLERANCE, finger_length
from wiggleroom.mating.flanks import FlankLine, SheetPlate, plates_with

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class JointAngleSettings:
    """Which angles are looked for.

    Parameters
    ----------
    row_flanks : int
        Rows of at least as many flanks say at which angles panels meet.
    least_angle, square_angle : float [degrees]
        Angles below the one, and nearer to a right angle than the other, are not looked for.
    square_corner : float [degrees]
        The same for angles that corners of three panels ask for: walls that lean a little all lean.
    max_angles : int
        How many of them, the most frequent ones.
    shortest_finger : float in (0, 1)
        Fingers shorter than this share of the thickness say nothing.
    corner_reach : float > 0
        Edges end in one corner if their fingers' lines cross nearer to the panel than this many thicknesses.
    more_flanks : int
        Of two edges that belong together one may have as many flanks more, which the ends of the other swallow.
    """

    row_flanks: int = 4
    least_angle: float = 20.0
    square_angle: float = 4.0
    square_corner: float = 0.5
    max_angles: int = 6
    shortest_finger: float = 0.35
    corner_reach: float = 2.0
    more_flanks: int = 2


SETTINGS = JointAngleSettings()


@dataclass(frozen=True, order=True)
class FingeredCorner:
    """Corner of a panel between two edges that both have fingers.

    Parameters
    ----------
    angle : float [degrees]
        Inside the panel.
    before, after : (int, float)
        Of its edges, how many flanks of fingers and how long they are, as a share of the thickness.
    """

    angle: float
    before: tuple[int, float]
    after: tuple[int, float]


def plates_of(
    names: list[str], polygons: list[shapely.Polygon], thickness: list[float], burn: float
) -> tuple[SheetPlate, ...]:
    """Plates of the panels of a sheet.

    Parameters
    ----------
    names : list of str
    polygons : list of shapely.Polygon [mm]
        As drawn on the sheet.
    thickness : list of float [mm]
        Nominal, one a panel.
    burn : float [mm]
        By how much outlines were drawn larger.
    """
    # At first fingers of any length count, for it is the angles that say how long they are.
    shares = np.arange(1.0 - ASKEW_LENGTH_TOLERANCE, SETTINGS.shortest_finger, -ASKEW_LENGTH_TOLERANCE)
    plates = plates_with(names, polygons, thickness, burn, np.arcsin(shares))
    return plates_with(names, polygons, thickness, burn, joint_angles(plates))


def joint_angles(plates: Sequence[SheetPlate]) -> Floats:
    """Angles [rad] other than right ones by which plates may turn at a joint, each with the one that makes up half a turn."""
    said: list[float] = []
    corners: list[FingeredCorner] = []
    for plate in plates:
        for a, b, follow in _rows_side_by_side(plate):
            sine, cosine = abs(a.along[0] * b.along[1] - a.along[1] * b.along[0]), float(a.across @ b.across)
            angle = float(np.degrees(np.arctan2(sine, abs(cosine))))
            if angle < 90.0 - SETTINGS.square_angle:
                said.append(angle)
            if follow and _off_corner(plate, a, b) < SETTINGS.corner_reach * plate.thickness:
                outside = float(np.degrees(np.arctan2(sine, cosine * a.outward * b.outward)))
                fingers = [(len(row.rows), round(float(row.length.mean()) / plate.thickness, 2)) for row in (a, b)]
                corners.append(FingeredCorner(round(180.0 - outside, 2), *fingers))
    asked = (min(turn, 180.0 - turn) for turn in trihedral_angles(corners))
    said += [angle for angle in asked if angle < 90.0 - SETTINGS.square_corner]
    alike: dict[float, list[float]] = {}
    for angle in said:
        if angle > SETTINGS.least_angle:
            alike.setdefault(round(angle, 1), []).append(angle)
    usual = [float(np.mean(each)) for each in sorted(alike.values(), key=len, reverse=True)[: SETTINGS.max_angles]]
    return np.radians(sorted({*usual, *(180.0 - angle for angle in usual)}))


def _rows_side_by_side(plate: SheetPlate) -> list[tuple[FlankLine, FlankLine, bool]]:
    """Every two rows of fingers on edges that follow each other round a panel (True), and every two of which one is within it (False)."""
    lines = [line for line in plate.lines if len(line.rows) >= SETTINGS.row_flanks]
    edges = [k for k, line in enumerate(lines) if line.outward]
    ring, middle = plate.polygon.exterior, plate.middle
    order = sorted((ring.project(shapely.Point(middle[row])), k) for k in edges for row in lines[k].rows.tolist())
    round_it = [k for _, k in order]
    beside = {frozenset(pair) for pair in zip(round_it, round_it[1:] + round_it[:1], strict=True)}
    pairs = [(i, j) for i, j in combinations(range(len(lines)), 2) if {i, j} in beside or not {i, j} <= set(edges)]
    return [(lines[i], lines[j], {i, j} in beside) for i, j in pairs]


def _off_corner(plate: SheetPlate, a: FlankLine, b: FlankLine) -> float:
    """How far off a panel two lines of flanks cross [mm]: far where an edge lies between them, infinite where they hardly turn."""
    rows = np.array([a.across, b.across])
    if abs(np.linalg.det(rows)) < np.sin(np.radians(SETTINGS.least_angle)):
        return np.inf
    return float(plate.polygon.distance(shapely.Point(np.linalg.solve(rows, [a.offset, b.offset]))))


def trihedral_angles(corners: Iterable[FingeredCorner]) -> Iterator[float]:
    """Angles [degrees] between the normals of plates at joints, for every three corners that fit each other.

    Examples
    --------
    Three equal corners of 90 degrees: a cube.

    >>> [round(turn, 6) for turn in trihedral_angles([FingeredCorner(90.0, (8, 1.0), (8, 1.0))])]
    [90.0, 90.0, 90.0]
    """
    given = set(corners)
    known = sorted(given | {FingeredCorner(each.angle, each.after, each.before) for each in given})
    for p in known:
        for q in (each for each in known if _alike(p.after, each.before)):
            for r in (each for each in known if _alike(q.after, each.before) and _alike(each.after, p.before)):
                turns = _turns(p.angle, q.angle, r.angle)
                opposite = (q.after, r.after, p.after)
                if all(
                    _as_long(finger_length(np.cos(np.radians(turn)), 1.0), length)
                    for turn, (_, length) in zip(turns, opposite, strict=False)
                ):
                    yield from turns


def _alike(a: tuple[int, float], b: tuple[int, float]) -> bool:
    """Whether the fingers of two edges may belong together."""
    return abs(a[0] - b[0]) <= SETTINGS.more_flanks and _as_long(a[1], b[1])


def _as_long(a: float, b: float) -> bool:
    return abs(a - b) < ASKEW_LENGTH_TOLERANCE


def _turns(*faces: float) -> tuple[float, ...]:
    """Angles between normals at the edges opposite to faces with these angles at their corner; none where they make no corner."""
    cosine, sine = np.cos(np.radians(faces)), np.sin(np.radians(faces))
    dihedral = [(cosine[k] - cosine[k - 1] * cosine[k - 2]) / (sine[k - 1] * sine[k - 2]) for k in range(3)]
    if max(map(abs, dihedral)) >= 1.0:
        return ()
    return tuple(float(np.degrees(np.arccos(-each))) for each in dihedral)
