"""The loosest freedoms of an assembly at rest, each followed to its end both ways."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import eigsh, splu

from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.geometry.bodies import Bodies, corners
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.live.live_result import Mode
from wiggleroom.live.warm_start import TimeBudget, WarmSearch, state_at_rest
from wiggleroom.program.nonlinear_program import Program, build_program
from wiggleroom.program.objectives import ZERO_MOTION, PointMotion, Points
from wiggleroom.search.prepare import Prepared

Floats = NDArray[np.float64]

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
"""Where nothing stops a freedom, it is shown up to this share of the drawing's size."""
MAX_NAMED_PARTS, MIN_NAMED_SHARE = 5, 0.3
"""A freedom names so many parts at most, those that move most, and by at least this share of the farthest."""
MIN_SPARSE_VARIABLES = 12
"""With fewer variables all eigenvectors are worked out."""


def modes(ready: Prepared, body: int | None, count: int, until: TimeBudget) -> tuple[Mode, ...]:
    """Return at most `count` freedoms, loosest first; those that move one body where one is given.

    The walls at rest hold every body as springs would: the stiffness is that of the barrier - sum log h of the rows h.
    Its softest eigenvectors are the directions; the freedom is the largest motion along one, both ways.

    Source: the paper's W (Mind the Gap, section 4.4) with the eigenvector as weights.
    """
    program = build_program(ready.bodies, ready.cells, ZERO_MOTION, length=ready.clearance)
    found: list[tuple[Mode, Floats]] = []
    gone: list[Floats] = []  # directions of the freedoms found: what leads along them is no new one
    for towards in _directions(program, body, count):
        if len(found) == count or until.is_set():
            break
        direction = towards - sum((towards @ g) * g for g in gone)
        if np.linalg.norm(direction) < MIN_INDEPENDENCE * np.linalg.norm(towards):
            continue
        one, far = _end(ready, program, direction, until)
        other, further = _end(ready, program, -direction, until)
        ends = np.concatenate([one[-1].ravel(), other[-1].ravel()])
        long = np.linalg.norm(ends)
        there = _furthest(ready.bodies, one[-1]), _furthest(ready.bodies, other[-1])
        size = np.maximum(*there)
        if size.max() < MIN_AMPLITUDE * ready.clearance:
            continue
        flipped = np.concatenate([other[-1].ravel(), one[-1].ravel()])
        if any(max(ends @ e, flipped @ e) > PARALLEL_COSINE * long * np.linalg.norm(e) for _, e in found):
            continue
        frames = np.concatenate([one, one[-2::-1], other[1:], other[-2::-1]])
        most = [b for b in np.argsort(-size, kind="stable")[:MAX_NAMED_PARTS] if size[b] > MIN_NAMED_SHARE * size.max()]
        names = tuple(ready.assembly.names[p] for b in most for p in ready.bodies.members[b])
        shown = of_parts(ready.assembly, ready.bodies, frames)
        for end in (one[-1], other[-1]):
            along = program.variables(end)
            along = along - sum((along @ g) * g for g in gone)
            if np.linalg.norm(along) > 0:
                gone.append(along / np.linalg.norm(along))
        found.append((Mode(float(size.max()), names, shown, not (far or further)), ends))
    found.sort(key=lambda m: (m[0].ends, -m[0].size))
    return tuple(mode for mode, _ in found)


def _directions(program: Program, body: int | None, count: int) -> list[Floats]:
    """Softest directions (3F,) at rest, in scaled variables: more than asked for, as some lead to the same end."""
    u = np.zeros(len(program.scale))
    at = program.linearise(u)
    data = at.condensed(1.0 / np.maximum(at.h, 1e-9) ** 2, np.zeros(program.rows), share=0.0)
    n = len(u)
    upper = sp.csc_matrix((data, program.pattern.indices, program.pattern.indptr), shape=(n, n))
    stiff = sp.csc_matrix(upper + sp.triu(upper, 1).T)
    soft = STIFFNESS_SHIFT * float(stiff.diagonal().mean())
    stiff = sp.csc_matrix(stiff + soft * sp.eye(n))
    if body is not None:
        loads = np.zeros((n, 3))
        loads[3 * program.slot[body] + np.arange(3), np.arange(3)] = 1.0
        given = splu(stiff).solve(loads)
        _, vectors = np.linalg.eigh(loads.T @ given)
        return list((given @ vectors[:, ::-1]).T)
    few = min(2 * count + 2, n - 1)
    if few < 1 or n < MIN_SPARSE_VARIABLES:
        _, vectors = np.linalg.eigh(stiff.toarray())
        return list(vectors.T[: 2 * count + 2])
    values, vectors = eigsh(stiff, few, sigma=0.0, which="LM", v0=np.ones(n))
    return list(vectors.T[::-1]) if values[0] > values[-1] else list(vectors.T)


def _end(ready: Prepared, program: Program, direction: Floats, until: TimeBudget) -> tuple[Floats, bool]:
    """Motions (k, n, 3) of the bodies from rest to the end of a freedom, and whether that was cut off."""
    weights = (direction / program.scale).reshape(-1, 3)
    weights = weights / np.abs(weights[:, :2]).max(initial=1e-300)
    goal = PointMotion(program.free, weights[:, :2].copy(), np.zeros((len(program.free), 2)), weights[:, 2].copy())
    warm = WarmSearch(ready, goal, state_at_rest(ready), until)
    warm.reach()
    search = warm.search
    still = np.zeros((1, len(ready.bodies.fixed), 3))
    if search.best is None:
        return still, False
    checked = search.checked_path(search.best)
    motions, safe = checked.motions()[: checked.certain], OVERLAP_TOLERANCE * ready.size
    if search.unlimited:
        far = np.array([_furthest(ready.bodies, m).max() for m in motions]) > MAX_SHOWN_TRAVEL * ready.size
        motions = motions[: max(1, int(far.argmax()))] if far.any() else motions
    pick = np.unique(np.linspace(0, len(motions) - 1, FRAMES_PER_SIDE).round().astype(int))
    shown = [m for m in motions[pick] if overlaps(ready.bodies, m, ready.ignored).deepest <= safe]
    return np.concatenate([still, shown[1:]]) if len(shown) > 1 else still, search.unlimited


def _furthest(bodies: Bodies, motion: Floats) -> Floats:
    """How far the furthest corner of each body is moved (n,) [mm]."""
    body, spot = corners(bodies)
    moved = Points(body, spot - bodies.rest[body, :2]).moved(motion)
    out = np.zeros(len(bodies.fixed))
    np.maximum.at(out, body, np.hypot(*moved.T))
    return out
