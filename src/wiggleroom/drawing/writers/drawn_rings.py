"""Which strokes of a drawing are the outlines of its parts, and which of them the outlines of the parts as made take the place of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.model import Part, Points
from wiggleroom.drawing.strokes.elements import Stroke
from wiggleroom.drawing.strokes.flatten import Curved
from wiggleroom.drawing.strokes.pathdata import Subpath
from wiggleroom.drawing.writers.svg_writer import placed_rings

NEAR, NEAR_SHARE = 0.05, 1e-3
"""A stroke nearer to an outline than this [mm, share of the drawing's size] is on it: ends were joined, curves cut into edges."""
SAMPLES = 33
"""Points of a stroke that are looked at; it is an outline where more than half of them are on one."""
MOVED = 1e-9
"""Outlines that lie this near to each other, as a share of the drawing's size, are the same."""


@dataclass(frozen=True, eq=False)
class Redrawn:
    """What is left of a stroke, and what takes the place of the rest.

    Parameters
    ----------
    kept : tuple of Subpath [mm]
        What is no outline; all of the stroke where it draws none.
    rings : dict
        Outlines (n, 2) [mm] in its place, by the name of their part, first of the part that has its name.
    """

    kept: tuple[Subpath, ...]
    rings: dict[str, list[Points]]


def redrawn(
    strokes: Sequence[Stroke], drawn: Sequence[Part], made: Sequence[Part], flatten: float
) -> list[Redrawn] | None:
    """What becomes of every stroke where the outlines of `made` take the place of those that were drawn; None where they are the same.

    Parameters
    ----------
    strokes : sequence of Stroke
        What is cut.
    drawn, made : sequence of Part
        The same parts, as drawn and as they are made.
    flatten : float [mm]
        Chord error of the outlines as drawn.
    """
    before, after = ([_rings(part) for part in parts] for parts in (drawn, made))
    every = [ring for rings in before for ring in rings]
    size = float(np.ptp(np.vstack(every), axis=0).max())
    if all(_same(a, b, MOVED * size) for a, b in zip(before, after, strict=True)):
        return None
    near = flatten + min(NEAR, NEAR_SHARE * size)
    paths = [path for stroke in strokes for path in stroke.paths]
    stroke_of_path = np.repeat(np.arange(len(strokes)), [len(stroke.paths) for stroke in strokes])
    samples = _sampled(paths, near)
    tree = shapely.STRtree([shapely.LinearRing(ring) for ring in every])
    hit, ring = tree.query_nearest(shapely.points(samples.reshape(-1, 2)), max_distance=near)
    path = hit // SAMPLES
    on = np.bincount(np.unique(hit) // SAMPLES, minlength=len(paths)) > SAMPLES / 2
    named = [stroke.label or stroke.name for stroke in strokes]
    names = [part.name for part, rings in zip(drawn, before, strict=True) for _ in rings]
    own = np.array(named)[stroke_of_path[path]] == np.array(names)[ring]
    strongest = _strongest(ring[on[path]], stroke_of_path[path[on[path]]], own[on[path]], len(every))
    rings: list[dict[str, list[Points]]] = [{} for _ in strokes]
    first = 0
    for part, old, new in zip(made, before, after, strict=True):
        for number, outline in enumerate(new):
            place = strongest[first + (number if len(new) == len(old) else _nearest(outline, old))]
            rings[place].setdefault(part.name, []).append(outline)
        first += len(old)
    outlines = iter(on.tolist())
    kept = [tuple(path for path in stroke.paths if not next(outlines)) for stroke in strokes]
    ordered = [dict(sorted(new.items(), key=lambda one: one[0] != own)) for new, own in zip(rings, named, strict=True)]
    return [Redrawn(left, new) for left, new in zip(kept, ordered, strict=True)]


def _rings(part: Part) -> list[Points]:
    return [ring for region in part.regions for ring in placed_rings(part, region)]


def _same(before: list[Points], after: list[Points], moved: float) -> bool:
    shapes = [ring.shape for ring in before] == [ring.shape for ring in after]
    return shapes and all(np.abs(a - b).max() <= moved for a, b in zip(before, after, strict=True))


def _sampled(paths: Sequence[Subpath], tolerance: float) -> Points:
    """Points along strokes (k, SAMPLES, 2) [mm], at equal distances."""
    curved = Curved()
    for path in paths:
        curved.add(path)
    share = np.linspace(0, 1, SAMPLES)
    found = np.empty((len(paths), SAMPLES, 2))
    for k, corners in enumerate(curved.corners(tolerance)):
        length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
        for axis in range(2):
            found[k, :, axis] = np.interp(share * length[-1], length, corners[:, axis])
    return found


def _strongest(rings: NDArray[np.intp], strokes: NDArray[np.intp], own: NDArray[np.bool_], count: int) -> list[int]:
    """The stroke that most of the points on each ring belong to, of several the one with the part's name; any where none does."""
    pairs, at = np.unique(np.stack([rings, strokes]), axis=1, return_inverse=True)
    number = np.bincount(at) + np.bincount(at, weights=own) / SAMPLES
    found = [int(pairs[1, 0])] * count
    for k in np.argsort(number, kind="stable"):
        found[pairs[0, k]] = int(pairs[1, k])
    return found


def _nearest(outline: Points, old: list[Points]) -> int:
    ring = shapely.LinearRing(outline)
    return int(np.argmin([shapely.hausdorff_distance(ring, shapely.LinearRing(other)) for other in old]))
