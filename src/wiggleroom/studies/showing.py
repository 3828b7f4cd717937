"""Whatever is found into files and notebooks: results of declared questions by their findings, all others as they are."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from typing import Any

from wiggleroom.studies.registry import finding_of


def draw(
    found: Any, path: str | PathLike[str], *, command: str = "", progress: Callable[[int, int], None] | None = None
) -> None:
    """Write a picture or a page of a result, by the ending of the name.

    Raises
    ------
    InputError
        If the name has another ending, or there is nothing to show.
    MissingExtraError
        If a film needs a library that is not installed.
    """
    from wiggleroom.report.write_picture import write_picture

    write_picture(finding_of(found, command) or found, path, command=command, progress=progress)


def mime_bundle(found: Any) -> dict[str, str]:
    """What a notebook shows of a result, by media type."""
    from wiggleroom.report import notebook

    return notebook.mime_bundle(finding_of(found) or found)
