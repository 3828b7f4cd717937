"""`wiggleroom bench`."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from wiggleroom.bench.result import Record
from wiggleroom.cli.outputs import Force, check_outputs, command_line, write_picture, write_result
from wiggleroom.report.pictures.file_endings import STILLS

if TYPE_CHECKING:
    from wiggleroom.bench.result import Bench
    from wiggleroom.errors import Stop

Table = Literal["accuracy", "speed", "chains", "interlock"]
TABLES: tuple[Table, ...] = ("accuracy", "speed", "chains", "interlock")


def bench(
    table: Table | None = None,
    /,
    *,
    samples: int | None = None,
    max_parts: int | None = None,
    limit: float | None = None,
    json: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None,
    markdown: Path | None = None,
    picture: Path | None = None,
    force: Force = False,
) -> int:
    """Compare this method with the paper's and its peers on the same work, beside published figures.

    accuracy: random motions of one joint judged by each model and by exact collision. speed: time and memory of large
    assemblies. chains: displacement against gap, beside the true optimum. interlock: coming apart. Default: all four.

    Example: wiggleroom bench accuracy --samples 20000

    Parameters
    ----------
    table
        Name of the comparison; all by default.
    samples
        Random motions of each pair for accuracy; by default 1,000,000.
    max_parts
        For speed: leave out larger assemblies.
    limit
        For speed: seconds that other methods may take; by default 30 times as long as ours, within 60 and 600.
    json
        Write the figures as JSON to this file; - is stdout, which then holds nothing else.
    markdown
        Write the tables into this page: .md. The section of a table is replaced, the rest of the page stays.
    picture
        Draw the comparison: .svg or .png; needs the name of a table.
    force
        Overwrite a picture that this program did not make, or that was changed since.
    """
    from wiggleroom.cli.watch import bar, interruptible
    from wiggleroom.errors import InputError

    check_outputs("", {"--markdown": (markdown, (".md",))}, force=True)
    check_outputs("", {"--json": (json, ()), "--picture": (picture, STILLS)}, force)
    names = TABLES if table is None else (table,)
    wrong = (
        [f"--picture {picture}: name one table, {', '.join(TABLES)}"] if picture is not None and table is None else []
    )
    for option, value, its in (
        ("--samples", samples, "accuracy"),
        ("--max-parts", max_parts, "speed"),
        ("--limit", limit, "speed"),
    ):
        if value is not None and its not in names:
            wrong.append(f"{option} {value:g}: only {its} knows it; leave it out")
    if samples is not None and samples < 1:
        wrong.append(f"--samples {samples}: there must be at least 1")
    if wrong:
        raise InputError(wrong)
    if "speed" in names:
        from wiggleroom.bench.speed import checked_cases

        checked_cases(max_parts, limit)
    if "chains" in names:
        from wiggleroom.bench.chains import require_engine

        require_engine()
    page = _page(markdown, names)
    command = command_line()
    found: list[Bench] = []
    with interruptible() as stop:
        for name in names:
            if stop.is_set():
                break
            with bar(name) as show:
                found.append(_measure(name, samples, max_parts, limit, stop, show))
    from wiggleroom.bench.render import bench_record, bench_table

    if json is not None:
        write_result(bench_record(found, command, machine()), json)
    if json != "-":
        from wiggleroom.cli.say import show as print_page

        for one in found:
            print_page(bench_table(one))
    if markdown is not None:
        _write_page(markdown, page, found)
    if picture is not None:
        from wiggleroom.bench.pictures import comparison_picture as draw

        write_picture(draw(found[0], command), picture)
    return 3 if stop.is_set() else 0


def _measure(
    name: Table,
    samples: int | None,
    max_parts: int | None,
    limit: float | None,
    stop: Stop,
    show: Callable[[int, int], None] | None,
) -> Bench:
    """One comparison."""
    if name == "accuracy":
        from wiggleroom.bench.accuracy import SAMPLES, accuracy

        return accuracy(SAMPLES if samples is None else samples, stop=stop, progress=show)
    if name == "speed":
        from wiggleroom.bench.speed import speed

        return speed(max_parts, limit=limit, stop=stop, progress=show)
    if name == "chains":
        from wiggleroom.bench.chains import chains

        return chains(stop=stop, progress=show)
    from wiggleroom.bench.interlock_table import interlock_table

    return interlock_table(stop=stop, progress=show)


def _page(markdown: Path | None, names: tuple[Table, ...]) -> str:
    """What the page holds now; an error where the sections cannot be put into it, before the long work."""
    if markdown is None or not markdown.exists():
        return ""
    from wiggleroom.bench.render import with_section
    from wiggleroom.errors import InputError

    try:
        page = markdown.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        finding = f"--markdown {markdown}: this is not a text in UTF-8; give another name"
        raise InputError(finding) from None
    for name in names:
        try:
            with_section(page, name, "")
        except InputError as error:
            finding = f"--markdown {markdown}: {error}"
            raise InputError(finding) from None
    return page


def _write_page(markdown: Path, page: str, found: list[Bench]) -> None:
    """Page with the new sections in the place of the old ones."""
    from wiggleroom.bench.render import bench_markdown, with_section
    from wiggleroom.cli.say import note
    from wiggleroom.files import write_whole

    for one in found:
        page = with_section(page, one.name, bench_markdown(one))
    write_whole(markdown, page)
    note(f"tables: {markdown}")


def machine() -> Record:
    """Processor kind, cores, system, Python and wiggleroom."""
    from importlib.metadata import version

    return {
        "processor": platform.machine(),
        "cores": os.cpu_count(),
        "system": platform.system(),
        "python": platform.python_version(),
        "wiggleroom": version("wiggleroom"),
    }
