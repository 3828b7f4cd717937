"""The answer in space: a motion that was found and checked, and how sure it is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.displayable import Drawable
from wiggleroom.drawing.model import Goal
from wiggleroom.spatial.solids.spatial_model import SpatialAssembly
from wiggleroom.verdict import PathState, Verdict

if TYPE_CHECKING:
    from wiggleroom.search.global_search import SearchEffort
    from wiggleroom.spatial.planes.separating_plane_program import SeparatingPlaneProgram
    from wiggleroom.spatial.planes.separating_plane_solver import SeparatingPlaneSolution
    from wiggleroom.spatial.spatial_bodies import Grouping


@dataclass(frozen=True)
class SpatialContact:
    """One place where two parts hold each other at the reported motion.

    Parameters
    ----------
    parts : pair of names
        The normal points from the first into the second.
    point, normal : (x, y, z) [mm], unit vector
        Assembly coordinates at the moved position.
    force : float
        Objective gained per mm that this contact gives way.
    """

    parts: tuple[str, str]
    point: tuple[float, float, float]
    normal: tuple[float, float, float]
    force: float


@dataclass(frozen=True, eq=False)
class HeldMotion:
    """How a motion is held: the last program, its solution, and which part every piece belongs to."""

    grouping: Grouping
    program: SeparatingPlaneProgram
    found: SeparatingPlaneSolution


@dataclass(frozen=True, eq=False)
class SpatialAnswer(Drawable):
    """The largest safe motion that was found.

    Parameters
    ----------
    assembly : SpatialAssembly
    goals : tuple of Pull, Turn or Weight
    verdict : Verdict
    objective : float or None
        Sum of the goals [mm] (turns in [rad]); None where nothing stops the motion.
    motion : (n, 6) float64 [mm, rad]
        Displacement of the reference point of every part, and its rotation vector.
    waypoints : (k, n, 6) float64 [mm, rad]
        Motions along a path from rest to `motion`; between them positions go straight, turns about one constant axis.
    contacts : tuple of SpatialContact
    path : str
        "checked" where no two parts overlap anywhere along the path, else "not checked".
    collision_free : bool
    deepest_overlap : float [mm]
        Deepest overlap of any two parts at `motion`, by booleans of the solids.
    leaves, turns : tuple of names
        Parts that move away or turn without limit.
    at_most : float or None
        A value that no motion can exceed; only where all parts move in one plane.
    search : SearchEffort or None
        What climbs from other places came to; None where there were none.
    lead : (k, n, 6) float64 [mm, rad]
        First part of the path, to half way through a climb that began where a random pull led to; rest alone where it began there.
    warm_start : HeldMotion or None
        The program and the forces that hold the motion, where it ends.
    """

    assembly: SpatialAssembly
    goals: tuple[Goal, ...]
    verdict: Verdict
    objective: float | None
    motion: NDArray[np.float64]
    waypoints: NDArray[np.float64]
    contacts: tuple[SpatialContact, ...]
    path: PathState
    collision_free: bool
    deepest_overlap: float
    solver: str
    rounds: int
    iterations: int
    seconds: dict[str, float] = field(default_factory=dict)
    leaves: tuple[str, ...] = ()
    turns: tuple[str, ...] = ()
    command: str = ""
    at_most: float | None = None
    model: str = "planes"
    search: SearchEffort | None = None
    lead: NDArray[np.float64] | None = field(default=None, repr=False)
    warm_start: HeldMotion | None = field(default=None, repr=False)

    @property
    def turn(self) -> NDArray[np.float64]:
        """Angles by which the parts are turned (n,) [rad]."""
        return np.linalg.norm(self.motion[:, 3:], axis=1)
