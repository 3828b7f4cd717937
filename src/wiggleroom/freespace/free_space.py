"""The free space of one pair of parts, as a union of cells."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import overload

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, require_planar
from wiggleroom.assembly.overlaps import CONTACT_TOLERANCE
from wiggleroom.assembly.statements import unknown
from wiggleroom.compiled.jit_options import njit
from wiggleroom.displayable import Drawable
from wiggleroom.errors import InputError, Stop, TouchingError, go_on
from wiggleroom.freespace.cells.cells import Cells
from wiggleroom.freespace.cells.cover import cover
from wiggleroom.freespace.models.halfplane import half_planes
from wiggleroom.freespace.models.hull import hulls, joint_point
from wiggleroom.freespace.models.pair_models import HalfPlane, Hull, PairModel, Walls, model_named
from wiggleroom.freespace.models.polyhedron import Polyhedron
from wiggleroom.freespace.slices import Slice, SliceSequence, pair_outlines, slice_sequence
from wiggleroom.geometry.bodies import Bodies, bodies
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import PairFrames, relate, rotated
from wiggleroom.geometry.row_kinds import A_EDGE

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

HALF_PLANE_REACH = 6.0
"""Half-planes are made of corners and edges no further apart than this multiple of the clearance."""
OPEN_REACH = 10.0
"""Open free spaces are worked out this many clearances far, though no further than the larger part's radius."""


@dataclass(frozen=True, eq=False)
class FreeSlices:
    """Exact slices of all relative motions of part b against part a that are free of overlap and connected to rest.

    Relative motions are (tau, phi): where part b's reference point is in part a's frame and how far b is turned
    against a, less the same at rest. Parts glued to a or b count as their material.

    Parameters
    ----------
    assembly : Assembly
        Where the two parts are from.
    parts : (a, b)
        Names.
    slices : tuple of Slice [mm]
        By angle; regions of tau.
    angles : (low, high) [rad]
        Range of phi.
    closed : bool
        True where the space ends on all sides: the parts hold each other, whatever the others do.
    reach : float [mm]
        Where the space is open, it is worked out only as far as the `pivot` moves no further than this from rest, in x
        and in y of part a's frame; infinite where it is closed.
    pivot : (2,) float64 [mm]
        That point of b, from b's reference point, in the axes of a's frame at rest: the middle of b's material near a.
    """

    assembly: Assembly
    parts: tuple[str, str]
    slices: tuple[Slice, ...]
    angles: tuple[float, float]
    closed: bool
    reach: float
    pivot: Floats


@dataclass(frozen=True, eq=False)
class FreeSpace(FreeSlices, Drawable):
    """Free space as a union of cells, each free of overlap by its walls, with slices evenly spaced over the angles.

    Parameters
    ----------
    cells : Cells
        Regions free of overlap that together cover the space, in relative poses of the bodies.
    coverage : float
        Share of the slices' volume that the cells cover.
    """

    cells: Cells
    coverage: float
    _bodies: Bodies
    _relation: PairFrames
    _full: bool

    @property
    def rows(self) -> int:
        """Walls of all cells, the ends of their angle intervals not counted."""
        return int(self.cells.is_wall.sum())

    @property
    def intervals(self) -> Floats:
        """Turns phi (c, 2) [rad] between which each cell holds."""
        return self.cells.ends - self._relation.psi

    def contains(self, relative: Floats) -> NDArray[np.bool_]:
        """Which relative motions lie in the space.

        Parameters
        ----------
        relative : (k, 3) float64 [mm, mm, rad]

        Returns
        -------
        (k,) bool
            True only where the parts do not overlap; False also for the small share of the space that no cell covers.
        """
        motion = np.asarray(relative, dtype=float)
        if motion.ndim != 2 or motion.shape[1] != 3:
            finding = f"relative motions have shape {motion.shape}: they must be (k, 3), x, y [mm] and turn [rad]"
            raise InputError(finding)
        shift = self._relation.shift(motion)
        pose = self._relation.pose(shift, motion[:, 2])
        inside = np.abs(shift).max(axis=1, initial=0.0) <= self.reach
        shapes, cells = self._bodies.shapes, self.cells
        walls = cells.is_wall
        row = np.concatenate([[0], np.cumsum(walls)])[cells.row]
        edge = cells.edge[walls]
        normal, start, corner = shapes.normal[edge], shapes.corner[edge], shapes.corner[cells.corner[walls]]
        return inside & _in_any(pose, row, cells.kind[walls], normal, start, corner, cells.ends, self._full)


