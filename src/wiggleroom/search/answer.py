"""The answer to "how far can it move": a motion that was found and checked, and how sure it is."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.displayable import Drawable
from wiggleroom.drawing.model import Goal, Vector
from wiggleroom.verdict import PathState, SearchState, Verdict

if TYPE_CHECKING:
    from wiggleroom.search.global_search import SearchEffort

PROVEN_WITHIN = 1.001
"""An answer is proven where no motion is worth more than this multiple of it."""
MAX_BOUND_RATIO = 2.0
"""A bound of more than this many times the motion found says too little to be stated."""


@dataclass(frozen=True)
class Contact:
    """One place where two parts hold each other at the reported motion.

    Parameters
    ----------
    parts : pair of names
        The normal points from the first into the second.
    point, normal : (x, y), in space (x, y, z) [mm], unit vector
        Assembly coordinates at the moved position.
    force : float
        Multiplier: gain of the objective per mm that this contact gives way.
    """

    parts: tuple[str, str]
    point: Vector
    normal: Vector
    force: float


@dataclass(frozen=True)
class Bound:
    """A proven bound of the largest motion.

    Parameters
    ----------
    at_most : float or None
        A value that no motion can exceed [mm] (turns in [rad]); None if nothing was proven.
    within : float or None
        Excess of that value over the motion of the answer, as a share of the motion.
    seconds : float
        Time of the proof.
    why : str
        Reason if nothing was proven, else empty.
    certificate : dict, optional
        The proof for `wiggleroom verify`, on request.
    kind : str
        "proven" for a requested, tightened bound; "quick" for the cheap bound beside an answer, which is as certain but may lie far above
        the truth.
    """

    at_most: float | None
    within: float | None
    seconds: float
    why: str = ""
    certificate: dict[str, Any] | None = None
    kind: str = "proven"


@dataclass(frozen=True, eq=False)
class Period:
    """One period of a motion that repeats: it ends congruent to where it began, every part turned by a symmetry of its outline.

    Parameters
    ----------
    objective : float
        Gain of the objective in one period [rad].
    turn : (n,) float64 [rad]
        How far every part turns in it.
    first : int
        Waypoint at which it begins; it ends at the last one.
    """

    objective: float
    turn: NDArray[np.float64]
    first: int


@dataclass(frozen=True, eq=False)
class Answer(Drawable):
    """The largest safe motion of a search.

    Parameters
    ----------
    assembly : Assembly
    goals : tuple of goals
        The question.
    verdict : Verdict
    objective : float or None
        Sum of the goals [mm] (turns in [rad]); None if nothing stops the motion.
    motion : (n, 3) float64 [mm, mm, rad], in space (n, 6) [mm, rad]
        Pose minus rest pose of every part, about its reference point; in space the displacement of that point, and a rotation vector.
    waypoints : (k, n, 3) or (k, n, 6) float64
        Motions along a path from rest (first, all zero) to `motion` (last). Between them positions go straight; in space each part turns
        about one axis.
    contacts : tuple of Contact
    path : str
        "checked" if no two parts overlap anywhere along the path, else "not checked".
    deepest_overlap : float [mm]
        Largest overlap of any two parts at `motion`, by exact geometry.
    leaves, turns : tuple of names
        Parts that move away or turn without limit.
    period : Period or None
        Period of a motion that repeats without end.
    at_most : float or None
        A value that no motion can exceed; None if none was computed.
    bound : Bound or None
        Basis of `at_most`, or the reason for its absence; None if no bound was computed.
    search : SearchEffort or None
        Effort and result of the global search; None without one.
    search_state : SearchState
        Whether a search still under way, or left out, may find more.
    warm_start : Incumbent, HeldMotion or None
        State from which another question about the same prepared assembly can start; in space the program and the forces that hold the
        motion at its end.
    lead : (k, n, 6) float64 [mm, rad] or None
        In space: first part of the path, to half way through a climb from the end of a random pull; rest alone for a climb from rest.
    """

    assembly: Assembly
    goals: tuple[Goal, ...]
    verdict: Verdict
    objective: float | None
    motion: NDArray[np.float64]
    waypoints: NDArray[np.float64]
    contacts: tuple[Contact, ...]
    path: PathState
    collision_free: bool
    deepest_overlap: float
    model: str
    solver: str
    rounds: int
    iterations: int
    seconds: dict[str, float] = field(default_factory=dict)
    leaves: tuple[str, ...] = ()
    turns: tuple[str, ...] = ()
    period: Period | None = None
    at_most: float | None = None
    bound: Bound | None = None
    command: str = ""
    search: SearchEffort | None = None
    search_state: SearchState = SearchState.DONE
    warm_start: Any = field(default=None, repr=False)
    lead: NDArray[np.float64] | None = field(default=None, repr=False)

    @property
    def turn(self) -> NDArray[np.float64]:
        """Angles by which the parts are turned (n,) [rad]; in space without a sign, about the axis of each."""
        return np.asarray(
            self.motion[:, 2] if self.motion.shape[1] == 3 else np.linalg.norm(self.motion[:, 3:], axis=1)
        )


def with_bound(answer: Answer, bound: Bound) -> Answer:
    """The answer with a bound, its verdict `proven` where that is near enough."""
    value, most = answer.objective, bound.at_most
    near = value is not None and most is not None and 0 < value <= most <= PROVEN_WITHIN * value
    free = answer.collision_free and answer.path == PathState.CHECKED  # however the search for it ended
    verdict = Verdict.PROVEN if near and free else answer.verdict
    return replace(answer, at_most=most, bound=bound, verdict=verdict)


def witnessed(
    assembly: Assembly,
    goals: tuple[Goal, ...],
    verdict: Verdict,
    objective: float | None,
    waypoints: NDArray[np.float64],
    path: PathState,
    **more: Any,
) -> Answer:
    """Return an answer for a motion, the last of `waypoints` (k, n, 3), that is free of overlap without a search of its own."""
    return Answer(
        assembly=assembly,
        goals=goals,
        verdict=verdict,
        objective=objective,
        motion=waypoints[-1],
        waypoints=waypoints,
        path=path,
        collision_free=True,
        deepest_overlap=0.0,
        model="walls",
        solver="interior-point",
        rounds=0,
        iterations=0,
        **{"contacts": (), **more},
    )
