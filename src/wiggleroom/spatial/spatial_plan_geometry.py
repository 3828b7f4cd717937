"""What plans ask of an assembly in space: how near parts come to each other, and which step is free."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.disassembly_sequence import Disassembly
from wiggleroom.errors import InputError
from wiggleroom.planning.gravity import Distances, Gravity
from wiggleroom.planning.steps import MAX_CLEARANCE, STILL, Step, StepRoom, with_room
from wiggleroom.spatial.bodies.rigid import SpatialPose, near_pieces
from wiggleroom.spatial.bodies.rotations import exponential
from wiggleroom.spatial.bodies.spatial_bodies import Grouping, grouped
from wiggleroom.spatial.escapes.spatial_disassembly import SpatialStages, reduced
from wiggleroom.spatial.overlaps.swept_check import SweptCheck
from wiggleroom.spatial.planes.separating_plane_program import best_axis
from wiggleroom.spatial.search.spatial_prepare import prepare_spatial
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

SAMPLES = 16
"""So many poses of every straight piece of a path are looked at for the clearance."""
NARROWED = 40
"""Along a piece without turns the distance of two convex pieces is convex: its minimum is enclosed in so many steps."""
GOLDEN = (np.sqrt(5) - 1) / 2


class SpatialPlanGeometry:
    """See `wiggleroom.planning.plan_geometry.PlanGeometry`.

    Parameters
    ----------
    assembly : Assembly
        Something in it stands.

    Raises
    ------
    TouchingError
        If two parts touch at rest.
    """

    def __init__(self, assembly: Assembly) -> None:
        self.assembly = assembly
        self._ready = prepare_spatial(assembly)

    @property
    def clearance(self) -> float:
        """Typical clearance between neighbours [mm]."""
        return self._ready.clearance

    def made(self, gap: float | None = None, inward: Mapping[str, float] | None = None) -> Self | None:
        """The assembly made otherwise; None where parts then touch at rest, or cannot be made."""
        try:
            return type(self)(assemble_spatial(self.assembly.drawing, gap=gap, inward=inward))
        except InputError:
            return None

    def taken_apart(self, targets: tuple[str, ...], weight: Gravity | None, context: Context) -> Disassembly:  # noqa: ARG002
        """Its parts taken away; those that left together are then taken from each other, where all are to leave."""
        look = SpatialStages(self.assembly, context)
        n = len(self.assembly.names)
        done = Disassembly(self.assembly.names, look.stages, np.zeros((n, 6)))
        done.last = done.take_apart(np.arange(n), targets=targets)
        stuck = look.stuck
        for departure in done.departures:  # taking those apart that left together adds more
            if targets or context.stopped:
                break
            if len(departure.parts) > 1:
                done.take_apart(departure.parts)
                stuck += look.stuck
        done.together = tuple(stuck)
        return done

    def fitted(self, steps: Sequence[Step], context: Context = UNLIMITED) -> tuple[Step, ...]:  # noqa: ARG002
        """The steps as they are: paths in space are not moved to where there is more room."""
        return tuple(steps)

    def collision(self, step: Step) -> tuple[str, str] | None:
        """Two parts that are in each other's way in a step; None where it is free."""
        there = np.flatnonzero(step.there)
        left = reduced(self.assembly, there.tolist())
        check = SweptCheck(left)
        for one, other in itertools.pairwise(step.path[:, there]):
            for a, b in check.doubtful(one, other, first=True):
                return left.names[a], left.names[b]
        return None

    def measured(self, step: Step) -> Step:
        """The step with its clearance, exact of slides and at sampled poses of turns, room for errors, axis and held parts."""
        there = np.flatnonzero(step.there)
        left = reduced(self.assembly, there.tolist())
        group = grouped(left)
        bodies, most = group.bodies, MAX_CLEARANCE * self.assembly.size
        apart = np.full((len(bodies.at), len(bodies.at)), most)
        for one, other in itertools.pairwise(step.path[:, there]):
            poses = [group.pose_of(one + share * (other - one)) for share in np.linspace(0.0, 1.0, SAMPLES)]
            slides = np.abs(other - one)[:, 3:].max() <= STILL
            change = other - one
            first = np.unique(group.body_of, return_index=True)[1]
            known: dict[tuple[int, ...], list[float]] = {}
            axis = np.empty(3)
            for k, pose in enumerate(poses):
                for who in map(tuple, near_pieces(bodies, pose, most).tolist()):
                    a, _, b, _ = who
                    if slides and np.array_equal(change[first[a]], change[first[b]]):
                        continue
                    at = known.setdefault(who, [most] * SAMPLES)
                    at[k] = min(float(best_axis(bodies, pose, who, axis)[0]), most)
            for who, at in known.items():
                a, _, b, _ = who
                least = min(at)
                if slides and least < most:
                    least = _narrowed(group, who, one, other, at)
                apart[a, b] = apart[b, a] = min(apart[a, b], least)
        room = StepRoom(group.body_of, ~bodies.moves, bodies.at, bodies.radius, apart, most)
        names, mine = left.names, np.ones(len(there), dtype=np.bool_)
        found = with_room(replace(step, path=step.path[:, there], there=mine), names, room)
        return replace(found, path=step.path, there=step.there)

    def falling(self) -> SpatialFalling:
        """Its bodies, as gravity asks for them."""
        return SpatialFalling(self.assembly, self.clearance)


