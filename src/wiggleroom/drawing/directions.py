"""Points and directions as people write them."""

from __future__ import annotations

import math
import re

from wiggleroom.drawing.model import Vector
from wiggleroom.errors import InputError

HOW = {
    2: "+x, -x, +y or -y, or a direction of two numbers as {}0.6,0.8",
    3: "+x, -x, +y, -y, +z or -z, or a direction of three numbers as {}0,0.6,0.8",
}
"""How a direction is written in the plane and in space, after what stands before a pair of numbers."""


def parsed_direction(option: str, text: str, dimension: int = 2) -> Vector:
    """A direction such as "-y" or "0.6,-0.8"; raises InputError.

    >>> parsed_direction("--gravity", "-y"), parsed_direction("--gravity", "-z", 3)
    ((0.0, -1.0), (0.0, 0.0, -1.0))
    """
    found = vector(text, dimension)
    if found is None:
        finding = f"{option} {text}: write {HOW[dimension].format('')}"
        raise InputError(finding)
    return found


def vector(text: str, dimension: int) -> Vector | None:
    """A direction such as "-y" or "0.6,-0.8"; None for what is no direction.

    >>> vector("-y", 2), vector("0,0.6,0.8", 3), vector("0,0", 2), vector("+z", 2)
    ((0.0, -1.0), (0.0, 0.6, 0.8), None, None)
    """
    axis = "xyz"[:dimension].find(text[1:]) if len(text) == 2 and text[0] in "+-" else -1
    if axis >= 0:
        return tuple(float(f"{text[0]}1") if k == axis else 0.0 for k in range(dimension))
    found = coordinates(text, dimension)
    return found if found and 0 < math.hypot(*found) < math.inf else None


def coordinates(text: str, dimension: int) -> Vector | None:
    """Finite numbers such as "12,-1.5"; None for anything else.

    >>> coordinates("1, 2.5", 2), coordinates("1,2", 3), coordinates("1,1e999", 2)
    ((1.0, 2.5), None, None)
    """
    number = r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*"
    match = re.fullmatch(",".join([number] * dimension), text)
    found = tuple(map(float, match.groups())) if match else None
    return found if found and all(map(math.isfinite, found)) else None
