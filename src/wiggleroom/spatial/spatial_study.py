"""An assembly in space, as studies of gaps ask it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import Context
from wiggleroom.drawing.model import Drawing, Goal
from wiggleroom.errors import InputError, Stop, go_on
from wiggleroom.parallel.parallel_run import StopHere, Work
from wiggleroom.search.answer import Answer
from wiggleroom.sensitivity.dual_face import face
from wiggleroom.sensitivity.found_motion import verdict_of, verdict_of_carried
from wiggleroom.sensitivity.gap_study import DIFFERENCE_STEP, DifferenceQuotients, GapDerivatives, PlaceDerivatives
from wiggleroom.sensitivity.gap_trials import AllowableGap, Trial
from wiggleroom.sensitivity.perturbation import PerturbedObjective
from wiggleroom.spatial.planes.separating_plane_program import LinearisedSeparatingPlanes
from wiggleroom.spatial.search.spatial_prepare import SpatialPrepared, prepare_spatial
from wiggleroom.spatial.solid_offset import offset_of_faces
from wiggleroom.spatial.solids.corner_displacement import corner_displacements
from wiggleroom.spatial.solids.joint_faces import JointFaces, TouchedSurface, joint_faces
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.spatial_contact_forces import HeldMotion
from wiggleroom.spatial.spatial_flex import flex_spatial
from wiggleroom.verdict import Certainty

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ACTIVE = 1e-6
"""A row with less than this share of the largest force holds nothing."""


@dataclass(frozen=True, eq=False)
class SpatialStudy:
    """An assembly in space and what is asked of it.

    Parameters
    ----------
    assembly : Assembly
    goals : tuple of Goal
    found : Answer, optional
    least : bool
        True where least motions will do, as of parts that are covered by larger pieces; else these are refused.
    """

    assembly: Assembly
    goals: tuple[Goal, ...]
    found: Answer | None = None
    least: bool = False

    def __post_init__(self) -> None:
        """Refuse covers where more than least motions is asked for."""
        if self.assembly.overshoot and not self.least:
            message = (
                f"{self.assembly.drawing.source or 'the assembly'}: parts are covered by pieces up to {self.assembly.overshoot:.2g} mm "
                f"larger than they are made at gap {self.assembly.gap:g}, so what stops them is not known; ask flex, check or sweep"
            )
            raise InputError(message)

    @cached_property
    def ready(self) -> SpatialPrepared:
        """Bodies and near pieces."""
        return prepare_spatial(self.assembly)

    @property
    def clearance(self) -> float:
        """Typical clearance between neighbours [mm]."""
        return self.ready.clearance

    def at_gap(self, gap: float, stop: Stop | None = None) -> Self:
        """The same question with another gap [mm] of the whole assembly."""
        return replace(self, assembly=assemble_spatial(self.assembly.drawing, gap=gap, stop=stop), found=None)

    def made_of(self, drawing: Drawing, stop: Stop | None = None) -> Self:
        """The same question of another drawing of the same parts."""
        return replace(self, assembly=assemble_spatial(drawing, stop=stop), found=None)

    def with_inward(self, inward: Floats, stop: Stop | None = None) -> Self:
        """The same question with all faces of each part moved inward by `inward` (n,) [mm]."""
        return replace(self, assembly=_moved_inward(self.assembly, inward, stop), found=None)

    def answer(self, context: Context) -> Answer:
        """Largest motion from rest; the one that was found before, where there is one."""
        return self.found or flex_spatial(
            self.ready if "ready" in vars(self) else self.assembly,
            self.goals,
            search=0,
            context=context.silent,
        )

    def flexed(self, search: int | None, context: Context) -> Answer:
        """Answer of `wiggleroom.flex`, a bound by cross-sections included, from rest and `search` more starts."""
        return flex_spatial(self.assembly, self.goals, search=search, bound=True, context=context.silent)

    def with_bound(self, answer: Answer, *_: Any) -> Answer:
        """The answer as it is: but for cross-sections, which `flexed` looks at, nothing bounds motions in space."""
        return answer

    def with_assembly(self, answer: Answer) -> Answer:
        """The motion of an answer at a smaller gap, as an answer for this one."""
        return replace(answer, assembly=self.assembly)

    def in_place_of(self, lower: Answer, smaller: Answer) -> Answer:
        """The motion of a smaller gap in place of a lower answer of this one; what was proven of larger parts is not of these."""
        verdict = verdict_of_carried(smaller, lower)
        return replace(self.with_assembly(smaller), verdict=verdict, at_most=None, search=None)

    def with_room(self, answer: Answer, *_: Any) -> Answer:
        """The answer as it is: paths in space are not followed."""
        return answer

    def followed(self, *_: Any) -> None:
        """None: checking a path in space for larger parts costs as much as looking for one."""

    def can_be_ranked(self, answer: Answer) -> bool:
        """True where the motion ends, with forces that say what each contact is worth."""
        return answer.warm_start is not None and answer.objective is not None and answer.verdict.ends

    def derivatives(self, answer: Answer) -> GapDerivatives:
        """Derivatives by the gap of every part and joint."""
        assert answer.warm_start is not None  # see `can_be_ranked`
        return _derivatives(answer.assembly, answer.warm_start)

    def quotients(self, answer: Answer, context: Context) -> DifferenceQuotients:
        """How derivatives are found by solving again from where the answer's climb began."""
        stop = StopHere(context.stop)
        shared = (self.assembly, answer.goals, answer.lead, answer.objective, self.clearance, stop)
        return DifferenceQuotients(spatial_slope, shared, self.derivatives(answer))

    def moved(self, answer: Answer, inward: Floats, context: Context) -> Answer:
        """Largest motion when all faces of each part move inward by `inward` (n,) [mm], from rest and where the answer's climb began."""
        return flex_spatial(
            _moved_inward(self.assembly, inward, context.stop),
            answer.goals,
            search=0,
            lead=answer.lead,
            context=context.silent,
        )

    def draws(self, answer: Answer, context: Context) -> tuple[Work, Any]:
        """What many such motions need: each is worked out from nothing."""
        return one_spatial_draw, (self.assembly, answer.goals, answer.lead, StopHere(context.stop))

    def room(self, whole: float, aim: float) -> Floats:
        """How far the faces of each part (n,) may move out [mm]; a joint with a smaller gap of its own limits both its parts."""
        room = dict.fromkeys(self.assembly.names, whole)
        for joint in self.assembly.drawing.gaps:
            for name in joint.parts:
                room[name] = min(room[name], joint.gap)
        return np.maximum((np.array(list(room.values())) - aim) / 2, 0.0)


