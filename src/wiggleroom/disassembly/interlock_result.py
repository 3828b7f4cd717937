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
        Motions of all parts about their reference points, from rest to where `parts` are beyond all others and go on straight without
        limit; straight between. Parts of earlier escapes stay where those ended and are out of the game. Every step is checked for overlap.
    """

    parts: tuple[str, ...]
    path: Floats


@dataclass(frozen=True, eq=False)
class Interlock(Drawable):
    """Whether an assembly comes apart, and how sure that is.

    Parameters
    ----------
    assembly : Assembly
    verdict : Separability
    certainty : Certainty
        A path apart whose every step was checked is proven. Interlocked is proven where closed free spaces of pairs tie all parts
        together; else every planned question was asked and no path was found.
    escapes : tuple of Escape
        In the order in which they leave.
    spins : tuple of names
        Parts that turn in place without limit.
    remains : tuple of names
        Parts that are left where nothing more was found to leave; none where only what stands is left.
    questions : int
        Largest motions that were searched.
    states : int
        States to which slides of parts, and turns of single parts, led, each visited once.
    turned : int
        Of these states those in which every part was turned both ways.
    whole : bool
        True where these are all such states of the parts that are left.
    unanswered : int
        Largest motions whose search found no end that is certain.
    tight : bool
        True where parts touch at rest and their contacts alone lock them.
    at_most : float or None [mm]
        A distance that no point of any part exceeds in any motion that starts at rest, proven; None where little work found
        none, and in space.
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
