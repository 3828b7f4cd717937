"""Write parts made of boxes as an assembly file of space."""

from __future__ import annotations

from wiggleroom.drawing.dimension import SPATIAL_FORMAT
from wiggleroom.drawing.model import Boxes, Drawing
from wiggleroom.drawing.writers.plain_json import json_bytes
from wiggleroom.errors import InputError


def write_boxes(drawing: Drawing) -> str:
    """Text of the assembly file [mm].

    Raises
    ------
    InputError
        If a part is made of something else, or turned.

    Examples
    --------
    >>> import numpy as np
    >>> from wiggleroom.drawing.model import Part
    >>> part = Part("a", solid=Boxes(np.array([[[0.0, 0, 0], [2, 1, 1]]])))
    >>> print(write_boxes(Drawing((part,), gap=0.2)))
    {
    "format": "wiggleroom/2", "unit": "mm", "gap": 0.2,
    "parts": [
    {"name":"a","boxes":[[0.0,0.0,0.0,2.0,1.0,1.0]]}
    ]
    }
    <BLANKLINE>
    """
    lines = []
    for part in drawing.parts:
        if not isinstance(part.solid, Boxes) or (part.R != [[1, 0, 0], [0, 1, 0], [0, 0, 1]]).any():
            message = f'part "{part.name}" is not made of boxes along the axes, and cannot be written'
            raise InputError(message)
        entry = {"name": part.name, "boxes": (part.solid.boxes + part.at).reshape(-1, 6).tolist()}
        lines.append(json_bytes(entry | ({"fixed": True} if part.fixed else {})).decode())
    head = f'"format": "{SPATIAL_FORMAT}", "unit": "mm", "gap": {drawing.gap!r}'
    return "{\n" + head + ',\n"parts": [\n' + ",\n".join(lines) + "\n]\n}\n"
