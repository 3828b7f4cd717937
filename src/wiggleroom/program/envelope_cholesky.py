"""Cholesky factorisation within the envelope of a sparse symmetric matrix: the quickest one for small matrices.

Rows are stored from their first entry to the diagonal, and reverse Cuthill-McKee ordering keeps these short.
Source: Jennings 1966; George and Liu 1981, chapter 4.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import NO_ALLOCATION, OPTIONS, njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_ENVELOPE_ROWS = 600
"""Up to this many rows no other factorisation is quicker, for the graphs of neighbours that assemblies have."""
SUM = {**NO_ALLOCATION, "fastmath": {"reassoc", "contract"}}
"""For scalar products, whose terms may then be added several at a time."""


class EnvelopeCholesky:
    """L L^T of a symmetric matrix whose pattern stays the same while its numbers change.

    Parameters
    ----------
    row, column : (E,) int64
        Where its entries live, each off the diagonal on one side of it only; entries of the same place add up.
    size : int

    Examples
    --------
    >>> factor = EnvelopeCholesky(np.array([0, 0, 1]), np.array([0, 1, 1]), 2)
    >>> factor.update(np.array([4.0, 2.0, 3.0]), 0.0)
    True
    >>> factor.solve(np.array([8.0, 7.0]))
    array([1.25, 1.5 ])
    """

    def __init__(self, row: Ints, column: Ints, size: int) -> None:
        self._order, self._first, self._start, self._target = _envelope(row, column, size)
        self._factor = np.empty(self._start[-1])

    def update(self, data: Floats, shift: float) -> bool:
        """Factorise with `shift` added to the diagonal; False where the matrix is not positive definite."""
        return _factorise(self._first, self._start, self._target, data, shift, self._factor)

    def solve(self, right: Floats) -> Floats:
        """Solution of the factorised system."""
        out = np.empty(len(right))
        _solve(self._order, self._first, self._start, self._factor, right, np.empty(len(right)), out)
        return out


@njit(**OPTIONS)
def _envelope(row, column, size):
    """Order of elimination, first column of each row, where each row is stored, and where each entry of the matrix is."""
    order = _reverse_cuthill_mckee(*_adjacency(row, column, size))
    place, first, start = np.empty(size, np.int64), np.arange(size), np.zeros(size + 1, np.int64)
    for k in range(size):
        place[order[k]] = k
    for e in range(len(row)):
        i, j = place[row[e]], place[column[e]]
        first[max(i, j)] = min(first[max(i, j)], min(i, j))
    for k in range(size):
        start[k + 1] = start[k] + k - first[k] + 1
    target = np.empty(len(row), np.int64)
    for e in range(len(row)):
        i, j = place[row[e]], place[column[e]]
        target[e] = start[max(i, j)] + min(i, j) - first[max(i, j)]
    return order, first, start, target


@njit(**OPTIONS)
def _adjacency(row, column, size):
    """Neighbours of each row: those of v are `neighbour[start[v]:start[v + 1]]`."""
    start = np.zeros(size + 2, np.int64)
    for e in range(len(row)):
        if row[e] != column[e]:
            start[row[e] + 2] += 1
            start[column[e] + 2] += 1
    for v in range(size):
        start[v + 2] += start[v + 1]
    neighbour = np.empty(start[-1], np.int64)
    for e in range(len(row)):
        for one, other in ((row[e], column[e]), (column[e], row[e])):
            if one != other:
                neighbour[start[one + 1]] = other
                start[one + 1] += 1
    return start[:-1], neighbour


@njit(**OPTIONS)
def _reverse_cuthill_mckee(start, neighbour):
    """Order of elimination: breadth first from a vertex at the rim of each component, vertices of small degree first, then reversed.

    Source: Cuthill and McKee 1969; the rim as of George and Liu 1979.
    """
    size = len(start) - 1
    order, level = np.empty(size, np.int64), np.full(size, -1)
    placed = np.zeros(size, np.bool_)
    done = 0
    for root in range(size):
        if placed[root]:
            continue
        height = -1
        while True:  # the last vertex of small degree that a breadth-first search reaches lies nearer to the rim
            end = _breadth_first(start, neighbour, root, done, order, level)
            last = order[end - 1]
            far = last
            for k in range(done, end):
                v = order[k]
                if level[v] == level[last] and start[v + 1] - start[v] < start[far + 1] - start[far]:
                    far = v
            if level[last] <= height:
                break
            height, root = level[last], far
            for k in range(done, end):
                level[order[k]] = -1
        for k in range(done, end):
            placed[order[k]] = True
        done = end
    return order[::-1].copy()


@njit(**NO_ALLOCATION)
def _breadth_first(start, neighbour, root, begin, order, level):
    """Write the component of `root` to `order` from `begin` on, breadth first, small degrees first; where it ends."""
    order[begin], level[root] = root, 0
    end, k = begin + 1, begin
    while k < end:
        v = order[k]
        before = end
        for q in range(start[v], start[v + 1]):
            w = neighbour[q]
            if level[w] >= 0:
                continue
            level[w] = level[v] + 1
            place, degree = end, start[w + 1] - start[w]
            while place > before and start[order[place - 1] + 1] - start[order[place - 1]] > degree:
                order[place] = order[place - 1]
                place -= 1
            order[place] = w
            end += 1
        k += 1
    return end


@njit(**SUM)
def _factorise(first, start, target, data, shift, factor):
    """Factorise row by row; False where a pivot is not positive."""
    factor[:] = 0.0
    for k in range(len(target)):
        factor[target[k]] += data[k]
    for i in range(len(first)):
        begin = first[i]
        row = start[i] - begin
        square = 0.0
        for j in range(begin, i):
            other = start[j] - first[j]
            total = 0.0
            for k in range(max(begin, first[j]), j):
                total += factor[row + k] * factor[other + k]
            entry = (factor[row + j] - total) / factor[other + j]
            factor[row + j] = entry
            square += entry * entry
        pivot = factor[row + i] + shift - square
        if not pivot > 0.0:
            return False
        factor[row + i] = np.sqrt(pivot)
    return True


@njit(**SUM)
def _solve(order, first, start, factor, right, x, out):
    """Fill `out` with the solution for a right-hand side; `x` is worked in."""
    for i in range(len(order)):
        row = start[i] - first[i]
        total = 0.0
        for k in range(first[i], i):
            total += factor[row + k] * x[k]
        x[i] = (right[order[i]] - total) / factor[row + i]
    for i in range(len(order) - 1, -1, -1):
        row = start[i] - first[i]
        value = x[i] / factor[row + i]
        for k in range(first[i], i):
            x[k] -= factor[row + k] * value
        out[order[i]] = value