@njit(cache=True, nogil=True, error_model="numpy")
def _in_any(
    pose: Floats, row: Ints, kind: Ints, normal: Floats, start: Floats, corner: Floats, ends: Floats, full: bool
) -> NDArray[np.bool_]:
    """Whether each relative pose lies in any of the cells."""
    out = np.zeros(len(pose), dtype=np.bool_)
    for k in range(len(pose)):
        x, y, psi = pose[k]
        c, s = np.cos(psi), np.sin(psi)
        for cell in range(len(ends)):
            low, high = ends[cell]
            past = np.remainder(psi - low, 2 * np.pi) if full else psi - low
            if not 0.0 <= past <= high - low:
                continue
            good = True
            for r in range(row[cell], row[cell + 1]):
                if kind[r] == A_EDGE:
                    px = c * corner[r, 0] - s * corner[r, 1] + x - start[r, 0]
                    py = s * corner[r, 0] + c * corner[r, 1] + y - start[r, 1]
                else:
                    ux, uy = corner[r, 0] - x, corner[r, 1] - y
                    px, py = c * ux + s * uy - start[r, 0], -s * ux + c * uy - start[r, 1]
                if not normal[r, 0] * px + normal[r, 1] * py >= 0.0:
                    good = False
                    break
            if good:
                out[k] = True
                break
    return out


@overload
def free_space(
    assembly: Assembly, a: str, b: str, *, reach: float | None = None, stop: Stop | None = None
) -> FreeSpace: ...
@overload
def free_space(
    assembly: Assembly, a: str, b: str, model: str | PairModel, *, reach: float | None = None, stop: Stop | None = None
) -> FreeSpace | Polyhedron: ...
def free_space(
    assembly: Assembly,
    a: str,
    b: str,
    model: str | PairModel = "walls",
    *,
    reach: float | None = None,
    stop: Stop | None = None,
) -> FreeSpace | Polyhedron:
    """Compute the free space of two parts, with all others left out.

    Parameters
    ----------
    assembly : Assembly
    a, b : str
        Names of two parts that are not glued to each other.
    model : str, Hull or HalfPlane
        "walls": cells that never overlap. "hull", "halfplane": the polyhedra of the paper and of PuzzleFlex, for comparison.
    reach : float, optional [mm]
        Extent of an open free space, for walls; by default ten clearances, though no further than the larger part's radius.
    stop : optional
        Anything with `is_set()`, asked now and then while walls are looked for.

    Raises
    ------
    StoppedError
        If it was asked to stop.
    InputError
        If there is no such part or model, the two never meet, or the reach is no length.
    TouchingError
        If the two touch at rest.

    Examples
    --------
    >>> import numpy as np
    >>> import wiggleroom as wr
    >>> chain = wr.patterns.chain(2, joint="tee", gap=0.01)
    >>> space = wr.free_space(chain, "b1", "b2")
    >>> space.closed, round(space.angles[1], 4)
    (True, 0.0317)
    >>> space.contains(np.array([[0.0, 0.009, 0.0], [0.0, 0.011, 0.0]]))
    array([ True, False])
    >>> hull = wr.free_space(chain, "b1", "b2", model="hull")
    >>> hull.rows, round(hull.angles[1], 4)
    (14, 0.0148)

    Source: Mind the Gap, section 4.1; exact walls instead of the hull of three slices.
    """
    require_planar(assembly, "free_space")
    wanted = model_named(model)
    them, rows, material, usual = _pair(assembly, a, b, reach)
    if isinstance(wanted, Walls):
        return _walls(assembly, them, rows, (a, b), material, usual, stop)
    return _polyhedron(assembly, them, rows, (a, b), wanted)


def free_slices(assembly: Assembly, a: str, b: str, count: int = 40, *, stop: Stop | None = None) -> FreeSlices:
    """Exact slices of the free space of two parts, its two ends among them, without the cells that fill it.

    Parameters, errors: see `free_space`.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = free_slices(wr.patterns.chain(2, joint="tee", gap=0.01), "b1", "b2", count=5)
    >>> len(found.slices), found.closed, round(found.slices[2].area, 6)
    (5, True, 0.0004)
    """
    them, rows, material, usual = _pair(assembly, a, b, None)
    space, relation = _marched(assembly, them, rows, (a, b), material, usual, stop)
    low, high = space.ends
    found = []
    for phi in np.linspace(low, high, count)[1:-1]:
        go_on(stop)
        found.append(space.at(float(phi)))
    slices = [space.slices[0], *(one for one in found if one is not None), space.slices[-1]]
    return FreeSlices(
        assembly, (a, b), tuple(_about_reference(s, relation) for s in slices), space.ends, space.limit == np.inf, space.limit,
        -relation.point,
    )  # fmt: skip


def _pair(
    assembly: Assembly, a: str, b: str, reach: float | None
) -> tuple[Bodies, tuple[int, int], NDArray[np.object_], float]:
    """Bodies, the rows of two of them, their material, and how far they are followed where nothing stops them [mm]."""
    if reach is not None and not 0 < reach < np.inf:
        finding = f"reach {reach:g} mm: it must be a length above 0"
        raise InputError(finding)
    them = bodies(assembly)
    one, other = _bodies_of(assembly, them, a, b)
    material = placed(them)[[one, other]]
    apart = float(shapely.distance(*material))
    if apart < CONTACT_TOLERANCE * assembly.size:
        where = assembly.drawing.source or "the assembly"
        finding = (
            f'{where}: parts "{a}" and "{b}" touch at rest, clearance {apart:.3g} mm; '
            "there is no room to move: give a gap"
        )
        raise TouchingError(finding, (a, b), apart)
    usual = min(OPEN_REACH * apart, float(them.radius[[one, other]].max()))
    return them, (one, other), material, usual if reach is None else reach


