"""Faces of a net of lines: crossings and T-junctions split, what leads nowhere left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from wiggleroom.drawing.model import Points
from wiggleroom.drawing.outlines.connected_components import components
from wiggleroom.drawing.outlines.joining import PAIR_SHARE, Ends
from wiggleroom.drawing.outlines.rings import extents

SNAP_GRID = 1e-8
"""Crossings are rounded to a grid of about this share of the drawing's size."""


@dataclass(frozen=True, eq=False)
class Net:
    """Faces of a net.

    Parameters
    ----------
    faces : (n,) polygons [mm]
    dangles : (m,) lines [mm]
        What leads nowhere, and bridges between outlines.
    slivers : int
        Faces too thin to be parts, which were dropped.
    """

    faces: list[shapely.Polygon]
    dangles: list[shapely.Geometry]
    slivers: int


def net_of(
    lines: Sequence[Points], ends: Ends, rings: Sequence[Points], *, join: float, chord: float, reach: float = 0.0
) -> Net:
    """Faces that open lines make among each other and with closed outlines.

    Parameters
    ----------
    lines : sequence of (n, 2) float64 [mm]
        Open lines.
    ends : Ends
        Of these lines.
    rings : sequence of (n, 2) float64 [mm]
        Closed outlines that the lines reach.
    join : float [mm]
        Ends nearer than this to a line end on it; ...
    reach : float [mm]
        ... those that meet nothing else also over more, up to this and `PAIR_SHARE` of all lines that follow on them.
    chord : float [mm]
        How far a curve may stray from its corners.

    Examples
    --------
    >>> from wiggleroom.drawing.outlines.joining import join_ends
    >>> square = np.array([[0.0, 0], [9, 0], [9, 9], [0, 9]])
    >>> cut = [np.array([[3.0, -1], [3, 10]])]
    >>> sorted(face.area for face in net_of(cut, join_ends(cut, 0.05, 9.0), [square], join=0.05, chord=1e-3).faces)
    [27.0, 54.0]
    """
    drawn = [_moved(line, ends, row) for row, line in enumerate(lines)]
    drawn += [np.vstack([ring, ring[:1]]) for ring in rings]
    corners = np.vstack(drawn)
    size = float(np.ptp(corners, axis=0).max())
    drawn = _ends_on_lines(drawn, len(lines), ends, join, chord, size, reach)
    grid = 10.0 ** np.floor(np.log10(SNAP_GRID * max(size, float(np.abs(corners).max()) * 1e-4)))
    noded = shapely.unary_union(shapely.multilinestrings([shapely.linestrings(line) for line in drawn]), grid_size=grid)
    faces, cuts, dangles, _ = shapely.polygonize_full(shapely.get_parts(noded))
    polygons = shapely.get_parts(faces)
    thin = 2 * shapely.area(polygons) < max(join, 2 * chord) * shapely.length(polygons)
    loose = [*shapely.get_parts(dangles), *shapely.get_parts(cuts)]
    return Net(list(polygons[~thin]), [line for line in loose if line.length > max(join, 2 * chord)], int(thin.sum()))


def _moved(line: Points, ends: Ends, row: int) -> Points:
    moved = line.copy()
    moved[0], moved[-1] = ends.at[ends.node[row]]
    return moved


def _ends_on_lines(
    drawn: list[Points], open_lines: int, ends: Ends, join: float, chord: float, size: float, reach: float
) -> list[Points]:
    """Lines with a corner wherever another one ends on them; ends are drawn to lines they almost reach."""
    starts = np.vstack([line[:-1] for line in drawn])
    stops = np.vstack([line[1:] for line in drawn])
    owner = np.repeat(np.arange(len(drawn)), [len(line) - 1 for line in drawn])
    place = np.concatenate([np.arange(len(line) - 1) for line in drawn])
    tree = shapely.STRtree(shapely.linestrings(np.stack([starts, stops], axis=1)))
    near = max(chord * 1.01, 1e-9 * size)
    single = np.bincount(ends.node.ravel(), minlength=len(ends.at)) == 1
    chain = components(len(ends.at), ends.node[:, 0], ends.node[:, 1])
    length = np.bincount(chain[ends.node[:, 0]], extents(drawn[:open_lines]).max(axis=1), minlength=len(ends.at))[chain]
    most = np.where(single, np.maximum(max(near, join), np.minimum(reach, PAIR_SHARE * length)), near)
    points, segments = tree.query(shapely.points(ends.at), predicate="dwithin", distance=most)
    here, a, b = ends.at[points], starts[segments], stops[segments]
    along = b - a
    share = np.clip(((here - a) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-300), 0.0, 1.0)
    foot = a + share[:, None] * along
    apart = np.hypot(*(here - foot).T)
    own = (here == a).all(axis=1) | (here == b).all(axis=1)
    at_own = np.zeros(len(ends.at), dtype=bool)
    at_own[points[own & (owner[segments] >= open_lines)]] = True  # a corner of a closed outline is there already
    reached = ~own & (apart <= most[points]) & ~at_own[points]
    best: dict[int, int] = {}
    for k in np.lexsort((apart, points)):
        if reached[k]:
            best.setdefault(int(points[k]), int(k))
    target = ends.at.copy()
    inserted: dict[int, list[tuple[int, float, Points]]] = {}
    for node, k in best.items():
        corner = a[k] if share[k] <= 0 else b[k] if share[k] >= 1 else foot[k]
        target[node] = corner
        if 0 < share[k] < 1:
            line = int(owner[segments[k]])
            inserted.setdefault(line, []).append((int(place[segments[k]]), float(share[k]), corner))
    result = []
    for line, corners in enumerate(drawn):
        for position, _, corner in sorted(inserted.get(line, []), key=lambda entry: entry[:2], reverse=True):
            corners = np.insert(corners, position + 1, corner, axis=0)
        if line < open_lines:
            corners = corners.copy()
            corners[0], corners[-1] = target[ends.node[line]]
        result.append(corners)
    return result
