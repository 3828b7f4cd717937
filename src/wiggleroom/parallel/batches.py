"""Work on several cores: compiled kernels let other threads run meanwhile."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import count as numbers
from itertools import pairwise
from typing import TypeVar

import numpy as np

THREADS = 2
"""Batches that are worked on at once; the same on every machine, so that sums are added up in the same order."""
S = TypeVar("S")
T = TypeVar("T")


def usable_cores() -> int:
    """Cores that this process may use: not those of the machine that it is kept from."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def in_batches(count: int, batches: int, work: Callable[[slice], T]) -> list[T]:
    """Results of `work` for so many consecutive batches of `count` things, in order.

    Examples
    --------
    >>> in_batches(5, 2, lambda some: list(range(5))[some])
    [[0, 1], [2, 3, 4]]
    """
    if batches < 2:
        return [work(slice(0, count))]
    cuts = np.linspace(0, count, batches + 1).astype(int).tolist()
    return in_parallel([slice(one, other) for one, other in pairwise(cuts)], work)


def in_parallel(items: Sequence[S], work: Callable[[S], T]) -> list[T]:
    """Results of `work` for some items, in order, by the thread that asks and by helpers.

    Whoever is free takes the next item, so nobody waits for a helper that has not begun: on a busy machine that is the rule.
    """
    found: dict[int, T] = {}
    turn, held = numbers(), [work]

    def help_out() -> None:
        while (k := next(turn)) < len(items):
            found[k] = held[0](items[k])

    helpers = [_pool(os.getpid()).submit(help_out) for _ in range(min(THREADS, len(items)) - 1)]
    try:
        help_out()
    finally:
        late = [one for one in helpers if not one.cancel()]
        for one in late:
            one.result()
        held.clear()  # helpers that were cancelled still wait in the queue, and would keep all arrays of the work
    return [found[k] for k in range(len(items))]


@cache
def _pool(_: int) -> ThreadPoolExecutor:
    """Helpers of this process; a copy of a process has none of those of the original."""
    return ThreadPoolExecutor(THREADS - 1)
