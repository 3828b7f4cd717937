"""One iterate of the method over bodies and planes, and the Newton directions from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.solve.factorisation import Factor
from wiggleroom.solve.newton_step import dot
from wiggleroom.spatial.bodies.rigid import SpatialPose
from wiggleroom.spatial.bodies.rotations import logarithm
from wiggleroom.spatial.planes import separating_plane_elimination as kernel
from wiggleroom.spatial.planes.graph_retraction import GraphRetraction
from wiggleroom.spatial.planes.separating_plane_program import LinearisedSeparatingPlanes, SeparatingPlanePoint
from wiggleroom.spatial.planes.separating_plane_settings import SETTINGS

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SeparatingPlaneResiduals:
    """By how much the conditions of first order fail at an iterate.

    Parameters
    ----------
    u : (V,) float64
        Scaled motion from the anchor.
    weight : float
        Weight of the proximal term, half the squared motion.
    primal : (R,) float64 [clearances]
        How far slacks run ahead of rows.
    dual : (V,) float64
        Imbalance of the bodies, in units of the objective's largest derivative per clearance.
    dual_planes : (K, 3) float64
        Imbalance of the planes.
    """

    u: Floats
    weight: float
    primal: Floats
    dual: Floats
    dual_planes: Floats

    @property
    def imbalance(self) -> float:
        """Largest imbalance."""
        return max(float(np.abs(d).max(initial=0.0)) for d in (self.dual, self.dual_planes))

    @property
    def unheld(self) -> float:
        """What imbalances are worth over the whole motion."""
        return dot(np.abs(self.dual), np.abs(self.u))


@dataclass(eq=False)
class SeparatingPlaneIterate:
    """A point, with slacks and multipliers of its rows.

    Parameters
    ----------
    at : LinearisedSeparatingPlanes
    s : (R,) float64
        Slacks of the rows: these themselves, or larger where they run ahead.
    lam : (R,) float64
        Multipliers, in units of the objective's largest derivative per clearance.
    unit : float
        Largest derivative of the objective at the start.
    shift : float
        Last strengthening of the diagonal.
    anchor : SpatialPose
        Where displacements begin.
    held : float
        Weight of the proximal term, in units of the barrier's.
    """

    at: LinearisedSeparatingPlanes
    s: Floats
    lam: Floats
    unit: float
    shift: float
    anchor: SpatialPose
    held: float

    @property
    def displacement(self) -> Floats:
        """Scaled motion (V,) from the anchor."""
        P, pose = self.at.program, self.at.point.pose
        turn = logarithm(np.einsum("nji,njk->nik", self.anchor.R, pose.R))
        turn = np.einsum("nji,nj->ni", self.at.axes, turn)
        return P.packed(np.hstack([pose.T - self.anchor.T, turn]) / P.scale)

    @property
    def complementarity(self) -> float:
        """Mean of slacks times multipliers."""
        return dot(self.s, self.lam) / max(len(self.lam), 1)

    def proximal(self, mu: float, u: Floats) -> float:
        """Weight of half the squared displacement at a barrier parameter; it never counts more than the barrier."""
        rows = max(len(self.lam), 1)
        return self.held * mu * rows / max(dot(u, u), rows)

    def residuals(self, mu: float) -> SeparatingPlaneResiduals:
        """What the conditions lack, with the proximal term of a barrier parameter."""
        u = self.displacement
        weight = self.proximal(mu, u)
        force, moment = self.at.against(self.lam)
        dual = weight * u - self.at.gradient / self.unit - force
        return SeparatingPlaneResiduals(u, weight, self.s - self.at.h, dual, -moment)

    def barrier(self, at: LinearisedSeparatingPlanes, mu: float, weight: float) -> float:
        """Barrier function at a point, infinite outside the rows."""
        if at.h.min(initial=np.inf) <= 0:
            return np.inf
        u = SeparatingPlaneIterate(at, self.s, self.lam, self.unit, 0.0, self.anchor, self.held).displacement
        return -at.value / self.unit - mu * float(np.log(at.h).sum()) + weight / 2 * dot(u, u)


@dataclass(frozen=True, eq=False)
class CarriedIterate:
    """Where a round begins.

    Parameters
    ----------
    point : SeparatingPlanePoint
        Pieces that joined may overlap there; their planes stand where these overlap least.
    lam : (R,) float64
        Multipliers, objective per mm of each row; zero on the planes that joined.
    value : float
        Objective at the point.
    path : tuple of SeparatingPlanePoint
        Points inside all rows, from rest: those of the round before, as far as nothing that joined overlaps.
    """

    point: SeparatingPlanePoint
    lam: Floats
    value: float
    path: tuple[SeparatingPlanePoint, ...]


class SeparatingPlaneSystem:
    """The condensed system of one iterate, factorised."""

    def __init__(self, matrix: Factor, retraction: GraphRetraction) -> None:
        self._matrix, self._retraction = matrix, retraction

    def set(self, state: SeparatingPlaneIterate, lacking: SeparatingPlaneResiduals) -> None:
        """Work the matrix out."""
        self._at, self._s, self._lam = state.at, state.s, state.lam
        self._curvature = self._retraction.balance(lacking.dual, state.at), 1.0 / state.unit, lacking.weight
        self._condense(0.0)

    def _condense(self, damping: float) -> None:
        """Entries of the matrix, with `damping` added to the weight of every row."""
        at, (balance, share, weight) = self._at, self._curvature
        self._damping = damping
        self._data, self._inverse, self._mixed = at.condensed(self._lam / self._s + damping, self._lam, balance, share)
        self._data[at.program.pattern.diagonal] += weight

    def factorise_damped(self, damping: float) -> bool:
        """Factorise with a damping of all rows, and some of all freedoms; False where the matrix is not positive definite.

        What many bodies do together hardly changes any row, so it is not held back as a shift of the diagonal alone would.
        """
        if damping != self._damping:
            self._condense(damping)
        return self.factorise(max(SETTINGS.tiny_shift, SETTINGS.damping_of_freedoms * damping))

    def set_least_squares(self, at: LinearisedSeparatingPlanes, weight: Floats) -> bool:
        """Work out and factorise the matrix of weighted least squares of the rows, for corrections; False where that fails."""
        self._at = at
        self._s, self._lam = np.ones_like(weight), weight
        nothing = np.zeros((len(at.program.a), 3))
        self._data, self._inverse, self._mixed = at.condensed(weight, np.zeros_like(weight), nothing, 0.0)
        return self.factorise(1e-9 * float(weight.max(initial=1.0)))

    def factorise(self, shift: float) -> bool:
        """Factorise with a shift of the diagonal; False where the matrix is not positive definite."""
        return bool(np.isfinite(self._data).all()) and self._matrix.update(self._data, shift)

    def newton(self, lacking: SeparatingPlaneResiduals, goal: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Directions (du, dy, ds, dlam) that change s * lam by `goal` and remove the residuals, to first order."""
        du, dy = self._solved((self._lam * lacking.primal + goal) / self._s, lacking.dual, lacking.dual_planes)
        ds = self._at.along(du, dy) - lacking.primal
        return du, dy, ds, (goal - self._lam * ds) / self._s

    def correction(self, missing: Floats) -> tuple[Floats, Floats]:
        """Changes (du, dy) that bring rows nearer by `missing` (R,): least squares, weighted as the rows are."""
        P = self._at.program
        return self._solved(self._lam / self._s * missing, np.zeros_like(self._at.gradient), np.zeros((P.planes, 3)))

    def _solved(self, force: Floats, dual: Floats, dual_planes: Floats) -> tuple[Floats, Floats]:
        """Changes of bodies and planes for forces (R,) of the rows and dual residuals."""
        at, P = self._at, self._at.program
        x, y = at.against(force)
        y = y - dual_planes
        bodies, share = P.unpacked(x - dual), np.empty_like(y)
        on_bodies = np.zeros_like(bodies)
        kernel.eliminate(
            at.Psi, at.point.pose.R, at.axes, P.a, P.b, P.plane, self._inverse, self._mixed, y, P.scale, share, on_bodies
        )  # fmt: skip
        du = self._matrix.solve(P.packed(bodies + on_bodies))
        kernel.substitute(P.plane, self._inverse, self._mixed, at.seen(du), share)
        return du, share
