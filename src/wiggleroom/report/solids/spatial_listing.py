"""Parts in space as they are read: table, JSON and an exploded picture with names."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Drawing, Plate, Surface
from wiggleroom.drawing.units import millimetres
from wiggleroom.errors import InputError
from wiggleroom.report.results.table import columns
from wiggleroom.report.solids.exploded_view import exploded_offsets
from wiggleroom.report.solids.spatial_picture import Shown, write_moved_parts
from wiggleroom.schema.spatial_result_schema import SpatialPartListing, SpatialPartsResult
from wiggleroom.spatial.solids.made_solids import made_solid
from wiggleroom.spatial.solids.mesh_file import MeshFiles
from wiggleroom.spatial.solids.solid_boolean import centroid_of, require_solid_library

if TYPE_CHECKING:
    from rich.table import Table

Floats = NDArray[np.float64]

SPREAD = 1.2
"""Parts are drawn further from the middle by this share of their distance from it."""


def spatial_parts_result(entries: list[SpatialPartListing], notes: list[str], command: str = "") -> SpatialPartsResult:
    """Everything `parts --json` says; lengths in mm, volumes in mm3."""
    return SpatialPartsResult(parts=entries, notes=notes, findings=[], command=command)


def spatial_parts_table(entries: list[SpatialPartListing]) -> Table:
    """Page that `parts` prints: size of the box round each part at rest, place, volume, and kind of solid."""
    found = columns("part", "dx mm", "dy mm", "dz mm", "x mm", "y mm", "z mm", "volume mm3", words="solid")
    for entry in entries:
        numbers = (f"{value:.2f}" for value in (*entry.size, *entry.at, entry.volume))
        found.add_row(entry.name + (" (fixed)" if entry.fixed else ""), *numbers, entry.solid)
    return found


def draw_spatial_parts(assembly: Assembly, path: Path) -> None:
    """Write an exploded picture with the names of the parts; .svg, .png or .glb.

    Raises
    ------
    InputError
        If the name has another ending.
    """
    motion = np.zeros((len(assembly.parts), 6))
    motion[:, :3] = SPREAD * exploded_offsets(assembly)
    lines = [f"{len(assembly.parts)} parts, gap {assembly.gap:g} mm", "drawn apart; dashed: where they belong"]
    write_moved_parts(assembly, motion, path, lines, Shown(names=assembly.names))


def drawn_parts(drawing: Drawing) -> list[SpatialPartListing]:
    """All parts as drawn: no gap is taken off, of a single joint neither, and meshes are not cut into pieces.

    Raises
    ------
    InputError
        Where plates or boxes make no solid.
    """
    found: list[SpatialPartListing] = []
    wrong: list[str] = []
    for part in drawing.parts:
        if isinstance(part.solid, Surface):
            surface, pieces = part.solid, None
        else:
            made, findings = made_solid(part, 0.0)
            wrong += [f'{drawing.source or "assembly"}: part "{part.name}" {line}' for line in findings]
            if made is None:
                continue
            surface, pieces = made.surface, len(made.pieces)
        kind: Literal["plate", "boxes", "mesh"] = "plate" if isinstance(part.solid, Plate) else "boxes"
        entry = _entry(part.name, surface, part.R, np.array(part.at))
        found.append(
            msgspec.structs.replace(
                entry, solid=kind if pieces else "mesh", pieces=pieces, fixed=part.fixed, lock=sorted(part.lock)
            )
        )
    if wrong:
        raise InputError(wrong)
    return found


def drawn_bodies(path: Path, unit: str | None = None) -> tuple[list[SpatialPartListing], list[str]]:
    """Bodies of a mesh file by the names that an assembly file calls them by, and notes; not cut into pieces.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    require_solid_library()
    bodies, notes = MeshFiles(millimetres(unit or "mm")).bodies(path)
    return [_entry(f"{path.name}{body}", surface, np.eye(3), np.zeros(3)) for body, surface in bodies.items()], notes


def _entry(name: str, surface: Surface, R: Floats, at: Floats) -> SpatialPartListing:
    """A mesh as drawn, turned by R and moved by `at` [mm]."""
    volume, centroid = centroid_of(surface)
    return SpatialPartListing(
        name=name,
        solid="mesh",
        at=tuple((at + R @ centroid).tolist()),
        size=tuple(np.ptp(surface.vertices @ R.T, axis=0).round(9).tolist()),
        volume=volume,
        pieces=None,
        fixed=False,
        lock=[],
    )
