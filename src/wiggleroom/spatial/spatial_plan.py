"""Plans in space: in which order and along which paths parts are taken apart, each stage begun where the one before ended."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import Context
from wiggleroom.disassembly.disassembly_sequence import Departure, Disassembly
from wiggleroom.disassembly.disassembly_stage import NO_BODIES, Stage
from wiggleroom.disassembly.ground import with_ground
from wiggleroom.drawing.model import Part
from wiggleroom.planning.gravity import Gravity
from wiggleroom.planning.plan import Plan, check_targets, planned
from wiggleroom.planning.steps import moves_of
from wiggleroom.spatial.rotations import exponential, logarithm
from wiggleroom.spatial.spatial_bodies import grouped
from wiggleroom.spatial.spatial_disassembly import DisassemblyStage, reduced
from wiggleroom.spatial.spatial_plan_geometry import SpatialPlanGeometry
from wiggleroom.spatial.spatial_prepare import prepare_spatial
from wiggleroom.verdict import Certainty, Separability

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def plan_spatial(
    assembly: Assembly, targets: Sequence[str] = (), *, gravity: tuple[float, ...] | None = None, context: Context
) -> Plan:
    """Plan how an assembly in space is taken apart; see `wiggleroom.plan`.

    Raises
    ------
    InputError
        If a target is unknown or fixed, there is only one body, or all are fixed; if gravity has no direction.
    TouchingError
        If two parts touch at rest.
    """
    began = time.perf_counter()
    targets = tuple(dict.fromkeys(targets))
    standing = with_ground(assembly)
    check_targets(standing, targets)
    geometry = SpatialPlanGeometry(standing)
    weight = None if gravity is None else Gravity(geometry.falling(), gravity)
    sequence = _Sequence(standing, context, np.zeros((len(standing.parts), 6)))
    rest, sure, stuck = sequence.take_apart(np.arange(len(standing.parts)), targets)
    for group in sequence.groups:  # those that left together; taking them apart may add more
        if targets or context.stopped:
            break
        *_, held = sequence.take_apart(group, ())
        stuck += held
    last = Stage(rest, sure, NO_BODIES, None, NO_BODIES, whole=rest is not Separability.UNKNOWN)
    done = Disassembly(
        tuple(sequence.departures), last, standing, questions=sequence.questions,
        together=tuple(standing.names[k] for k in stuck),
    )  # fmt: skip
    return planned(assembly, targets, done, geometry, weight, context, began)


@dataclass(eq=False)
class _Sequence:
    """Departures so far, where all parts are, and groups that left together and are still one."""

    standing: Assembly
    context: Context
    now: Floats
    departures: list[Departure] = field(default_factory=list)
    groups: list[Ints] = field(default_factory=list)
    questions: int = 0

    def take_apart(self, who: Ints, targets: Sequence[str]) -> tuple[Separability, Certainty, list[int]]:
        """Take some parts (k,) apart, until the targets have left: what became of those that stay, and which these are beside one."""
        names = self.standing.names
        there = np.isin(np.arange(len(names)), who)
        while True:
            alive = np.flatnonzero(there)
            if targets and not any(there[names.index(name)] for name in targets):
                return Separability.UNKNOWN, Certainty.SEARCHED, []
            left = reduced(displaced(self.standing, self.now), alive.tolist())
            if len(grouped(left).bodies.at) < 2:
                return Separability.INTERLOCKED, Certainty.PROVEN, []
            left = with_ground(left)
            if not grouped(left).bodies.moves.any():
                return Separability.INTERLOCKED, Certainty.PROVEN, []
            stage = DisassemblyStage(prepare_spatial(left), self.context)
            found = stage.escape_path()
            self.questions += stage.questions
            if found is None:
                stuck = [int(k) for k in alive if not left.parts[list(alive).index(k)].fixed]
                return *stage.verdict(), stuck
            parts, own = found
            path = np.repeat(self.now[None], len(own), axis=0)
            path[:, alive] = continued(self.now[alive], own)
            gone = alive[parts]
            self.departures.append(Departure(gone, path, there.copy(), moves_of(path)))
            there[gone] = False
            self.now = path[-1]
            if len(gone) > 1:
                self.groups.append(gone)


def continued(before: Floats, path: Floats) -> Floats:
    """Motions since rest (k, n, 6) [mm, rad] along a path that begins where a motion (n, 6) has taken the parts.

    >>> turn = np.array([[1.0, 0, 0, 0, 0, np.pi / 2]])
    >>> continued(turn, np.array([[[0, 2.0, 0, 0, 0, np.pi / 4]]]))[0, 0].round(6).tolist()
    [1.0, 2.0, 0.0, 0.0, 0.0, 2.356194]
    """
    out = np.empty_like(path)
    out[:, :, :3] = before[:, :3] + path[:, :, :3]
    turns = exponential(path[:, :, 3:].reshape(-1, 3)).reshape(*path.shape[:2], 3, 3) @ exponential(before[:, 3:])
    out[:, :, 3:] = logarithm(turns.reshape(-1, 3, 3)).reshape(*path.shape[:2], 3)
    return out


def displaced(assembly: Assembly, motion: Floats) -> Assembly:
    """The assembly as made, at rest where a motion (n, 6) [mm, rad] has taken it."""
    if not motion.any():
        return assembly
    turns = exponential(motion[:, 3:])

    def at(parts: tuple[Part, ...]) -> tuple[Part, ...]:
        found = []
        for part, turn, shift, middle in zip(parts, turns, motion[:, :3], assembly.reference, strict=True):
            place = turn @ (np.asarray(part.at) - middle) + middle + shift
            found.append(replace(part, at=tuple(place.tolist()), R=turn @ part.R))
        return tuple(found)

    return Assembly(at(assembly.parts), replace(assembly.drawing, parts=at(assembly.drawing.parts)))
