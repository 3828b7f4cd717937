"""What a person said of edges, as constraints of the search: joined edges, flush edges, and panels whose pose is given.

A join asks that flanks of one edge meet flanks of the other, a flush pair that two edges end in one plane (the mate and
flush constraints of assembly modelling). They are kept during the search, not judged after it.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.errors import InputError
from wiggleroom.mating.cutting_sheet import CuttingSheet, Outlined
from wiggleroom.mating.flanks import SheetPlate
from wiggleroom.mating.hints import EdgePair, EdgeReference, Hints

Floats = NDArray[np.float64]

REACH = 2.0
"""A point means a panel, or an edge, that is nearer than this many thicknesses."""
FLUSH = 0.2
"""Edges are flush that are nearer to one plane than this share of the thickness."""
MET_SHARE = 0.5
"""Of two edges that are joined at least this share of the flanks of the smaller one meet."""
_OUTWARD = {"left": (-1.0, 0.0), "right": (1.0, 0.0), "bottom": (0.0, -1.0), "top": (0.0, 1.0)}


@dataclass(frozen=True)
class JoinedEdges:
    """Two edges of which one holds the other.

    Parameters
    ----------
    panels : (int, int)
    flanks : (int, int)
        Flanks of each edge, as bits.
    least : int
        Fewest pairs of flanks that meet.
    words : str
    """

    panels: tuple[int, int]
    flanks: tuple[int, int]
    least: int
    words: str

    def held(self, met: tuple[int, int]) -> bool:
        """Whether enough of the flanks (bits, of the one and the other panel) meet."""
        return all((own & edge).bit_count() >= self.least for own, edge in zip(met, self.flanks, strict=True))


@dataclass(frozen=True, eq=False)
class FlushEdges:
    """Two edges that end in one plane.

    Parameters
    ----------
    panels : (int, int)
    points, outward : (2, 2) float64
        Of each edge, in the frame of its panel: a point [mm], and the direction out of the panel.
    tolerance : float [mm]
    words : str
    """

    panels: tuple[int, int]
    points: Floats
    outward: Floats
    tolerance: float
    words: str

    def held(self, turns: Sequence[Floats], moves: Sequence[Floats]) -> bool:
        """Whether the edges lie in one plane and look the same way, for poses of both panels."""
        directions = [turn[:, :2] @ outward for turn, outward in zip(turns, self.outward, strict=True)]
        places = [turn[:, :2] @ point + move for turn, point, move in zip(turns, self.points, moves, strict=True)]
        return bool(
            directions[0] @ directions[1] > 0.99 and abs((places[0] - places[1]) @ directions[0]) < self.tolerance
        )


@dataclass(frozen=True, eq=False)
class GivenPose:
    """Where a panel stands in the frame of another.

    Parameters
    ----------
    panels : (int, int)
        The one whose frame it is, and the one that stands in it.
    turn, move : (3, 3) and (3,) float64 [mm]
    tolerance : float [mm]
    """

    panels: tuple[int, int]
    turn: Floats
    move: Floats
    tolerance: float

    def held(self, turns: Sequence[Floats], moves: Sequence[Floats]) -> bool:
        """Whether the panel stands there, for poses of both panels."""
        turn, move = turns[0].T @ turns[1], turns[0].T @ (moves[1] - moves[0])
        return bool(np.abs(turn - self.turn).max() < 0.01 and np.abs(move - self.move).max() < self.tolerance)


@dataclass(frozen=True, eq=False)
class EdgeConstraints:
    """Everything that was said of edges and poses.

    Parameters
    ----------
    joins : tuple of JoinedEdges
    flush : tuple of FlushEdges
    poses : tuple of GivenPose
    """

    joins: tuple[JoinedEdges, ...] = ()
    flush: tuple[FlushEdges, ...] = ()
    poses: tuple[GivenPose, ...] = ()

    @property
    def named(self) -> frozenset[int]:
        """Panels of which something was said: none of them may stand for one that is congruent."""
        return frozenset(row for panels, _ in self.pairs for row in panels) | frozenset(
            row for pose in self.poses for row in pose.panels
        )

    @property
    def pairs(self) -> list[tuple[tuple[int, int], str]]:
        """Panels whose edges belong together, and what was said of them."""
        return [(join.panels, join.words) for join in self.joins] + [(pair.panels, pair.words) for pair in self.flush]

    def between(self, a: int, b: int) -> list[JoinedEdges]:
        """Joins of two panels, seen from panel `a`."""
        found = [join for join in self.joins if join.panels == (a, b)]
        return found + [
            JoinedEdges((a, b), join.flanks[::-1], join.least, join.words)
            for join in self.joins if join.panels == (b, a)
        ]  # fmt: skip

    def allow(
        self,
        rows: Sequence[int],
        turns: Floats,
        moves: Floats,
        other: int,
        turn: Floats,
        move: Floats,
        met: Mapping[int, tuple[int, int]],
    ) -> bool:
        """Whether a panel may be added to a placement.

        Parameters
        ----------
        rows : sequence of int
            Panels placed before, with their `turns` and `moves`.
        other : int
            The panel that is added, with its `turn` and `move`.
        met : mapping of int to (int, int)
            By panel placed before, flanks of that one and of the new one that meet, as bits.
        """
        for join in self.joins:
            for a, b, ea, eb in ((*join.panels, *join.flanks), (*join.panels[::-1], *join.flanks[::-1])):
                if b == other and a in rows:
                    own, new = met.get(a, (0, 0))
                    if min((own & ea).bit_count(), (new & eb).bit_count()) < join.least:
                        return False
                elif b == other and any(new & eb for _, new in met.values()):
                    return False  # the edge is taken by another panel
                elif a in rows and b not in rows and met.get(a, (0, 0))[0] & ea:
                    return False
        ties: tuple[FlushEdges | GivenPose, ...] = (*self.flush, *self.poses)
        for pair in ties:
            if other in pair.panels:
                there = pair.panels[1 - pair.panels.index(other)]
                if there in rows:
                    k = list(rows).index(there)
                    poses = {there: (turns[k], moves[k]), other: (turn, move)}
                    if not pair.held(*zip(*(poses[row] for row in pair.panels), strict=True)):
                        return False
        return True


def without_skipped(sheet: CuttingSheet, hints: Hints) -> CuttingSheet:
    """Sheet without the outlines that are said to be no panels.

    Raises
    ------
    InputError
        With one line for every name in the hints that no panel has, and every point that lies on none.
    """
    known = [panel.name for panel in sheet.panels]
    said = [*hints.thicknesses, *hints.skip, *(name for group in hints.groups for name in group)]
    said += [edge.panel for pair in (*hints.joins, *hints.flush) for edge in pair if edge.panel]
    said += [name for plate in hints.plates for name in (plate.panel, plate.frame)]
    findings = []
    for name in dict.fromkeys(said):
        if name not in known:
            near = difflib.get_close_matches(name, known, 1)
            meant = f'did you mean "{near[0]}"?' if near else f"it must be one of {', '.join(known[:8])}"
            findings.append(f'{sheet.source}: there is no panel "{name}"; {meant}')
    if findings:
        raise InputError(findings)
    if not hints.skip:
        return sheet
    left = tuple(panel for panel in sheet.panels if panel.name not in hints.skip)
    if not left:
        message = f"{sheet.source}: skip leaves no panel; leave out what is no part of the whole alone"
        raise InputError(message)
    note = f"{sheet.source}: left out as said: {', '.join(dict.fromkeys(hints.skip))}"
    return replace(sheet, panels=left, notes=(*sheet.notes, note))


def edge_constraints(sheet: CuttingSheet, plates: Sequence[SheetPlate], hints: Hints) -> EdgeConstraints:
    """Edges and poses of hints found on the panels.

    Raises
    ------
    InputError
        With one line for every point that lies on no panel, and every edge that has nothing to join.
    """
    findings: list[str] = []
    joins: list[JoinedEdges] = []
    flush: list[FlushEdges] = []
    for key, pairs in (("join", hints.joins), ("flush", hints.flush)):
        for i, pair in enumerate(pairs):
            where = f"{key}[{i}]"
            rows = [_panel_row(sheet, plates, edge, where, findings) for edge in pair]
            if None in rows:
                continue
            a, b = (row for row in rows if row is not None)
            if a == b:
                findings.append(f"{where}: {pair[0]} and {pair[1]} are both of {plates[a].name}; name two panels")
            elif key == "join":
                found = _joined(plates, (a, b), pair, where, findings)
                joins += [found] if found else []
            else:
                flush.append(_flush(plates, (a, b), pair))
    names = [plate.name for plate in plates]
    poses = []
    for plate in hints.plates:
        frame, row = names.index(plate.frame), names.index(plate.panel)
        if frame == row:
            findings.append(f"plate: {plate.panel} stands in its own frame; name another panel as frame")
        right, up = (np.array(axis) / np.linalg.norm(axis) for axis in (plate.right, plate.up))
        turn = np.column_stack([right, up, np.cross(right, up)])
        poses.append(GivenPose((frame, row), turn, np.array(plate.centre), FLUSH * plates[row].thickness))
    if findings:
        raise InputError([f"{sheet.source}: {finding}" for finding in findings])
    return EdgeConstraints(tuple(joins), tuple(flush), tuple(poses))


def _panel_row(
    sheet: CuttingSheet, plates: Sequence[SheetPlate], edge: EdgeReference, where: str, findings: list[str]
) -> int | None:
    """Which panel an edge is of."""
    if edge.point is None:
        return next(k for k, panel in enumerate(sheet.panels) if panel.name == edge.panel)
    point = shapely.Point(edge.point)
    apart = [panel.polygon.distance(point) for panel in sheet.panels]
    near = int(np.argmin(apart))
    if edge.panel:
        row = next(k for k, panel in enumerate(sheet.panels) if panel.name == edge.panel)
        if apart[row] > REACH * plates[row].thickness:
            findings.append(f"{where}: {edge} is {apart[row]:.3g} mm away from that panel; {_box(sheet.panels[row])}")
            return None
        return row
    if apart[near] > REACH * plates[near].thickness:
        name = sheet.panels[near].name
        findings.append(
            f"{where}: there is no panel at {str(edge)[1:]}; the nearest is {name}, {apart[near]:.3g} mm away"
        )
        return None
    return near


def _box(panel: Outlined) -> str:
    x0, y0, x1, y1 = panel.polygon.bounds
    return f"it lies from {x0:.4g},{y0:.4g} to {x1:.4g},{y1:.4g}"


def edge_flanks(plate: SheetPlate, edge: EdgeReference) -> int:
    """Flanks of an edge as bits: of all lines along a side, or of the row of fingers nearest to a point."""
    rows: set[int] = set()
    if edge.point is not None:
        point = np.array(edge.point) - plate.centre
        apart = {row: _distance(plate, row, point) for row in _row_numbers(plate)}
        near = min(apart, key=lambda row: apart[row], default=None)
        if near is not None and apart[near] <= REACH * plate.thickness:
            rows = set(np.flatnonzero(plate.joint_rows == near).tolist())
    else:
        outward = np.array(_OUTWARD[edge.side])
        most = float((shapely.get_coordinates(plate.polygon) @ outward).max())
        for line in plate.lines:
            along_side = abs(line.along @ outward) < 0.1
            if along_side and abs(line.offset * (line.across @ outward) - most) < REACH * plate.thickness:
                rows |= set(line.rows.tolist())
    return sum(1 << row for row in rows)


def _row_numbers(plate: SheetPlate) -> list[int]:
    return np.unique(plate.joint_rows).tolist() if len(plate.length) else []


def _distance(plate: SheetPlate, row: int, point: Floats) -> float:
    middles = plate.middle[plate.joint_rows == row]
    return float(shapely.MultiPoint(middles).convex_hull.distance(shapely.Point(point)))


def _joined(
    plates: Sequence[SheetPlate], panels: tuple[int, int], pair: EdgePair, where: str, findings: list[str]
) -> JoinedEdges | None:
    flanks = [edge_flanks(plates[row], edge) for row, edge in zip(panels, pair, strict=True)]
    bare = [str(edge) for edge, bits in zip(pair, flanks, strict=True) if not bits]
    if bare:
        findings.append(
            f"{where}: {' and '.join(bare)} has no fingers, slots or holes as wide as the material is thick; "
            "name edges that have, or give the place of the panel ([[plate]])"
        )
        return None
    least = max(1, math.ceil(MET_SHARE * min(bits.bit_count() for bits in flanks)))
    return JoinedEdges(panels, (flanks[0], flanks[1]), least, f"{pair[0]} and {pair[1]}")


def _flush(plates: Sequence[SheetPlate], panels: tuple[int, int], pair: EdgePair) -> FlushEdges:
    found = [_edge_plane(plates[row], edge) for row, edge in zip(panels, pair, strict=True)]
    points, outward = (np.array(values) for values in zip(*found, strict=True))
    tolerance = FLUSH * min(plates[row].thickness for row in panels)
    return FlushEdges(panels, points, outward, tolerance, f"{pair[0]} and {pair[1]}")


def _edge_plane(plate: SheetPlate, edge: EdgeReference) -> tuple[Floats, Floats]:
    """A point of an edge and the direction out of the panel; where fingers stand out, that of their tips."""
    here = shapely.get_coordinates(plate.polygon.exterior)[:-1]
    if edge.point is None:
        outward = np.array(_OUTWARD[edge.side])
        return here[int(np.argmax(here @ outward))], outward
    there = np.roll(here, -1, axis=0)
    point = np.array(edge.point) - plate.centre
    along = (there - here) / np.maximum(np.hypot(*(there - here).T), 1e-12)[:, None]
    k = int(np.argmin(shapely.distance(shapely.linestrings(np.stack([here, there], axis=1)), shapely.Point(point))))
    outward = np.array([along[k, 1], -along[k, 0]])  # rings run counterclockwise, material is left of them
    beyond = (here - here[k]) @ outward
    near = (beyond < 1.5 * plate.thickness) & (beyond >= 0) & (np.abs((here - point) @ along[k]) < 20 * plate.thickness)
    tip = int(np.argmax(np.where(near, beyond, -1.0)))
    return here[tip], outward