def fitting(assembly: Assembly, larger: float, stop: Stop | None) -> AllowableGap:
    """Smallest gap at which parts whose faces lie `larger` further out do not overlap as drawn, not shifted."""
    found = offset_of_faces(assembly, larger, stop)
    gap = None if found.offset is None else 2 * (larger - found.offset)
    why, sure = f"no gap makes room: {found.why}", Certainty.PROVEN
    if gap is not None:
        try:
            made = assemble_spatial(assembly.drawing, gap=gap, stop=stop)
            why = ""
            if made.overshoot:
                sure, why = Certainty.SEARCHED, "parts are covered by larger pieces: a smaller gap may do"
            elif assembly.drawing.gaps:
                sure, why = (
                    Certainty.SEARCHED,
                    "solids with a gap of a single joint may grow by a sliver as the gap grows",
                )
        except InputError as problem:  # faces so much further out may stand a gap that those drawn do not
            gap, why = None, f"no gap makes room: as drawn, {problem.findings[0]}"
    trials = [] if gap is None else [Trial(gap, 0.0, "fits", True)]
    beyond = None
    if found.beyond is not None and found.beyond[0] <= larger:
        beyond = 2 * (larger - found.beyond[0])
        trials.insert(0, Trial(beyond, found.beyond[1], "overlaps", True))
    return AllowableGap(
        "fits", larger, assembly, (), gap, None if gap is None else sure, beyond, gap,
        gap if sure is Certainty.PROVEN else None, tuple(trials), why=why,
    )  # fmt: skip


def _moved_inward(assembly: Assembly, inward: Floats, stop: Stop | None) -> Assembly:
    further = {name: float(x) for name, x in zip(assembly.names, inward, strict=True) if x}
    return assemble_spatial(assembly.drawing, inward=further, stop=stop)


def spatial_slope(
    shared: tuple[Assembly, tuple[Goal, ...], Floats | None, float, float, StopHere], task: tuple[int, float]
) -> float:
    """Objective gained per mm of extra gap round one part, from solving again with a little more (+1) or less (-1) of it."""
    assembly, goals, lead, value, clearance, stop = shared
    part, sign = task
    extra = sign * DIFFERENCE_STEP * clearance
    inward = np.zeros(len(assembly.parts))
    inward[part] = extra / 2
    found = one_spatial_draw((assembly, goals, lead, stop), inward)
    return (found.value - value) / extra if np.isfinite(found.value) and found.verdict.ends else np.nan


