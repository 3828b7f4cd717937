"""Whether two placements are the same up to a rigid motion or a reflection, whichever of equal panels is where."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

Floats = NDArray[np.float64]


def congruent(a: Sequence[tuple[float, Floats]], b: Sequence[tuple[float, Floats]], tolerance: float) -> bool:
    """Whether an isometry of space lays the corners of one placement on those of the other.

    Parameters
    ----------
    a, b : sequences of (shape, (n, 3) float64 [mm])
        For every panel a number that equal panels share, and its corners, in one plane.
    tolerance : float [mm]
        By how much corners may miss each other.

    Examples
    --------
    >>> square = np.array([[0, 0, 0], [4, 0, 0], [4, 3, 0], [0, 3, 0.0]])
    >>> congruent([(1, square)], [(1, square[:, [2, 0, 1]] + 5)], 0.01)
    True
    >>> other = square + [0, 0, 7]
    >>> congruent([(1, square), (1, other)], [(1, square), (1, other + [1, 0, 0])], 0.01)
    False
    """
    counts = Counter(shape for shape, _ in a)
    if counts != Counter(shape for shape, _ in b):
        return False
    rarest = min(counts, key=lambda shape: counts[shape])
    first = next(points for shape, points in a if shape == rarest)
    all_a, all_b = _tagged(a), _tagged(b)
    tree_b = KDTree(all_b)
    for shape, points in b:
        if shape != rarest or len(points) != len(first):
            continue
        local = KDTree(points)
        for turn, shift in _isometries(first, points, tolerance):
            if local.query(first @ turn.T + shift)[0].max() > tolerance:
                continue
            moved = np.column_stack([all_a[:, :3] @ turn.T + shift, all_a[:, 3]])
            if tree_b.query(moved)[0].max() <= tolerance and KDTree(moved).query(all_b)[0].max() <= tolerance:
                return True
    return False


def _tagged(panels: Sequence[tuple[float, Floats]]) -> Floats:
    """Corners of all panels with a fourth coordinate that keeps different shapes apart."""
    return np.vstack([np.column_stack([points, np.full(len(points), 1e3 * shape)]) for shape, points in panels])


def _frame(points: Floats, corner: Floats) -> Floats:
    """Orthonormal axes as columns: towards a corner from the centre, square to it in the plane, and the normal."""
    centre = points.mean(axis=0)
    normal = np.linalg.svd(points - centre, full_matrices=False)[2][2]
    along = corner - centre
    along = along / np.linalg.norm(along)
    return np.column_stack([along, np.cross(normal, along), normal])


def _isometries(a: Floats, b: Floats, tolerance: float) -> list[tuple[Floats, Floats]]:
    """Every isometry that lays the furthest corner of `a` on a corner of `b` as far out, plane on plane."""
    far_a, far_b = (np.linalg.norm(points - points.mean(axis=0), axis=1) for points in (a, b))
    top = int(np.argmax(far_a))
    own = _frame(a, a[top])
    found = []
    for k in np.flatnonzero(np.abs(far_b - far_a[top]) < tolerance).tolist():
        axes = _frame(b, b[k])
        for across in (1.0, -1.0):
            for up in (1.0, -1.0):
                turn = axes @ np.diag([1.0, across, up]) @ own.T
                found.append((turn, b.mean(axis=0) - turn @ a.mean(axis=0)))
    return found
