"""Assemblies in space and what was found about them, as the page reads it: the words and numbers of its protocol."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, corners_at
from wiggleroom.drawing.model import Drawing
from wiggleroom.report.page.page_messages import design_message
from wiggleroom.report.page.solid_page import packed
from wiggleroom.report.solids.exploded_view import exploded_offsets
from wiggleroom.report.solids.spatial_path import along_path, with_quaternions
from wiggleroom.schema.replies import Opened, PartShape, Solids, SolidShape

Floats = NDArray[np.float64]

MAX_FRAMES = 64
"""Frames of a path."""
MAX_FRAME_MOTIONS = 60_000
"""Motions of parts in all frames of a path together; at least two frames."""


def spatial_opened(drawing: Drawing, assembly: Assembly, name: str) -> Opened:
    """An assembly in space and what it asks; solids as they are in `assembly`."""
    reference = assembly.reference
    corners = np.vstack([corners_at(part) for part in assembly.parts])
    (x0, y0, _), (x1, y1, _) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return Opened(
        name=name,
        gap=drawing.gap,
        notes=list(drawing.notes),
        size=(x0, y0, x1, y1),
        parts=[
            PartShape(part.name, (float(at[0]), float(at[1]), 0.0), [])
            for part, at in zip(assembly.parts, reference, strict=True)
        ],
        ignore=list(drawing.ignore),
        design=design_message(drawing),
        dimension=3,
        solids=solids_message(assembly),
    )


def solids_message(assembly: Assembly) -> Solids:
    """Surfaces about their reference points; parts that are alike share theirs."""
    reference = assembly.reference
    shapes: list[SolidShape] = []
    of: list[int] = []
    known: dict[tuple[int, bytes], int] = {}
    for part, made, at in zip(assembly.parts, assembly.solids, reference, strict=True):
        key = (id(made), part.R.tobytes())
        if key not in known:
            known[key] = len(shapes)
            world = made.surface.vertices @ part.R.T + part.at
            shapes.append(SolidShape(packed(world - at, "<f4"), packed(made.surface.faces, "<u4")))
        of.append(known[key])
    aside = exploded_offsets(assembly)
    return Solids(shapes, of, _triples(reference), _triples(aside))


def _triples(points: Floats) -> list[tuple[float, float, float]]:
    return [(float(x), float(y), float(z)) for x, y, z in points]


def spatial_frames(assembly: Assembly, points: Floats) -> Floats:
    """Motions (k, n, 7) along a path (m, n, 6), evenly along it: displacements [mm] and quaternions x, y, z, w.

    Between two frames positions go straight and turns about one constant axis, as between waypoints; the first and the last of
    the path are as they are.
    """
    if len(points) == 1:
        return with_quaternions(points)
    most = max(2, min(MAX_FRAMES, MAX_FRAME_MOTIONS // max(1, len(assembly.parts))))
    return with_quaternions(along_path(assembly, points, np.linspace(0.0, 1.0, most)))
