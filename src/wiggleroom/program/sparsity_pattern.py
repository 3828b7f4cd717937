"""Sparsity pattern of the condensed matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Shorts = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Pattern:
    """Where the entries of the condensed matrix live: upper triangle, compressed columns.

    Parameters
    ----------
    indptr, indices : int32
        Column pointers and row indices.
    diagonal_at : (F, 6) int32
        Entries (0,0) (0,1) (1,1) (0,2) (1,2) (2,2) of each free body's own block.
    block_at : (P, 9) int32
        Entries of each pair's block, column by column; -1 where one of the two is fixed.
    at : (F, 2) float64 [mm]
        Where the free bodies lie at rest.
    """

    indptr: Shorts
    indices: Shorts
    diagonal_at: Shorts
    block_at: Shorts
    at: Floats

    @property
    def diagonal(self) -> Shorts:
        """Where the diagonal lives."""
        return self.diagonal_at[:, [0, 2, 5]].ravel()


def pattern(a: Ints, b: Ints, slot: Ints, at: Floats) -> Pattern:
    """Block pattern of the graph of pairs (P,), each once, of free bodies at `at` (F, 2); `slot` maps bodies to free ones (-1: fixed)."""
    n = len(at)
    i, j = slot[a], slot[b]
    both = (i >= 0) & (j >= 0)
    lo, hi = np.minimum(i, j)[both], np.maximum(i, j)[both]
    rank = np.empty(len(lo), dtype=np.int64)
    order = np.lexsort((lo, hi))
    rank[order] = np.arange(len(lo))
    count = np.bincount(hi, minlength=n)  # blocks above the diagonal in each block column
    start = np.concatenate([[0], np.cumsum(count)])
    height = 3 * count[:, None] + np.arange(1, 4)  # entries of the three columns of each block column
    indptr = np.concatenate([[0], np.cumsum(height.ravel())])
    top = indptr[:-1].reshape(-1, 3)
    indices = np.empty(indptr[-1], dtype=np.int32)
    place = rank - start[hi]
    block = top[hi][:, :, None] + 3 * place[:, None, None] + np.arange(3)
    indices[block] = 3 * lo[:, None, None] + np.arange(3)
    own = np.empty((n, 6), dtype=np.int32)
    k = 0
    for q in range(3):
        for r in range(q + 1):
            own[:, k] = top[:, q] + 3 * count + r
            indices[own[:, k]] = 3 * np.arange(n) + r
            k += 1
    block_at = np.full((len(i), 9), -1, dtype=np.int32)
    block_at[both] = block.reshape(-1, 9)
    return Pattern(indptr.astype(np.int32), indices, own, block_at, at)
