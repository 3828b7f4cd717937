"""Judge of an assembled sheet of boxes.py by the joints that its generator asked for.

A row of tabs belongs into a row of notches or holes of the same length. As many pairs as the numbers of both allow must lie
in each other in space: the ends of both rows in the same two places. Panels without such rows must lie loose, and must be said to.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from benchmarks.boxes_sheets import DrawnSheet, JointRow

Floats = NDArray[np.float64]
SAME_LENGTH = 0.15
"""Rows belong together whose lengths differ by no more than this [mm]."""
APART = 0.45
"""Ends of rows that lie in each other are no further apart than this [mm]."""
APART_SLANTED = 3.0
"""The same for fingers made for other angles than 90 degrees: they end on the outer face, not in the middle of the depth."""


@dataclass(frozen=True)
class JudgedJoints:
    """How many of the joints that a generator drew are closed.

    Parameters
    ----------
    closed, asked : int
        Rows of tabs that lie in rows of notches, and how many can at most.
    joined : frozenset of str
        Panels with rows that belong into another panel's.
    open : dict of str to list of JointRow
        By panel, rows that have partners but lie in none.
    """

    closed: int
    asked: int
    joined: frozenset[str]
    open: dict[str, list[JointRow]]


def panels_of_rows(drawn: DrawnSheet, panels: Mapping[str, shapely.Polygon]) -> list[str]:
    """Name of the panel on which every row lies; "" for a row that is not cut."""
    names = list(panels)
    found = []
    for row in drawn.rows:
        line = shapely.LineString(row.ends)
        share = [panels[name].intersection(line).length / max(line.length, 1e-9) for name in names]
        best = int(np.argmax(share))
        # Holes that are drawn beside all panels, to drill after, make small outlines of their own: no panel holds the row.
        reach = shapely.minimum_rotated_rectangle(panels[names[best]]).exterior.length / 2
        whole = reach > 0.8 * line.length
        found.append(names[best] if share[best] > 0.1 and whole else "")
    return found


def classes_of_rows(rows: Sequence[JointRow], of: Sequence[str]) -> list[list[int]]:
    """Numbers of rows on panels whose lengths are the same."""
    order = sorted((k for k in range(len(rows)) if of[k]), key=lambda k: rows[k].length)
    classes: list[list[int]] = []
    for k in order:
        if not classes or rows[k].length - rows[classes[-1][-1]].length > SAME_LENGTH:
            classes.append([])
        classes[-1].append(k)
    return classes


def judge_joints(
    drawn: DrawnSheet, panels: Mapping[str, shapely.Polygon], poses: Mapping[str, tuple[Floats, Floats]]
) -> JudgedJoints:
    """Count the joints that are closed.

    Parameters
    ----------
    drawn : DrawnSheet
    panels : mapping of name to shapely.Polygon [mm]
        Where they lie on the sheet.
    poses : mapping of name to ((3, 3), (3,)) [mm]
        Rotation and shift that take the sheet's plane, x and y as there, to where each placed panel's middle plane is.
    """
    of = panels_of_rows(drawn, panels)
    closed = asked = 0
    joined: set[str] = set()
    still: dict[str, list[JointRow]] = {}
    for rows in classes_of_rows(drawn.rows, of):
        tabs = [k for k in rows if drawn.rows[k].tabs]
        notches = [k for k in rows if not drawn.rows[k].tabs]
        asked += min(len(tabs), len(notches))
        if not tabs or not notches:
            continue
        joined |= {of[k] for k in (tabs if len(tabs) <= len(notches) else [])}
        joined |= {of[k] for k in (notches if len(notches) <= len(tabs) else [])}
        taken: set[int] = set()
        for i in tabs:
            for j in notches:
                if j not in taken and of[i] != of[j] and _closed(drawn, of, poses, i, j):
                    taken |= {i, j}
                    break
        closed += len(taken) // 2
        for k in rows:
            if k not in taken:
                still.setdefault(of[k], []).append(drawn.rows[k])
    return JudgedJoints(closed, asked, frozenset(joined), still)


def _closed(drawn: DrawnSheet, of: Sequence[str], poses: Mapping[str, tuple[Floats, Floats]], i: int, j: int) -> bool:
    if of[i] not in poses or of[j] not in poses:
        return False
    square = drawn.rows[i].angle == drawn.rows[j].angle == 90.0
    ends = []
    for k in (i, j):
        turn, move = poses[of[k]]
        ends.append(drawn.rows[k].ends @ turn[:, :2].T + move)
    apart = min(np.abs(ends[0] - other).max() for other in (ends[1], ends[1][::-1]))
    # In a joint as deep as two plates each of them lies half a plate beside its middle.
    spare = abs(drawn.rows[i].depth - drawn.rows[j].depth) / 2
    return bool(apart < spare + (APART if square else APART_SLANTED))
