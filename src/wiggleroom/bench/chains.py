"""Fig. 9: ten blocks in a row, the first fixed, how far the last moves sideways, by every method and in truth.

The physics engine shows what an experiment without friction would. It is Chipmunk (pymunk, extra `bench`). Parts are rigid convex pieces
without friction or bounce, fixed parts are static, a constant force acts at every pulled point, and everything is damped until nothing
changes; then the force is lowered, twice, to let what was pressed together come free. Inside, a typical clearance is one unit of length.
Engines let bodies sink into each other a little on purpose; how much, in all, is measured by exact geometry and reported beside the
displacement, which it enlarges.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly import patterns
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.findings import role_findings
from wiggleroom.bench.result import Bench, Column, Record, ResultTable
from wiggleroom.context import Context
from wiggleroom.drawing.model import Pull
from wiggleroom.errors import InputError, Stop, require_extra
from wiggleroom.freespace.models.pair_models import HalfPlane, Hull, PairModel, Walls
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.maximise import witness
from wiggleroom.program.objectives import Objective, objective
from wiggleroom.search.prepare import prepare_as_drawn

JOINTS = ("tee", "swallowtail")
TRUTH = "true optimum"

Found = tuple[float | None, float]
"""Displacement [mm], None where nothing stops it, and how deep parts overlap there [mm]."""
Method = Callable[[Assembly, Stop | None], Found]
Floats = NDArray[np.float64]

STEP = 0.01
"""Time of a step."""
SLOP = 0.002
"""How far bodies may sink into each other before the engine pushes back [clearance]."""
STIFF = 1e-12
"""Share of an overlap beyond the slop that is left after one unit of time."""
ROUNDS = 40
"""Passes over all contacts in every step."""
DRAG = 10.0
"""Speed fades by exp(-DRAG) in one unit of time."""
SPEED = 2.0
"""Speed at which the force drags everything [clearances per unit of time]."""
FORCES = (1.0, 0.1, 0.01)
"""Shares of the force, one after the other."""
PATIENCE, CALM = 500, 1e-3
"""It is at rest where this many steps change less than this [clearance per moving body]."""


def by_model(model: PairModel) -> Method:
    """Method that asks `flex` with a pair model."""

    def ask(assembly: Assembly, stop: Stop | None) -> Found:
        answer = witness(assembly, model=model, context=Context(stop=stop))
        return answer.objective, 0.0 if answer.collision_free else answer.deepest_overlap

    return ask


def by_physics(assembly: Assembly, _: Stop | None) -> Found:
    """Method that pulls in a physics engine until everything is at rest."""
    rest = pulled_to_rest(assembly)
    return rest.objective, rest.deepest_overlap


METHODS: dict[str, Method] = {
    "walls": by_model(Walls()),
    "hull, reference": by_model(Hull("reference")),
    "hull, joint": by_model(Hull("joint")),
    "half-planes, at rest": by_model(HalfPlane(iterated=False)),
    "half-planes": by_model(HalfPlane()),
    "physics engine": by_physics,
}
"""Registry: every method that is given a chain."""


def optima() -> tuple[int, dict[tuple[str, float], float]]:
    """Number of blocks, and the true optimum [mm] by joint and gap [mm].

    From an exact dynamic programme over the turns of the links, `python -m benchmarks.optima` in the repository.
    """
    stored = json.loads(files("wiggleroom.bench").joinpath("optima.json").read_text(encoding="utf-8"))
    split = {key: key.split() for key in stored["optima"]}
    return stored["blocks"], {(split[k][0], float(split[k][1])): value for k, value in stored["optima"].items()}


def require_engine() -> None:
    """Check that the physics engine is there; raises MissingExtraError."""
    require_extra("bench", "bench chains compares with a physics engine", "pymunk")


def chains(*, stop: Stop | None = None, progress: Callable[[int, int], None] | None = None) -> Bench:
    """Displacement against gap for every method, beside the true optimum.

    Parameters
    ----------
    stop, progress : optional
        Asked all the time; told how many questions are done, and how many there are.

    Source: Mind the Gap, Fig. 9; its figures are in a plot only, and its blocks' sizes are not given.
    """
    blocks, true = optima()
    cases = [(joint, gap) for joint in JOINTS for j, gap in true if j == joint]
    found: list[Record] = []
    for k, (joint, gap) in enumerate(cases):
        optimum = true[joint, gap]
        base: Record = {"joint": joint, "gap_mm": gap, "blocks": blocks, "published": False}
        found.append({**base, "method": TRUTH, "moves_mm": optimum, "overlap_mm": 0.0, "share_percent": 100.0})
        chain = patterns.chain(blocks, joint, gap)
        for i, (name, method) in enumerate(METHODS.items()):
            if stop is not None and stop.is_set():
                break
            if progress is not None:
                progress(k * len(METHODS) + i, len(cases) * len(METHODS))
            value, deep = method(chain, stop)
            share = None if value is None else 100 * value / optimum
            found.append({**base, "method": name, "moves_mm": value, "overlap_mm": deep, "share_percent": share})
    cut = stop is not None and stop.is_set()
    notes = (
        f"{blocks} unit blocks in a row, the first fixed, the last pulled in +y. The true optimum is an exact "
        "dynamic programme over the turns of the links (stored with the package, accurate to 1e-9; `python -m "
        "benchmarks.optima` works it out anew).",
        "A star: parts overlap in that motion. Hull: three slices, about the reference point or the joint. "
        "Half-planes: step by step; at rest: one linear program. Physics engine: Chipmunk, no friction, a force lowered until "
        "all is at rest; bodies sink into each other a little.",
        "† Mind the Gap shows such curves in its Fig. 9, without figures or the sizes of its blocks: there "
        "experiments with real blocks move furthest, then its hull, then PuzzleFlex.",
    )
    title = "Chains: displacement against gap, beside the true optimum"
    return Bench("chains", title, tuple(found), _sheets(found), notes, "wiggleroom bench chains", cut)


def _sheets(found: list[Record]) -> tuple[ResultTable, ...]:
    """Displacement, and share of the true optimum, with a column for every gap."""
    gaps = sorted({r["gap_mm"] for r in found})
    sheets = []
    for title, key, places in (
        ("Moves [mm] by gap [mm]", "moves_mm", 3),
        ("Share of the true optimum [%] by gap [mm]", "share_percent", 2),
    ):
        rows: dict[tuple[str, str], Record] = {}
        for r in found:
            row = rows.setdefault((r["joint"], r["method"]), {"joint": r["joint"], "method": r["method"]})
            row[f"{r['gap_mm']:g}"] = (
                "unbounded" if r[key] is None else f"{r[key]:.{places}f}{'*' if r['overlap_mm'] else ''}"
            )
        order = [rows[j, m] for j in JOINTS for m in (TRUTH, *METHODS) if (j, m) in rows]
        columns = (
            Column("joint", "joint"),
            Column("method", "method"),
            *[Column(f"{g:g}", f"{g:g}", right=True) for g in gaps],
        )
        sheets.append(ResultTable(title, columns, tuple(order)))
    return tuple(sheets)


@dataclass(frozen=True, eq=False)
class Rest:
    """Where the engine came to rest.

    Parameters
    ----------
    objective : float [mm]
        Sum of the pulls.
    motion : (parts, 3) float64 [mm, mm, rad]
        About the parts' reference points.
    deepest_overlap : float [mm]
        By exact geometry, at `motion`.
    settled : bool
        False where `most` steps did not bring it to rest.
    steps : int
    seconds : float
    """

    objective: float
    motion: Floats
    deepest_overlap: float
    settled: bool
    steps: int
    seconds: float


def pulled_to_rest(assembly: Assembly, pulls: Pull | Sequence[Pull] | None = None, *, most: int = 100_000) -> Rest:
    """Pull with a constant force until everything is at rest.

    Parameters
    ----------
    assembly : Assembly
        With a gap.
    pulls : Pull or several, optional
        By default what the assembly's file asks for.
    most : int
        Steps after which it is given up.

    Raises
    ------
    InputError
        If nothing is fixed or pulled, something else than pulls is asked, or parts are told to ignore each other.
    TouchingError
        If two parts touch at rest.
    MissingExtraError
        Without pymunk (extra `bench`).

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = pulled_to_rest(wr.patterns.chain(2, gap=0.02))
    >>> abs(found.objective / 0.05387 - 1) < 0.05
    True
    """
    began = time.perf_counter()
    asked = assembly.goals if pulls is None else (pulls,) if isinstance(pulls, Pull) else tuple(pulls)
    wrong = list(role_findings(replace(assembly.drawing, goals=asked)))
    wrong += [f"the physics engine knows pulls only, no {type(g).__name__}" for g in asked if not isinstance(g, Pull)]
    if assembly.drawing.ignore:
        wrong.append("the physics engine does not know parts that ignore each other")
    if wrong:
        raise InputError(wrong)
    ready = prepare_as_drawn(assembly)
    them = ready.bodies
    goal = objective(assembly, them, asked)
    scene = _Scene(them, ready.clearance)
    motion, settled, steps = _run(scene, goal, most)
    return Rest(
        goal.value(motion),
        of_parts(assembly, them, motion[None])[0],
        overlaps(them, motion, ready.ignored).deepest,
        settled,
        steps,
        time.perf_counter() - began,
    )


class _Scene:
    """The assembly in the engine, lengths in clearances."""

    def __init__(self, them: Bodies, unit: float) -> None:
        munk = _library()
        self.unit, self.rest = unit, them.rest
        self.space: Any = munk.Space()
        self.space.iterations, self.space.damping = ROUNDS, float(np.exp(-DRAG))
        self.space.collision_slop, self.space.collision_bias = SLOP, STIFF
        self.bodies: list[Any] = []
        self.middle = them.rest[:, :2].mean(0)
        pieces: dict[int, list[Floats]] = {}
        for n, geometry in enumerate(placed(them)):
            shape = int(them.shape[n])
            if shape not in pieces:
                pieces[shape] = [_local(p, them.rest[n]) / unit for p in convex_polygons(geometry)]
            mass = geometry.area / unit**2
            moment = sum(
                munk.moment_for_poly(mass * _area(p) * unit**2 / geometry.area, p.tolist()) for p in pieces[shape]
            )
            body = munk.Body(mass, moment, munk.Body.STATIC if them.fixed[n] else munk.Body.DYNAMIC)
            body.position = tuple((them.rest[n, :2] - self.middle) / unit)
            body.angle = float(them.rest[n, 2])
            shapes = [munk.Poly(body, p.tolist()) for p in pieces[shape]]
            self.space.add(body, *shapes)
            self.bodies.append(body)
        self.free = [n for n, fixed in enumerate(them.fixed) if not fixed]
        self.mass = float(sum(self.bodies[n].mass for n in self.free))

    def pulled(self, goal: Objective, force: float, motion: Floats) -> Floats:
        """Motion after `PATIENCE` more steps."""
        for _ in range(PATIENCE):
            slope = force * goal.gradient(motion)  # the force, and its moment about the body's origin
            for n in np.flatnonzero(slope.any(axis=1)):
                self.bodies[n].force = tuple(slope[n, :2])
                self.bodies[n].torque = float(slope[n, 2] / self.unit)
            self.space.step(STEP)
            motion = self.motion()
        return motion

    def motion(self) -> Floats:
        """Pose minus rest pose of every body (n, 3) [mm, mm, rad]."""
        motion = np.zeros_like(self.rest)
        pose = np.array([(*self.bodies[n].position, self.bodies[n].angle) for n in self.free])
        pose[:, :2] = pose[:, :2] * self.unit + self.middle
        motion[self.free] = pose - self.rest[self.free]
        return motion


def _run(scene: _Scene, goal: Objective, most: int) -> tuple[Floats, bool, int]:
    """Step until nothing changes, under a force that is lowered again and again, so that what was pressed together comes free."""
    motion, steps = scene.motion(), 0
    weights = np.hypot(*goal.gradient(motion)[:, :2].T).sum()
    calm = CALM * scene.unit * len(scene.free) * weights
    for share in FORCES:
        force = share * scene.mass * DRAG * SPEED / weights
        last = np.inf
        while True:
            motion = scene.pulled(goal, force, motion)
            steps += PATIENCE
            value = goal.value(motion)
            if abs(value - last) < calm:
                break
            if steps >= most:
                return motion, False, steps
            last = value
    return motion, True, steps


def convex_polygons(shape: shapely.Geometry) -> list[Floats]:
    """Convex polygons (k, 2) that fill a shape, each with as much as can be joined without a dent.

    Triangles between the corners, then joined across edges while the union stays convex (Hertel and Mehlhorn).

    Examples
    --------
    >>> ell = shapely.Polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)])
    >>> sorted(shapely.Polygon(p).area for p in convex_polygons(ell))
    [1.5, 1.5]
    """
    pieces = [p for p in shapely.get_parts(shapely.constrained_delaunay_triangles(shape)) if p.area > 0]
    k = 0
    while k < len(pieces):
        for other in range(k + 1, len(pieces)):
            if not shapely.dwithin(pieces[k], pieces[other], 0.0):
                continue
            joined = shapely.union(pieces[k], pieces[other])
            if joined.geom_type == "Polygon" and joined.area > (1 - 1e-9) * joined.convex_hull.area:
                pieces[k] = joined
                del pieces[other]
                k = -1
                break
        k += 1
    return [shapely.get_coordinates(shapely.normalize(p).exterior.simplify(0.0))[:-1] for p in pieces]


def _local(points: Floats, pose: Floats) -> Floats:
    """Points (k, 2) of the assembly in a body's frame."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return np.asarray((points - pose[:2]) @ np.array([[c, -s], [s, c]]))


def _area(points: Floats) -> float:
    return float(shapely.Polygon(points).area)


def _library() -> Any:
    """The engine, imported when it is needed."""
    require_extra("bench", "the physics engine needs pymunk", "pymunk")
    import pymunk

    return pymunk
