"""Read a DXF drawing: its lines, curves and texts [mm]."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from wiggleroom.drawing.readers.dxf_file import DxfFile, load_dxf, scale_of
from wiggleroom.drawing.readers.dxf_walk import DxfWalk
from wiggleroom.drawing.strokes.elements import Artwork, Stroke
from wiggleroom.drawing.strokes.strokes import trace
from wiggleroom.errors import InputError, Stop, StoppedError, go_on


def dxf_artwork(path: str | Path, unit: str | None = None, stop: Stop | None = None) -> Artwork:
    """Strokes and texts of a DXF drawing, text or binary, of any version from R12 on.

    Parameters
    ----------
    path : str or Path
    unit : str, optional
        What one unit is (mm, cm, m, in, px, pt, or units an inch as "90dpi"), whatever the file says.
    stop : optional
        Asked before every element, once ezdxf has read the file.

    Raises
    ------
    InputError
        With one line per finding.
    MissingExtraError
        If ezdxf is not installed.
    """
    return walked_dxf(load_dxf(Path(path)), unit, stop)[1]


def walked_dxf(file: DxfFile, unit: str | None = None, stop: Stop | None = None) -> tuple[DxfWalk, Artwork]:
    """The same with the entity that every stroke comes from; see `dxf_artwork`."""
    walked = cache(lambda scale: _walked(file, scale, stop))
    scale, assumed = scale_of(file, unit, lambda: _sizes(walked(1.0).strokes))
    go_on(stop)
    walk = walked(scale)
    notes = [*assumed, *file.notes]
    if walk.hidden:
        notes.append(f"{file.name}: layers that are off or frozen are left out: {', '.join(sorted(walk.hidden))}")
    artwork = Artwork(
        file=file.name,
        strokes=tuple(walk.strokes),
        texts=tuple(walk.texts),
        notes=tuple(notes),
        findings=tuple(walk.findings),
        left_out=tuple(walk.left_out.items()),
    )
    return walk, artwork


def _walked(file: DxfFile, scale: float, stop: Stop | None) -> DxfWalk:
    """Everything that a file draws, its unit `scale` [mm] long."""
    walk = DxfWalk(file.name, file.document, scale, stop)
    try:
        walk.run()
    except (InputError, StoppedError):
        raise
    except Exception:  # tables and layouts of a damaged file
        message = f"{file.name}: is damaged; export it again"
        raise InputError(message) from None
    return walk


def _sizes(strokes: Sequence[Stroke]) -> list[float]:
    """Longer sides of all strokes together and of each."""
    points = [np.array(trace(path, 4)) for stroke in strokes for path in stroke.paths]
    if not points:
        return [math.inf, math.inf]
    return [max(np.ptp(found.real), np.ptp(found.imag)) for found in (np.concatenate(points), *points)]