def one_spatial_draw(
    shared: tuple[Assembly, tuple[Goal, ...], Floats | None, StopHere], inward: Floats
) -> PerturbedObjective:
    """Largest objective with other faces, everything worked out anew, from rest and where an answer's climb began.

    Raises
    ------
    StoppedError
        If it was asked to stop: what was found by then is no draw.
    """
    assembly, goals, lead, stop = shared
    try:
        made = _moved_inward(assembly, inward, stop)
        answer = flex_spatial(made, goals, search=0, lead=lead, context=Context(stop=stop))
        go_on(stop)
    except InputError as why:
        return PerturbedObjective(np.nan, verdict_of(why))
    return PerturbedObjective(np.inf if answer.objective is None else answer.objective, answer.verdict)


def _derivatives(assembly: Assembly, held: HeldMotion) -> GapDerivatives:
    """Derivatives from the forces on the planes.

    A corner that moves inward by s gives its row n . s more room, where n points from the corner to the other piece.
    """
    P, found = held.program, held.found
    at = P.linearise(found.point)
    lam = found.lam * P.length
    row = np.flatnonzero((found.lam > ACTIVE * found.lam.max(initial=0.0)) & (lam > at.h * P.length))
    plane = np.searchsorted(P.row, row, side="right") - 1
    pair = np.repeat(np.arange(len(P.a)), np.diff(P.plane))[plane]
    side = _sides(held, row, plane, pair, at)
    known: dict[tuple[int, int], Floats] = {}
    gain = np.empty(len(row))
    for k, (part, piece, corner) in enumerate(zip(side.part.tolist(), side.piece.tolist(), side.corner, strict=True)):
        if (part, piece) not in known:
            known[part, piece] = corner_displacements(assembly.solids[part], piece) @ assembly.parts[part].R.T
        gain[k] = -side.toward[k] @ known[part, piece][corner]
    columns = np.arange(len(row))
    by_part = sp.csr_matrix((gain / 2, (side.part, columns)), shape=(len(assembly.parts), len(row)))
    joints, by_joint = spatial_joint_gains(assembly, side, lam[row])
    here = PlaceDerivatives(by_part, by_joint, face(_jacobian(at, row, plane, pair), lam[row], P.length))
    return GapDerivatives(here, joints, virtual=0.0)


def _sides(held: HeldMotion, row: Ints, plane: Ints, pair: Ints, at: LinearisedSeparatingPlanes) -> HoldingCorners:
    """The corners of some rows, and what they are held against."""
    P, found, owner = held.program, held.found, held.grouping.bodies.owner
    first = _first_pieces(held)
    part, other, piece = (np.empty(len(row), dtype=np.int64) for _ in range(3))
    corner = row - P.row[plane]
    mine = corner < P.own[plane]
    toward, body = np.empty((len(row), 3)), np.where(mine, P.a[pair], P.b[pair])
    for k, (p, x) in enumerate(zip(plane.tolist(), pair.tolist(), strict=True)):
        ends = P.pieces[p, :2], P.pieces[p, 2:]
        (its, own), (across, there) = ends if mine[k] else ends[::-1]
        part[k], other[k] = owner[its][own], owner[across][there]
        piece[k] = own - first[int(part[k])]
        toward[k] = found.point.n[p] if mine[k] else -at.Psi[x].T @ found.point.n[p]
    return HoldingCorners(
        part, other, piece, np.where(mine, corner, corner - P.own[plane]), toward, 2 * plane + mine,
        held.grouping.bodies.at[body] + P.V[row],
    )  # fmt: skip


def _first_pieces(held: HeldMotion) -> dict[int, int]:
    """Index, among the pieces of its body, of the first piece of every part."""
    found: dict[int, int] = {}
    for owner in held.grouping.bodies.owner:
        for k, part in enumerate(owner.tolist()):
            found.setdefault(part, k)
    return found


