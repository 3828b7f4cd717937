"""Directional blocking graphs: an arc leads from each body to those that stop it in one direction.

Source: Wilson and Latombe 1994.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]


def unblocked(tail: Ints, head: Ints, label: Ints, ground: int) -> Ints:
    """Strongly connected components that can move alone: no arc leads out of them, and the ground is not among them.

    Parameters
    ----------
    tail, head : (m,) int64
        Arcs of the graph, from and to nodes.
    label : (n,) int64
        Component of every node.
    ground : int
        The node of the fixed bodies.

    Examples
    --------
    >>> unblocked(np.array([1, 2]), np.array([0, 1]), np.array([0, 1, 2]), ground=2)  # 2 stops at 1, 1 at 0
    array([0])
    """
    between = label[tail] != label[head]
    return np.setdiff1d(label, np.append(label[tail[between]], label[ground]))
