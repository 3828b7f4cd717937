"""Where results go: looked at before the long work, written whole after it."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

if TYPE_CHECKING:
    from wiggleroom.analysis.answer import Answer

PICTURES = (".svg", ".png")


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Outputs:
    """Where the answer goes besides the terminal.

    Parameters
    ----------
    json
        Write the answer as JSON to this file; - is stdout, which then holds nothing else.
    picture
        Draw the answer to this file: .svg or .png.
    """

    json: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None
    picture: Path | None = None


def check(source: str, places: dict[str, tuple[str | Path | None, tuple[str, ...]]]) -> None:
    """See that every output can be written: a known ending, a folder that is there, never over the source.

    Parameters
    ----------
    source : str
        The file that is read.
    places : dict
        By the name of the option: where it goes (None: nowhere, "-": stdout), and the endings it may have (none: any).

    Raises
    ------
    InputError
        With one line for each that cannot.
    """
    from wiggleroom.errors import InputError

    wrong = []
    for option, (place, endings) in places.items():
        if place is None or place == "-":
            continue
        problem = _problem(Path(place), source, endings)
        if problem:
            wrong.append(f"{option} {place}: {problem}")
    if wrong:
        raise InputError(wrong)


def _problem(path: Path, source: str, endings: tuple[str, ...]) -> str:
    """Say what is wrong with an output path, or nothing."""
    if endings and path.suffix.lower() not in endings:
        return f"the name must end in {' or '.join(endings)}"
    if path.is_dir():
        return "this is a folder; give the name of a file"
    if not path.parent.is_dir():
        return f"there is no folder {path.parent}; make it first"
    if not os.access(path if path.exists() and not path.is_file() else path.parent, os.W_OK):
        return f"the folder {path.parent} cannot be written"
    if path.exists() and os.path.exists(source) and path.samefile(source):
        return "this would overwrite the file that is read; give another name"
    return ""


def write(answer: Answer, outputs: Outputs) -> None:
    """Answer as JSON and as a picture, where they are asked for."""
    from wiggleroom.report.records import flex_record

    if outputs.json is not None:
        write_record(flex_record(answer), outputs.json)
    if outputs.picture is not None:
        from wiggleroom.report.picture import picture

        write_picture(picture(answer), outputs.picture)


def write_record(record: dict[str, Any], place: str) -> None:
    """Record as JSON to a file, or to stdout where `place` is -."""
    from wiggleroom.cli.say import note
    from wiggleroom.report.files import write_whole
    from wiggleroom.report.records import to_json

    if place == "-":
        sys.stdout.write(to_json(record))
    else:
        write_whole(place, to_json(record))
        note(f"answer: {place}")


def write_picture(svg: str, path: Path) -> None:
    """Picture as SVG or, where the name says so, as PNG."""
    from wiggleroom.cli.say import note
    from wiggleroom.report.draw import write_svg

    write_svg(svg, path)
    note(f"picture: {path}")