def _narrowed(group: Grouping, who: tuple[int, ...], one: Floats, other: Floats, at: Sequence[float]) -> float:
    """Least distance of two convex pieces on a slide [mm], from its values at samples, by golden sections."""
    axis = np.empty(3)

    def value(share: float) -> float:
        return float(best_axis(group.bodies, group.pose_of(one + share * (other - one)), who, axis)[0])

    k = int(np.argmin(at))
    low, high = max(k - 1, 0) / (SAMPLES - 1), min(k + 1, SAMPLES - 1) / (SAMPLES - 1)
    best = at[k]
    if max(at[max(k - 1, 0)], at[min(k + 1, SAMPLES - 1)]) - best <= STILL:
        return best
    x, y = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_x, at_y = value(x), value(y)
    for _ in range(NARROWED):
        best = min(best, at_x, at_y)
        if at_x < at_y:
            high, y, at_y = y, x, at_x
            x = high - GOLDEN * (high - low)
            at_x = value(x)
        else:
            low, x, at_x = x, y, at_y
            y = low + GOLDEN * (high - low)
            at_y = value(y)
    return best


class SpatialFalling:
    """See `wiggleroom.planning.gravity.FallingBodies`; poses are those of the bodies.

    Parameters
    ----------
    assembly : Assembly
    clearance : float [mm]
        Typical clearance.
    """

    def __init__(self, assembly: Assembly, clearance: float) -> None:
        self._group = grouped(assembly)
        self._bodies = self._group.bodies
        self.names, self.body_of = assembly.names, self._group.body_of
        self.fixed, self.clearance = ~self._bodies.moves, clearance
        mass = [solid.volume * part.density for part, solid in zip(assembly.parts, assembly.solids, strict=True)]
        self._mass: Floats = np.bincount(self.body_of, np.array(mass)).astype(float)

    def poses(self, motion: Floats) -> SpatialPose:
        """Poses of the bodies where a motion of the parts has taken them."""
        return self._group.pose_of(motion)

    def key(self, poses: SpatialPose, here: Bools) -> bytes:
        """Poses of the bodies that are here, to be known again."""
        return np.round(poses.T[here], 9).tobytes() + np.round(poses.R[here], 9).tobytes()

    def places(self, poses: SpatialPose) -> Floats:
        """Centroids (m, 3) [mm] of the bodies."""
        return poses.T

    def weights(self, who: Ints) -> Floats:
        """Volumes times densities (k,) of some bodies."""
        return self._mass[who]

    def freedoms(self, who: Ints) -> Bools:
        """What their locks leave."""
        return self._bodies.free[who]

    def _near(self, poses: SpatialPose, here: Bools, free: Ints, reach: float) -> Ints:
        near = near_pieces(self._bodies, poses, reach)
        mine = np.isin(np.arange(len(here)), free)
        a, b = near[:, 0], near[:, 2]
        return near[here[a] & here[b] & (mine[a] | mine[b])]

    def distances(self, poses: SpatialPose, here: Bools, free: Ints, reach: float) -> Distances:
        """Distances below `reach` [mm] of corners from a plane that parts two pieces, which tilts and moves.

        Two pieces whose planes stay parallel could not roll off each other.
        """
        bodies, axis = self._bodies, np.empty(3)
        number = np.full(len(here), -1)
        number[free] = np.arange(len(free))
        value: list[Floats] = []
        slope: list[Floats] = []
        planes: list[Floats] = []
        for who in self._near(poses, here, free, reach).tolist():
            apart, other = best_axis(bodies, poses, who, axis)
            if apart > reach:
                continue
            a, i, b, _ = who
            normal, corners = poses.R[a] @ axis, bodies.pieces[a][i].corners
            level = (corners @ axis).max() + apart / 2
            tilts = np.linalg.svd(normal[None])[2][1:]
            middle = poses.T[a] + poses.R[a] @ corners.mean(axis=0)
            arm = max(bodies.radius[a], bodies.radius[b])
            for body, its, sign in ((a, corners, -1.0), (b, other, 1.0)):
                distance = sign * (its @ axis - level)
                near = distance < reach
                at = its[near] @ poses.R[a].T + poses.T[a]
                row = np.zeros((len(at), len(free), 6))
                if number[body] >= 0:
                    row[:, number[body], :3] = sign * normal
                    row[:, number[body], 3:] = sign * np.cross(at - poses.T[body], normal) / bodies.radius[body]
                value.append(distance[near])
                slope.append(row.reshape(len(at), -1))
                planes.append(sign * np.column_stack([(at - middle) @ tilts.T / arm, np.full(len(at), -1.0)]))
        if not value:
            return Distances(np.zeros(0), sp.csr_matrix((0, 6 * len(free))), sp.csr_matrix((0, 0)))
        both = [np.vstack(planes[k : k + 2]) for k in range(0, len(planes), 2)]
        return Distances(np.concatenate(value), sp.csr_matrix(np.vstack(slope)), sp.block_diag(both, format="csr"))

    def changed(self, poses: SpatialPose, free: Ints, change: Floats) -> SpatialPose:
        """Poses after a change (k, 6) [mm] of the free bodies: displaced, then turned about their centroids."""
        T, R = poses.T.copy(), poses.R.copy()
        T[free] += change[:, :3]
        R[free] = exponential(change[:, 3:] / self._bodies.radius[free, None]) @ R[free]
        return SpatialPose(T, R)

    def stay_apart(self, poses: SpatialPose, later: SpatialPose, here: Bools, free: Ints) -> bool:  # noqa: ARG002
        """Whether the free bodies meet nothing later: steps are shorter than what is between bodies."""
        near, axis = self._near(later, here, free, 0.0), np.empty(3)
        return all(best_axis(self._bodies, later, who, axis)[0] > 0 for who in near.tolist())
