"""A proven bound beside an answer in space, of one body that moves among fixed ones."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, placed_surface
from wiggleroom.bound.prove import check_bound, check_request, not_proven, proof_budget
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.deadline import Deadline, WorkBudget
from wiggleroom.drawing.model import Pull, Turn
from wiggleroom.errors import InputError, Stop
from wiggleroom.search.answer import Answer, Bound, with_bound
from wiggleroom.search.progress import Progress
from wiggleroom.solve.dual_linear_program import need_highs
from wiggleroom.spatial.bodies.rotations import unit_vector
from wiggleroom.spatial.bodies.spatial_bodies import Grouping, grouped
from wiggleroom.spatial.proof.inner_pieces import InnerPiece, bent_edges, inner_pieces
from wiggleroom.spatial.proof.pose_flood import Lengths, LinearGoal, PoseFlood, Unbounded
from wiggleroom.spatial.proof.pose_rows import Contacts

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FORMAT = "wiggleroom.certificate/5"
REACH = 4.0
"""Displacements of more than this multiple of the size are not looked at: a body that gets there may leave."""
INWARD = 1e-9
"""Points lie this share of the size inside the pieces that they are material of."""
TARGET_SHARE = 0.9
"""The bound is to come so near, as a share of what was asked for."""
MaterialPoint = tuple[int, Floats]
"""A piece, and a point inside it [mm]."""
NEAR = 2.0
"""Edges that come nearer to pieces than this multiple of the clearance get points, so far from where they leave those."""
ABOVE = 1e-11
"""The bound is stated larger by this share, for rounding."""


@dataclass(frozen=True, eq=False)
class _Scene:
    """One moving body among fixed ones.

    Parameters
    ----------
    body : int
    origin : (3,) float64 [mm]
        Its reference point.
    pieces : list of InnerPiece
    moving : (pieces,) bool
    parts : (parts,) bool
        Which parts move.
    """

    assembly: Assembly
    group: Grouping
    body: int
    origin: Floats
    pieces: list[InnerPiece]
    moving: NDArray[np.bool_]
    parts: NDArray[np.bool_]


def prove_spatial(
    answer: Answer,
    within: float = 0.01,
    *,
    seconds: float | None = None,
    work: float | None = None,
    certify: bool = False,
    context: Context = UNLIMITED,
) -> Answer:
    """A value that no motion in space can exceed; see `wiggleroom.prove`.

    One body moves, of one part or of glued ones, and one pull or turn is asked. `certify` adds `bound.certificate`.
    """
    check_request(within, seconds, work)
    need_highs()
    clock = Deadline(seconds, context.stop)
    goal = _goal_of(answer)
    if isinstance(goal, str):
        raise InputError(goal)
    if answer.objective is None:
        return not_proven(answer, clock, "nothing stops the motion")
    scene = _scene(answer.assembly, clock)
    if isinstance(scene, str):
        return not_proven(answer, clock, scene)
    witness = answer.objective
    free = scene.group.bodies.free[scene.body]
    if free[:3].all() and free[3:].any():
        # linear rows leave out least about the axis of the largest turn; where shifts are locked, they are those of the reference point
        calm = _flood(scene, _linear(scene, goal)[0], WorkBudget())[0].calmest()
        scene = replace(scene, origin=scene.origin + calm)
    linear, tangent = _linear(scene, goal)
    aim = within * max(abs(witness), 1e-3 * max(answer.assembly.gap, 1e-6 * answer.assembly.size))
    target = (
        _tangent_of(witness + TARGET_SHARE * aim, goal) if tangent else (witness + TARGET_SHARE * aim) / goal.weight
    )
    flood, points = _flood(scene, linear, proof_budget(work, clock))

    def tell(reached: int, open_: int, best: float) -> None:
        most = (2 * math.atan(best) if tangent else best) * goal.weight if math.isfinite(best) else math.nan
        doing = f"{reached} boxes of poses, {open_} of them open" if open_ else f"{reached} boxes of poses"
        context.tell(Progress(f"proof, {clock.spent:.0f} s: {doing}", 0, 0, most))

    try:
        best = flood.run(target, tell)
    except Unbounded as why:
        return not_proven(answer, clock, str(why))
    if not math.isfinite(best):
        return not_proven(answer, clock, "no bound was found in the time or work given")
    most = (2 * math.atan(best) if tangent else best) * goal.weight
    most += ABOVE * (abs(most) + answer.assembly.gap)
    check_bound(most, answer)
    paper = _certificate(scene, goal, flood, points, most) if certify and flood.closed else None
    if answer.at_most is not None:
        if answer.at_most <= most and not certify:
            return answer
        most = min(most, answer.at_most)
    share = (most - witness) / abs(witness) if witness else None
    return with_bound(answer, Bound(float(most), share, clock.spent, certificate=paper))


def _goal_of(answer: Answer) -> Pull | Turn | str:
    """The only goal, or why there is no bound of what is asked."""
    if len(answer.goals) != 1 or not isinstance(answer.goals[0], Pull | Turn):
        return "a bound in space is proven for one pull or one turn, not for sums and weights"
    goal = answer.goals[0]
    return goal if goal.weight > 0 else "a bound in space is proven for a goal of positive weight"


def _scene(assembly: Assembly, stop: Stop) -> _Scene | str:
    """What moves among what, or why there is no bound."""
    group = grouped(assembly)
    moves = np.flatnonzero(group.bodies.moves)
    if len(moves) != 1:
        return f"{len(moves)} bodies move: a bound in space is proven for one body among fixed ones"
    if assembly.overshoot:
        return "a part is covered by larger pieces, and a bound needs pieces inside it"
    if assembly.drawing.ignore:
        return "parts that may overlap (ignore) are not supported by bounds in space"
    body = int(moves[0])
    pieces = inner_pieces(assembly, stop)
    parts = group.body_of == body
    moving = np.array([parts[piece.part] for piece in pieces])
    if stop.is_set():
        return "no bound was found in the time or work given"
    if not moving.any() or moving.all():
        return "there is nothing that could hold it"
    return _Scene(assembly, group, body, group.bodies.at[body], pieces, moving, parts)


def _linear(scene: _Scene, goal: Pull | Turn) -> tuple[LinearGoal, bool]:
    """What is maximised, and whether it is the tangent of half a turn."""
    if isinstance(goal, Turn):
        return LinearGoal(unit_vector(goal.sense), None), True
    point = (
        scene.assembly.reference[scene.assembly.names.index(goal.part)] if goal.point is None else np.array(goal.point)
    )
    return LinearGoal(unit_vector(goal.direction), point - scene.origin), False


def _tangent_of(value: float, goal: Pull | Turn) -> float:
    half = value / goal.weight / 2
    return math.tan(half) if half < math.pi / 2 else math.inf


def _flood(scene: _Scene, goal: LinearGoal, budget: WorkBudget) -> tuple[PoseFlood, list[MaterialPoint]]:
    """The flood, begun with all corners of the solids, and the points that it knows by number."""
    size, origin = scene.assembly.size, scene.origin
    contacts, ends = [], []
    surfaces = [
        placed_surface(part, made.surface)
        for part, made in zip(scene.assembly.parts, scene.assembly.solids, strict=True)
    ]
    for fixed in (False, True):
        faces = [
            (k, p.normals, p.offsets - p.normals @ origin)
            for k, p in enumerate(scene.pieces)
            if bool(scene.moving[k]) == fixed
        ]
        contacts.append(Contacts(fixed, faces))
        own = [s for s, moves in zip(surfaces, scene.parts, strict=True) if bool(moves) != fixed]
        ends.append(np.vstack([bent_edges(s) for s in own]) - origin)

    def material(fixed: bool, point: Floats) -> MaterialPoint | None:
        """The piece that a point [mm], from the origin, belongs to, and where it is inside."""
        best, own = None, contacts[not fixed]
        outside = np.maximum.reduceat(own.normals @ point - own.offsets, own.first)
        for k in own.number[outside < 1e-6 * size].tolist():
            piece = scene.pieces[k]
            inside = piece.drawn_in((point + origin)[None], INWARD * size)[0]
            away = float(np.abs(inside - origin - point).max())
            if away < 1e-6 * size and (best is None or away < best[2]):
                best = k, inside, away
        return None if best is None else (best[0], best[1])

    points: list[MaterialPoint] = []

    def named(fixed: bool, point: Floats) -> tuple[int, Floats] | None:
        found = material(fixed, point)
        if found is None:
            return None
        points.append(found)
        return len(points) - 1, found[1] - origin

    clearance = scene.assembly.gap or 1e-2 * size
    for fixed in (False, True):
        # a corner near an edge may be beyond either of two faces; the middle of an edge is seldom
        edge, start, stop, _ = contacts[fixed].bites(ends[fixed], NEAR * clearance)
        along = ends[fixed][edge, 1] - ends[fixed][edge, 0]
        inset = np.minimum(2 * NEAR * clearance / np.linalg.norm(along, axis=1), (stop - start) / 2)
        places = [ends[fixed].reshape(-1, 3), ends[fixed].mean(axis=1)]
        places += [ends[fixed][edge, 0] + t[:, None] * along for t in (start + inset, (start + stop) / 2, stop - inset)]
        for point in np.unique(np.vstack(places).round(9), axis=0):
            found = named(fixed, point)
            if found is not None:
                contacts[fixed].add(np.array([found[0]]), found[1][None])
    radius = max(
        float(np.linalg.norm(p.corners - origin, axis=1).max())
        for p, m in zip(scene.pieces, scene.moving, strict=True)
        if m
    )
    free = scene.group.bodies.free[scene.body]
    flood = PoseFlood(
        (contacts[0], contacts[1]),
        (ends[0], ends[1]),
        named,
        goal,
        free,
        Lengths(radius, clearance, REACH * size),
        budget,
    )
    return flood, points


def _certificate(
    scene: _Scene, goal: Pull | Turn, flood: PoseFlood, points: list[MaterialPoint], most: float
) -> dict[str, Any]:
    """What `wiggleroom verify` reads; lengths in mm, at rest."""
    reached = {id(flood.domain.leaves[k].step) for k in flood.reached()}
    assembly = scene.assembly
    used: dict[int, int] = {}

    def told(step: dict[str, Any]) -> dict[str, Any]:
        out: dict[str, Any] = {}
        if "rows" in step:
            out["rows"] = [[used.setdefault(p, len(used)), q, f] for p, q, f in step["rows"]]
        if "cuts" in step:
            out["cuts"] = step["cuts"]
        if "split" in step:
            out["split"] = step["split"]
        if "then" in step:
            out["then"] = [told(then) for then in step["then"]]
        if "best" in step:
            return {**out, "best": step["best"]} if id(step) in reached else {"open": True}
        return out or {"open": True}

    proof = told(flood.domain.root)
    low, high = flood.domain.box.low, flood.domain.box.high
    out: dict[str, Any] = {
        "format": FORMAT,
        "dimension": 3,
        "gap": float(assembly.gap),
        "at_most": float(most),
        "origin": scene.origin.tolist(),
        "free": [bool(f) for f in flood.domain.free],
        "goal": _told_goal(scene, goal),
        "parts": [
            {
                "name": part.name,
                "fixed": not bool(moves),
                "vertices": surface.vertices.tolist(),
                "faces": surface.faces.tolist(),
            }
            for part, moves, surface in (
                (part, moves, placed_surface(part, made.surface))
                for part, moves, made in zip(assembly.parts, scene.parts, assembly.solids, strict=True)
            )
        ],
        "pieces": [
            {
                "part": p.part,
                "inside": p.corners.mean(axis=0).tolist(),
                "faces": np.column_stack([p.normals, p.offsets]).tolist(),
            }
            for p in scene.pieces
        ],
        "points": [[k, *at.tolist()] for k, at in (points[n] for n in used)],
        "box": [low.tolist(), high.tolist()],
        "proof": proof,
    }
    return out | {"sha256": hashlib.sha256(json.dumps(out).encode()).hexdigest()}


def _told_goal(scene: _Scene, goal: Pull | Turn) -> dict[str, Any]:
    linear, tangent = _linear(scene, goal)
    if tangent or linear.arm is None:
        return {"part": goal.part, "turn": linear.direction.tolist(), "weight": float(goal.weight)}
    point = linear.arm + scene.origin
    return {"part": goal.part, "pull": linear.direction.tolist(), "point": point.tolist(), "weight": float(goal.weight)}
