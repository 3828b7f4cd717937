"""Answer as JSON, to the letter of the format `wiggleroom.flex/1`."""

from __future__ import annotations

import math
from collections.abc import Container
from typing import TYPE_CHECKING, Any, Literal

import msgspec
import numpy as np
from msgspec import UNSET, Struct, json
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.writers.plain_json import plain
from wiggleroom.schema.fields import ContactEntry, PartMotion
from wiggleroom.schema.flex_schema import BoundEntry, FlexResult, PeriodEntry, SearchEntry
from wiggleroom.schema.spatial_result_schema import SpatialFlexResult, SpatialMotion
from wiggleroom.search.answer import Answer, Contact
from wiggleroom.verdict import Verdict

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly


def flex_result(answer: Answer) -> FlexResult | SpatialFlexResult:
    """Everything `flex --json` says; lengths in mm, angles in degrees."""
    free = answer.verdict is Verdict.UNBOUNDED
    in_space = answer.assembly.dimension == 3
    kind: Any = SpatialFlexResult if in_space else FlexResult
    return kind(
        verdict=answer.verdict,
        objective=None if free or answer.objective is None else float(answer.objective),
        at_most=answer.at_most,
        search=UNSET if answer.search is None else SearchEntry(**vars(answer.search)),
        leaves=list(answer.leaves) if free else UNSET,
        turns=list(answer.turns) if free else UNSET,
        parts=_motions(answer, answer.motion, set(answer.assembly.names)),
        collision_free=bool(answer.collision_free),
        deepest_overlap=float(answer.deepest_overlap),
        path=answer.path,
        contacts=[contact_entry(c) for c in answer.contacts],
        model=answer.model,
        solver=answer.solver,
        rounds=int(answer.rounds),
        seconds={stage: round(float(spent), 4) for stage, spent in answer.seconds.items()},
        notes=list(answer.assembly.drawing.notes),
        command=answer.command,
        bound=_bound(answer),
        **({} if in_space else {"period": _period(answer)}),
    )


def dimension(assembly: Assembly) -> Literal[3] | msgspec.UnsetType:
    """What the result of a study says of an assembly in space; nothing in the plane."""
    return 3 if assembly.dimension == 3 else UNSET


def _period(answer: Answer) -> PeriodEntry | msgspec.UnsetType:
    period, names = answer.period, answer.assembly.names
    if period is None:
        return UNSET
    turned = {name: math.degrees(turn) for name, turn in zip(names, period.turn.tolist(), strict=True) if turn}
    moves = np.abs(answer.waypoints).max(axis=(0, 2)).tolist()
    moving = {name for name, far in zip(names, moves, strict=True) if far}
    path = [_motions(answer, motion, moving) for motion in answer.waypoints]
    return PeriodEntry(float(period.objective), turned, period.first, path)


def _motions(answer: Answer, motion: NDArray[np.float64], names: Container[str]) -> dict[str, Any]:
    """Motions of some parts, by name."""
    return {name: part_motion(m) for name, m in zip(answer.assembly.names, motion, strict=True) if name in names}


def part_motion(motion: NDArray[np.float64]) -> Any:
    """Motion (3,) or (6,) [mm, rad] of a part: `PartMotion`, in space `SpatialMotion`."""
    if len(motion) == 3:
        x, y, turn = motion.tolist()
        return PartMotion(x, y, math.degrees(turn))
    (x, y, z), (u, v, w) = motion[:3].tolist(), np.degrees(motion[3:]).tolist()
    return SpatialMotion((x, y, z), (u, v, w))


def _bound(answer: Answer) -> BoundEntry | msgspec.UnsetType:
    bound = answer.bound
    if bound is None or bound.at_most is None:
        return UNSET
    within = None if bound.within is None else float(bound.within)
    return BoundEntry(bound.kind, within, round(float(bound.seconds), 4))  # type: ignore[arg-type]


def contact_entry(contact: Contact) -> ContactEntry:
    """One contact in plain numbers."""
    point, normal = (tuple(float(x) for x in place) for place in (contact.point, contact.normal))
    return ContactEntry(contact.parts, point, normal, float(contact.force))


def to_json(result: Struct | dict[str, Any]) -> str:
    """`result` as JSON text that is easy to read: one line for every part and every contact."""
    content = msgspec.to_builtins(result, enc_hook=plain)
    lines = [f"  {_line(key)}: {_value(value)}" for key, value in content.items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _value(value: Any) -> str:
    """One entry of the record; those that hold many things get one line for each."""
    if isinstance(value, dict) and any(isinstance(v, dict) for v in value.values()):
        return "{\n" + ",\n".join([f"    {_line(k)}: {_line(v)}" for k, v in value.items()]) + "\n  }"
    if isinstance(value, list) and any(isinstance(v, dict) for v in value):
        return "[\n" + ",\n".join([f"    {_line(v)}" for v in value]) + "\n  ]"
    return _line(value)


def _line(value: Any) -> str:
    """The value on one line; null for numbers that JSON cannot say, and no negative zero."""
    text = json.encode(value)
    if b"-0.0" in text:
        text = json.encode(_positive_zeros(value))
    return json.format(text, indent=0).decode()


def _positive_zeros(value: Any) -> Any:
    if isinstance(value, float):
        return value + 0.0
    if isinstance(value, dict):
        return {k: _positive_zeros(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_positive_zeros(v) for v in value]
    return value
