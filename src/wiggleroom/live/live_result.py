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
    """The best motion within a time limit.

    Parameters
    ----------
    motion : (n, 3) float64 [mm, mm, rad], in space (n, 6) [mm, rad]
        Pose minus rest pose of every part, about its reference point; no two parts overlap there.
    settled : bool
        True if the search ended; False if time ran out, and the same request continues it. Also False for a largest motion followed down
        from a larger gap, which these parts may be unable to reach.
    seconds : float
        Time of the answer.
    contacts : tuple of Contact
        Contacts that hold the motion. Forces of a drag balance a pull of 1 at the grip.
    blocking : tuple of names
        Parts that touch the dragged one and hold it.
    objective : float or None
        For `flex`: sum of the goals; None if nothing stops the motion.
    leaves, turns : tuple of names
        Parts that move away or turn without limit.
    reached : (x, y), (x, y, z) or None [mm]
        For `drag`: the present place of the grip.
    distance : float or None [mm]
        For `drag`: distance from there to the target.
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
        Largest displacement of a corner of a part, on the larger side.
    parts : tuple of names
        The parts that move most, the furthest first.
    frames : (k, n, 3) float64 [mm, mm, rad]
        Motions of the parts: rest, one end, rest, the other end, rest; no two parts overlap in any of them.
    ends : bool
        False if nothing stops it and the frames were cut off.
    """

    size: float
    parts: tuple[str, ...]
    frames: NDArray[np.float64]
    ends: bool
