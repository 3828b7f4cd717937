"""Still pictures into files."""

from __future__ import annotations

from pathlib import Path

from wiggleroom.files import write_whole
from wiggleroom.report.pictures.file_endings import STILLS, check_ending, ending


def write_still(svg: str, path: Path) -> None:
    """Write a still picture as SVG or, where the name says so, as PNG; whole or not at all.

    Raises
    ------
    InputError
        If the name does not end in .svg or .png.
    """
    check_ending(path, STILLS)
    if ending(path) == ".png":
        from wiggleroom.report.pictures.png import png

        write_whole(path, png(svg))
    else:
        write_whole(path, svg)
