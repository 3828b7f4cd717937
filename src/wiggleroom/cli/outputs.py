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

STILLS = (".svg", ".png")
PICTURES = (*STILLS, ".gif", ".mp4", ".html")


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Outputs:
    """Where the answer goes besides the terminal.

    Parameters
    ----------
    json
        Write the answer as JSON to this file; - is stdout, which then holds nothing else.
    picture
        Show the answer in this file: .svg or .png a picture, .gif, .mp4 or .film.svg a film, .html a report with all.
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
    MissingExtraError
        If a film needs a library that is not installed.
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
    for place, _ in places.values():
        if place is not None and Path(place).suffix.lower() in (".gif", ".mp4"):
            from wiggleroom.report.film_frames import see_library

            see_library(Path(place).suffix.lower())


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
    """Answer as JSON and as a picture, film or report, where they are asked for."""
    from wiggleroom.cli.say import note
    from wiggleroom.report.records import flex_record

    if outputs.json is not None:
        write_record(flex_record(answer), outputs.json)
    if outputs.picture is not None:
        from wiggleroom.cli.watch import bar
        from wiggleroom.report.draw import draw

        with bar("film") as count:
            draw(answer, outputs.picture, progress=count)
        note(f"picture: {outputs.picture}")


def write_record(record: dict[str, Any], place: str) -> None:
    """Record as JSON to a file, or to stdout where the place is "-"."""
    from wiggleroom.cli.say import note
    from wiggleroom.files import write_whole
    from wiggleroom.report.records import to_json

    text = to_json(record)
    if place == "-":
        sys.stdout.write(text)
    else:
        write_whole(place, text)
        note(f"answer: {place}")


def write_picture(made: str, path: Path) -> None:
    """Still picture as SVG or, where the name says so, as PNG; a page as HTML."""
    from wiggleroom.cli.say import note
    from wiggleroom.report.draw import write_svg

    if path.suffix.lower() == ".html":
        from wiggleroom.files import write_whole

        write_whole(path, made)
    else:
        write_svg(made, path)
    note(f"picture: {path}")
