"""Where results go: looked at before the long work, written whole after it."""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from cyclopts import Parameter

from wiggleroom.cli.options import RESULTS
from wiggleroom.files import leads_back
from wiggleroom.provenance import is_own
from wiggleroom.report.pictures.file_endings import ANSWERS, PAGE, STUDIES, ending, wrong_ending

if TYPE_CHECKING:
    import numpy as np
    from msgspec import Struct
    from numpy.typing import NDArray

    from wiggleroom.assembly.assembly import Assembly

Places = dict[str, tuple[str | Path | None, tuple[str, ...]]]
Text = Annotated[str | None, Parameter(allow_leading_hyphen=True)]
Force = Annotated[bool, Parameter(negative="", group=RESULTS)]
MOVED = (".dxf", ".svg", ".json")
TABLE = (".csv",)
MODEL = ".glb"
MESHES = (MODEL, ".stl", ".obj")
PIXELS = (".png", ".gif", ".mp4")


def command_line() -> str:
    """The command as it was typed, for results that say where they come from."""
    return shlex.join(["wiggleroom", *sys.argv[1:]])


@Parameter(name="*", group=RESULTS)
@dataclass(frozen=True, kw_only=True)
class PictureOutputs:
    """Where what was found goes besides the terminal.

    Parameters
    ----------
    json
        Write the results as JSON to this file. Alone, or with -, to stdout, which then holds nothing else.
    picture
        Draw the results: .svg or .png a picture, .html a full report.
    force
        Overwrite files that this program did not make, or that were changed since.
    """

    ENDINGS: ClassVar[tuple[str, ...]] = STUDIES
    json: Text = None
    picture: Path | None = None
    force: Force = False

    def check(self, source: str, *, in_space: bool = False, **more: tuple[Path | None, tuple[str, ...]]) -> None:
        """Check that everything asked for can be written; see the function `check_outputs`. In space pictures may be models, too."""
        places = self.places()
        if in_space:
            places["--picture"] = (self.picture, (*self.ENDINGS, MODEL))
        if in_space and "--moved" in places:
            places["--moved"] = (places["--moved"][0], MESHES)
        check_outputs(source, places | more, self.force)

    def places(self) -> Places:
        """Where everything goes, by the name of its option, and which endings are right."""
        return {"--json": (self.json, ()), "--picture": (self.picture, self.ENDINGS)}


@Parameter(name="*", group=RESULTS)
@dataclass(frozen=True, kw_only=True)
class TableOutputs(PictureOutputs):
    """The same with a table.

    Parameters
    ----------
    csv
        Write a table of the results: .csv.
    """

    csv: Path | None = None

    def places(self) -> Places:
        """Where everything goes, the table too."""
        return super().places() | {"--csv": (self.csv, TABLE)}


@Parameter(name="*", group=RESULTS)
@dataclass(frozen=True, kw_only=True)
class StudyOutputs(TableOutputs):
    """The same of a study, whose picture may be wanted beside its page.

    Parameters
    ----------
    html
        Write the page as well, beside a picture of another format: .html.
    """

    html: Path | None = None

    def places(self) -> Places:
        """Where everything goes, the page too."""
        return super().places() | {"--html": (self.html, (PAGE,))}


@Parameter(name="*", group=RESULTS)
@dataclass(frozen=True, kw_only=True)
class FilmOutputs(TableOutputs):
    """The same of what has paths, and so films.

    Parameters
    ----------
    picture
        Draw the results: .svg or .png a picture, .gif, .mp4 or .film.svg a film, .html a full report.
    """

    ENDINGS: ClassVar[tuple[str, ...]] = ANSWERS
    picture: Path | None = None


@Parameter(name="*", group=RESULTS)
@dataclass(frozen=True, kw_only=True)
class Outputs(FilmOutputs):
    """The same of an answer that has moved parts.

    Parameters
    ----------
    moved
        Write the parts at their end: .dxf, .svg or an assembly file .json; in space .stl, .obj or .glb.
    """

    moved: Path | None = None

    def places(self) -> Places:
        """Where everything goes, the moved parts too."""
        return super().places() | {"--moved": (self.moved, MOVED)}


def check_outputs(source: str, places: Places, force: bool = False) -> None:
    """Check that every output can be written: a known ending, a folder that is there, never over the source or somebody's own file.

    Parameters
    ----------
    source : str
        The file that is read.
    places : dict
        By the name of the option: where it goes (None: nowhere, "-": stdout), and the endings it may have (none: any).
    force : bool
        True: also over files that the program did not make.

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
        problem = _problem(Path(place), source, endings, force)
        if problem:
            wrong.append(f"{option} {place}: {problem}")
    if wrong:
        raise InputError(wrong)
    for place, _ in places.values():
        if place is not None and ending(Path(place)) in (".gif", ".mp4"):
            from wiggleroom.report.films.film_frames import need_film_library

            need_film_library(ending(Path(place)))


def _problem(path: Path, source: str, endings: tuple[str, ...], force: bool) -> str:
    """Say what is wrong with an output path, or nothing."""
    odd = wrong_ending(path, endings)
    if odd:
        return odd
    if leads_back(path):
        return "this is a link that leads back to itself; give another name"
    if path.is_dir():
        return "this is a folder; give the name of a file"
    if not path.parent.is_dir():
        return f"there is no folder {path.parent}; make it first"
    if not os.access(path if path.exists() and not path.is_file() else path.parent, os.W_OK):
        return f"the folder {path.parent} cannot be written"
    if path.exists() and os.path.exists(source) and path.samefile(source):
        return "this would overwrite the file that is read; give another name"
    if not force and path.is_file() and path.stat().st_size and not is_own(path):
        return "this file is there already, and is not as wiggleroom made it; give another name, or --force"
    return ""


def write_moved(assembly: Assembly, motion: NDArray[np.float64], path: Path) -> None:
    """Parts as made where a motion has taken them: a drawing or an assembly file, in space meshes."""
    if assembly.dimension == 3:
        from wiggleroom.report.solids.moved_meshes import write_moved_meshes

        write_moved_meshes(assembly, motion, path)
        return
    from wiggleroom.assembly.assembly import moved_drawing
    from wiggleroom.drawing import write_drawing

    write_drawing(moved_drawing(assembly, motion), path)


def write_table(table: str, path: Path) -> None:
    """Table as comma-separated values."""
    from wiggleroom.cli.say import note
    from wiggleroom.files import write_whole

    write_whole(path, table)
    note(f"table: {path}")


def write_result(result: Struct | dict[str, Any], place: str) -> None:
    """Result as JSON to a file, or to stdout where the place is "-"."""
    from wiggleroom.cli.say import note
    from wiggleroom.files import write_whole
    from wiggleroom.report.results.json_results import to_json

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
    from wiggleroom.report.pictures.stills import write_still

    if ending(path) == PAGE:
        write_whole(path, made)
    else:
        write_still(made, path)
    note(f"picture: {path}")
    if ending(path) in PIXELS:
        note_missing_letters(path, [made])


def note_missing_letters(path: Path, texts: Iterable[str]) -> None:
    """Say which letters no font on this machine has."""
    from wiggleroom.cli.say import note
    from wiggleroom.report.pictures.missing_glyphs import missing_glyphs

    letters = missing_glyphs(texts)
    if letters:
        some = letters[:20] + ("..." if len(letters) > 20 else "")
        note(
            f"{path}: no font on this machine has the letters {some}; install one, such as Noto Sans, or write .svg, "
            "where the viewer's fonts are used"
        )
