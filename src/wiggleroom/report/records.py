"""Answer as JSON, to the letter of the format `wiggleroom.flex/1`."""

from __future__ import annotations

import json
import math
from typing import Any

from wiggleroom.search.answer import Answer
from wiggleroom.verdict import Verdict

Record = dict[str, Any]


def flex_record(answer: Answer) -> Record:
    """Everything `flex --json` says, as plain dicts, lists, strings and numbers; lengths in mm, angles in degrees."""
    free = answer.verdict is Verdict.UNBOUNDED
    record: Record = {
        "format": "wiggleroom.flex/1",
        "verdict": answer.verdict.value,
        "objective": None if free or answer.objective is None else float(answer.objective),
        "at_most": answer.at_most,
    }
    if answer.bound is not None and answer.bound.at_most is not None:
        within = answer.bound.within
        record["bound"] = {
            "kind": answer.bound.kind,
            "within": None if within is None else float(within),
            "seconds": round(float(answer.bound.seconds), 4),
        }
    if free:
        record |= {"leaves": list(answer.leaves), "turns": list(answer.turns)}
    return record | {
        "parts": {
            name: {"dx": x, "dy": y, "turn_deg": math.degrees(turn)}
            for name, (x, y, turn) in zip(answer.assembly.names, answer.motion.tolist(), strict=True)
        },
        "collision_free": bool(answer.collision_free),
        "deepest_overlap": float(answer.deepest_overlap),
        "path": answer.path,
        "contacts": [
            {
                "parts": list(c.parts),
                "point": [float(x) for x in c.point],
                "normal": [float(x) for x in c.normal],
                "force": float(c.force),
            }
            for c in answer.contacts
        ],
        "model": answer.model,
        "solver": answer.solver,
        "rounds": int(answer.rounds),
        "seconds": {stage: round(float(spent), 4) for stage, spent in answer.seconds.items()},
        "command": answer.command,
    }


def to_json(record: Record) -> str:
    """`record` as JSON text that is easy to read: one line for every part and every contact."""
    lines = [f"  {json.dumps(key)}: {_value(value)}" for key, value in record.items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _value(value: Any) -> str:
    """One entry of the record; those that hold many things get one line for each."""
    if isinstance(value, dict) and any(isinstance(v, dict) for v in value.values()):
        return "{\n" + ",\n".join(f"    {json.dumps(k)}: {_line(v)}" for k, v in value.items()) + "\n  }"
    if isinstance(value, list) and any(isinstance(v, dict) for v in value):
        return "[\n" + ",\n".join(f"    {_line(v)}" for v in value) + "\n  ]"
    return _line(value)


def _line(value: Any) -> str:
    return json.dumps(_finite(value), allow_nan=False)


def _finite(value: Any) -> Any:
    """Put null for numbers that JSON cannot say, and leave no negative zero."""
    if isinstance(value, float):
        return value + 0.0 if math.isfinite(value) else None
    if isinstance(value, dict):
        return {k: _finite(v) for k, v in value.items()}
    if isinstance(value, list):
        return [_finite(v) for v in value]
    return value
