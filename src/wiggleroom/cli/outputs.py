"""Where results go: looked at before the long work, written whole after it."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from cyclopts import Parameter

from wiggleroom.cli.options import RESULTS
from wiggleroom.report.endings import ANSWERS, PAGE, STUDIES, ending, unlike

if TYPE_CHECKING:
    from msgspec import Struct
    from rich.console import RenderableType

    from wiggleroom.report.draw_study import Study
    from wiggleroom.search.answer import Answer

Text = Annotated[str | None, Parameter(allow_leading_hyphen=True)]


@Parameter(name="*", group=RESULTS)
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

    ENDINGS: ClassVar[tuple[str, ...]] = ANSWERS
    json: Text = None
    picture: Path | None = None

    def check(self, source: str, **more: tuple[Path | None, tuple[str, ...]]) -> None:
        """See that everything asked for can be written; see the function `check`."""
        check(source, {"--json": (self.json, ()), "--picture": (self.picture, self.ENDINGS)} | more)


@Parameter(name="*", group=RESULTS)
@dataclass(frozen=True, kw_only=True)
class StudyOutputs(Outputs):
    """Where what was found goes besides the terminal.

    Parameters
    ----------
    json
        Write what was found as JSON to this file; - is stdout, which then holds nothing else.
    picture
        Show what was found in this file: .svg or .png a picture, .html a report with all.
    """

    ENDINGS: ClassVar[tuple[str, ...]] = STUDIES
    json: Text = None
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
        if place is not None and ending(Path(place)) in (".gif", ".mp4"):
            from wiggleroom.report.film_frames import see_library

            see_library(ending(Path(place)))


def _problem(path: Path, source: str, endings: tuple[str, ...]) -> str:
    """Say what is wrong with an output path, or nothing."""
    odd = unlike(path, endings)
    if odd:
        return odd
    if path.is_dir():
        return "this is a folder; give the name of a file"
    if not path.parent.is_dir():
        return f"there is no folder {path.parent}; make it first"
    if not os.access(path if path.exists() and not path.is_file() else path.parent, os.W_OK):
        return f"the folder {path.parent} cannot be written"
    if path.exists() and os.path.exists(source) and path.samefile(source):
        return "this would overwrite the file that is read; give another name"
    return ""


def tell(
    outputs: Outputs,
    result: Callable[[], Struct],
    page: Callable[[], RenderableType],
    found: Answer | Study,
    command: str,
) -> None:
    """What was found as JSON, as a page on stdout (unless the JSON goes there), and as a picture."""
    if outputs.json is not None:
        write_result(result(), outputs.json)
    if outputs.json != "-":
        from wiggleroom.cli.say import show

        show(page())
    if outputs.picture is not None:
        from wiggleroom.cli.say import note
        from wiggleroom.cli.watch import bar
        from wiggleroom.report.draw import draw

        with bar("frames", "drawing") as count:
            draw(found, outputs.picture, command=command, progress=count)
        note(f"picture: {outputs.picture}")


def write_result(result: Struct | dict[str, Any], place: str) -> None:
    """Result as JSON to a file, or to stdout where the place is "-"."""
    from wiggleroom.cli.say import note
    from wiggleroom.files import write_whole
    from wiggleroom.report.records import to_json

    text = to_json(result)
    if place == "-":
        sys.stdout.write(text)
    else:
        write_whole(place, text)
        note(f"answer: {place}")


def write_picture(made: str, path: Path) -> None:
    """Still picture as SVG or, where the name says so, as PNG; a page as HTML."""
    from wiggleroom.cli.say import note
    from wiggleroom.files import write_whole
    from wiggleroom.report.stills import write_svg

    if ending(path) == PAGE:
        write_whole(path, made)
    else:
        write_svg(made, path)
    note(f"picture: {path}")