def _walls(
    assembly: Assembly, them: Bodies, rows: tuple[int, int], names: tuple[str, str], material: NDArray[np.object_],
    reach: float, stop: Stop | None,
) -> FreeSpace:  # fmt: skip
    """Union of cells round exact slices."""
    space, relation = _marched(assembly, them, rows, names, material, reach, stop)
    covered = cover(them, rows, relation, space, stop)
    return FreeSpace(
        assembly=assembly,
        parts=names,
        cells=covered.cells,
        slices=tuple(_about_reference(s, relation) for s in covered.slices),
        coverage=covered.coverage,
        angles=space.ends,
        closed=space.limit == np.inf,
        reach=space.limit,
        pivot=-relation.point,
        _bodies=them,
        _relation=relation,
        _full=space.full,
    )


def _marched(
    assembly: Assembly, them: Bodies, rows: tuple[int, int], names: tuple[str, str], material: NDArray[np.object_],
    reach: float, stop: Stop | None,
) -> tuple[SliceSequence, PairFrames]:  # fmt: skip
    """Slices from one end of the free space to the other, and how they are related to the bodies."""
    pivot = joint_point(*material)
    at_a, at_b = (assembly.rest[assembly.names.index(name)] for name in names)
    relation = relate(at_a, at_b, them.rest[rows[0]], them.rest[rows[1]], pivot)
    own = [shapely.transform(g, lambda p: rotated(p - pivot, np.array([-at_a[2]]))) for g in material]
    return slice_sequence(pair_outlines(own[0], own[1]), reach, stop), relation


def _polyhedron(
    assembly: Assembly, them: Bodies, rows: tuple[int, int], names: tuple[str, str], model: Hull | HalfPlane
) -> Polyhedron:
    """Faces of a model, turned from the body's frame into that of part a."""
    at_a, at_b = (assembly.rest[assembly.names.index(name)] for name in names)
    a, b = (np.array([k]) for k in rows)
    reference = np.zeros((len(them.rest), 2))
    reference[rows[1]] = rotated(at_b[:2] - them.rest[rows[1], :2], -them.rest[rows[1], 2:])[0]
    slices: tuple[Slice, ...] = ()
    if isinstance(model, Hull):
        found = hulls(them, a, b, reference, model)
        if found is None:
            finding = f'parts "{names[0]}" and "{names[1]}": no free space was found round rest'
            raise InputError(finding)
        faces, (hull,) = found.faces, found.distinct
        slices, angles, closed = hull.slices, hull.ends, hull.closed
    else:
        apart = float(shapely.distance(*placed(them)[list(rows)]))
        faces = half_planes(them, a, b, np.zeros_like(them.rest), HALF_PLANE_REACH * apart)
        turns = np.where(faces.normal[:, 2] != 0, -faces.offset / faces.normal[:, 2], np.inf)
        angles = float(-np.abs(turns[turns < 0]).min(initial=np.inf)), float(turns[turns > 0].min(initial=np.inf))
        closed = bool(np.isfinite(angles).all())
    body = them.rest[rows[1]]
    pivot = body[:2] + rotated(faces.point[0], body[2:])[0]
    relation = relate(at_a, at_b, them.rest[rows[0]], body, pivot)
    normal = np.column_stack(
        [rotated(faces.normal[:, :2], np.full(len(faces.normal), relation.turned)), faces.normal[:, 2]]
    )
    if slices and relation.turned:
        slices = tuple(
            replace(s, region=shapely.transform(s.region, lambda p: rotated(p, np.array([relation.turned]))))
            for s in slices
        )
    return Polyhedron(names, model.name, normal, faces.offset, slices, angles, closed, -relation.point, relation)


def _about_reference(one: Slice, relation: PairFrames) -> Slice:
    """Express the same slice as motions of part b's reference point."""
    swing = relation.swing(np.array([one.angle]))
    return replace(one, region=shapely.transform(one.region, lambda p: p + swing))


def _bodies_of(assembly: Assembly, them: Bodies, a: str, b: str) -> tuple[int, int]:
    """Rows of the bodies of two parts that can meet."""
    wrong = [unknown(name, assembly.names) for name in dict.fromkeys((a, b)) if name not in assembly.names]
    if wrong:
        raise InputError(wrong)
    if a == b:
        finding = f'"{a}" is named twice: a free space is that of two parts'
        raise InputError(finding)
    one, other = (int(them.body_of[assembly.names.index(name)]) for name in (a, b))
    if one == other:
        finding = f'parts "{a}" and "{b}" are glued: they move as one; name two parts that can move against each other'
        raise InputError(finding)
    members = [{assembly.names[p] for p in them.members[k]} for k in (one, other)]
    for p, q in assembly.drawing.ignore:
        if (p in members[0] and q in members[1]) or (q in members[0] and p in members[1]):
            finding = f'parts "{p}" and "{q}" never collide ("ignore"): every motion of theirs is free'
            raise InputError(finding)
    return one, other
