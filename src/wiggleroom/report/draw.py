"""Pictures into files."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from wiggleroom.analysis.answer import Answer
from wiggleroom.errors import InputError
from wiggleroom.files import write_whole
from wiggleroom.report.picture import picture


def draw(answer: Answer, path: str | PathLike[str]) -> None:
    """Write the picture of an answer.

    Raises
    ------
    InputError
        If the name does not end in .svg or .png.
    """
    write_svg(picture(answer), Path(path))


def write_svg(svg: str, path: Path) -> None:
    """Write a picture as SVG or, where the name says so, as PNG; whole or not at all.

    Raises
    ------
    InputError
        If the name does not end in .svg or .png.
    """
    if path.suffix.lower() == ".png":
        from wiggleroom.report.png import png

        write_whole(path, png(svg))
    elif path.suffix.lower() == ".svg":
        write_whole(path, svg)
    else:
        finding = f"picture {path}: the name must end in .svg or .png"
        raise InputError(finding)
