"""Read a DXF drawing: closed outlines, and loose edges joined to such, become parts [mm]."""

from __future__ import annotations

from pathlib import Path

from wiggleroom.drawing.dxf_file import load_dxf, scale_of
from wiggleroom.drawing.dxf_outlines import shapes_of
from wiggleroom.drawing.dxf_walk import DxfWalk
from wiggleroom.drawing.limits import check_options
from wiggleroom.drawing.model import Drawing
from wiggleroom.drawing.parts import drawing_of
from wiggleroom.errors import InputError


def read_dxf(
    path: str | Path, *, unit: str | None = None, flatten: float | None = None, gap: float | None = None
) -> Drawing:
    """Parts of a DXF drawing, text or binary, of any version from R12 on.

    Parameters
    ----------
    path : str or Path
    unit : str, optional
        What one unit is (mm, cm, m, in, px), whatever the file says.
    flatten : float [mm], optional
        Chord error of curves; by default gap / 50, or 1e-4 of the median part size where the gap is 0.
    gap : float [mm], optional
        Clearance across every joint; a drawing itself has none.

    Raises
    ------
    InputError
        With one line per finding.
    MissingExtraError
        If ezdxf is not installed.
    """
    check_options(flatten=flatten, gap=gap)
    file = load_dxf(Path(path))
    scale, assumed = scale_of(file, unit)
    walk = DxfWalk(file.name, file.document, scale)
    try:
        walk.run()
    except InputError:
        raise
    except Exception:  # tables and layouts of a damaged file
        message = f"{file.name}: is damaged; export it again"
        raise InputError(message) from None
    shapes, notes = shapes_of(walk)
    return drawing_of(
        file.name,
        shapes,
        walk.findings,
        notes=(*assumed, *file.notes, *notes),
        left_out=walk.left_out,
        flatten=flatten,
        gap=gap,
    )
