"""What a live question gets: a safe motion at once, and the freedoms that an assembly has."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.displayable import Displayable
from wiggleroom.drawing.model import Vector
from wiggleroom.search.answer import Contact


@dataclass(frozen=True, eq=False)
class LiveResult(Displayable):
    """A motion found in the time that there was.

    Parameters
    ----------
    motion : (n, 3) float64 [mm, mm, rad], in space (n, 6) [mm, rad]
        Pose minus rest pose of every part, about its reference point; no two parts overlap there.
    settled : bool
        True where the search came to its end; False where time ran out, and asking again goes on from here. Also False
        where a largest motion was followed from a larger gap, so that it is not known whether these parts get there.
    seconds : float
        What it took.
    contacts : tuple of Contact
        What holds the motion. The forces of a drag are those that hold against a pull of 1 at the grip.
    blocking : tuple of names
        Parts that touch the dragged one and hold it.
    objective : float or None
        Of `flex`: sum of the goals; None where nothing stops the motion.
    leaves, turns : tuple of names
        Parts that move away or turn without limit.
    reached : (x, y), (x, y, z) or None [mm]
        Of `drag`: where the grip is now.
    distance : float or None [mm]
        Of `drag`: from there to the target.
    """

    motion: NDArray[np.float64]
    settled: bool
    seconds: float
    contacts: tuple[Contact, ...] = ()
    blocking: tuple[str, ...] = ()
    objective: float | None = None
    leaves: tuple[str, ...] = ()
    turns: tuple[str, ...] = ()
    reached: Vector | None = None
    distance: float | None = None


@dataclass(frozen=True, eq=False)
class Mode(Displayable):
    """One freedom: a motion there, back through rest, and to the other side.

    Parameters
    ----------
    size : float [mm]
        Furthest that a corner of a part is moved, on the side where that is more.
    parts : tuple of names
        Those that move most, the furthest first.
    frames : (k, n, 3) float64 [mm, mm, rad]
        Motions of the parts: rest, one end, rest, the other end, rest; no two parts overlap in any of them.
    ends : bool
        False where nothing stops it and the frames were cut off.
    """

    size: float
    parts: tuple[str, ...]
    frames: NDArray[np.float64]
    ends: bool
