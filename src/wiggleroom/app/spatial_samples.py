"""Assemblies in space to begin with: unions of boxes, and small pictures of them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from itertools import product

import numpy as np
import shapely
from numpy.typing import NDArray

LOOK = np.array([[0.76, 0.65, 0.0], [-0.3, 0.35, 0.88]])
"""Where x, y, z of space go in small pictures: to the right, and up."""


@dataclass(frozen=True)
class BoxesSample:
    """Parts as unions of boxes [mm], the first one fixed, the last one pulled.

    Parameters
    ----------
    words : str
    gap : float [mm]
    boxes : dict
        Boxes of each part: x, y, z of the lower and then of the upper corner.
    lifted : float [mm]
        How far the last part is lifted in the picture.
    """

    words: str
    gap: float
    boxes: dict[str, list[list[float]]]
    pull: tuple[float, float, float]
    lifted: float = 0.0

    def text(self) -> str:
        """The assembly as a file of format wiggleroom/2."""
        names = list(self.boxes)
        parts = [{"name": n, "boxes": b, **({"fixed": True} if n == names[0] else {})} for n, b in self.boxes.items()]
        pull = [{"part": names[-1], "direction": list(self.pull)}]
        return json.dumps({"format": "wiggleroom/2", "gap": self.gap, "parts": parts, "pull": pull})

    def outlines(self) -> list[list[NDArray[np.float64]]]:
        """What is seen of each part, as outlines in the plane of the picture."""
        last = list(self.boxes)[-1]
        found = []
        for name, boxes in self.boxes.items():
            hulls = []
            for box in boxes:
                corners = np.array(list(product(*zip(box[:3], box[3:], strict=True))), dtype=float)
                corners[:, 2] += self.lifted * (name == last)
                hulls.append(shapely.convex_hull(shapely.multipoints(corners @ LOOK.T)))
            whole = shapely.union_all(hulls)
            found.append([shapely.get_coordinates(one.exterior) for one in shapely.get_parts(whole)])
        return found


SPATIAL_SAMPLES = {
    "box": BoxesSample(
        "A box in space: does anything hold its lid?",
        0.3,
        {
            "case": [
                [0, 0, 0, 60, 40, 3], [0, 0, 0, 3, 40, 30], [57, 0, 0, 60, 40, 30], [0, 0, 0, 60, 3, 30], [0, 37, 0, 60, 40, 30],
            ],
            "lid": [[0, 0, 30, 60, 40, 33], [3, 3, 27, 57, 37, 30]],
        },
        (1.0, 0.0, 0.0),
        lifted=16,
    ),
    "burr": BoxesSample(
        "A burr of three sticks: does it come apart?",
        0.5,
        {
            "stick1": [[-30, -10, -10, -10, 10, 10], [-30, -10, 0, 30, 0, 10], [10, -10, -10, 30, 10, 10]],
            "stick2": [
                [-10, -30, -10, 10, -10, 10], [-10, -30, -10, 10, 0, 0], [-10, 10, -10, 10, 30, 10], [0, 0, -10, 10, 30, 10],
            ],
            "stick3": [[-10, -10, -30, 10, 10, -10], [-10, -10, 10, 10, 10, 30], [-10, 0, -30, 0, 10, 30]],
        },
        (0.0, 0.0, 1.0),
    ),
}  # fmt: skip
