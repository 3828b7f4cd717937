"""Commands of declared questions: each takes the options that its question declares and those that all share."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from wiggleroom.cli.options import WORK, QuestionOptions
from wiggleroom.cli.outputs import FilmOutputs, Outputs, StudyOutputs, TableOutputs, command_line, write_moved
from wiggleroom.cli.sheet_options import SheetOptions
from wiggleroom.context import Context
from wiggleroom.studies.question import Question

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.deadline import Deadline
    from wiggleroom.report.finding import Finding

FILE = Annotated[
    str,
    Parameter(
        help="A drawing (.svg, .dxf, .lbrn2), an assembly file (.json), of the plane or of space, or a voxel puzzle "
        "(.puz, .xmpuzzle)."
    ),
]
DRAWING = Annotated[str, Parameter(help="A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json).")]


def study_command(question: type[Question]) -> Callable[..., int]:
    """The command that asks a question."""

    def command(file: str, /, **given: Any) -> int:
        return answer(file, **{name: default for name, (_, default) in options.items()} | given)

    outputs: TableOutputs = {"curve": StudyOutputs(), "path": FilmOutputs(), "end": Outputs()}[question.shows]
    own: Any = Annotated[question, Parameter(name="*", negative="", allow_leading_hyphen=question.signed)]  # type: ignore[valid-type]
    options: dict[str, tuple[Any, Any]] = {
        "study": (own, _default(question)),
        "asked": (QuestionOptions, QuestionOptions()),
        "outputs": (type(outputs), outputs),
        "time": (TimeLimit, TimeLimit()),
    }
    if question.spatial:
        options["sheet"] = (SheetOptions, SheetOptions())
    if question.parallel:
        options["running"] = (Running, Running())
    parameters = [
        inspect.Parameter("file", inspect.Parameter.POSITIONAL_ONLY, annotation=FILE if question.spatial else DRAWING)
    ]
    parameters += [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, annotation=kind, default=default)
        for name, (kind, default) in options.items()
    ]
    command.__name__ = command.__qualname__ = question.name
    command.__doc__ = inspect.getdoc(question)
    command.__signature__ = inspect.Signature(parameters, return_annotation=int)  # type: ignore[attr-defined]
    command.__annotations__ = {p.name: p.annotation for p in parameters} | {"return": int}
    return command


def _default(question: type[Question]) -> Any:
    """The question as it is asked without options; none where one must be given."""
    try:
        return question()
    except TypeError:
        return inspect.Parameter.empty


def answer(
    file: str,
    study: Question,
    asked: QuestionOptions,
    outputs: TableOutputs,
    time: TimeLimit,
    sheet: SheetOptions | None = None,
    running: Running | None = None,
) -> int:
    """Ask a question about a file, and tell what was found where the options say; the exit code."""
    from time import perf_counter

    from wiggleroom.cli.say import note
    from wiggleroom.cli.watch import bar, interruptible, progress
    from wiggleroom.drawing.dimension import is_spatial_file

    if sheet is not None:
        sheet.check(file)
    in_space = is_spatial_file(file) or (sheet is not None and sheet.given)
    study.check(3 if in_space else 2)
    outputs.check(file, in_space=in_space, **study.places())
    shared: dict[str, Any] = {} if running is None else running.options()
    command, watched = command_line(), bar(study.counts) if study.counts else progress()
    begin = perf_counter()
    with interruptible(time.time) as stop, unless_stopped(stop), watched as told:
        about = _read(file, study, asked, sheet, stop)
        read = perf_counter() - begin
        heard: dict[str, Any] = {"counted" if study.counts else "progress": told}
        found = study.ask(about, Context(stop=stop, **heard, **shared))
    found = study.timed(found, read, perf_counter() - begin)
    for line in study.notes(found):
        note(line)
    finding = study.finding(found, command)
    for line in study.write(found, command):
        note(line)
    _tell(finding, outputs, command)
    if isinstance(outputs, Outputs) and outputs.moved is not None:
        write_moved(about, study.end(found), outputs.moved)
        note(f"moved parts: {outputs.moved}")
    return finding.code


def _tell(finding: Finding, outputs: TableOutputs, command: str) -> None:
    """A finding as JSON, on stdout (unless the JSON goes there), as a table, and as pictures."""
    from wiggleroom.cli.outputs import write_result, write_table
    from wiggleroom.cli.say import note, show

    if outputs.json is not None:
        write_result(finding.record(), outputs.json)
    if outputs.json != "-":
        from wiggleroom.report.results.finding_text import finding_text

        show(finding_text(finding))
    if outputs.csv is not None:
        from wiggleroom.report.results.tables import csv_of

        write_table(csv_of(finding.motion if finding.data is None else finding), outputs.csv)
    page = outputs.html if isinstance(outputs, StudyOutputs) else None
    for option, place in (("picture", outputs.picture), ("page", page)):
        if place is not None and (finding.figure is not None or finding.motion is not None):
            _draw(finding, place, command)
            note(f"{option}: {place}")


def _read(file: str, study: Question, asked: QuestionOptions, sheet: SheetOptions | None, stop: Deadline) -> Any:
    """The assembly that a file, or a cutting sheet, and the options describe."""
    from wiggleroom.cli.in_space import read_in_space
    from wiggleroom.cli.options import read
    from wiggleroom.drawing.dimension import is_spatial_file

    if study.spatial and (is_spatial_file(file) or (sheet is not None and sheet.given)):
        found = read_in_space(file, asked, sheet, stop, overlapping=study.may_overlap)
    else:
        found = read(file, asked, stop, overlapping=study.may_overlap)
    return require_question(found) if study.asks_motion else found


def _draw(finding: Finding, place: Path, command: str) -> None:
    from wiggleroom.cli.outputs import PIXELS, note_missing_letters
    from wiggleroom.cli.watch import bar
    from wiggleroom.report.pictures.file_endings import ending
    from wiggleroom.report.write_picture import write_picture

    with bar("frames", "drawing") as count:
        write_picture(finding, place, command=command, progress=count)
    if ending(place) in PIXELS:
        note_missing_letters(place, finding.assembly.names)


@Parameter(name="*", group=WORK)
@dataclass(frozen=True, kw_only=True)
class TimeLimit:
    """Time limit of a question.

    Parameters
    ----------
    time
        Time limit [s]; then the best result so far is given (exit 3 if it is no complete answer).
    """

    time: float | None = None


@Parameter(name="*", group=WORK)
@dataclass(frozen=True, kw_only=True)
class Running:
    """Distribution of the work; the results are the same everywhere.

    Parameters
    ----------
    workers
        Processes on this machine. Default: one for each processor.
    cluster
        Dask scheduler that takes the work: tcp://host:port. Needs the extra cluster.
    """

    workers: int | None = None
    cluster: str | None = None

    def options(self) -> dict[str, Any]:
        """Arguments of the functions that do the work.

        Raises
        ------
        InputError
            If a number makes no sense.
        """
        from wiggleroom.errors import InputError

        if self.workers is not None and self.workers < 1:
            wrong = f"--workers {self.workers}: it must be at least 1"
            raise InputError(wrong)
        return {"workers": self.workers, "cluster": self.cluster}


@contextmanager
def unless_stopped(stop: Deadline) -> Iterator[None]:
    """Take what is missing after Ctrl-C, or after the time is over, for an interruption, not for bad input.

    Raises
    ------
    StoppedError
        If the time was over before there was anything to say.
    """
    from wiggleroom.errors import InputError, StoppedError

    try:
        yield
    except (InputError, StoppedError, KeyboardInterrupt):
        if stop.over:
            message = f"stopped after {stop.seconds:g} s, before there was anything to say; give more --time"
            raise StoppedError(message) from None
        if stop.is_set():
            raise KeyboardInterrupt from None
        raise


def require_question(assembly: Assembly) -> Assembly:
    """The assembly, if a question about motion can be asked of it.

    Raises
    ------
    InputError
        If nothing is fixed or pulled.
    """
    from wiggleroom.assembly.findings import role_findings
    from wiggleroom.errors import InputError

    lacking = role_findings(assembly.drawing)
    if lacking:
        raise InputError(lacking)
    return assembly
