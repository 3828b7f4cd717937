"""Frames of a path for the page: evenly along it, and no more than the page can play."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.report.films.film_timing import TimedPath

MAX_FRAMES = 48
"""Frames of a path."""
MAX_FRAME_MOTIONS = 120_000
"""Motions of parts in all frames of a path together; at least two frames."""


def path_frames(assembly: Assembly, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Motions (k, n, 3) along a path, the first and the last of it as they are [mm, mm, rad].

    Parameters
    ----------
    points : (m, n, 3) float64 [mm, mm, rad]
        Such as `Answer.waypoints`.
    """
    most = max(2, min(MAX_FRAMES, MAX_FRAME_MOTIONS // max(1, len(assembly.parts))))
    timed = TimedPath(assembly, points)
    if len(points) == 1 or timed.length == 0:
        return points[-1:]
    found = timed.at(np.linspace(0.0, timed.length, most))
    found[0], found[-1] = points[0], points[-1]
    return found
