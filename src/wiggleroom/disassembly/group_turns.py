"""Bodies that turn together, as one rigid group, about the centre of arcs in the drawing, until something leaves straight.

Curved pieces that mesh leave a round channel only so: no slide moves them, and none of them turns alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.audit.audit_outlines import AuditOutlines, outlines
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.disassembly.translation import TranslationEscape, translation_escape
from wiggleroom.errors import Stop
from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.rigid_motions import of_parts
from wiggleroom.search.prepare import Survey

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

MAX_SEARCHED = 6
"""Groups are turned where at most this many bodies are loose."""
MAX_CENTRES = 4
"""So many centres are tried, those of the longest arcs."""
ARC_CORNERS = 6, 12, 24
"""So many corners in a row that lie on one circle are an arc; more where they lie close together."""
ARC_TOLERANCE = 0.05
"""They do so to this share of the clearance."""
MIN_ARC, MAX_CORNER_ANGLE = 0.3, 0.8
"""An arc spans at least the first angle [rad], and the second at most from corner to corner."""
QUANTUM = 2 * np.pi / 48
"""After each such turn it is looked whether something leaves straight."""
SAGITTA = 0.01
"""Waypoints are so near to each other that no chord lies further from its arc than this share of the clearance."""
MAX_WAYPOINTS = 64
"""Waypoints of one quantum, at most."""


@dataclass(frozen=True, eq=False)
class GroupTurn:
    """A path (k, n, 3) [mm, mm, rad] on which some bodies turn about one centre, and what leaves straight at its end."""

    path: Floats
    exit: TranslationEscape


def group_turn(assembly: Assembly, surveyed: Survey, group: Ints, stop: Stop | None = None) -> GroupTurn | None:
    """Turn each loose body about each centre of arcs, either way, with all that it meets on its way; None where nothing leaves.

    Parameters
    ----------
    assembly : Assembly
    surveyed : Survey
        Of the assembly.
    group : (n,) int64
        Bodies of the same number are known not to leave each other.
    stop : optional
        Asked now and then.
    """
    bodies = surveyed.bodies
    loose = np.flatnonzero(~bodies.fixed)
    if not 2 <= len(loose) <= MAX_SEARCHED:
        return None
    parts = outlines(assembly)
    for centre in arc_centres(bodies, surveyed.clearance):
        for sense in (1.0, -1.0):
            tried: set[bytes] = set()
            for body in loose.tolist():
                found = _turned(assembly, surveyed, parts, group, centre, sense, body, tried, stop)
                if found is not None:
                    return found
    return None


def _turned(
    assembly: Assembly,
    surveyed: Survey,
    parts: AuditOutlines,
    group: Ints,
    centre: Floats,
    sense: float,
    body: int,
    tried: set[bytes],
    stop: Stop | None,
) -> GroupTurn | None:
    """One body turned about a centre, with those that it meets, until it meets what stands or is round; groups `tried` are left out."""
    bodies = surveyed.bodies
    ground = int(np.flatnonzero(bodies.fixed)[0])
    who = np.arange(len(bodies.fixed)) == body
    path = np.zeros((1, len(who), 3))
    reach = np.hypot(*(bodies.rest[~bodies.fixed, :2] - centre).T).max()
    step = np.sqrt(8 * SAGITTA * surveyed.clearance / max(reach, surveyed.clearance))
    count = int(np.clip(np.ceil(QUANTUM / step), 2, MAX_WAYPOINTS))
    for _ in range(round(2 * np.pi / QUANTUM)):
        while True:
            if (stop is not None and stop.is_set()) or (bodies.fixed & who).any():
                return None
            piece = _rotated(bodies, path[-1], who, centre, sense * QUANTUM * np.arange(count + 1) / count)
            audit = audit_path(parts, of_parts(assembly, bodies, piece), stop)
            if audit.free:
                break
            pairs = bodies.body_of[np.column_stack([audit.a, audit.b])]
            met = np.unique(pairs[who[pairs].any(axis=1)])
            if who[met].all():  # they meet each other, by rounding
                return None
            who[met] = True
        if len(path) == 1 and who.sum() > 1:
            if who.tobytes() in tried:
                return None
            tried.add(who.tobytes())
        path = np.concatenate([path, piece[1:]])
        out = translation_escape(bodies, path[-1], ground, surveyed.ignored, surveyed.size, group, stop)
        if out is not None:
            return GroupTurn(path, out)
    return None


def _rotated(bodies: Bodies, motion: Floats, who: Bools, centre: Floats, angle: Floats) -> Floats:
    """Motions (k, n, 3): from one of them (n, 3) on, some bodies turn about a centre by some angles (k,)."""
    out = np.repeat(motion[None], len(angle), axis=0)
    arm = (bodies.rest + motion)[who, :2] - centre
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    out[:, who, 0] += (c - 1) * arm[:, 0] - s * arm[:, 1]
    out[:, who, 1] += s * arm[:, 0] + (c - 1) * arm[:, 1]
    out[:, who, 2] += angle[:, None]
    return out


def arc_centres(bodies: Bodies, clearance: float) -> list[Floats]:
    """Centres (2,) [mm] at rest of the arcs of all bodies, those of the longest arcs first, each once.

    Every few corners in a row are fitted with a circle, |p|^2 = 2 c . p + k in the least squares. Source: Kasa, "A circle fitting procedure
    and its error analysis", 1976.
    """
    found: list[tuple[float, Floats]] = []
    for b in range(len(bodies.fixed)):
        for count in ARC_CORNERS:
            arcs = [arc for points in _in_a_row(bodies, b, count) if (arc := _arc(points, clearance)) is not None]
            found += arcs
            if arcs:
                break
    sums: list[tuple[float, Floats]] = []
    for length, centre in found:
        for k, (total, near) in enumerate(sums):
            if np.hypot(*(centre - near)) <= clearance:
                sums[k] = total + length, (total * near + length * centre) / (total + length)
                break
        else:
            sums.append((length, centre))
    return [centre for _, centre in sorted(sums, key=lambda one: -one[0])[:MAX_CENTRES]]


def _in_a_row(bodies: Bodies, b: int, count: int) -> Floats:
    """Corners (k, count, 2) [mm] of a body at rest that follow each other, from each of its k corners on."""
    shapes = bodies.shapes
    begin, end = int(shapes.first[bodies.shape[b]]), int(shapes.first[bodies.shape[b] + 1])
    x, y, turn = bodies.rest[b]
    c, s = np.cos(turn), np.sin(turn)
    at = shapes.corner[begin:end] @ np.array([[c, s], [-s, c]]) + [x, y]
    after = shapes.after[begin:end] - begin
    row = np.empty((len(at), count), dtype=np.int64)
    row[:, 0] = np.arange(len(at))
    for k in range(1, count):
        row[:, k] = after[row[:, k - 1]]
    return at[row]


def _arc(points: Floats, clearance: float) -> tuple[float, Floats] | None:
    """Length and centre (2,) [mm] of the arc on which points (k, 2) lie; None where they lie on none."""
    middle = points.mean(axis=0)
    off = points - middle
    fit, _, rank, _ = np.linalg.lstsq(np.column_stack([2 * off, np.ones(len(off))]), (off**2).sum(axis=1), rcond=None)
    if rank < 3:
        return None
    arm = off - fit[:2]
    step = np.diff(np.unwrap(np.arctan2(arm[:, 1], arm[:, 0])))
    even = (step > 0).all() or (step < 0).all()
    long = abs(step.sum()) >= MIN_ARC and np.abs(step).max() <= MAX_CORNER_ANGLE
    if not (even and long and np.ptp(np.hypot(*arm.T)) <= ARC_TOLERANCE * clearance):
        return None
    return float(np.hypot(*np.diff(points, axis=0).T).sum()), middle + fit[:2]
