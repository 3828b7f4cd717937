"""A proof as a file: outlines, regions with the chords that show them, cuts of turns and multipliers."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, place
from wiggleroom.bound.joint_constraints import AngleRanges, JointConstraints
from wiggleroom.bound.proof_steps import ProofNode
from wiggleroom.bound.window_bounds import WindowProof
from wiggleroom.drawing.model import Part
from wiggleroom.freespace.outer.caging_surface import CagingSurface
from wiggleroom.program.objectives import PointMotion
from wiggleroom.search.prepare import Survey

Floats = NDArray[np.float64]

FORMAT = "wiggleroom.certificate/4"
ABOVE = 1e-12
"""A bound is stated larger by this share, so that whoever works it out with other rounding does not come out above it."""


@dataclass(frozen=True, eq=False)
class ProvenBound:
    """A bound, by what it was proven: motions worth no more than `cut` are left out, windows and a tree of cases see to the others."""

    cut: float
    windows: list[WindowProof]
    tree: ProofNode


def certificate(
    surveyed: Survey,
    assembly: Assembly,
    joints: JointConstraints,
    regions: list[CagingSurface],
    goal: PointMotion,
    ranges: AngleRanges,
    proven: ProvenBound,
) -> dict[str, Any]:
    """What `wiggleroom verify` reads; lengths in mm, angles in radians."""
    them = surveyed.bodies
    used = sorted({*them.body_of.tolist()})
    held = np.isfinite(ranges.far)
    bound = max(proven.cut, proven.tree.bound())
    out: dict[str, Any] = {
        "format": FORMAT,
        "gap": float(assembly.gap),
        "turns": bool((goal.direction == 0).all()),
        "at_most": float(bound + ABOVE * max(abs(bound), surveyed.clearance)),
        "worth": float(proven.cut),
        "bodies": [
            {
                "parts": [assembly.names[p] for p in them.members[b]],
                "fixed": bool(them.fixed[b]),
                "origin": them.rest[b, :2].tolist(),
                "polygons": _polygons([assembly.parts[p] for p in them.members[b]]),
                "low": float(ranges.low[b]) if held[b] else None,
                "high": float(ranges.high[b]) if held[b] else None,
                "far": float(ranges.far[b]) if held[b] else None,
            }
            for b in used
        ],
        "goal": [
            [int(b), *d.tolist(), *(them.rest[b, :2] + arm).tolist(), float(t)]
            for b, d, arm, t in zip(goal.body, goal.direction, goal.arm, goal.turn, strict=True)
        ],
        "regions": [_region(s) for s in regions],
        "pairs": [
            [int(a), int(b), int(k), *(them.rest[a, :2] + arm).tolist(), float(axes)]
            for a, b, k, arm, axes in zip(joints.a, joints.b, joints.kind, joints.arm_a, joints.axes, strict=True)
        ],
        "windows": [_window(w) for w in proven.windows],
        "proof": proven.tree.record(),
    }
    return out | {"sha256": fingerprint(out)}


def fingerprint(content: dict[str, Any]) -> str:
    """SHA-256 of all that a certificate says, apart from this."""
    return hashlib.sha256(json.dumps({k: v for k, v in content.items() if k != "sha256"}).encode()).hexdigest()


def _polygons(parts: Sequence[Part]) -> list[list[list[list[float]]]]:
    """Outer ring and holes of each polygon of a body, as drawn where that is one, without the closing corner.

    Not the outlines that congruent bodies share, which may differ from these in their last digits: others compare them with the drawing.
    """
    regions = [
        [place(ring, part.at) for ring in (region.outer, *region.holes)] for part in parts for region in part.regions
    ]
    if len(regions) > 1:
        union = shapely.orient_polygons(shapely.union_all([shapely.Polygon(r[0], r[1:]) for r in regions]))
        pieces = shapely.get_parts(union)
        regions = [[shapely.get_coordinates(r)[:-1] for r in (p.exterior, *p.interiors)] for p in pieces]
    return [[ring.tolist() for ring in rings] for rings in regions]


def _window(proof: WindowProof) -> dict[str, Any]:
    """A window, first ranges, steps, and what they say of turns against its first body in all placements."""
    first, last, window = proof.first, proof.last, proof.window
    return {
        "placements": window.placements.tolist(),
        "pairs": window.placed_joints.tolist(),
        "far": first.far.tolist(),
        "steps": [step.record() for step in proof.steps],
        "low": last.low.tolist(),
        "high": last.high.tolist(),
    }


def _region(surface: CagingSurface) -> dict[str, Any]:
    """One caging surface with only the chords that it names."""
    chords = np.vstack([seam.chords for seam in surface.seams])
    a, first = np.unique(chords[:, 0], return_inverse=True)
    b, second = np.unique(chords[:, 1], return_inverse=True)
    ends = np.cumsum([len(seam.chords) for seam in surface.seams])[:-1]
    return {
        "a": surface.crossings.a[a].tolist(),
        "b": surface.crossings.b[b].tolist(),
        "loops": [[float(loop.angle), loop.at.tolist()] for loop in surface.loops],
        "seams": [
            [seam.tracks.tolist(), np.column_stack(named).tolist()]
            for seam, *named in zip(surface.seams, np.split(first, ends), np.split(second, ends), strict=True)
        ],
    }
