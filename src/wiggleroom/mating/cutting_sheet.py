"""Panels of a cutting sheet, read like any drawing."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

import shapely
from shapely import affinity

from wiggleroom.drawing.read import reading
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.errors import InputError

CHORD_ERROR = 0.01
"""Chord error of curves on a sheet [mm]."""
OPEN_ENDS = 0.2
"""Open ends of an outline nearer than this [mm] are joined: panels on a sheet lie further apart."""
MIN_PANEL_AREA = 1.0
"""Outlines that enclose less than this [mm2] are no panels."""
BURN_TEXT = re.compile(r"burn: *(\d+(?:\.\d+)?) ?mm")


@dataclass(frozen=True, eq=False)
class Outlined:
    """One panel as it is drawn.

    Parameters
    ----------
    name : str
        Unique on its sheet.
    polygon : shapely.Polygon [mm]
        Material on the sheet, y up, holes cut out.
    """

    name: str
    polygon: shapely.Polygon


@dataclass(frozen=True, eq=False)
class CuttingSheet:
    """Everything a sheet says.

    Parameters
    ----------
    panels : tuple of Outlined
    burn : float [mm], optional
        Half of the cut's width, by which outlines were drawn larger, where the sheet says so.
    notes : tuple of str
    source : str
        The file's name.
    """

    panels: tuple[Outlined, ...]
    burn: float | None = None
    notes: tuple[str, ...] = ()
    source: str = ""


def read_sheet(path: str | Path, *, unit: str | None = None, options: ReadOptions | None = None) -> CuttingSheet:
    """Panels of a cutting sheet; what is wrong with a drawing as an assembly, such as touching parts, does not matter here.

    Parameters
    ----------
    path : str or Path
        A drawing, or an assembly file in the plane.
    unit : str, optional
        What one user unit is (mm, cm, m, in, px, pt, or units an inch as "90dpi"), whatever the file says.
    options : ReadOptions, optional
        What is read of a drawing, and how far open ends are joined: by default up to `OPEN_ENDS`.

    Raises
    ------
    InputError
        With one line per finding.
    """
    path = Path(path)
    drawn = path.suffix.lower() != ".json"
    options = options or ReadOptions()
    if drawn and options.join is None:
        options = replace(options, join=OPEN_ENDS)
    read = reading(path, unit=unit, flatten=CHORD_ERROR if drawn else None, options=options)
    notes = [*read.drawing.notes, *read.findings]
    panels, specks = [], 0
    for part in read.drawing.parts:
        pieces = [shapely.Polygon(region.outer, region.holes) for region in part.regions]
        sound = [piece for piece in map(_valid, pieces) if piece.area > MIN_PANEL_AREA]
        specks += len(pieces) - len(sound)
        x, y, angle = part.at
        for k, piece in enumerate(sound, 1):
            placed = affinity.translate(affinity.rotate(piece, angle, origin=(0, 0), use_radians=True), x, y)
            panels.append(Outlined(part.name if len(sound) == 1 else f"{part.name} {k}", placed))
    if not panels:
        raise InputError([*read.findings] or [f"{path.name}: has no closed outline; every panel must be closed"])
    if specks:
        notes.append(f"{path.name}: {specks} outlines of less than {MIN_PANEL_AREA:g} mm2 are left out")
    burn = _burn(path)
    if burn is not None:
        notes.append(f"{path.name}: says that burn is {burn:g} mm")
    return CuttingSheet(tuple(panels), burn, tuple(notes), path.name)


def check_burn(sheet: CuttingSheet, burn: float) -> None:
    """Check that every panel is there still once the burn [mm] is taken off.

    Raises
    ------
    InputError
        With one line for each that is not.
    """
    gone = [p.name for p in sheet.panels if shapely.buffer(p.polygon, -burn, join_style="mitre").is_empty]
    if gone:
        raise InputError(
            [f'{sheet.source}: panel "{name}" is used up by a burn of {burn:g} mm; it must be less' for name in gone]
        )


def _valid(polygon: shapely.Polygon) -> shapely.Polygon:
    """Polygon, or the largest piece of what a faulty one encloses."""
    if polygon.is_valid:
        return polygon
    pieces = [piece for piece in shapely.get_parts(shapely.make_valid(polygon)) if piece.geom_type == "Polygon"]
    return max(pieces, key=lambda piece: piece.area, default=shapely.Polygon())


def _burn(path: Path) -> float | None:
    """Burn that boxes.py writes beside its reference bar [mm]."""
    if path.suffix.lower() != ".svg":
        return None
    found = BURN_TEXT.search(path.read_text(encoding="utf-8", errors="replace"))
    return float(found[1]) if found else None
