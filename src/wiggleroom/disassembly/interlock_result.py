"""What a check finds: whether an assembly comes apart, who leaves, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.displayable import Displayable, Drawable
from wiggleroom.verdict import Certainty, Separability

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Escape(Displayable):
    """Parts that leave together.

    Parameters
    ----------
    parts : tuple of names
    path : (k, n, 3) float64 [mm, mm, rad], in space (k, n, 6) [mm, rad]
        Motions of all parts about their reference points, from rest to a place beyond all others from which `parts` go straight without
        limit; straight between waypoints. Parts of earlier escapes stay at their ends, out of play. Every step is checked for overlap.
    """

    parts: tuple[str, ...]
    path: Floats


@dataclass(frozen=True, eq=False)
class Interlock(Drawable):
    """Whether an assembly comes apart, with the certainty of that verdict.

    Parameters
    ----------
    assembly : Assembly
    verdict : Separability
    certainty : Certainty
        A path apart with every step checked is proven. Interlocked is proven if closed free spaces of pairs tie all parts together;
        otherwise the search found no path.
    escapes : tuple of Escape
        In the order of leaving.
    spins : tuple of names
        Parts that turn in place without limit.
    remains : tuple of names
        Parts that stay when nothing more leaves; empty if only the standing body remains.
    questions : int
        Number of searched largest motions.
    states : int
        Number of states reached by slides of parts and turns of single parts.
    turned : int
        Number of these states in which every part was turned both ways.
    whole : bool
        True if these are all such states of the remaining parts.
    unanswered : int
        Number of largest motions without a certain end.
    tight : bool
        True if parts touch at rest and their contacts alone lock them.
    at_most : float or None [mm]
        A distance that no point of any part exceeds in any motion from rest, proven; None if little work gives none, and in space.
    """

    assembly: Assembly
    verdict: Separability
    certainty: Certainty
    escapes: tuple[Escape, ...] = ()
    spins: tuple[str, ...] = ()
    remains: tuple[str, ...] = ()
    questions: int = 0
    states: int = 0
    seconds: float = 0.0
    tight: bool = False
    at_most: float | None = None
    turned: int = 0
    whole: bool = True
    unanswered: int = 0
