"""Write an assembly file that reads back as the same drawing."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from typing import Any

from wiggleroom.drawing.model import WHOLE, Drawing, Goal, Part, Pull, Region, Tolerance, Turn, W
from wiggleroom.drawing.readers.assembly_schema import FORMAT
from wiggleroom.drawing.writers.plain_json import json_bytes

Json = dict[str, Any]


def write_assembly(drawing: Drawing) -> str:
    """Text of the assembly file [mm, degrees]; parts with identical material share one shape.

    Examples
    --------
    >>> import numpy as np
    >>> part = Part("a", (Region(np.array([[0.0, 0], [2, 0], [2, 1]])),), at=(1.0, 0.0, math.pi / 2))
    >>> print(write_assembly(Drawing((part,), gap=0.2)))
    {
    "format": "wiggleroom/1", "unit": "mm", "gap": 0.2,
    "parts": [
    {"name":"a","outline":[[0.0,0.0],[2.0,0.0],[2.0,1.0]],"at":[1.0,0.0,90.0]}
    ]
    }
    <BLANKLINE>
    """
    materials = [_material(part.regions) for part in drawing.parts]
    keys = [_line(material) for material in materials]
    shared = {key: f"s{i + 1}" for i, key in enumerate(key for key, count in Counter(keys).items() if count > 1)}
    parts = [
        _part(part, {"shape": shared[key]} if key in shared else material)
        for part, material, key in zip(drawing.parts, materials, keys, strict=True)
    ]
    fields = [f'"format": "{FORMAT}", "unit": "mm", "gap": {_line(drawing.gap)}']
    if shared:
        fields.append('"shapes": {\n' + ",\n".join(f'"{name}": {key}' for key, name in shared.items()) + "\n}")
    fields.append(_lines("parts", parts))
    tables: dict[str, list[Any]] = {
        "glue": [list(names) for names in drawing.glue],
        "ignore": [list(names) for names in drawing.ignore],
        "gaps": [{"parts": joint.parts, "gap": joint.gap} for joint in drawing.gaps],
        "tolerances": [_tolerance(tolerance) for tolerance in drawing.tolerances],
    }
    asked = goal_entries(drawing.goals)
    if isinstance(asked, list):
        tables["pull"] = asked
    fields += [_lines(name, rows) for name, rows in tables.items() if rows]
    if isinstance(asked, str):
        fields.append(f'"objective": "{asked}"')
    return "{\n" + ",\n".join(fields) + "\n}\n"


def degrees(angle: float) -> float:
    """Give the shortest number of degrees that reads back as exactly this angle [rad], where there is one.

    Examples
    --------
    >>> degrees(math.pi / 2), degrees(math.radians(33.3))
    (90.0, 33.3)
    """
    exact = math.degrees(angle)
    near = [float(f"{exact:.{digits}g}") for digits in range(1, 18)]
    near += [math.nextafter(exact, math.inf), math.nextafter(exact, -math.inf)]
    return next((value for value in near if math.radians(value) == angle), exact)


def _line(value: Any) -> str:
    return json_bytes(value).decode()


def _lines(name: str, rows: Iterable[Any]) -> str:
    return f'"{name}": [\n' + ",\n".join(map(_line, rows)) + "\n]"


def _material(regions: tuple[Region, ...]) -> Json:
    entries = []
    for region in regions:
        entries.append({"outline": region.outer.tolist()})
        if region.holes:
            entries[-1]["holes"] = [hole.tolist() for hole in region.holes]
    return entries[0] if len(entries) == 1 else {"outlines": entries}


def _part(part: Part, material: Json) -> Json:
    x, y, angle = part.at
    entry: Json = {"name": part.name, **material, "at": [x, y, degrees(angle)]}
    if part.fixed:
        entry["fixed"] = True
    if part.offset:
        entry["offset"] = part.offset
    return entry


def _tolerance(tolerance: Tolerance) -> Json:
    names: Json = {"part": tolerance.parts[0]} if len(tolerance.parts) == 1 else {"parts": list(tolerance.parts)}
    where: Json = {} if tolerance.outline is None else {"outline": tolerance.outline}
    right: Json = {} if tolerance.nominal is None else {"nominal": tolerance.nominal}
    return names | where | right | {"plus": tolerance.plus, "minus": tolerance.minus}


def goal_entries(goals: tuple[Goal, ...]) -> list[Json] | str:
    """What is asked as entries of `pull`, or the word of `objective` that stands in place of all pulls.

    >>> goal_entries((Turn("a", "ccw"),))
    [{'part': 'a', 'turn': 'ccw'}]
    """
    whole = next((name for name, kind in WHOLE.items() if kind() in goals), None)
    return whole or [_goal_entry(goal) for goal in goals if isinstance(goal, Pull | Turn | W)]


def _goal_entry(goal: Pull | Turn | W) -> Json:
    """One goal as an entry of `pull`."""
    entry: Json = {"part": goal.part}
    if isinstance(goal, Pull):
        entry["direction"] = goal.direction
        if goal.point is not None:
            entry["point"] = goal.point
    elif isinstance(goal, Turn):
        entry["turn"] = goal.sense
    else:
        entry["w"] = goal.w
    return entry if goal.weight == 1.0 else entry | {"weight": goal.weight}
