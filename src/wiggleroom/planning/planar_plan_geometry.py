"""What plans ask of an assembly in the plane: how near parts come to each other, which step is free, and paths fitted to other outlines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Self

import numpy as np
import scipy.sparse as sp
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.clearance import least_distances
from wiggleroom.disassembly.clearance_program import ClearanceProblem, MovingBodies
from wiggleroom.disassembly.disassemble import disassemble
from wiggleroom.disassembly.disassembly_sequence import Disassembly
from wiggleroom.disassembly.remaining import only
from wiggleroom.errors import InputError
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.rigid_motions import of_bodies
from wiggleroom.planning.gravity import Distances, Gravity
from wiggleroom.planning.path_improvement import finer, improved_steps
from wiggleroom.planning.steps import MAX_CLEARANCE, Step, StepRoom, with_room
from wiggleroom.search.prepare import Survey, survey

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

TURN_PER_PIECE = 0.02
"""Clearances are worked out on pieces that turn by at most this [rad]."""


class PlanarPlanGeometry:
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
        self.surveyed = survey(assembly)

    @property
    def clearance(self) -> float:
        """Typical clearance between neighbours [mm]."""
        return self.surveyed.clearance

    def made(self, gap: float | None = None, inward: Mapping[str, float] | None = None) -> Self | None:
        """The assembly made otherwise; None where parts then touch at rest, or cannot be made."""
        offset = {name: -x for name, x in (inward or {}).items()}
        try:
            return type(self)(assemble(self.assembly.drawing, gap=gap, offset=offset))
        except InputError:
            return None

    def taken_apart(self, targets: tuple[str, ...], weight: Gravity | None, context: Context) -> Disassembly:
        """Its parts taken away, of those that could leave straight those first after which the fewest must be held."""
        cost = None if weight is None else partial(weight.holding_cost, context=context)
        return disassemble(self.assembly, targets=targets, holding_cost=cost, context=context)

    def fitted(self, steps: Sequence[Step], context: Context = UNLIMITED) -> tuple[Step, ...]:
        """Steps that do the same with more room."""
        return improved_steps(self.assembly, self.surveyed, steps, context)

    def collision(self, step: Step) -> tuple[str, str] | None:
        """Two parts that are in each other's way in a step; None where it is free."""
        there = np.flatnonzero(step.there)
        audit = audit_path(only(self.assembly, there), step.path[:, there])
        if audit.free:
            return None
        first = audit.piece.argmin()
        names = self.assembly.names
        return names[there[audit.a[first]]], names[there[audit.b[first]]]

    def measured(self, step: Step) -> Step:
        """The step with its clearance, room for errors, axis and held parts."""
        bodies = self.surveyed.bodies
        fine, stray = self._finely(step.path)
        there = np.array([step.there[list(m)].all() for m in bodies.members])
        most = MAX_CLEARANCE * self.surveyed.size
        path = of_bodies(self.assembly, bodies, fine)
        apart = least_distances(bodies, path, there, self.surveyed.ignored, most) - stray
        room = StepRoom(bodies.body_of, bodies.fixed, bodies.rest[:, :2], bodies.radius, apart, most)
        return with_room(step, self.assembly.names, room)

    def falling(self) -> PlanarFalling:
        """Its bodies, as gravity asks for them."""
        return PlanarFalling(self.assembly, self.surveyed)

    def _finely(self, path: Floats) -> tuple[Floats, float]:
        """The path with many points where it turns, and how far bodies may be from straight between them [mm].

        Reference points of parts go straight, so the middles of their bodies do not quite.
        """
        fine = finer(path, TURN_PER_PIECE)
        turn = float(np.abs(np.diff(fine[..., 2], axis=0)).max())
        bodies = self.surveyed.bodies
        arm = self.assembly.rest[:, :2] - bodies.rest[bodies.body_of, :2]
        return fine, 2 * float(np.hypot(*arm.T).max()) * turn**2 / 8


class PlanarFalling:
    """See `wiggleroom.planning.gravity.FallingBodies`; poses are motions (m, 3) [mm, mm, rad] of the bodies.

    Parameters
    ----------
    assembly : Assembly
    surveyed : Survey
        Of the assembly.
    """

    def __init__(self, assembly: Assembly, surveyed: Survey) -> None:
        self._assembly, self._surveyed = assembly, surveyed
        self.names, self.body_of = assembly.names, surveyed.bodies.body_of
        self.fixed, self.clearance = surveyed.bodies.fixed, surveyed.clearance

    def poses(self, motion: Floats) -> Floats:
        """Motions of the bodies where one of the parts has taken them."""
        return of_bodies(self._assembly, self._surveyed.bodies, motion[None])[0]

    def key(self, poses: Floats, here: Bools) -> bytes:
        """Motions of the bodies that are here, to be known again."""
        return np.round(poses[here], 9).tobytes()

    def places(self, poses: Floats) -> Floats:
        """Reference points (m, 2) [mm] of the bodies."""
        return (self._surveyed.bodies.rest + poses)[:, :2]

    def weights(self, who: Ints) -> Floats:
        """Areas (k,) of some bodies."""
        return np.asarray(shapely.area(placed(self._surveyed.bodies, None, who)[who]))

    def freedoms(self, who: Ints) -> Bools:
        """They may move and turn."""
        return np.ones((len(who), 3), dtype=np.bool_)

    def _problem(self, here: Bools, free: Ints) -> ClearanceProblem:
        its, moving = self._surveyed, MovingBodies(free, as_one=False)
        return ClearanceProblem(its.bodies, here, its.ignored, its.clearance, its.size, moving)

    def distances(self, poses: Floats, here: Bools, free: Ints, reach: float) -> Distances:
        """Distances of corners from edges below `reach` [mm]."""
        problem, bodies = self._problem(here, free), self._surveyed.bodies
        near = problem.near(bodies.rest + poses, reach)
        mine = problem.moving.numbers(len(poses))[near.who]
        r, side = np.nonzero(mine >= 0)
        slope = near.gradient[r, side] / np.column_stack([np.ones((len(r), 2)), bodies.radius[near.who[r, side]]])
        column = 3 * mine[r, side][:, None] + np.arange(3)
        shape = len(near.distance), 3 * len(free)
        matrix = sp.csr_matrix((slope.ravel(), (np.repeat(r, 3), column.ravel())), shape=shape)
        return Distances(near.distance, matrix, sp.csr_matrix((shape[0], 0)))

    def changed(self, poses: Floats, free: Ints, change: Floats) -> Floats:
        """Motions after a change (k, 3) [mm] of the free bodies."""
        later = poses.copy()
        later[free] += np.column_stack([change[:, :2], change[:, 2] / self._surveyed.bodies.radius[free]])
        return later

    def stay_apart(self, poses: Floats, later: Floats, here: Bools, free: Ints) -> bool:
        """Whether the free bodies meet nothing in between."""
        return self._problem(here, free).least(np.stack([poses, later])) > 0
