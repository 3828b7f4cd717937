"""Assemblies made ready for the models that approximate, and answers found with them.

These models accept some motions that overlap and refuse some that are free. What they find is therefore measured by exact
geometry afterwards, and said; it is not put right.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError
from wiggleroom.freespace.models.pair_models import HalfPlane, Hull
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.neighbours import hulls_meet
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.geometry.relative_pose import rotated
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.program.nonlinear_program import Program
from wiggleroom.search.answer import Answer
from wiggleroom.search.build_answer import unlimited
from wiggleroom.search.prepare import NEIGHBOUR_REACH, survey
from wiggleroom.verdict import PathState, Verdict

if TYPE_CHECKING:
    from wiggleroom.freespace.models.halfspaces import Halfspaces
    from wiggleroom.freespace.models.hull import Hulls

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WAYPOINT_SPACING = 0.5
"""Waypoints are kept where a body has moved by this many clearances since the last."""


@dataclass(frozen=True, eq=False)
class Approximation:
    """An assembly made ready for questions to the model `hull` or `halfplane`.

    Parameters
    ----------
    assembly : Assembly
    model : Hull or HalfPlane
    bodies : Bodies
    ignored : (k,) int64
        Keys a * n + b of pairs of bodies that never collide.
    clearance : float [mm]
        Typical clearance between neighbours.
    size : float [mm]
        Longer side of the box round everything.
    near : two (k,) int64
        Pairs of neighbouring bodies.
    hulls : Hulls or None
        Of all pairs whose convex hulls overlap, for the model `hull`.
    seconds : float
        What it took.
    """

    assembly: Assembly
    model: Hull | HalfPlane
    bodies: Bodies
    ignored: Ints
    clearance: float
    size: float
    near: tuple[Ints, Ints]
    hulls: Hulls | None
    seconds: float

    @property
    def reference(self) -> Floats:
        """Reference point (n, 2) [mm] of every body in its own frame."""
        return reference_points(self.assembly, self.bodies)

    @property
    def faces(self) -> Halfspaces:
        """Rows N g + D <= 0 of every pair at rest."""
        if self.hulls is not None:
            return self.hulls.faces
        from wiggleroom.freespace.models.halfplane import half_planes  # not for questions to walls

        return half_planes(self.bodies, *self.near, np.zeros_like(self.bodies.rest), NEIGHBOUR_REACH * self.clearance)


@dataclass(frozen=True, eq=False)
class End:
    """Where an approximating model ends: motions (k, n, 3) of the bodies from rest on, verdict, and what it took.

    `program` is that of the round that found it.
    """

    motions: Floats
    verdict: Verdict
    program: Program
    value: float
    rounds: int
    iterations: int

    def after(self, rounds: int, iterations: int) -> End:
        """The same, found after so much work."""
        return replace(self, rounds=rounds, iterations=iterations)


def approximate(assembly: Assembly, model: Hull | HalfPlane, context: Context = UNLIMITED) -> Approximation:
    """Make an assembly ready; raises as `wiggleroom.prepare` does."""
    began = time.perf_counter()
    surveyed = survey(assembly, context.stop)
    them = surveyed.bodies
    found = None
    if isinstance(model, Hull):
        from wiggleroom.freespace.models.hull import hulls  # nor this

        pairs = hulls_meet(them, surveyed.geometry, ignored=surveyed.ignored, stop=context.stop)
        found = hulls(them, pairs.a, pairs.b, reference_points(assembly, them), model, stop=context.stop)
        if found is None:
            finding = f"{assembly.drawing.source or 'the assembly'}: no free space was found round rest; parts touch"
            raise InputError(finding)
    return Approximation(
        assembly, model, them, surveyed.ignored, surveyed.clearance, surveyed.size, (surveyed.near.a, surveyed.near.b), found,
        time.perf_counter() - began,
    )  # fmt: skip


def reference_points(assembly: Assembly, bodies: Bodies) -> Floats:
    """Reference point (n, 2) [mm] of every body in its own frame: that of its part, the centroid where several are glued."""
    single = np.array([len(m) == 1 for m in bodies.members])
    part = np.array([m[0] for m in bodies.members])
    arm = rotated(assembly.rest[part, :2] - bodies.rest[:, :2], -bodies.rest[:, 2])
    return np.where(single[:, None], arm, 0.0)


def answer_from(
    ready: Approximation, asked: tuple[Goal, ...], solver: str, end: End, seconds: dict[str, float]
) -> Answer:
    """Measure what a model found, and say it as it is."""
    began = time.perf_counter()
    bodies, assembly = ready.bodies, ready.assembly
    deepest = overlaps(bodies, end.motions[-1], ready.ignored).deepest
    waypoints = of_parts(assembly, bodies, end.motions)
    free = audit_path(assembly, waypoints).free
    away = end.verdict is Verdict.UNBOUNDED and free  # said only where nothing is met on the way
    verdict = Verdict.STOPPED if end.verdict is Verdict.UNBOUNDED and not free else end.verdict
    leaves, turns = unlimited(assembly, bodies, end.motions[-1], ready.size) if away else ((), ())
    seconds = seconds | {"check": time.perf_counter() - began}
    seconds["total"] = sum(seconds.values())
    return Answer(
        assembly=assembly,
        goals=asked,
        verdict=verdict,
        objective=None if away else end.value,
        motion=waypoints[-1],
        waypoints=waypoints,
        contacts=(),
        path=PathState.of(free),
        collision_free=deepest <= OVERLAP_TOLERANCE * ready.size,
        deepest_overlap=deepest,
        model=ready.model.name,
        solver=solver,
        rounds=end.rounds,
        iterations=end.iterations,
        seconds=seconds,
        leaves=leaves,
        turns=turns,
    )


def thinned(bodies: Bodies, motions: Sequence[Floats], clearance: float) -> Floats:
    """Waypoints (k, n, 3) far enough apart to be worth keeping; the first and the last always."""
    kept = [motions[0]]
    for motion in motions[1:-1]:
        step = np.abs(motion - kept[-1])
        if (step[:, :2].max(axis=1) + bodies.radius * step[:, 2]).max() > WAYPOINT_SPACING * clearance:
            kept.append(motion)
    return np.array([*kept, motions[-1]] if len(motions) > 1 else kept)
