"""Read a DXF drawing: its lines, curves and texts [mm]."""

from __future__ import annotations

from pathlib import Path

from wiggleroom.drawing.readers.dxf_file import load_dxf, scale_of
from wiggleroom.drawing.readers.dxf_walk import DxfWalk
from wiggleroom.drawing.strokes.elements import Artwork
from wiggleroom.errors import InputError, Stop, StoppedError, go_on


def dxf_artwork(path: str | Path, unit: str | None = None, stop: Stop | None = None) -> Artwork:
    """Strokes and texts of a DXF drawing, text or binary, of any version from R12 on.

    Parameters
    ----------
    path : str or Path
    unit : str, optional
        What one unit is (mm, cm, m, in, px), whatever the file says.
    stop : optional
        Asked before every element, once ezdxf has read the file.

    Raises
    ------
    InputError
        With one line per finding.
    MissingExtraError
        If ezdxf is not installed.
    """
    file = load_dxf(Path(path))
    scale, assumed = scale_of(file, unit)
    go_on(stop)
    walk = DxfWalk(file.name, file.document, scale, stop)
    try:
        walk.run()
    except (InputError, StoppedError):
        raise
    except Exception:  # tables and layouts of a damaged file
        message = f"{file.name}: is damaged; export it again"
        raise InputError(message) from None
    notes = [*assumed, *file.notes]
    if walk.hidden:
        notes.append(f"{file.name}: layers that are off or frozen are left out: {', '.join(sorted(walk.hidden))}")
    return Artwork(
        file=file.name,
        strokes=tuple(walk.strokes),
        texts=tuple(walk.texts),
        notes=tuple(notes),
        findings=tuple(walk.findings),
        left_out=tuple(walk.left_out.items()),
    )
