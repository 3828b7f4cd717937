"""Factorisation of the condensed matrix, with the inertia that tells whether a step points downhill."""

from __future__ import annotations

from typing import Any, Protocol
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from wiggleroom.parallel.batches import usable_cores
from wiggleroom.program.envelope_cholesky import MAX_ENVELOPE_ROWS, EnvelopeCholesky
from wiggleroom.program.sparsity_pattern import Pattern

Floats = NDArray[np.float64]
Indices = NDArray[np.int32] | NDArray[np.int64]

MIN_DISSECTION_ROWS = 3000
"""From this many rows on nested dissection and threads pay in rslab."""
MAX_THREADS = 4
"""Of one factorisation by dense blocks."""
BODY_VARIABLES = 3
"""Of a body in the plane."""
_PLANS: WeakKeyDictionary[Pattern, Any] = WeakKeyDictionary()
"""Plans of multifrontal factorisations: programs of the same pairs share a pattern."""


class SparsePattern(Protocol):
    """Where the entries of a symmetric matrix live: upper triangle, compressed columns."""

    @property
    def indptr(self) -> Indices:
        """Column pointers."""

    @property
    def indices(self) -> Indices:
        """Row indices."""

    @property
    def diagonal(self) -> Indices:
        """Where the diagonal lives."""


class Factor(Protocol):
    """L D L^T of a symmetric matrix whose pattern stays the same while its numbers change."""

    def update(self, data: Floats, shift: float) -> bool:
        """Factorise with `shift` added to the diagonal; False where the matrix is not positive definite."""

    def solve(self, right: Floats) -> Floats:
        """Solution of the factorised system."""


def factor(pattern: SparsePattern) -> Factor:
    """The fastest factorisation for a pattern.

    Up to two hundred bodies it is within the envelope; above, the multifrontal one for bodies in the plane, else rslab (extra `fast`) where
    installed.
    """
    size = len(pattern.indptr) - 1
    if size <= MAX_ENVELOPE_ROWS:
        return EnvelopeCholesky(
            pattern.indices.astype(np.int64), np.repeat(np.arange(size), np.diff(pattern.indptr)), size
        )
    if isinstance(pattern, Pattern):
        from wiggleroom.program.multifrontal import (  # with what it needs of scipy it is slow to import
            FrontalPlan,
            Multifrontal,
        )

        if pattern not in _PLANS:
            _PLANS[pattern] = FrontalPlan(pattern.at, pattern.indptr, pattern.indices, BODY_VARIABLES)
        return Multifrontal(_PLANS[pattern])
    try:
        return Supernodal(pattern)
    except ImportError:
        return Plain(pattern)


class Plain:
    """qdldl: one column at a time."""

    def __init__(self, pattern: SparsePattern) -> None:
        import scipy.sparse as sp

        self._diagonal = pattern.diagonal
        n = len(pattern.indptr) - 1
        self._matrix = sp.csc_matrix((np.zeros(len(pattern.indices)), pattern.indices, pattern.indptr), shape=(n, n))
        self._solver: Any = None

    def update(self, data: Floats, shift: float) -> bool:
        """Factorise with `shift` added to the diagonal; False where the matrix is not positive definite."""
        import qdldl

        self._matrix.data[:] = data
        self._matrix.data[self._diagonal] += shift
        try:
            if self._solver is None:
                self._solver = qdldl.Solver(self._matrix, upper=True)
            else:
                self._solver.update(self._matrix, upper=True)
            return bool((self._solver.factors()[1] > 0).all())
        except RuntimeError:  # a zero pivot
            self._solver = None
            return False

    def solve(self, right: Floats) -> Floats:
        """Solution of the factorised system."""
        return self._solver.solve(right)


class Supernodal:
    """rslab: dense blocks, which pays from some hundred bodies on."""

    def __init__(self, pattern: SparsePattern) -> None:
        import rslab
        import scipy.sparse as sp

        n = len(pattern.indptr) - 1
        upper = sp.csc_matrix(
            (np.arange(len(pattern.indices), dtype=float), pattern.indices, pattern.indptr), shape=(n, n)
        )
        lower = sp.csc_matrix(upper.T)
        lower.sort_indices()
        self._order = lower.data.astype(np.int64)  # where each entry of the lower triangle stands in the upper one
        self._diagonal = pattern.diagonal
        ordering = "metis" if n > MIN_DISSECTION_ROWS else "amd"
        threads = min(MAX_THREADS, usable_cores()) if n > MIN_DISSECTION_ROWS else 1
        self._symbolic = rslab.analyze(lower, path="ldlt", ordering=ordering, threads=threads)
        self._factor: Any = None
        self._size = n

    def update(self, data: Floats, shift: float) -> bool:
        """Factorise with `shift` added to the diagonal; False where the matrix is not positive definite."""
        moved = data.copy()
        moved[self._diagonal] += shift
        try:
            self._factor = self._symbolic.factor(moved[self._order])
        except (RuntimeError, ValueError):  # a pivot of zero
            return False
        return bool(self._factor.inertia[0] == self._size)

    def solve(self, right: Floats) -> Floats:
        """Solution of the factorised system."""
        return self._factor.solve(right)
