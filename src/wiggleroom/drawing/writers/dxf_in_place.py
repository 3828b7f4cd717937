"""Write parts as they are made into the DXF that they were drawn in: layers, colours and all else stay as they are."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from wiggleroom.drawing.model import Part
from wiggleroom.drawing.readers.dxf import walked_dxf
from wiggleroom.drawing.readers.dxf_file import DxfFile, import_ezdxf, load_dxf
from wiggleroom.drawing.readers.dxf_walk import NAME, DxfWalk
from wiggleroom.drawing.strokes.layers import cut_strokes
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.drawing.writers.drawn_rings import Redrawn, redrawn
from wiggleroom.drawing.writers.dxf_writer import dxf_text, without_dates

_LOOKS = ("layer", "color", "true_color", "linetype", "ltscale", "lineweight", "transparency")
"""What an outline takes over from the entity in whose place it stands."""


def dxf_in_place(
    path: Path, drawn: Sequence[Part], made: Sequence[Part], flatten: float, unit: str | None, options: ReadOptions
) -> str:
    """Text of the same file with the outlines of `made` in place of those of `drawn`; blocks that hold outlines are exploded.

    Raises
    ------
    MissingExtraError
        If ezdxf is not installed.
    """
    file = load_dxf(path)
    while True:
        walk, told = _changed(file, drawn, made, flatten, unit, options)
        blocks = {id(insert): insert for (_, insert), _ in told if insert is not None}
        if not blocks:
            break
        for insert in blocks.values():
            _explode(insert)
    for (entity, _), new in told:
        _replace(file.document, entity, new, walk.scale)
    with without_dates(import_ezdxf("written")):
        return dxf_text(file.document)


def _changed(
    file: DxfFile, drawn: Sequence[Part], made: Sequence[Part], flatten: float, unit: str | None, options: ReadOptions
) -> tuple[DxfWalk, list[tuple[tuple[Any, Any], Redrawn]]]:
    """Entities that draw outlines, each with the insert that shows it, and what takes their place."""
    walk, artwork = walked_dxf(file, unit)
    origins = {id(stroke): origin for stroke, origin in zip(walk.strokes, walk.origins, strict=True)}
    strokes = cut_strokes(artwork, options)[0].strokes
    changed = redrawn(strokes, drawn, made, flatten) or []
    return walk, [(origins[id(s)], new) for s, new in zip(strokes, changed, strict=False) if not new.kept]


def _explode(insert: Any) -> None:
    """Draw what a block shows without it; what has its layer and its colour keeps them."""
    layer, colour = insert.dxf.get("layer", "0"), insert.dxf.get("color", 256)
    for entity in insert.explode():
        if entity.dxf.get("layer", "0") == "0":
            entity.dxf.layer = layer
        if entity.dxf.get("color", 256) == 0:
            entity.dxf.color = colour


def _replace(document: Any, entity: Any, new: Redrawn, scale: float) -> None:
    """Put closed polylines in the place of an entity, on its layer, in its colour and in its groups."""
    space = document.modelspace()
    looks = {key: entity.dxf.get(key) for key in _LOOKS if entity.dxf.hasattr(key)}
    groups = [group for _, group in document.groups if entity.dxf.handle in set(group.handles())]
    add = space.add_polyline2d if document.dxfversion <= "AC1009" else space.add_lwpolyline
    lines = [
        add((ring / scale).tolist(), close=True, dxfattribs=looks) for rings in new.rings.values() for ring in rings
    ]
    if entity.has_xdata(NAME) and len(lines) == 1:
        lines[0].set_xdata(NAME, entity.get_xdata(NAME)[1:])
    for group in groups:
        with group.edit_data() as members:
            members[:] = [other for other in members if other is not entity] + lines
    space.delete_entity(entity)
