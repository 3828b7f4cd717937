"""Answers in space as JSON: the formats of the plane with `"dimension": 3` and motions of six numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from wiggleroom.disassembly.largest_gap import LargestGap
from wiggleroom.report.tables import text_of
from wiggleroom.spatial.spatial_answer import SpatialAnswer
from wiggleroom.spatial.spatial_disassembly import SpatialDisassembly
from wiggleroom.verdict import Verdict

Record = dict[str, Any]
MIN_MOTION = 1e-12
"""Parts that never move further are left out of paths [mm, rad]."""


def motion_entry(motion: np.ndarray) -> Record:
    """Motion (6,) [mm, rad] of a part: displacement of its reference point, and rotation vector in degrees."""
    return {"move": motion[:3].tolist(), "turn_deg": np.degrees(motion[3:]).tolist()}


def spatial_flex_record(answer: SpatialAnswer) -> Record:
    """Everything `flex --json` says; lengths in mm, angles in degrees."""
    free = answer.verdict is Verdict.UNBOUNDED
    record: Record = {
        "format": "wiggleroom.flex/1",
        "dimension": 3,
        "verdict": answer.verdict.value,
        "objective": None if free or answer.objective is None else float(answer.objective),
        "at_most": answer.at_most,
    }
    if answer.search is not None:
        record["search"] = asdict(answer.search)
    if free:
        record |= {"leaves": list(answer.leaves), "turns": list(answer.turns)}
    return record | {
        "parts": {n: motion_entry(m) for n, m in zip(answer.assembly.names, answer.motion, strict=True)},
        "collision_free": bool(answer.collision_free),
        "deepest_overlap": float(answer.deepest_overlap),
        "path": answer.path,
        "contacts": [
            {"parts": list(c.parts), "point": list(c.point), "normal": list(c.normal), "force": c.force}
            for c in answer.contacts
        ],
        "model": answer.model,
        "solver": answer.solver,
        "rounds": answer.rounds,
        "seconds": {stage: round(float(spent), 4) for stage, spent in answer.seconds.items()},
        "command": answer.command,
    }


def spatial_check_record(found: SpatialDisassembly, border: LargestGap | None = None, command: str = "") -> Record:
    """Everything `check --json` says; lengths in mm, angles in degrees."""
    record: Record = {"format": "wiggleroom.check/1", "dimension": 3} | _separability_entry(found)
    record["gap"] = found.assembly.gap
    if border is not None:
        record["largest_gap"] = {
            "interlocked_at": border.holds,
            "comes_apart_at": border.parts_at,
            "interlocked": None if border.interlocked is None else _separability_entry(border.interlocked),
            "comes_apart": None if border.apart is None else _separability_entry(border.apart),
        }
    return record | {"seconds": round(found.seconds, 4), "command": command}


def _separability_entry(found: SpatialDisassembly) -> Record:
    """Whether parts come apart at one gap."""
    names = found.assembly.names
    escapes = []
    for escape in found.escapes:
        moved = np.flatnonzero((np.abs(escape.path) > MIN_MOTION).any(axis=(0, 2)))
        path = [{names[k]: motion_entry(m[k]) for k in moved} for m in escape.path]
        escapes.append({"parts": list(escape.parts), "path": path})
    return {
        "verdict": found.verdict.value,
        "certainty": found.certainty.value,
        "at_most": None,
        "escapes": escapes,
        "spins": [],
        "remains": list(found.remains),
    }


def spatial_steps(names: Sequence[str], paths: Sequence[np.ndarray]) -> str:
    """Motions along paths (k, n, 6), one after the other, as comma-separated values: a row for each path, step and part that moves."""
    heads = ("path", "step", "part", "dx_mm", "dy_mm", "dz_mm", "rx_deg", "ry_deg", "rz_deg")
    rows = [
        (k + 1, step, names[p], *motion[p, :3].tolist(), *np.degrees(motion[p, 3:]).tolist())
        for k, path in enumerate(paths)
        for step, motion in enumerate(path)
        for p in np.flatnonzero((np.abs(path) > MIN_MOTION).any(axis=(0, 2))).tolist()
    ]
    return text_of(heads, rows)
