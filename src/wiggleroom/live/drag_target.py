"""Where a drag leads: the target of the hand, or a nearer one in its direction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

MAX_TARGET_DISTANCE = 3.0
"""A target further from the grip than this multiple of the drawing's size is moved nearer: parts that come free stay in sight."""


def target_in_sight(grip: Sequence[float], target: Sequence[float], size: float) -> NDArray[np.float64]:
    """Target (2,) or (3,) [mm] of a grip; `size` [mm] is that of the drawing.

    Examples
    --------
    >>> target_in_sight((0.0, 0.0), (40.0, 0.0), 10.0).tolist()
    [30.0, 0.0]
    """
    away = np.subtract(target, grip)
    far, most = float(np.linalg.norm(away)), MAX_TARGET_DISTANCE * size
    return np.add(grip, away * (most / far) if far > most else away)
