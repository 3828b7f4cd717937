"""Plans as JSON (`wiggleroom.plan/1`) and in words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from msgspec import UNSET
from numpy.typing import NDArray

from wiggleroom.planning.plan import Plan
from wiggleroom.planning.plan_tolerance import PlanRanking, PlanSample, SmallestGap
from wiggleroom.planning.steps import STILL, Step, axes_of
from wiggleroom.report.results.answer_words import few, number, towards
from wiggleroom.report.results.json_results import part_motion
from wiggleroom.report.results.separability import extent_text, search_entry
from wiggleroom.schema.plan_schema import (
    PlanAssemblyEntry,
    PlanGapEntry,
    PlanRankEntry,
    PlanResult,
    PlanSampleEntry,
    PlanStepEntry,
    SpatialPlanAssemblyEntry,
    SpatialPlanResult,
    SpatialPlanStepEntry,
)  # fmt: skip
from wiggleroom.verdict import Certainty, Separability

Floats = NDArray[np.float64]

MAX_PIECES = 3
"""Paths of more straight pieces than this are not described piece by piece."""
SLIGHT_TURN = 0.05
"""Turns up to this are not described [deg]."""
PLAN_QUANTILES = (0.01, 0.05, 0.5)
"""Quantiles of the least clearance that are told when gaps vary."""


@dataclass(frozen=True)
class PlanTolerances:
    """What was asked about a plan when gaps vary."""

    sample: PlanSample | None = None
    rank: PlanRanking | None = None
    gap: SmallestGap | None = None


def plan_result(found: Plan, command: str = "", told: PlanTolerances | None = None) -> PlanResult | SpatialPlanResult:
    """Everything `plan --json` says; lengths in mm, angles in degrees."""
    names, told = found.assembly.names, told or PlanTolerances()
    steps: list[Any] = [_step(names, step) for step in found.steps]
    in_space = found.assembly.dimension == 3
    kind = SpatialPlanResult if in_space else PlanResult
    back: Any = SpatialPlanAssemblyEntry if in_space else PlanAssemblyEntry
    return kind(
        verdict=found.verdict,
        certainty=found.certainty,
        targets=list(found.targets),
        order=[list(parts) for parts in found.order],
        level=list(found.level),
        moves=found.moves,
        steps=steps,
        assembly=[
            back(step=k + 1, parts=s.parts, path=s.path[::-1], axis=s.axis, held=s.held, falling=s.falling)
            for k, s in reversed(list(enumerate(steps)))
        ],
        remains=list(found.remains),
        rest=found.rest,
        rest_certainty=found.rest_certainty,
        gravity=found.gravity,
        search=search_entry(found),
        sample=UNSET if told.sample is None else _sample(told.sample),
        rank=UNSET if told.rank is None else _rank(told.rank),
        smallest_gap=UNSET if told.gap is None else _gap(names, told.gap),
        gap=found.assembly.gap,
        seconds=round(found.seconds, 4),
        notes=list(found.assembly.drawing.notes),
        command=command,
    )


def _sample(found: PlanSample) -> PlanSampleEntry:
    quantiles = {f"{100 * q:g}": found.quantile(q) for q in PLAN_QUANTILES}
    draws = len(found.clearance)
    return PlanSampleEntry(
        share=found.share, interval=found.interval, draws=draws, clearance=quantiles, failing=list(found.failing)
    )


def _rank(found: PlanRanking) -> list[PlanRankEntry]:
    return [PlanRankEntry(name, gain) for name, gain in zip(found.parts, found.gain.tolist(), strict=True)]


def _gap(names: tuple[str, ...], found: SmallestGap) -> PlanGapEntry:
    return PlanGapEntry(
        works_at=found.works_at,
        fails_at=found.fails_at,
        step=found.failing + 1 if found.failing >= 0 else None,
        parts=list(found.pair),
        paths=[_step(names, step).path for step in found.works],
    )


def tolerance_sentences(told: PlanTolerances) -> list[str]:
    """What is known of a plan when gaps vary, a line each."""
    said = []
    if told.sample is not None:
        low, high = told.sample.interval
        said.append(
            f"{number(100 * told.sample.share, 3)} % of {len(told.sample.clearance)} draws go together "
            f"({number(100 * low, 3)} to {number(100 * high, 3)} %); in 5 % the clearance is below "
            f"{number(told.sample.quantile(0.05), 3)} mm"
        )
    if told.rank is not None:
        best = [
            f"{n} {number(g, 3)}" for n, g in zip(told.rank.parts, told.rank.gain.tolist(), strict=True) if g > 0.01
        ]
        none = "no single part's gap gives the narrowest steps more room; enlarge several"
        said.append(f"more room, mm per mm of extra gap: {', '.join(best[:6])}" if best else none)
    if told.gap is not None:
        works = f"the plan works down to a gap of {number(told.gap.works_at)} mm"
        if told.gap.fails_at is None:
            said.append(f"{works}, the smallest that was tried")
        elif told.gap.failing < 0:
            said.append(f"{works}; at {number(told.gap.fails_at)} mm parts touch at rest")
        else:
            pair = " and ".join(told.gap.pair)
            said.append(
                f"{works}; at {number(told.gap.fails_at)} mm {pair} are in each other's way in step {told.gap.failing + 1}"
            )
    return said


def _step(names: tuple[str, ...], step: Step) -> PlanStepEntry:
    shown = np.flatnonzero(step.there & np.any(np.abs(step.path) > STILL, axis=(0, 2)))
    path = [{names[k]: part_motion(m[k]) for k in shown} for m in step.path]
    kind: Any = PlanStepEntry if step.path.shape[2] == 3 else SpatialPlanStepEntry
    return kind(
        parts=list(step.parts),
        as_one=step.as_one,
        leaves=list(step.leaves),
        moves=step.moves,
        path=path,
        clearance=step.clearance,
        room=step.room,
        turn_room_deg=math.degrees(step.turn_room),
        axis=step.axis,
        held=list(step.all_held),
        falling=list(step.falling),
    )


def plan_title(found: Plan) -> str:
    """Verdict, moves and gap in one line."""
    gap = f"at gap {number(found.assembly.gap)} mm"
    if found.verdict is Separability.COMES_APART:
        what = f"{few(found.targets)} taken out" if found.targets else "taken apart"
        return f"{what} in {found.moves} move{'s' if found.moves != 1 else ''} {gap}"
    what = f"no way to take out {few(found.targets)}" if found.targets else "no plan"
    sure = "" if found.verdict is Separability.UNKNOWN else f", {found.certainty}"
    return f"{what} {gap}: {found.verdict}{sure}"


def plan_facts(found: Plan) -> list[str]:
    """Level, order and what is left."""
    said = []
    if found.steps:
        said.append(f"level: {'.'.join(map(str, found.level)) or '0'} (moves up to each removal)")
        nearest = min(found.steps, key=lambda s: s.clearance)
        said.append(
            f"least clearance: {number(nearest.clearance, 3)} mm, in step {found.steps.index(nearest) + 1}; every step "
            "checked for overlap"
        )
    if found.gravity is not None and found.steps:
        most = max(len(step.falling) for step in found.steps)
        hands = (
            f"at most {most} part{'s' if most != 1 else ''} held besides those that move"
            if most
            else "none needs to be held"
        )
        said.append(f"loose parts fall in {towards(found.gravity)}: {hands}")
    if found.remains and found.verdict is Separability.COMES_APART:
        held = f"interlocked, {found.rest_certainty}"
        sure = {Separability.INTERLOCKED: held, Separability.UNKNOWN: "nothing more was found to leave"}
        said.append(f"remains: {few(found.remains)} ({sure.get(found.rest, found.rest)})")
    return said


def step_sentence(step: Step) -> str:
    """Who moves, and how."""
    many = len(step.parts) > 1
    verb = ("leave" if many else "leaves") if step.leaves else ("move" if many else "moves")
    together = " as one" if many and step.as_one else " at the same time" if many else ""
    return f"{few(step.parts)} {verb}{together} {_how(step)}, clearance {number(step.clearance, 3)} mm" + (
        f"; hold {few(step.falling)}" if step.falling else ""
    )


def _how(step: Step) -> str:
    """Directions of the pieces of a step."""
    rows = np.flatnonzero(np.any(np.abs(step.path - step.path[:1]) > STILL, axis=(0, 2)))
    axes = axes_of(step.path)
    pieces = np.diff(step.path[:, rows[0]], axis=0)
    turn = math.degrees(float(np.linalg.norm(step.path[-1, rows[0], axes:] - step.path[0, rows[0], axes:])))
    if len(pieces) <= MAX_PIECES and (step.as_one or len(rows) == 1):
        lengths = np.linalg.norm(pieces[:, :axes], axis=1).tolist()
        straight = [
            f"{towards(piece)}" + ("" if step.leaves and k == len(pieces) - 1 else f" by {number(length)} mm")
            for k, (piece, length) in enumerate(zip(pieces[:, :axes].tolist(), lengths, strict=True))
            if length > STILL
        ]
        if straight:
            return "in " + ", then ".join(straight) + (f", turned by {number(turn, 2)}°" if turn > SLIGHT_TURN else "")
    return f"on a path of {len(step.path)} points"


def searched_sentence(found: Plan) -> str:
    """How far the search went."""
    said = extent_text(found)
    if found.verdict is not Separability.COMES_APART and found.certainty is not Certainty.PROVEN and not found.whole:
        said += ", cut short"
    return said
