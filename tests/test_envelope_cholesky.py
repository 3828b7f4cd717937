"""The factorisation within the envelope against dense linear algebra, on random graphs."""

from __future__ import annotations

import numpy as np
import pytest

from wiggleroom.program.envelope_cholesky import EnvelopeCholesky


def random_matrix(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Entries of one half of a positive definite matrix on a random graph, perhaps in several components, and the whole of it."""
    rng = np.random.default_rng(seed)
    size = int(rng.integers(1, 40))
    links = rng.integers(0, size, (int(rng.integers(0, 3 * size)), 2))
    links = np.unique(np.sort(links[links[:, 0] != links[:, 1]], axis=1), axis=0).reshape(-1, 2)
    swapped = rng.random(len(links)) < 0.5  # entries may stand on either side of the diagonal
    links[swapped] = links[swapped][:, ::-1]
    row, column = np.concatenate([np.arange(size), links[:, 0]]), np.concatenate([np.arange(size), links[:, 1]])
    whole = np.zeros((size, size))
    whole[links[:, 0], links[:, 1]] = whole[links[:, 1], links[:, 0]] = rng.standard_normal(len(links))
    whole[np.arange(size), np.arange(size)] = np.abs(whole).sum(axis=1) + rng.random(size) + 1e-3
    return row, column, whole[row, column], whole


@pytest.mark.parametrize("seed", range(4))
def test_solutions_are_those_of_dense_algebra(seed):
    row, column, entry, whole = random_matrix(seed)
    factor = EnvelopeCholesky(row, column, len(whole))
    right = np.random.default_rng(seed).standard_normal(len(whole))
    for shift in (0.0, 0.7):
        assert factor.update(entry, shift)
        expected = np.linalg.solve(whole + shift * np.eye(len(whole)), right)
        np.testing.assert_allclose(factor.solve(right), expected, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_what_is_not_positive_definite_is_told(seed):
    row, column, entry, whole = random_matrix(seed)
    least = np.linalg.eigvalsh(whole)[0]
    factor = EnvelopeCholesky(row, column, len(whole))
    assert not factor.update(entry, -least - 1e-6)
    assert factor.update(entry, -least + 1e-6)


def test_a_value_that_is_no_number_is_told():
    factor = EnvelopeCholesky(np.array([0, 0, 1]), np.array([0, 1, 1]), 2)
    assert not factor.update(np.array([1.0, np.nan, 1.0]), 0.0)
