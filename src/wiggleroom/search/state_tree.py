"""The tree of states that a search grows from the first one, and the driver that grows it; the same in the plane and in space."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable
from dataclasses import InitVar, dataclass, field
from typing import Generic, TypeVar

from wiggleroom.context import Context
from wiggleroom.errors import StoppedError

State = TypeVar("State")
Transition = TypeVar("Transition")
Found = TypeVar("Found")


@dataclass(frozen=True, eq=False)
class VisitedState(Generic[State, Transition]):
    """A state, and how it was reached.

    Parameters
    ----------
    state : State
    parent : int
        State from which it was reached; -1 for the first.
    step : Transition or None
        What leads from the parent to it.
    """

    state: State
    parent: int
    step: Transition | None


@dataclass(frozen=True, eq=False)
class Exit(Generic[Found]):
    """What ends a search: `found` is what was looked for."""

    found: Found


@dataclass(frozen=True, eq=False)
class Level(Generic[State, Transition, Found]):
    """One kind of steps from a state.

    Parameters
    ----------
    steps : callable
        Given the number of a state: states that steps lead to, each with its step, or an exit.
    spent : callable
        True where the work that such steps may take is done, which ends the search.
    """

    steps: Callable[[int], Iterable[tuple[State, Transition] | Exit[Found]]]
    spent: Callable[[], bool] = bool


@dataclass(eq=False)
class StateTree(Generic[State, Transition]):
    """States that were reached from the first of them.

    Parameters
    ----------
    first : State
    is_new : callable
        False where a state, with the step that leads to it, is merged with one that is known.
    most : int
        States kept at most, the first among them.
    """

    first: InitVar[State]
    is_new: Callable[[State, Transition], bool]
    most: float = math.inf
    states: list[VisitedState[State, Transition]] = field(default_factory=list, init=False)
    full: bool = field(default=False, init=False)
    """True once a new state was not kept because there are as many as may be."""
    whole: bool = field(default=False, init=False)
    """True once all steps from all states were taken."""

    def __post_init__(self, first: State) -> None:
        self.states.append(VisitedState(first, -1, None))

    def append(self, state: State, parent: int, step: Transition) -> int:
        """Keep a state; its number."""
        self.states.append(VisitedState(state, parent, step))
        return len(self.states) - 1

    def line(self, state: int) -> list[int]:
        """Numbers of the states from the first one to a state."""
        found = [state]
        while self.states[found[-1]].parent >= 0:
            found.append(self.states[found[-1]].parent)
        return found[::-1]

    def steps_to(self, state: int) -> list[Transition]:
        """The steps from the first state to a state."""
        return [step for k in self.line(state) if (step := self.states[k].step) is not None]

    def search(self, *levels: Level[State, Transition, Found], context: Context) -> Found | None:
        """Take the steps of the first level from every state, oldest first, then those of the next from the oldest, and so on anew.

        What the first exit found; None where no step is left, where the work is spent, and where it was asked to stop.
        """
        begun = [0] * len(levels)
        while True:
            which = next((k for k, at in enumerate(begun) if at < len(self.states)), None)
            if which is None:
                self.whole = True
                return None
            if context.stopped or levels[which].spent():
                return None
            here = begun[which]
            begun[which] += 1
            try:
                for step in levels[which].steps(here):
                    if isinstance(step, Exit):
                        return step.found
                    if self.is_new(*step):
                        if len(self.states) < self.most:
                            self.append(step[0], here, step[1])
                        else:
                            self.full = True
            except StoppedError:
                return None


class EqualKeys(Generic[State]):
    """Merges states of equal keys.

    Parameters
    ----------
    first : State
    key : callable
        Of a state, from which it is told from others.
    """

    def __init__(self, first: State, key: Callable[[State], Hashable]) -> None:
        self._key = key
        self.number = {key(first): 0}
        """Number of the state of each key, in the order in which they came."""

    def __call__(self, state: State, _: object = None) -> bool:
        """True where no state of this key came before."""
        key, count = self._key(state), len(self.number)
        return self.number.setdefault(key, count) == count
