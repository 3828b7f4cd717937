"""Whether parts overlap anywhere along a way: all pairs that come near, between way-points too."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.model import Assembly
from wiggleroom.audit.moving_edges import inside_each_other, sweep, swept_boxes
from wiggleroom.audit.outlines import Outlines, outlines

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WIDER = 2.0
"""A stretch of the way is halved where boxes round what parts sweep are larger than their own by more than this, in the mean."""
MOST_NEAR_EDGES = 200_000
"""Pairs of edges of two parts that may meet on one stretch, at most."""
BLOCK = 20_000
"""Poses of so many parts and way-points, times a thousand, are held at once."""


@dataclass(frozen=True, eq=False)
class PathAudit:
    """What is known about a way.

    Parameters
    ----------
    doubtful : (k - 1,) bool
        Pieces between way-points on which some parts may overlap.
    a, b : (p,) int64
        Pairs of parts, a < b, that may overlap somewhere.
    piece : (p,) int64
        The first piece on which each of them may.
    """

    doubtful: NDArray[np.bool_]
    a: Ints
    b: Ints
    piece: Ints

    @property
    def free(self) -> bool:
        """True where no two parts overlap anywhere along the way."""
        return len(self.a) == 0

    @property
    def certain(self) -> int:
        """Up to so many way-points, no two parts overlap anywhere; 0 where they do at the first already."""
        return int(self.piece.min()) + 1 if len(self.a) and self.piece.min() >= 0 else (0 if len(self.a) else len(self.doubtful) + 1)


def audit_path(parts: Outlines | Assembly, motions: Floats) -> PathAudit:
    """Judge a way from its way-points and the outlines of the parts alone.

    Between two way-points every part moves straight: x, y and angle of its reference point change evenly.

    Parameters
    ----------
    parts : Outlines or Assembly
    motions : (k, n, 3) float64 [mm, mm, rad]
        Way-points: motions of all parts about their reference points, from a state at which parts do not lie inside each other.

    Returns
    -------
    PathAudit
        `free` is said only where the outlines, moved inward by `INSET` of the drawing's size, certainly do not meet anywhere between
        the way-points, at no pair of parts. Glued parts, fixed ones and pairs that are ignored do not count.

    Notes
    -----
    It knows nothing of the search: pairs are found from the boxes round what parts sweep. See docs/mathematics.md, "The way from rest".

    Examples
    --------
    >>> import numpy as np
    >>> import wiggleroom as wr
    >>> pair = wr.patterns.chain(2, joint="tee", gap=0.01)
    >>> audit_path(pair, np.array([np.zeros((2, 3)), [[0, 0, 0], [0.005, 0, 0]]])).free
    True
    >>> audit_path(pair, np.array([np.zeros((2, 3)), [[0, 0, 0], [3, 0, 0]]])).free
    False
    """
    if isinstance(parts, Assembly):
        parts = outlines(parts)
    last, n = len(motions) - 1, motions.shape[1]
    doubtful = np.zeros(max(last, 0), dtype=np.bool_)
    first: dict[int, int] = {}
    if last == 0:
        motions, last = np.concatenate([motions, motions]), 1
        doubtful = np.zeros(1, dtype=np.bool_)
    middle = parts.rest[:, :2].mean(axis=0)
    for begin in range(0, last, max(1, 1000 * BLOCK // n)):
        end = min(last, begin + max(1, 1000 * BLOCK // n))
        poses = parts.rest + motions[begin : end + 1]
        poses[:, :, :2] -= middle
        poses = np.ascontiguousarray(poses.transpose(1, 0, 2))
        own = _areas(_boxes(parts, poses, 0, 0))
        waiting = [(0, end - begin)]
        while waiting:
            k0, k1 = waiting.pop()
            boxes = _boxes(parts, poses, k0, k1)
            if k1 - k0 > 1 and _areas(boxes).mean() > WIDER * own.mean():
                m = (k0 + k1) // 2
                waiting += [(m, k1), (k0, m)]
                continue
            a, b = _near(parts, boxes)
            if begin + k0 == 0:
                for key in _nested(parts, poses[:, 0], a, b):
                    first[key] = -1
            doubt = np.zeros(k1 - k0, dtype=np.bool_)
            piece = np.full(len(a), last, dtype=np.int64)
            sweep(
                a, b, np.ascontiguousarray(poses[:, k0 : k1 + 1]), parts.rounding, parts.corner, parts.next_corner,
                parts.direction, parts.length, parts.run, parts.first_run, parts.run_disc, parts.disc, parts.reach,
                MOST_NEAR_EDGES, doubt, piece,
            )  # fmt: skip
            doubtful[begin + k0 : begin + k1] |= doubt
            for k in np.flatnonzero(piece < last):
                key = int(a[k] * n + b[k])
                first[key] = min(first.get(key, last), begin + k0 + int(piece[k]))
    keys = np.array(sorted(first), dtype=np.int64)
    pieces = np.array([first[int(key)] for key in keys], dtype=np.int64)
    return PathAudit(doubtful[: len(motions) - 1], keys // n, keys % n, pieces)


def _boxes(parts: Outlines, poses: Floats, k0: int, k1: int) -> Floats:
    """Boxes (n, 4) [mm] round what every part sweeps from way-point k0 to k1."""
    out = np.empty((len(poses), 4))
    swept_boxes(poses, k0, k1, parts.first, parts.corner, parts.reach, out)
    return out


def _areas(boxes: Floats) -> Floats:
    return (boxes[:, 2] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 1])


def _near(parts: Outlines, boxes: Floats) -> tuple[Ints, Ints]:
    """Pairs of parts whose boxes meet and that may collide."""
    n = len(boxes)
    shapes = shapely.box(*boxes.T)
    a, b = shapely.STRtree(shapes).query(shapes)
    keep = (a < b) & ~(parts.fixed[a] & parts.fixed[b]) & (parts.body[a] != parts.body[b])
    keep[keep] = ~np.isin(a[keep] * n + b[keep], parts.ignored)
    a, b = a[keep], b[keep]
    order = np.lexsort((b, a))
    return a[order], b[order]


def _nested(parts: Outlines, poses: Floats, a: Ints, b: Ints) -> list[int]:
    """Keys of the pairs of which one begins inside the other."""
    out = np.zeros(len(a), dtype=np.bool_)
    inside_each_other(
        a, b, np.ascontiguousarray(poses), parts.first, parts.corner, parts.next_corner, parts.ring, parts.first_ring, out
    )
    return (a * len(poses) + b)[out].tolist()
