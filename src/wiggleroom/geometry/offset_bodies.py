"""Bodies whose outlines moved: every edge along its normal, every mitred corner along its bisector."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import InputError
from wiggleroom.geometry.bodies import Bodies, BodyShapes

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def mitres(shapes: BodyShapes) -> Floats:
    """How far each corner moves (N, 2) when both its edges move inward by 1: the walls are linear in this.

    With outward normals n1 and n2 it is the shift m with n1 . m = n2 . m = -1, so m = -2 (n1 + n2) / |n1 + n2|^2.
    """
    both = shapes.normal.copy()
    both[shapes.after] += shapes.normal
    return -2 * both / np.maximum((both**2).sum(axis=1), 1e-18)[:, None]


def offset_bodies(bodies: Bodies, inward: Floats) -> Bodies:
    """The same bodies in the same frames, the outlines of some parts moved.

    Parameters
    ----------
    bodies : Bodies
    inward : (parts,) float64 [mm]
        How far every edge of each part moves into its material; negative moves it out. Less than what would use up
        an edge: outlines keep their corners, as walls name them.

    Returns
    -------
    Bodies
        Bodies that changed have shapes of their own, behind those that were there.

    Raises
    ------
    InputError
        If an edge would be used up.
    """
    shapes, shift, first = bodies.shapes, mitres(bodies.shapes), bodies.shapes.first
    shape = bodies.shape.copy()
    made: dict[tuple[float, ...], int] = {}
    rows, corners, radius = [], [], []
    for b in np.flatnonzero(_changed(bodies, inward)):
        s = int(bodies.shape[b])
        amount = inward[list(bodies.members[b])]
        key = (s, *amount.tolist())
        if key not in made:
            made[key] = len(shapes.radius) + len(made)
            own = np.arange(first[s], first[s + 1])
            rows.append(own)
            corners.append(shapes.corner[own] + amount[shapes.member[own]][:, None] * shift[own])
            radius.append(np.hypot(*corners[-1].T).max())
        shape[b] = made[key]
    if not made:
        return bodies
    grown = _with(shapes, rows, corners, radius)
    along = grown.corner[grown.after] - grown.corner
    if (along[:, 1] * grown.normal[:, 0] - along[:, 0] * grown.normal[:, 1] <= 0).any():
        finding = "an outline that moved so far would lose an edge"
        raise InputError(finding)
    return replace(bodies, shapes=grown, shape=shape)


def _changed(bodies: Bodies, inward: Floats) -> NDArray[np.bool_]:
    """Bodies (n,) with a part that moves its outline."""
    changed = np.zeros(len(bodies.fixed), dtype=bool)
    changed[bodies.body_of[inward != 0]] = True
    return changed


def _with(shapes: BodyShapes, rows: list[Ints], corners: list[Floats], radius: list[float]) -> BodyShapes:
    """Shapes and, behind them, copies of some whose corners lie elsewhere."""
    counts = np.array([len(r) for r in rows])
    start = shapes.first[-1] + np.concatenate([[0], np.cumsum(counts)])
    old = np.concatenate(rows)
    corner = np.vstack([shapes.corner, *corners])
    by = np.repeat(start[:-1] - [r[0] for r in rows], counts)
    after = np.concatenate([shapes.after, shapes.after[old] + by])
    length = np.hypot(*(corner[after] - corner).T)
    run, run_first, disc = [shapes.run[:-1]], [shapes.run_first], [shapes.run_disc]
    count = len(shapes.run) - 1
    for r, there, at in zip(rows, corners, start[:-1], strict=True):
        low, high = np.searchsorted(shapes.run[:-1], [r[0], r[-1] + 1])
        count += high - low
        grown = shapes.run_disc[low:high].copy()
        grown[:, 2] += np.hypot(*(there - shapes.corner[r]).T).max()  # a disc round what moved by at most this
        run.append(shapes.run[low:high] + (at - r[0]))
        run_first.append(np.array([count]))
        disc.append(grown)
    run.append(np.array([len(corner)]))
    cat = np.concatenate
    return BodyShapes(
        corner, after, cat([shapes.normal, shapes.normal[old]]), length, cat([shapes.member, shapes.member[old]]),
        cat([shapes.first, start[1:]]), cat([shapes.radius, radius]), cat(run), cat(run_first), np.vstack(disc),
    )  # fmt: skip
