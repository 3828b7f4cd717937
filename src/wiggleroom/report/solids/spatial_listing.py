"""Parts in space as they are read: table, JSON and an exploded picture with names."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wiggleroom.report.results.table import columns
from wiggleroom.report.solids.exploded_view import exploded_offsets
from wiggleroom.report.solids.spatial_picture import write_moved_parts
from wiggleroom.schema.spatial_result_schema import SpatialPartListing, SpatialPartsResult
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
from wiggleroom.spatial.solids.spatial_model import Boxes, Plate, SpatialAssembly

if TYPE_CHECKING:
    from rich.table import Table

SPREAD = 1.2
"""Parts are drawn further from the middle by this share of their distance from it."""


def spatial_parts_result(assembly: SpatialAssembly, command: str = "") -> SpatialPartsResult:
    """Everything `parts --json` says; lengths in mm, volumes in mm3."""
    return SpatialPartsResult(
        parts=_entries(assembly), notes=list(assembly.drawing.notes), findings=[], command=command
    )


def spatial_parts_table(assembly: SpatialAssembly) -> Table:
    """Page that `parts` prints: size of the box round each part at rest, place, volume, and kind of solid."""
    found = columns("part", "dx mm", "dy mm", "dz mm", "x mm", "y mm", "z mm", "volume mm3", words="solid")
    for entry in _entries(assembly):
        numbers = (f"{value:.2f}" for value in (*entry.size, *entry.at, entry.volume))
        found.add_row(entry.name + (" (fixed)" if entry.fixed else ""), *numbers, entry.solid)
    return found


def draw_spatial_parts(assembly: SpatialAssembly, path: Path) -> None:
    """Write an exploded picture with the names of the parts; .svg, .png or .glb.

    Raises
    ------
    InputError
        If the name has another ending.
    """
    motion = np.zeros((len(assembly.parts), 6))
    motion[:, :3] = SPREAD * exploded_offsets(assembly)
    lines = [f"{len(assembly.parts)} parts, gap {assembly.gap:g} mm", "drawn apart; dashed: where they belong"]
    write_moved_parts(assembly, motion, path, lines, names=assembly.names)


def _entries(assembly: SpatialAssembly) -> list[SpatialPartListing]:
    """All parts as drawn: no gap is taken off, of a single joint neither."""
    found = []
    drawn = assemble_spatial(replace(assembly.drawing, gaps=()), gap=0.0).made
    for part, made, at in zip(assembly.parts, drawn, assembly.reference, strict=True):
        size = np.ptp(made.surface.vertices @ part.R.T, axis=0).round(9)
        found.append(
            SpatialPartListing(
                name=part.name,
                solid="plate"
                if isinstance(part.solid, Plate)
                else "boxes"
                if isinstance(part.solid, Boxes)
                else "mesh",
                at=tuple(at.tolist()),
                size=tuple(size.tolist()),
                volume=float(made.volume),
                pieces=len(made.pieces),
                fixed=part.fixed,
                lock=sorted(part.lock),
            )
        )
    return found
