"""Read and write drawings by the extension of their file; the formats are registered here and nowhere else."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from wiggleroom.drawing.limits import check_options
from wiggleroom.drawing.model import Drawing, Part
from wiggleroom.drawing.outlines.file_reading import Reading, sound
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.errors import InputError, go_on
from wiggleroom.files import write_whole

if TYPE_CHECKING:
    from wiggleroom.drawing.writers.lettering import Label

T = TypeVar("T")
Reader = Callable[[Path, "str | None", "float | None", "float | None", ReadOptions], Reading]
Writer = Callable[[Drawing, "Sequence[Label] | None"], str]


def read_drawing(
    path: str | Path,
    *,
    unit: str | None = None,
    flatten: float | None = None,
    gap: float | None = None,
    options: ReadOptions | None = None,
) -> Drawing:
    """Read what a file says, in millimetres and radians.

    Parameters
    ----------
    path : str or Path
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json).
    unit : str, optional
        What one user unit of a drawing is (mm, cm, m, in, px, pt, or units an inch as "90dpi"), whatever the file says.
    flatten : float [mm], optional
        Chord error of curves in a drawing.
    gap : float [mm], optional
        Clearance across every joint, in place of the file's.
    options : ReadOptions, optional
        Which lines of a drawing are read, and how.

    Raises
    ------
    InputError
        With one line per finding.

    Examples
    --------
    >>> read_drawing("puzzle.pdf")
    Traceback (most recent call last):
    wiggleroom.errors.InputError: puzzle.pdf: ".pdf" files are not read; it must be one of .svg, .dxf, .lbrn2, .lbrn, .json
    """
    return sound(reading(path, unit=unit, flatten=flatten, gap=gap, options=options))


def reading(
    path: str | Path,
    *,
    unit: str | None = None,
    flatten: float | None = None,
    gap: float | None = None,
    options: ReadOptions | None = None,
) -> Reading:
    """The same with everything that is wrong, left out or assumed, and where; see `read_drawing`.

    Raises
    ------
    InputError
        Where there is nothing that could be drawn.
    StoppedError
        If it was asked to stop.
    """
    options = options or ReadOptions()
    check_options(flatten=flatten, gap=gap)
    if options.join is not None and not (math.isfinite(options.join) and options.join >= 0):
        message = f"join is {options.join:g}; it must be 0 mm or more"
        raise InputError(message)
    go_on(options.stop)
    reader = _by_extension(Path(path), READERS, "read")
    return reader(Path(path), unit, flatten, gap, options)


def write_drawing(drawing: Drawing, path: str | Path, *, labels: Sequence[Label] | None = None) -> None:
    """Write `drawing` in the format that the extension names; the file appears whole or not at all.

    Parameters
    ----------
    drawing : Drawing
    path : str or Path
        .svg and .dxf are ready to cut, .json is an assembly file.
    labels : sequence of Label, optional
        What is engraved, apart from what is cut; by default every part's name.

    Raises
    ------
    InputError
        If the extension is not known or the file cannot be written.
    """
    path = Path(path)
    _write(path, _by_extension(path, WRITERS, "written")(drawing, labels))


def write_in_place(
    source: str | Path,
    path: str | Path,
    drawn: Drawing,
    made: Sequence[Part],
    *,
    unit: str | None = None,
    flatten: float | None = None,
    options: ReadOptions | None = None,
) -> None:
    """Write the file in which parts were drawn with the outlines of the parts as they are made; all else in it stays as it is.

    Page, units, places, layers, colours and whatever is engraved are those of the file; a file in which nothing moves is the same.

    Parameters
    ----------
    source : str or Path
        Drawing of a format of `IN_PLACE`.
    path : str or Path
        What is written, of the same format.
    drawn : Drawing
        As it was read, with the same `unit`, `flatten` and `options`.
    made : sequence of Part
        The same parts as they are made.

    Raises
    ------
    InputError
        If the file cannot be written, or draws an outline as a copy that looks otherwise alone.
    """
    write = _by_extension(Path(source), IN_PLACE, "written in place")
    error = flatten or (drawn.flattening.error if drawn.flattening is not None else 0.0)
    _write(Path(path), write(Path(source), drawn.parts, made, error, unit, options or ReadOptions()))


def _write(path: Path, text: str) -> None:
    try:
        write_whole(path, text)
    except OSError as error:
        reason = (error.strerror or "no access").lower()
        remedy = "" if path.parent.is_dir() else "; give a file in a directory that exists"
        message = f"{path}: cannot be written ({reason}){remedy}"
        raise InputError(message) from None


def _by_extension(path: Path, table: Mapping[str, T], done: str) -> T:
    found = table.get(path.suffix.lower())
    if found is None:
        if "\n" in str(path) or str(path).lstrip().startswith(("{", "[", "<")):
            message = "what a file holds was given in place of its name: write it to a file, and give the name of that"
            raise InputError(message)
        kind = f'"{path.suffix}" files are' if path.suffix else "files without extension are"
        message = f"{path}: {kind} not {done}; it must be one of {', '.join(table)}"
        raise InputError(message)
    return found


def _read_svg(path: Path, unit: str | None, flatten: float | None, gap: float | None, options: ReadOptions) -> Reading:
    from wiggleroom.drawing.outlines.parts import reading_of
    from wiggleroom.drawing.readers.svg import svg_artwork

    return reading_of(svg_artwork(path, unit, options.stop), options, flatten=flatten, gap=gap)


def _read_dxf(path: Path, unit: str | None, flatten: float | None, gap: float | None, options: ReadOptions) -> Reading:
    from wiggleroom.drawing.outlines.parts import reading_of
    from wiggleroom.drawing.readers.dxf import dxf_artwork

    return reading_of(dxf_artwork(path, unit, options.stop), options, flatten=flatten, gap=gap)


def _read_lightburn(
    path: Path, unit: str | None, flatten: float | None, gap: float | None, options: ReadOptions
) -> Reading:
    from wiggleroom.drawing.outlines.parts import reading_of
    from wiggleroom.drawing.readers.lightburn import lightburn_artwork

    return reading_of(lightburn_artwork(path, unit, options.stop), options, flatten=flatten, gap=gap)


def _read_assembly(
    path: Path, unit: str | None, flatten: float | None, gap: float | None, options: ReadOptions
) -> Reading:
    from wiggleroom.drawing.readers.assembly_file import read_assembly

    if unit is not None:
        message = f'{path.name}: an assembly file says its own unit; change "unit" in it'
        raise InputError(message)
    drawing = read_assembly(path)
    useless = [("flatten", flatten), ("only", options.only), ("skip", options.skip), ("join", options.join)]
    notes = [
        f"{path.name}: an assembly file has no curves, layers or open lines; {name} does not matter"
        for name, value in useless
        if value not in (None, ())
    ]
    drawing = replace(drawing, notes=(*drawing.notes, *notes))
    return Reading(drawing if gap is None else replace(drawing, gap=gap))


def _write_svg(drawing: Drawing, labels: Sequence[Label] | None) -> str:
    from wiggleroom.drawing.writers.svg_writer import write_svg

    return write_svg(drawing, labels)


def _write_dxf(drawing: Drawing, labels: Sequence[Label] | None) -> str:
    from wiggleroom.drawing.writers.dxf_writer import write_dxf

    return write_dxf(drawing, labels)


def _svg_in_place(
    path: Path, drawn: Sequence[Part], made: Sequence[Part], error: float, unit: str | None, options: ReadOptions
) -> str:
    from wiggleroom.drawing.readers.source import load
    from wiggleroom.drawing.writers.svg_in_place import svg_in_place

    return svg_in_place(load(path, opening="<", name="drawing"), drawn, made, error, unit, options)


def _lightburn_in_place(
    path: Path, drawn: Sequence[Part], made: Sequence[Part], error: float, unit: str | None, options: ReadOptions
) -> str:
    from wiggleroom.drawing.readers.source import load
    from wiggleroom.drawing.writers.lightburn_in_place import lightburn_in_place

    return lightburn_in_place(load(path, opening="<", name="drawing"), drawn, made, error, unit, options)


def _dxf_in_place(
    path: Path, drawn: Sequence[Part], made: Sequence[Part], error: float, unit: str | None, options: ReadOptions
) -> str:
    from wiggleroom.drawing.writers.dxf_in_place import dxf_in_place

    return dxf_in_place(path, drawn, made, error, unit, options)


def _write_assembly(drawing: Drawing, _: Sequence[Label] | None) -> str:
    from wiggleroom.drawing.writers.assembly_writer import write_assembly
    from wiggleroom.drawing.writers.boxes_writer import write_boxes

    return write_boxes(drawing) if any(part.solid is not None for part in drawing.parts) else write_assembly(drawing)


READERS: dict[str, Reader] = {
    ".svg": _read_svg,
    ".dxf": _read_dxf,
    ".lbrn2": _read_lightburn,
    ".lbrn": _read_lightburn,
    ".json": _read_assembly,
}
WRITERS: dict[str, Writer] = {".json": _write_assembly, ".svg": _write_svg, ".dxf": _write_dxf}
IN_PLACE: dict[str, Callable[[Path, Sequence[Part], Sequence[Part], float, str | None, ReadOptions], str]] = {
    ".svg": _svg_in_place,
    ".dxf": _dxf_in_place,
    ".lbrn2": _lightburn_in_place,
    ".lbrn": _lightburn_in_place,
}
