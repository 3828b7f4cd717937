"""Who falls: loose parts that their weight carries away from all that stands, and whom to hold so that nothing does.

The largest loss of height of all parts together is a motion as any other: every part is pulled down at its centroid by its weight. Parts
settle by the play that they have. What in the end still lies, neighbour by neighbour, beside what stands or is held as it did before has
only settled; all else has fallen. There is no friction.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from wiggleroom.assembly.assembly import Assembly, place
from wiggleroom.disassembly.remaining import displaced, only
from wiggleroom.drawing.model import Pull
from wiggleroom.errors import InputError, Stop
from wiggleroom.geometry.neighbours import neighbours, placed, relative_pose
from wiggleroom.geometry.rigid_motions import of_bodies
from wiggleroom.maximise import witness
from wiggleroom.planning.steps import Step
from wiggleroom.search.prepare import NEIGHBOUR_REACH, prepare

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

SETTLED = 3.0
"""Neighbours that move against each other by no more than this multiple of the clearance have only settled."""
LOOKS = 4
"""Each straight piece of a step is looked at so often."""


@dataclass(eq=False)
class Gravity:
    """Falling among the parts of one assembly.

    Parameters
    ----------
    assembly : Assembly
        Something in it stands.
    direction : (x, y)
        In which loose parts fall; any length but zero.

    Raises
    ------
    InputError
        If the direction is none.
    """

    assembly: Assembly
    direction: tuple[float, float]
    _known: dict[bytes, Bools] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        length = float(np.hypot(*self.direction))
        if not 0 < length < np.inf:
            finding = f"gravity {self.direction}: it must be a direction, as (0, -1)"
            raise InputError(finding)
        self.direction = (self.direction[0] / length, self.direction[1] / length)

    def falling(self, motion: Floats, there: Bools, held: Bools, stop: Stop | None = None) -> Bools:
        """Parts (n,) that fall.

        Parameters
        ----------
        motion : (n, 3) float64 [mm, mm, rad]
            Where the parts are, about their reference points.
        there : (n,) bool
            Parts that have not left.
        held : (n,) bool
            Parts that are held; what is fixed stands anyway.
        stop : optional
            Asked now and then; then nothing falls that was not seen to.
        """
        fixed = np.array([p.fixed for p in self.assembly.parts])
        out = np.zeros(len(there), dtype=np.bool_)
        if not (there & ~fixed & ~held).any():
            return out
        who = np.flatnonzero(there)
        key = np.round(motion[who], 9).tobytes() + there.tobytes() + (held & there).tobytes()
        if key not in self._known:
            out[who] = self._fallen(_standing(self.assembly, motion, who, (fixed | held)[who]), stop)
            if stop is not None and stop.is_set():
                return out
            self._known[key] = out
        return self._known[key]

    def to_hold(self, step: Step, stop: Stop | None = None) -> tuple[str, ...]:
        """Names of parts that somebody must hold during a step, besides those that move, so that nothing falls.

        Those that lie lowest are held first: others may rest on them.
        """
        names = np.array(self.assembly.names, dtype=object)
        moving = np.isin(names, step.parts)
        held = np.zeros(len(names), dtype=np.bool_)
        states = list(_states(step))
        for motion in states:
            while (falls := self.falling(motion, step.there, held | moving, stop)).any():
                held[self._lowest(motion, np.flatnonzero(falls))] = True
        for k in np.flatnonzero(held):  # what was held first may be held up by what came later
            without = held.copy()
            without[k] = False
            if not any(self.falling(m, step.there, without | moving, stop).any() for m in states):
                held = without
        return tuple(names[held])

    def _lowest(self, motion: Floats, who: Ints) -> int:
        """Which of some parts has its centroid lowest."""
        some = only(displaced(self.assembly, motion), who)
        middles = [
            shapely.MultiPolygon([(place(r.outer, p.at), [place(h, p.at) for h in r.holes]) for r in p.regions])
            for p in some.parts
        ]
        heights = shapely.get_coordinates(shapely.centroid(middles)) @ np.array(self.direction)
        return int(who[int(heights.argmax())])

    def _fallen(self, state: Assembly, stop: Stop | None) -> Bools:
        """Parts of a state that its weight moves further than play does."""
        ready = prepare(state, stop=stop)
        bodies = ready.bodies
        geometry = placed(bodies)
        weight = shapely.area(geometry) * ~bodies.fixed
        weight /= weight.sum()
        goals = tuple(
            Pull(state.names[bodies.members[b][0]], self.direction, _pair(bodies.rest[b]), float(weight[b]))
            for b in np.flatnonzero(~bodies.fixed)
        )
        answer = witness(ready, goals, periods=False, stop=stop)
        end = of_bodies(state, bodies, answer.waypoints[-1:])[0]
        near = neighbours(bodies, geometry, NEIGHBOUR_REACH * ready.clearance, ignored=ready.ignored)
        change = relative_pose(bodies, near.a, near.b, end) - relative_pose(bodies, near.a, near.b)
        moved = np.hypot(change[:, 0], change[:, 1]) + bodies.radius[near.b] * np.abs(change[:, 2])
        kept = moved <= SETTLED * ready.clearance
        stands = np.flatnonzero(bodies.fixed)
        a = np.concatenate([near.a[kept], np.repeat(stands[:1], len(stands))])
        b = np.concatenate([near.b[kept], stands])
        n = len(bodies.fixed)
        label = connected_components(coo_array((np.ones(len(a)), (a, b)), shape=(n, n)), directed=False)[1]
        gone = np.isin(state.names, answer.leaves)
        fallen: Bools = (label != label[stands[0]])[bodies.body_of] | gone
        return fallen


def _states(step: Step) -> Iterator[Floats]:
    """States on the way of a step, from its beginning to its end."""
    yield step.way[0]
    for one, other in pairwise(step.way):
        for t in np.arange(1, LOOKS + 1) / LOOKS:
            yield one + t * (other - one)


def _standing(assembly: Assembly, motion: Floats, who: Ints, stands: Bools) -> Assembly:
    """The parts `who` where a motion took them, some of them fixed."""
    state = only(displaced(assembly, motion), who)
    parts = tuple(replace(p, fixed=bool(f)) for p, f in zip(state.parts, stands, strict=True))
    return replace(state, parts=parts, drawing=replace(state.drawing, parts=parts))


def _pair(v: Floats) -> tuple[float, float]:
    return float(v[0]), float(v[1])
