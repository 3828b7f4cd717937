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
from wiggleroom.report.finding import Finding
from wiggleroom.report.results.answer_words import MIN_MOTION
from wiggleroom.report.results.separability import Checked
from wiggleroom.search.answer import Answer


def csv_of(found: Answer | Checked | Plan | Finding) -> str:
    """Table of what was found, lengths in mm and angles in degrees; what has no end or is not known is left empty."""
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
        case Plan() if found.assembly.dimension == 3:
            heads, rows = SPATIAL_COLUMNS, _spatial_steps(found.assembly.names, [step.path for step in found.steps])
        case Plan():
            heads, rows = ("step", "point", *MOTION_COLUMNS), _planned(found)
        case Finding():
            assert found.data is not None
            heads, rows = tuple(found.data.heads), found.data.rows
    return text_of(heads, rows)


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
