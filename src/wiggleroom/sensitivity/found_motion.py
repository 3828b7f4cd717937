"""What studies of gaps read of an assembly and of an answer, of the plane or of space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import FreeSpaceError, InputError, OverlapError, StoppedError, TouchingError
from wiggleroom.verdict import SAME_END, PathState, Verdict

Floats = NDArray[np.float64]


class MadeAssembly(Protocol):
    """What studies read of an assembly."""

    @property
    def names(self) -> Sequence[str]:
        """Names of its parts."""

    @property
    def parts(self) -> Sequence[Any]:
        """Its parts."""

    @property
    def drawing(self) -> Any:
        """Where it came from."""

    @property
    def gap(self) -> float:
        """The gap that was applied [mm]."""

    @property
    def size(self) -> float:
        """Diagonal of the box that holds it [mm]."""


class FoundMotion(Protocol):
    """What studies read of an answer, a dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def assembly(self) -> MadeAssembly:
        """The assembly that moves."""

    @property
    def verdict(self) -> Verdict:
        """How the question ended."""

    @property
    def objective(self) -> float | None:
        """Largest motion [mm] (turns in [rad]); None where nothing stops it."""

    @property
    def motion(self) -> Floats:
        """Where every part is at its end."""

    @property
    def path(self) -> PathState:
        """Whether the whole path is free."""

    @property
    def collision_free(self) -> bool:
        """True where no two parts overlap at its end."""

    @property
    def at_most(self) -> float | None:
        """A value that no motion exceeds."""


Found = TypeVar("Found", bound=FoundMotion)


def is_checked(answer: FoundMotion) -> bool:
    """True where the path from rest to the end of the motion was checked."""
    return answer.path == PathState.CHECKED and answer.collision_free


def verdict_of_carried(smaller: FoundMotion, lower: FoundMotion) -> Verdict:
    """What is said at a gap of the motion of a smaller one, which is free here too, in place of a lower answer.

    What was proven of larger parts is not of these. Where the answer is as high but for rounding, the motion ends as it does.
    """
    same = lower.objective is not None and lower.objective >= (1 - SAME_END) * (smaller.objective or 0.0)
    return lower.verdict if same else Verdict.STOPPED


def verdict_of(error: InputError | StoppedError) -> Verdict:
    """What is said of a gap at which there is no answer: parts overlap or touch, it was not decided, or they cannot be made.

    >>> verdict_of(OverlapError("a and b overlap"))
    <Verdict.TOUCHING: 'touching'>
    """
    if isinstance(error, OverlapError | TouchingError):
        return Verdict.TOUCHING
    return Verdict.STOPPED if isinstance(error, FreeSpaceError | StoppedError) else Verdict.NOT_MAKEABLE


def endless(answer: FoundMotion) -> InputError:
    """What is wrong with an answer whose motion cannot be held against gaps."""
    why = "nothing stops the motion" if answer.objective is None else "the search for its motion was cut short"
    return InputError(f"{answer.assembly.drawing.source or 'the assembly'}: {why}, so no gap can be held against it")
