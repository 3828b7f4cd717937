"""What a certificate in space claims, in a sentence, and whether that is about an assembly file."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from wiggleroom.verify.claim import describe_parts, rounded_up
from wiggleroom.verify.space_checker import SpatialClaim

ALIKE = 1e-12
"""Numbers agree where they differ by no more than this share of the size of the assembly."""
FREEDOMS = ("x", "y", "z", "rx", "ry", "rz")
AXES = {(1.0, 0.0, 0.0): "x", (0.0, 1.0, 0.0): "y", (0.0, 0.0, 1.0): "z"}


@dataclass(frozen=True, eq=False)
class SpatialGoal:
    """A pull, or a turn about a direction, of a part.

    Parameters
    ----------
    part : str
    turn : bool
    direction : (3,) float64
        Of any length.
    point : (3,) float64 [mm] or None
        None where it is not said.
    weight : float
    """

    part: str
    turn: bool
    direction: np.ndarray
    point: np.ndarray | None
    weight: float


@dataclass(frozen=True, eq=False)
class SpatialSpecification:
    """What an assembly file and options say; None for what neither says.

    Parameters
    ----------
    source : str
    gap : float [mm]
    bodies : dict
        For each body the names of its parts, and which of its six freedoms it has.
    surfaces : dict
        Vertices (v, 3) [mm] and faces (f, 3) of every part as made, at rest.
    origin : dict
        Reference point (3,) [mm] of each body.
    goals : tuple of SpatialGoal or None
    ignored : bool
        Whether there are parts that never collide.
    """

    source: str
    gap: float
    bodies: dict[frozenset[str], tuple[bool, ...]]
    surfaces: dict[str, tuple[np.ndarray, np.ndarray]]
    origin: dict[frozenset[str], np.ndarray]
    goals: tuple[SpatialGoal, ...] | None
    ignored: bool


def spatial_sentence(claim: SpatialClaim, source: str = "") -> str:
    """The whole claim."""
    who, direction = describe_parts([claim.part]), _direction(claim.direction)
    most = claim.at_most / claim.weight * (1 + 1e-14)
    if claim.turn:
        asked = f"turns it about {direction} by more than {rounded_up(math.degrees(most) * (1 + 1e-14))} degrees"
    else:
        point = ", ".join(f"{x + 0.0:.9g}" for x in claim.point or ())
        length = math.hypot(*claim.direction)
        far = rounded_up(most / length * (1 + 1e-14))
        asked = f"moves its point ({point}) by more than {far} mm in direction {direction}"
    locked = [name for name, free in zip(FREEDOMS, claim.free, strict=True) if not free]
    conditions = [
        f"the gap is {claim.gap:.9g} mm",
        f"{describe_parts(claim.fixed)} {'is' if len(claim.fixed) == 1 else 'are'} fixed",
        *([f"{describe_parts(claim.moving)} move as one"] if len(claim.moving) > 1 else []),
        *([f"{' '.join(locked)} {'is' if len(locked) == 1 else 'are'} locked"] if locked else []),
        f"solids are those of {source}" if source else "solids are those in this file",
    ]
    return f"no motion of {who} that starts at rest {asked}, where {', '.join(conditions[:-1])}, and {conditions[-1]}"


def _direction(direction: tuple[float, ...]) -> str:
    length = math.hypot(*direction)
    unit = [x / length + 0.0 for x in direction]
    for sign, mark in ((1.0, "+"), (-1.0, "-")):
        name = AXES.get((sign * unit[0] + 0.0, sign * unit[1] + 0.0, sign * unit[2] + 0.0))
        if name:
            return mark + name
    return "(" + ", ".join(f"{x:.9g}" for x in unit) + ")"


def spatial_difference(claim: SpatialClaim, asked: SpatialSpecification) -> str:
    """The first thing in which a certificate differs from an assembly file and options, in one line; empty where there is none."""
    where = asked.source
    mine, own = {*claim.fixed, *claim.moving}, set(asked.surfaces)
    if mine != own:
        odd = sorted(mine ^ own)
        return f"{where} has other parts than the certificate: {describe_parts(odd[:1])} is in one of them only"
    moving = [names for names, free in asked.bodies.items() if any(free)]
    if len(moving) != 1 or moving[0] != frozenset(claim.moving):
        names = ", ".join(describe_parts(sorted(names)) for names in moving) or "nothing"
        return f"in {where} {names} move, in the certificate {describe_parts(claim.moving)}"
    if asked.ignored:
        return f"{where} has parts that never collide, and the proof uses that all do"
    if abs(asked.gap - claim.gap) > ALIKE * asked.gap:
        return f"the gap is {claim.gap:.9g} mm in the certificate, {asked.gap:.9g} mm in {where}"
    if asked.bodies[moving[0]] != claim.free:
        return f"{where} locks other freedoms than the certificate"
    points = np.vstack([vertices for vertices, _ in asked.surfaces.values()])
    near = ALIKE * float(np.ptp(points, axis=0).max()) + float(np.abs(points).max()) * 2.0**-49
    # a lock of shifts is one of this point; without, any point of the body describes its motions
    if not all(claim.free[:3]) and np.abs(np.array(claim.origin) - asked.origin[moving[0]]).max() > near:
        return f"the reference point of what moves lies elsewhere in {where}"
    for name, (vertices, faces) in claim.surfaces.items():
        other, sides = asked.surfaces[name]
        if len(vertices) != len(other) or not np.array_equal(np.array(faces), sides):
            return f"{describe_parts([name])} has another surface in {where}"
        away = float(np.abs(np.array(vertices) - other).max())
        if away > near:
            return f"{describe_parts([name])} has another surface in {where}: a corner lies {away:.3g} mm away"
    return _goal(claim, asked, near)


def _goal(claim: SpatialClaim, asked: SpatialSpecification, near: float) -> str:
    if asked.goals is None:
        return ""
    kind = "a turn" if claim.turn else "a pull"
    told = (
        f"the certificate is about {kind} of {describe_parts([claim.part])} in direction {_direction(claim.direction)}"
    )
    if len(asked.goals) != 1:
        return f"{told}; {asked.source} asks for {len(asked.goals)} goals together"
    goal = asked.goals[0]
    unit = goal.direction / np.linalg.norm(goal.direction)
    same = (
        goal.part == claim.part
        and goal.turn == claim.turn
        and float(np.abs(unit - np.array(claim.direction)).max()) <= ALIKE
        and abs(goal.weight - claim.weight) <= ALIKE * goal.weight
    )
    if not same:
        other = "a turn" if goal.turn else "a pull"
        return (
            f"{told}, weight {claim.weight:.9g}; {asked.source} asks for {other} of {describe_parts([goal.part])} "
            f"in direction {_direction(tuple(goal.direction.tolist()))}, weight {goal.weight:.9g}"
        )
    if not claim.turn and goal.point is not None:
        away = float(np.abs(goal.point - np.array(claim.point)).max())
        if away > max(near, ALIKE * float(np.abs(goal.point).max())):
            return f"{told} at another point than {asked.source} asks"
    return ""
