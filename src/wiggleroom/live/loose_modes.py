"""The loosest freedoms of an assembly at rest, each followed to its end both ways, in the plane and in space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import eigsh, splu

from wiggleroom.errors import Stop
from wiggleroom.live.live_result import Mode

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STIFFNESS_SHIFT = 1e-9
"""Share of the mean stiffness that is added everywhere: bodies that nothing holds would else have none."""
MIN_AMPLITUDE = 0.05
"""A freedom that moves no corner by this share of the clearance is none."""
MIN_INDEPENDENCE = 1e-3
"""Directions with less than this share beside the freedoms already found are none."""
PARALLEL_COSINE = 0.95
"""Freedoms whose ends agree to this cosine are one."""
FRAMES_PER_SIDE = 12
"""Frames from rest to either end."""
MAX_SHOWN_TRAVEL = 0.3
"""Where nothing stops a freedom, it is shown up to this share of the assembly's size."""
MAX_NAMED_PARTS, MIN_NAMED_SHARE = 5, 0.3
"""A freedom names so many parts at most, those that move most, and by at least this share of the farthest."""
MIN_SPARSE_VARIABLES = 12
"""With fewer variables all eigenvectors are worked out."""


@dataclass(frozen=True, eq=False)
class Side:
    """A freedom followed from rest to one of its ends.

    Parameters
    ----------
    frames : (k, n, f) float64
        Motions of the parts, from rest; no two overlap in any of them.
    end : (V,) float64
        The last one in scaled variables of the bodies.
    far : (m,) float64 [mm]
        How far the furthest corner of each body is moved by it.
    endless : bool
        True where nothing stops it and the frames were cut off.
    """

    frames: Floats
    end: Floats
    far: Floats
    endless: bool


class LooseBodies(Protocol):
    """Bodies of an assembly at rest, as their freedoms are looked for.

    Parameters
    ----------
    names : tuple of str
        Of the parts.
    members : sequence of sequences of int
        Parts of every body.
    clearance : float [mm]
    """

    names: tuple[str, ...]
    members: tuple[tuple[int, ...], ...]
    clearance: float

    def stiffness(self) -> sp.csc_matrix:
        """Second derivatives (V, V) of the barrier - sum log h of the rows h that hold the bodies, in scaled variables."""

    def variables(self, body: int) -> Ints:
        """Which variables are freedoms of a body."""

    def followed(self, direction: Floats, until: Stop) -> Side:
        """The largest motion along a direction (V,)."""


def modes(loose: LooseBodies, body: int | None, count: int, until: Stop) -> tuple[Mode, ...]:
    """Return at most `count` freedoms, loosest first; those that move one body where one is given.

    What holds every body at rest does so as springs would, with the stiffness of the barrier. Its softest eigenvectors are the directions;
    the freedom is the largest motion along one, both ways.

    Source: the paper's W (Mind the Gap, section 4.4) with the eigenvector as weights.
    """
    found: list[tuple[Mode, Floats]] = []
    gone: list[Floats] = []  # directions of the freedoms found: what leads along them is no new one
    for towards in _directions(loose, body, count):
        if len(found) == count or until.is_set():
            break
        direction = towards - sum((towards @ g) * g for g in gone)
        if np.linalg.norm(direction) < MIN_INDEPENDENCE * np.linalg.norm(towards):
            continue
        one, other = loose.followed(direction, until), loose.followed(-direction, until)
        size = np.maximum(one.far, other.far)
        if size.max() < MIN_AMPLITUDE * loose.clearance:
            continue
        ends, flipped = np.concatenate([one.end, other.end]), np.concatenate([other.end, one.end])
        long = np.linalg.norm(ends)
        if any(max(ends @ e, flipped @ e) > PARALLEL_COSINE * long * np.linalg.norm(e) for _, e in found):
            continue
        frames = np.concatenate([one.frames, one.frames[-2::-1], other.frames[1:], other.frames[-2::-1]])
        most = [b for b in np.argsort(-size, kind="stable")[:MAX_NAMED_PARTS] if size[b] > MIN_NAMED_SHARE * size.max()]
        names = tuple(loose.names[p] for b in most for p in loose.members[b])
        for side in (one, other):
            end = np.where(np.abs(side.end) < MIN_INDEPENDENCE * np.abs(side.end).max(initial=0.0), 0.0, side.end)
            along = end - sum((end @ g) * g for g in gone)
            if np.linalg.norm(along) > MIN_INDEPENDENCE * np.linalg.norm(end):
                gone.append(along / np.linalg.norm(along))
        found.append((Mode(float(size.max()), names, frames, not (one.endless or other.endless)), ends))
    found.sort(key=lambda m: (m[0].ends, -m[0].size))
    return tuple(mode for mode, _ in found)


def _directions(loose: LooseBodies, body: int | None, count: int) -> list[Floats]:
    """Softest directions (V,) at rest, in scaled variables: more than asked for, as some lead to the same end."""
    stiff = loose.stiffness()
    n = stiff.shape[0]
    soft = STIFFNESS_SHIFT * float(stiff.diagonal().mean()) or 1.0
    stiff = sp.csc_matrix(stiff + soft * sp.eye(n))
    if body is not None:
        its = loose.variables(body)
        loads = np.zeros((n, len(its)))
        loads[its, np.arange(len(its))] = 1.0
        given = splu(stiff).solve(loads)
        _, vectors = np.linalg.eigh(loads.T @ given)
        return list((given @ vectors[:, ::-1]).T)
    few = min(2 * count + 2, n - 1)
    if few < 1 or n < MIN_SPARSE_VARIABLES:
        _, vectors = np.linalg.eigh(stiff.toarray())
        return list(vectors.T[: 2 * count + 2])
    values, vectors = eigsh(stiff, few, sigma=0.0, which="LM", v0=np.ones(n))
    return list(vectors.T[::-1]) if values[0] > values[-1] else list(vectors.T)


def cut_off(far: Floats, size: float) -> int:
    """How many motions, of whose furthest corners these are the distances (k,) [mm], are shown where nothing stops them."""
    gone = far > MAX_SHOWN_TRAVEL * size
    return max(1, int(gone.argmax())) if gone.any() else len(far)


def picked(count: int) -> Ints:
    """Which of so many motions are shown."""
    return np.unique(np.linspace(0, count - 1, FRAMES_PER_SIDE).round().astype(int))
