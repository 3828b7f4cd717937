"""Compiled sweeps over many things on both cores: numba lets other threads run while it does."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise
from typing import TypeVar

import numpy as np

THREADS = 2
T = TypeVar("T")


def in_batches(count: int, batches: int, work: Callable[[slice], T]) -> list[T]:
    """Results of `work` for so many consecutive batches of `count` things, in order; one batch is done by the thread that asks.

    Examples
    --------
    >>> in_batches(5, 2, lambda some: list(range(5))[some])
    [[0, 1], [2, 3, 4]]
    """
    if batches < 2:
        return [work(slice(0, count))]
    cuts = np.linspace(0, count, batches + 1).astype(int).tolist()
    return list(_pool(os.getpid()).map(work, [slice(one, other) for one, other in pairwise(cuts)]))


@cache
def _pool(_: int) -> ThreadPoolExecutor:
    """Threads of this process; a copy of a process has none of those of the original."""
    return ThreadPoolExecutor(THREADS)