def _jacobian(at: LinearisedSeparatingPlanes, row: Ints, plane: Ints, pair: Ints) -> sp.csr_matrix:
    """Derivatives (k, V + planes) of some rows by the freedoms of the bodies and by their planes."""
    P, R = at.program, at.point.pose.R
    a, b = P.a[pair], P.b[pair]
    G = at.G[row]
    force = np.einsum("kij,kj->ki", R[a], G[:, :3])
    turn_a = np.einsum("kji,kj->ki", at.axes[a], G[:, 3:6])
    turn_b = np.einsum("kji,kj->ki", at.Psi[pair] @ at.axes[b], G[:, 6:9])
    on_a, on_b = np.hstack([-force, turn_a]) * P.scale[a], np.hstack([force, turn_b]) * P.scale[b]
    used, which = np.unique(plane, return_inverse=True)
    size = int(P.slot.max(initial=-1)) + 1
    column = np.hstack([P.slot[a], P.slot[b], size + 3 * which.ravel()[:, None] + np.arange(3)])
    value = np.hstack([on_a, on_b, G[:, 9:]])
    keep = column >= 0
    rows = np.repeat(np.arange(len(row)), 15).reshape(column.shape)
    return sp.csr_matrix((value[keep], (rows[keep], column[keep])), shape=(len(row), size + 3 * len(used)))


SAME_PLACE = 1e-9
"""Joints whose parts lie to each other alike, to this share of the assembly's size, are the same."""


@dataclass(frozen=True, eq=False)
class HoldingCorners:
    """Corners of pieces that planes hold.

    Parameters
    ----------
    part, other : (k,) int64
        Part of the corner, and part across the plane.
    piece, corner : (k,) int64
        Which piece of the part, and which corner of the piece.
    toward : (k, 3) float64
        Normal of the plane, to the other side, as the corner's body had it at rest.
    side : (k,) int64
        Number of the side of the plane that the corner lies on.
    place : (k, 3) float64 [mm]
        The corner at rest, in assembly coordinates.
    """

    part: Ints
    other: Ints
    piece: Ints
    corner: Ints
    toward: Floats
    side: Ints
    place: Floats


def spatial_joint_gains(assembly: Assembly, held: HoldingCorners, force: Floats) -> tuple[Ints, sp.csr_matrix]:
    """Joints (m, 2) that planes hold, and what each of k forces is worth (m, k) per mm of their gaps.

    The corners on one side of a plane touch the other part at their mean, weighted by their forces (k,). It follows the faces it lies on; a
    plane gains what it moves away.
    """
    joints = np.unique(np.sort(np.column_stack([held.part, held.other]), axis=1), axis=0).reshape(-1, 2)
    of: list[list[tuple[int, JointFaces]]] = [[] for _ in assembly.parts]
    known: dict[tuple[object, ...], tuple[JointFaces, JointFaces] | None] = {}
    alone = {name for joint in assembly.drawing.gaps for name in joint.parts}
    for k, (a, b) in enumerate(joints.tolist()):
        names = assembly.names[a], assembly.names[b]
        key = _key(assembly, a, b) if alone.isdisjoint(names) else names
        if key not in known:
            known[key] = joint_faces(assembly.drawing, names)
        for part, faces in zip((a, b), known[key] or (), strict=False):
            of[part].append((k, faces))
    value, joint, column = [], [], []
    for side in np.unique(held.side):
        rows = np.flatnonzero(held.side == side)
        part = int(held.part[rows[0]])
        middle = force[rows] @ held.place[rows] / force[rows].sum()
        own = assembly.parts[part]
        touched = TouchedSurface(assembly.solids[part], (middle - own.at) @ own.R)
        for k, faces in of[part]:
            value.append(-held.toward[rows] @ own.R @ touched.displacement(faces))
            joint.append(np.full(len(rows), k))
            column.append(rows)
    flat = [np.concatenate(x) if x else np.zeros(0) for x in (value, joint, column)]
    return joints, sp.csr_matrix((flat[0], (flat[1].astype(int), flat[2].astype(int))), shape=(len(joints), len(force)))


def _key(assembly: Assembly, a: int, b: int) -> tuple[object, ...]:
    """What is alike where two joints are."""
    one, other = assembly.drawing.parts[a], assembly.drawing.parts[b]
    size = float(np.abs([p.at for p in assembly.drawing.parts]).max(initial=1.0))
    place = np.concatenate([np.subtract(other.at, one.at) @ one.R / size, (one.R.T @ other.R).ravel()])
    return (id(one.solid), id(other.solid), *np.round(place / SAME_PLACE).tolist())
