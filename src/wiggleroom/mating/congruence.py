"""Whether two placements are the same up to a rigid motion or a reflection, whichever of equal panels is where."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.mating.panel_outline import SAME_OUTLINE, same_outline

Floats = NDArray[np.float64]
Isometry = tuple[Floats, Floats]
"""Matrix (3, 3), orthogonal, and shift (3,) [mm]."""
PanelPose = tuple[int, Floats, Floats]
"""Kind of a panel, and its pose: rotation matrix (3, 3) and shift (3,) [mm]."""


class PanelIsometries:
    """Isometries of space that lay one kind of panel on another, or on itself.

    Parameters
    ----------
    outlines : mapping of int to shapely.Polygon [mm]
        By kind: a panel in its own frame, the middle of its thickness at z = 0.
    marked : set of int
        Kinds that are told apart from all others, and each of their edges from the others, though they may be congruent.
    thickness : mapping of int to float [mm], optional
        By kind; by default all are as thick as each other.
    """

    def __init__(
        self,
        outlines: Mapping[int, shapely.Polygon],
        marked: Set[int] = frozenset(),
        thickness: Mapping[int, float] | None = None,
    ) -> None:
        self._outlines, self._marked, self._thickness = outlines, marked, thickness or {}
        self._known: dict[tuple[int, int], list[Isometry]] = {}

    def between(self, a: int, b: int) -> list[Isometry]:
        """Isometries that lay a panel of kind `a` on one of kind `b`, each in its own frame."""
        if (a, b) not in self._known:
            if a == b and a in self._marked:
                self._known[a, b] = [(np.diag([1.0, 1.0, up]), np.zeros(3)) for up in (1.0, -1.0)]
            elif a in self._marked or b in self._marked or self._thickness.get(a) != self._thickness.get(b):
                self._known[a, b] = []
            else:
                self._known[a, b] = _isometries(self._outlines[a], self._outlines[b])
        return self._known[a, b]

    def marks(self, kind: int) -> Floats:
        """Three points (3, 3) [mm] that fix the pose of a panel."""
        reach = float(np.linalg.norm(shapely.get_coordinates(self._outlines[kind]), axis=1).max())
        return reach * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def congruent(known: PanelIsometries, a: Sequence[PanelPose], b: Sequence[PanelPose], tolerance: float) -> bool:
    """Whether an isometry of space lays the panels of one placement on those of the other.

    Parameters
    ----------
    known : PanelIsometries
    a, b : sequences of (kind, turn, move)
    tolerance : float [mm]
        By how much points of panels may miss each other.

    Examples
    --------
    >>> known = PanelIsometries({0: shapely.box(0, 0, 4, 3)})
    >>> one, up = (0, np.eye(3), np.zeros(3)), (0, np.eye(3), np.array([0, 0, 7.0]))
    >>> congruent(known, [one, up], [up, one], 0.01)
    True
    >>> congruent(known, [one, up], [one, (0, np.eye(3), np.array([1, 0, 7.0]))], 0.01)
    False
    """
    if len(a) != len(b):
        return False
    partners = [[j for j, (other, *_) in enumerate(b) if known.between(kind, other)] for kind, *_ in a]
    if not all(partners):
        return False
    first = min(range(len(a)), key=lambda i: len(partners[i]))
    _, turn, move = a[first]
    targets = {
        i: [(j, b[j][1] @ R, b[j][1] @ t + b[j][2]) for j in near for R, t in known.between(a[i][0], b[j][0])]
        for i, near in enumerate(partners)
    }
    marks = [known.marks(kind) for kind, *_ in a]
    placed = [points @ turn.T + move for points, (_, turn, move) in zip(marks, a, strict=True)]
    goals = {
        i: ([j for j, *_ in found], np.array([marks[i] @ R.T + t for _, R, t in found])) for i, found in targets.items()
    }
    for _, R, t in targets[first]:
        whole = R @ turn.T
        shift = t - whole @ move
        if _all_laid(placed, goals, whole, shift, tolerance):
            return True
    return False


def _all_laid(
    placed: Sequence[Floats], goals: dict[int, tuple[list[int], Floats]], whole: Floats, shift: Floats, tolerance: float
) -> bool:
    """Whether an isometry lays every panel on one of the other placement, no two on the same."""
    taken: set[int] = set()
    for i, points in enumerate(placed):
        rows, wanted = goals[i]
        off = np.linalg.norm(wanted - (points @ whole.T + shift), axis=2).max(axis=1)
        there = next((rows[k] for k in np.argsort(off).tolist() if off[k] <= tolerance and rows[k] not in taken), None)
        if there is None:
            return False
        taken.add(there)
    return True


def _isometries(a: shapely.Polygon, b: shapely.Polygon) -> list[Isometry]:
    """Every isometry that lays one panel on another."""
    same = abs(a.area - b.area) < SAME_OUTLINE * a.length and abs(a.length - b.length) < 0.002 * a.length
    if not same or len(a.interiors) != len(b.interiors):
        return []
    middle_a, middle_b = (np.array(outline.centroid.coords[0]) for outline in (a, b))
    out_a, out_b = (
        shapely.get_coordinates(a.exterior)[:-1] - middle_a,
        shapely.get_coordinates(b.exterior)[:-1] - middle_b,
    )
    far_a, far_b = np.hypot(*out_a.T), np.hypot(*out_b.T)
    top = int(np.argmax(far_a))
    own = _frame(out_a[top])
    found: list[Isometry] = []
    for k in np.flatnonzero(np.abs(far_b - far_a[top]) < 2 * SAME_OUTLINE).tolist():
        for across in (1.0, -1.0):
            turn = _frame(out_b[k]) @ np.diag([1.0, across]) @ own.T
            laid = shapely.transform(a, lambda points, turn=turn: (points - middle_a) @ turn.T + middle_b)
            if any(_alike(turn, R) for R, _ in found) or not same_outline(laid, b):
                continue
            for up in (1.0, -1.0):
                R = np.zeros((3, 3))
                R[:2, :2], R[2, 2] = turn, up
                found.append((R, np.append(middle_b - turn @ middle_a, 0.0)))
    return found


def _alike(turn: Floats, R: Floats) -> bool:
    return bool(np.abs(R[:2, :2] - turn).max() < 1e-3)


def _frame(along: Floats) -> Floats:
    """Orthonormal axes as columns: towards a corner from the centre, and square to it."""
    x, y = along / np.hypot(*along)
    return np.array([[x, -y], [y, x]])
