"""What stays the same from question to question: bodies, pairs that can meet, and their cells at rest."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from operator import itemgetter

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.findings import free_overlaps
from wiggleroom.assembly.overlaps import CONTACT_TOLERANCE
from wiggleroom.audit.audit_outlines import AuditOutlines, outlines
from wiggleroom.displayable import Displayable
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import FreeSpaceError, InputError, Stop, TouchingError, go_on
from wiggleroom.freespace.cells.cells import Cells, grow_cells, select
from wiggleroom.freespace.models.pair_models import Walls
from wiggleroom.geometry.bodies import Bodies, bodies
from wiggleroom.geometry.congruence_classes import congruence_classes
from wiggleroom.geometry.neighbours import Pairs, neighbours
from wiggleroom.geometry.outline_distances import OutlineDistances
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.program.objectives import Objective, objective

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CLEARANCE_SAMPLES = 200
"""The typical clearance is taken from at most this many bodies."""
NEIGHBOUR_REACH = 3.0
"""Pairs closer than this multiple of the typical clearance are in the program from the start."""


@dataclass(frozen=True, eq=False)
class Prepared(Displayable):
    """An assembly made ready for questions.

    Parameters
    ----------
    assembly : Assembly
    bodies : Bodies
    ignored : (k,) int64
        Keys a * n + b of pairs of bodies that never collide.
    clearance : float [mm]
        Typical clearance between neighbours.
    size : float [mm]
        Longer side of the box round everything.
    cells : Cells
        One cell, grown at rest, for every pair with edges that face each other.
    corners : (k,) int64
        Keys a * n + b of pairs that are near at a corner only. They join the program after the first round, which shows on which side
        they pass each other.
    simplified : float [mm]
        Largest distance of the outlines of the bodies outside those of the assembly's parts; never inside.
    """

    assembly: Assembly
    bodies: Bodies
    ignored: Ints
    clearance: float
    size: float
    cells: Cells
    corners: Ints
    simplified: float = 0.0
    model: Walls = field(default_factory=Walls)

    @cached_property
    def outlines(self) -> AuditOutlines:
        """What the judge of paths is given."""
        return outlines(self.assembly)

    def objective(self, goals: tuple[Goal, ...]) -> Objective:
        """What the program maximises for some goals."""
        return objective(self.assembly, self.bodies, goals, self._near)

    @cached_property
    def _near(self) -> tuple[Ints, Ints]:
        """Pairs of bodies that are near each other at rest."""
        n = len(self.bodies.fixed)
        near = np.union1d(self.cells.a * n + self.cells.b, self.corners)
        return near // n, near % n


def prepare_as_drawn(assembly: Assembly, *, surveyed: Survey | None = None, stop: Stop | None = None) -> Prepared:
    """Find the pairs that can meet and work out their cells round rest, congruent pairs once; see `wiggleroom.prepare`.

    Raises
    ------
    FreeSpaceError
        If two parts do not touch, but no free space was found round where they lie.
    """
    surveyed = surveyed or survey(assembly, stop)
    them, geometry, near = surveyed.bodies, surveyed.geometry, surveyed.near
    a, b = near.a, near.b
    go_on(stop)
    first, label = congruence_classes(them, a, b, relative_pose(them, a, b))
    facing = _facing(geometry[a[first]], geometry[b[first]], surveyed.clearance)[label]
    go_on(stop)
    cells = cells_at(assembly, them, a[facing], b[facing], near.clearance[facing], stop)
    corners = a[~facing] * len(geometry) + b[~facing]
    return Prepared(assembly, them, surveyed.ignored, surveyed.clearance, surveyed.size, cells, corners)


def prepare_without_cells(assembly: Assembly, surveyed: Survey) -> Prepared:
    """The assembly made ready for what needs no cells: paths and proofs by boxes of motions."""
    none = surveyed.near.a[:0]
    cells = cells_at(assembly, surveyed.bodies, none, none, surveyed.near.clearance[:0])
    return Prepared(assembly, surveyed.bodies, surveyed.ignored, surveyed.clearance, surveyed.size, cells, none)


@dataclass(frozen=True, eq=False)
class Survey:
    """What every pair model begins with.

    Parameters
    ----------
    bodies : Bodies
    geometry : (n,) shapely geometries
        Material at rest.
    ignored : (k,) int64
        Keys a * n + b of pairs of bodies that never collide.
    clearance : float [mm]
        Typical clearance between neighbours.
    size : float [mm]
        Longer side of the box round everything.
    near : Pairs
        Bodies no further apart than a few clearances.
    """

    bodies: Bodies
    geometry: NDArray[np.object_]
    ignored: Ints
    clearance: float
    size: float
    near: Pairs


def survey(assembly: Assembly, stop: Stop | None = None, clearance: float | None = None) -> Survey:
    """Bodies and neighbours of an assembly, once it is sure that none touch; raises as `prepare_as_drawn` does.

    `clearance` is the typical one [mm], where it is known already.
    """
    them = bodies(assembly)
    if them.fixed.all():
        finding = f"{assembly.drawing.source or 'the assembly'}: every part is fixed; at least one must be free to move"
        raise InputError(finding)
    ignored = _ignored(assembly, them)
    geometry, size = placed(them), assembly.size
    clearance = clearance or typical_clearance(assembly.gap, geometry, size, stop)
    near = neighbours(them, geometry, NEIGHBOUR_REACH * clearance, ignored=ignored, stop=stop)
    if len(near.a) and near.clearance.min() < CONTACT_TOLERANCE * size:
        _refuse_touching(assembly, them, near, size)
    return Survey(them, geometry, ignored, clearance, size, near)


def _facing(a: NDArray[np.object_], b: NDArray[np.object_], clearance: float) -> NDArray[np.bool_]:
    """True where boundaries run along each other, not only past a corner."""
    near = shapely.buffer(b, 1.5 * NEIGHBOUR_REACH * clearance)
    return shapely.length(shapely.intersection(shapely.boundary(a), near)) > 5 * NEIGHBOUR_REACH * clearance


def cells_at(assembly: Assembly, them: Bodies, a: Ints, b: Ints, clearance: Floats, stop: Stop | None = None) -> Cells:
    """Cells of some pairs round rest; congruent pairs are worked out once."""
    cells, good = congruent_cells(them, a, b, clearance, stop)
    if not good.all():
        k = np.flatnonzero(~good)[0]
        one, other = (" + ".join(assembly.names[p] for p in them.members[x]) for x in (a[k], b[k]))
        finding = (
            f'{assembly.drawing.source or "the assembly"}: parts "{one}" and "{other}": no free space was found round '
            "where they lie; two corners may point at each other: round one off, or give a larger gap"
        )
        raise FreeSpaceError(finding)
    return cells


def congruent_cells(
    them: Bodies, a: Ints, b: Ints, clearance: Floats, stop: Stop | None = None
) -> tuple[Cells, NDArray[np.bool_]]:
    """Cells of some pairs round rest, and which of them (P,) are free there; congruent pairs are worked out once."""
    pose = relative_pose(them, a, b)
    first, label = congruence_classes(them, a, b, pose)
    grown, good = grow_cells(them, a[first], b[first], pose[first], clearance[first], stop=stop)
    cells = select(grown, label)
    turns = np.round((pose[:, 2] - pose[first[label], 2]) / (2 * np.pi)) * (2 * np.pi)
    placed = Cells(a, b, cells.row, cells.kind, cells.edge, cells.corner, cells.ends + turns[:, None], pose)
    return placed, good[label]


def typical_clearance(gap: float, geometry: NDArray[np.object_], size: float, stop: Stop | None = None) -> float:
    """Typical distance between neighbours [mm]: the gap where it was given and most bodies have a neighbour there, else the median.

    Raises
    ------
    StoppedError
        If it was asked to stop.
    """
    if len(geometry) < 2:
        return float(gap) or 1e-3 * size
    some = np.linspace(0, len(geometry) - 1, min(len(geometry), CLEARANCE_SAMPLES)).astype(np.int64)
    apart = OutlineDistances(geometry).to_nearest(some, stop)
    apart = apart[np.isfinite(apart) & (apart > CONTACT_TOLERANCE * size)]
    middle = float(np.median(apart)) if len(apart) else 1e-3 * size
    return float(gap) if 0.3 * middle < gap < 3 * middle else middle


def _ignored(assembly: Assembly, them: Bodies) -> Ints:
    """Pairs of bodies that never collide; a body of several parts is barred only where all its parts are."""
    index = {name: k for k, name in enumerate(assembly.names)}
    said: dict[tuple[int, int], int] = {}
    for pair in {frozenset(p) for p in assembly.drawing.ignore}:
        one, other = (index[name] for name in pair)
        a, b = sorted((int(them.body_of[one]), int(them.body_of[other])))
        if a != b:
            said[a, b] = said.get((a, b), 0) + 1
    n = len(them.fixed)
    partly = [(a, b) for (a, b), count in said.items() if count < len(them.members[a]) * len(them.members[b])]
    if partly:
        a, b = partly[0]
        names = [" + ".join(assembly.names[p] for p in them.members[k]) for k in (a, b)]
        finding = f'"ignore" covers only some parts of the glued bodies {names[0]} and {names[1]}; name every pair of their parts'
        raise InputError(finding)
    return np.array([a * n + b for a, b in said], dtype=np.int64)


def _refuse_touching(assembly: Assembly, them: Bodies, near: Pairs, size: float) -> None:
    deep = max(free_overlaps(assembly.drawing, assembly.parts), key=itemgetter(2), default=None)
    if deep is not None:
        a, b, depth = deep
        finding = (
            f'{assembly.drawing.source or "the assembly"}: parts "{a}" and "{b}" overlap by {depth:.6g} mm at rest, gap '
            f"{assembly.gap:g}; parts may not overlap: give a larger gap, or correct the drawing"
        )
        raise TouchingError(finding, (a, b), -depth)
    k = int(near.clearance.argmin())
    one, other = (assembly.names[them.members[body[k]][0]] for body in (near.a, near.b))
    count = int((near.clearance < CONTACT_TOLERANCE * size).sum())
    more = f" (and {count - 1} more pairs)" if count > 1 else ""
    finding = (
        f'{assembly.drawing.source or "the assembly"}: parts "{one}" and "{other}" touch at rest, clearance '
        f"{near.clearance[k]:.3g} mm{more}; there is no room to move: give a gap, for example --gap {_nice(size / 500)}"
    )
    raise TouchingError(finding, (one, other), float(near.clearance[k]))


def _nice(x: float) -> str:
    """A round number near x."""
    digit = 10.0 ** np.floor(np.log10(x))
    return f"{digit * np.round(x / digit):.12g}"
