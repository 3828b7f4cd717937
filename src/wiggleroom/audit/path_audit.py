"""Whether parts overlap anywhere along a path: all pairs that come near, between waypoints too."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.audit.audit_outlines import AuditOutlines, outlines
from wiggleroom.audit.containment import inside_each_other
from wiggleroom.audit.moving_edges import mark_doubtful_pieces, swept_boxes
from wiggleroom.errors import Stop
from wiggleroom.parallel.batches import in_batches

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_BOX_GROWTH = 2.0
"""A stretch of the path is halved where boxes round what parts sweep are wider than their own by more than this, in the mean."""
MAX_NEAR_EDGES = 200_000
"""Pairs of edges of two parts that may meet on one stretch, at most."""
STOP_CHECK_CORNERS = 50_000
"""Number of corners of the pairs in one batch. Between batches it is asked whether to stop."""


@dataclass(frozen=True, eq=False)
class PathAudit:
    """What is known about a path.

    Parameters
    ----------
    doubtful : (k - 1,) bool
        Pieces between waypoints on which some parts may overlap.
    a, b : (p,) int64
        Pairs of parts, a < b, that may overlap somewhere.
    piece : (p,) int64
        The first piece on which each of them may, -1 where they do at the first waypoint.
    whole : bool
        False where it was asked to stop before every pair was looked at: then no more than the first waypoint is certain.
    """

    doubtful: NDArray[np.bool_]
    a: Ints
    b: Ints
    piece: Ints
    whole: bool

    @property
    def free(self) -> bool:
        """True where no two parts overlap anywhere along the path."""
        return self.whole and len(self.a) == 0

    @property
    def certain(self) -> int:
        """Number of waypoints up to which no two parts overlap anywhere; 0 where they overlap at the first already."""
        return int(self.piece.min(initial=len(self.doubtful) if self.whole else 0)) + 1


def audit_path(
    parts: AuditOutlines | Assembly,
    motions: Floats,
    stop: Stop | None = None,
    *,
    changed: NDArray[np.bool_] | None = None,
) -> PathAudit:
    """Judge a path from its waypoints and the outlines of the parts alone.

    Between two waypoints every part moves straight: x, y and angle of its reference point change evenly.

    Parameters
    ----------
    parts : AuditOutlines or Assembly
    motions : (k, n, 3) float64 [mm, mm, rad]
        Waypoints: motions of all parts about their reference points, from a state at which parts do not lie inside each other.
    stop : optional
        Once it is set, the whole path is in doubt.
    changed : (n,) bool, optional
        Parts that move otherwise than on a path that was judged before: pairs of other parts are not looked at again.

    Returns
    -------
    PathAudit
        `free` is said only where the outlines, moved inward by `INSET` of the drawing's size, certainly do not meet anywhere between
        the waypoints, at no pair of parts. Glued parts, fixed ones and pairs that are ignored do not count.

    Notes
    -----
    It knows nothing of the search: pairs are found from the boxes round what parts sweep. See docs/mathematics.md, "The path from rest".

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
    pieces, n = len(motions) - 1, motions.shape[1]
    if pieces == 0:  # a state alone
        motions = np.concatenate([motions, motions])
    poses = np.empty((n, len(motions), 3))
    np.add(parts.rest[:, None], motions.transpose(1, 0, 2), out=poses)
    poses[:, :, :2] -= parts.rest[:, :2].mean(axis=0)
    keys = _near(parts, poses, np.arange(n) if changed is None else np.flatnonzero(changed))
    a, b = keys // n, keys % n
    doubtful = np.zeros(len(motions) - 1, dtype=np.bool_)
    first = np.full(len(keys), len(motions), dtype=np.int64)
    whole = _sweep(parts, poses, a, b, doubtful, first, stop)
    nested = np.zeros(len(keys), dtype=np.bool_)
    inside_each_other(
        a, b, np.ascontiguousarray(poses[:, 0]), parts.shape, parts.first, parts.corner, parts.next_corner, parts.ring,
        parts.first_ring, nested,
    )  # fmt: skip
    first[nested] = -1
    doubt = first < len(motions)
    return PathAudit(doubtful[:pieces], a[doubt], b[doubt], first[doubt], whole)


def _sweep(
    parts: AuditOutlines,
    poses: Floats,
    a: Ints,
    b: Ints,
    doubtful: NDArray[np.bool_],
    first: Ints,
    stop: Stop | None,
) -> bool:
    """Look at some pairs along all pieces, many at a time; False where it was asked to stop before all were looked at."""
    corners = np.diff(parts.first)[parts.shape]

    def look(some: slice) -> NDArray[np.bool_] | None:
        if stop is not None and stop.is_set():
            return None
        met = np.zeros_like(doubtful)
        mark_doubtful_pieces(
            a[some], b[some], poses, parts.shape, parts.rounding, parts.corner, parts.next_corner, parts.direction, parts.length,
            parts.run, parts.first_run, parts.run_disc, parts.disc, parts.reach, MAX_NEAR_EDGES, met, first[some],
        )  # fmt: skip
        return met

    looked = in_batches(len(a), int((corners[a] + corners[b]).sum()) // STOP_CHECK_CORNERS, look)
    for met in looked:
        if met is not None:
            doubtful |= met
    return all(met is not None for met in looked)


def _near(parts: AuditOutlines, poses: Floats, who: Ints) -> Ints:
    """Keys a * n + b, a < b, of the pairs with one of some parts that may collide and whose boxes meet somewhere along the path."""
    n = len(poses)
    width = _widths(_swept(parts, poses, 0, 0))
    waiting = [(0, poses.shape[1] - 1)]
    found: list[Ints] = []
    while waiting:
        k0, k1 = waiting.pop()
        boxes = _swept(parts, poses, k0, k1)
        if k1 - k0 > 1 and _widths(boxes) > MAX_BOX_GROWTH * width:
            waiting += [((k0 + k1) // 2, k1), (k0, (k0 + k1) // 2)]
            continue
        shapes = shapely.box(*boxes.T)
        own, other = shapely.STRtree(shapes).query(shapes[who])
        a, b = np.minimum(who[own], other), np.maximum(who[own], other)
        keep = (a < b) & ~(parts.fixed[a] & parts.fixed[b]) & (parts.body[a] != parts.body[b])
        found.append(a[keep] * n + b[keep])
    keys = np.sort(np.concatenate(found))  # quicker than the hashing of np.unique
    keys = keys[np.diff(keys, prepend=-1) > 0]
    return keys[~np.isin(keys, parts.ignored)]


def _swept(parts: AuditOutlines, poses: Floats, k0: int, k1: int) -> Floats:
    """Boxes (n, 4) [mm] round what every part sweeps from waypoint k0 to k1."""
    out = np.empty((len(poses), 4))
    swept_boxes(poses, k0, k1, parts.shape, parts.first, parts.corner, parts.reach, out)
    return out


def _widths(boxes: Floats) -> float:
    """Mean of the sides of some boxes."""
    return float((boxes[:, 2:] - boxes[:, :2]).mean())
