"""What was found as comma-separated values, for spreadsheets and other programs; the first line names the columns."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.planning.plan import Plan
from wiggleroom.report.results.answer_words import MIN_MOTION
from wiggleroom.report.results.separability import Checked
from wiggleroom.search.answer import Answer
from wiggleroom.sensitivity.gap_trials import AllowableGap
from wiggleroom.sensitivity.rank import Ranking
from wiggleroom.sensitivity.sample import Sample
from wiggleroom.sensitivity.sweep import Sweep
from wiggleroom.sensitivity.tighten import Tightening
from wiggleroom.sensitivity.worst_case import WorstCase
from wiggleroom.verdict import PathState


def csv_of(
    found: Answer[Any] | Ranking | Tightening | Sweep | Sample | Checked | AllowableGap
    | WorstCase | Plan
) -> str:  # fmt: skip
    """Table of what was found, lengths in mm and angles in degrees; what has no end or is not known is left empty.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> print(csv_of(wr.sweep(wr.patterns.chain(2, joint="tee"), [0.02])).splitlines()[0])
    gap,objective,verdict
    """
    heads: tuple[str, ...]
    rows: Sequence[Sequence[Any]]
    match found:
        case Answer() if found.assembly.dimension == 3:
            heads, rows = SPATIAL_COLUMNS, _spatial_steps(found.assembly.names, [found.waypoints])
        case Answer():
            heads, rows = ("step", *MOTION_COLUMNS), _steps(found.assembly.names, found.waypoints)
        case Checked() if found.found.assembly.dimension == 3:
            paths = [e.path for e in found.found.escapes]
            heads, rows = SPATIAL_COLUMNS, _spatial_steps(found.found.assembly.names, paths)
        case Checked():
            heads, rows = ("escape", "step", *MOTION_COLUMNS), _escapes(found)
        case Plan():
            heads, rows = ("step", "point", *MOTION_COLUMNS), _planned(found)
        case Ranking():
            heads, rows = ("kind", "name", "other", "per_mm", "tighter_per_mm", "percent"), _ranks(found)
        case Tightening():
            heads, rows = ("order", "part", "moved_before_mm", "moved_after_mm"), _tightened(found)
        case Sweep():
            heads, rows = ("gap", "objective", "verdict"), [(s.gap, s.objective, s.verdict) for s in found.steps]
            if any(s.at_most is not None for s in found.steps):
                heads, rows = (*heads, "at_most"), [(*row, s.at_most) for row, s in zip(rows, found.steps, strict=True)]
        case Sample():
            heads, rows = ("draw", "objective", *found.answer.assembly.names), _draws(found)
        case AllowableGap():
            heads, rows = ("gap", "objective", "at_most", "verdict", "path"), _trials(found)
        case WorstCase():
            heads, rows = (*TOLERANCE_COLUMNS, "per_mm", "looser_mm", "tighter_mm", "percent"), _contributions(found)
    return text_of(heads, rows)


TOLERANCE_COLUMNS = ("kind", "name", "other", "outline", "nominal_mm", "plus_mm", "minus_mm")
MOTION_COLUMNS = ("part", "dx_mm", "dy_mm", "turn_deg")
SPATIAL_COLUMNS = ("path", "step", "part", "dx_mm", "dy_mm", "dz_mm", "rx_deg", "ry_deg", "rz_deg")


def text_of(heads: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Heads and rows as text; numbers as short as they read back exactly, and empty where they are not finite."""
    file = io.StringIO()
    table = csv.writer(file, lineterminator="\n")
    table.writerow(heads)
    table.writerows([_cell(value) for value in row] for row in rows)
    return file.getvalue()


def _cell(value: Any) -> Any:
    if isinstance(value, float | np.floating):
        return repr(float(value) + 0.0) if math.isfinite(value) else ""
    return "" if value is None else str(value)


def _steps(names: Sequence[str], path: NDArray[np.float64]) -> list[tuple[Any, ...]]:
    """Motions along a path (k, n, 3), a row for each step and part; the last step is the end."""
    return [
        (step, name, x, y, math.degrees(turn))
        for step, motion in enumerate(path.tolist())
        for name, (x, y, turn) in zip(names, motion, strict=True)
    ]


def _spatial_steps(names: Sequence[str], paths: Sequence[NDArray[np.float64]]) -> list[tuple[Any, ...]]:
    """Motions along paths (k, n, 6), one after the other: a row for each path, step and part that moves."""
    return [
        (k + 1, step, names[p], *motion[p, :3].tolist(), *np.degrees(motion[p, 3:]).tolist())
        for k, path in enumerate(paths)
        for step, motion in enumerate(path)
        for p in np.flatnonzero((np.abs(path) > MIN_MOTION).any(axis=(0, 2))).tolist()
    ]


def _escapes(checked: Checked) -> list[tuple[Any, ...]]:
    """Paths of those that leave, one after the other; only parts that have moved."""
    rows = []
    for k, escape in enumerate(checked.found.escapes):
        moves = np.asarray(escape.path.any(axis=(0, 2)))
        names = [name for name, move in zip(checked.found.assembly.names, moves, strict=True) if move]
        rows += [(k + 1, *row) for row in _steps(names, escape.path[:, moves])]
    return rows


def _planned(found: Plan) -> list[tuple[Any, ...]]:
    """Paths of all steps; only parts that move in them."""
    rows = []
    for k, step in enumerate(found.steps):
        moves = [found.assembly.names.index(name) for name in step.parts]
        rows += [(k + 1, *row) for row in _steps(step.parts, step.path[:, moves])]
    return rows


def _ranks(ranking: Ranking) -> list[tuple[Any, ...]]:
    """Parts, then joints, the most important first."""
    names = ranking.answer.assembly.names
    parts = [
        ("part", names[k], "", float(ranking.looser[k]), float(ranking.tighter[k]), float(ranking.percent[k]))
        for k in ranking.order.tolist()
    ]
    joints = [
        ("joint", *(names[i] for i in ranking.joints[k].tolist()), float(ranking.joint_looser[k]), None,
         float(ranking.joint_percent[k]))
        for k in ranking.joint_order.tolist()
    ]  # fmt: skip
    return parts + joints


def _tightened(found: Tightening) -> list[tuple[Any, ...]]:
    names = found.before.assembly.names
    before, after = (
        np.linalg.norm(a.motion[:, : 2 if a.motion.shape[1] == 3 else 3], axis=1).tolist()
        for a in (found.before, found.after)
    )
    return [(k + 1, name, before[names.index(name)], after[names.index(name)]) for k, name in enumerate(found.chosen)]


def _draws(found: Sample) -> list[tuple[Any, ...]]:
    """Objective of every draw, and the extra gap [mm] round every part."""
    return [
        (k + 1, float(value), *extra)
        for k, (value, extra) in enumerate(zip(found.value, found.extra.tolist(), strict=True))
    ]


def _trials(found: AllowableGap) -> list[tuple[Any, ...]]:
    return [(t.gap, t.value, t.at_most, t.verdict, PathState.of(t.checked)) for t in found.trials]


def _contributions(found: WorstCase) -> list[tuple[Any, ...]]:
    """Tolerances and what each contributes, the largest first."""
    rows = []
    for share, one in zip(found.percent.tolist(), found.contributions, strict=True):
        t = one.tolerance
        kind = "joint" if len(t.parts) == 2 else "part" if t.outline is None else "outline"
        names = (*t.parts, "")[:2]
        rows.append((kind, *names, t.outline, t.nominal, t.plus, t.minus, one.slope, one.looser, one.tighter, share))
    return rows
