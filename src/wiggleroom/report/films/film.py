"""Films of a path: GIF, MP4, and SVG that plays."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError
from wiggleroom.files import write_whole
from wiggleroom.report.films.scene import Caption, Scene, scene
from wiggleroom.report.results.answer_words import facts, headline
from wiggleroom.search.answer import Answer

Floats = NDArray[np.float64]
Progress = Callable[[int, int], None]

RATES = {".gif": 12.5, ".mp4": 30.0, ".svg": 16.0}
"""Frames a second by the ending of the name; an SVG that plays fills in between its frames."""


def film(
    assembly: Assembly,
    waypoints: Floats,
    path: str | PathLike[str],
    *,
    goals: tuple[Goal, ...] = (),
    pulled: str = "pulled",
    title: str = "",
    facts: tuple[str, ...] = (),
    command: str = "",
    back: bool = False,
    magnify: float | None = None,
    least_seconds: float = 0.0,
    progress: Progress | None = None,
) -> None:
    """Write a film of parts on their path.

    They move evenly along the path, gently at both ends, with a pause there; parts that go far away fade. The file is
    written whole or not at all.

    Parameters
    ----------
    assembly : Assembly
    waypoints : (k, n, 3) float64 [mm, mm, rad]
        Motions of the parts along the path, such as `Answer.waypoints`.
    path : str or path
        .gif and .mp4 need the extra `film`; .svg plays in browsers.
    goals : tuple of Pull, Turn or W
        Drawn as arrows; their parts are blue.
    pulled : str
        Name of these parts in the legend.
    title, facts, command : str, tuple of str, str
        Texts above and below.
    back : bool
        True: the film returns to rest the same path before it begins again.
    magnify : float, optional
        Factor by which the motion is enlarged; by default 1, unless the motion is too small to be seen.
    least_seconds : float
        Least time of the path.
    progress : callable, optional
        Called after every frame with the numbers of finished and of all frames.

    Raises
    ------
    InputError
        If the name has another ending, or the path another shape.
    MissingExtraError
        If the library for this kind of film is not installed.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> import wiggleroom as wr
    >>> chain = wr.patterns.chain(2, gap=0.02)
    >>> waypoints = np.array([[[0, 0, 0], [0, 0, 0]], [[0, 0, 0], [0, 0.02, 0.01]]])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     film(chain, waypoints, f"{folder}/move.svg", title="a small move")
    """
    path = Path(path)
    kind = path.suffix.lower()
    if kind not in RATES:
        finding = f"film {path}: the name must end in {', '.join(RATES)}"
        raise InputError(finding)
    made = scene(
        assembly,
        waypoints,
        Caption(title or f"{len(assembly.parts)} parts", facts, command, goals, pulled),
        rate=RATES[kind],
        magnify=magnify,
        least_seconds=least_seconds,
    )
    write_whole(path, _written(made, kind, back, progress))


def film_of_answer(answer: Answer, path: str | PathLike[str], *, progress: Progress | None = None) -> None:
    """Write a film of an answer: from rest along its waypoints and, where something holds it, back again."""
    film(
        answer.assembly,
        answer.waypoints,
        path,
        **film_texts(answer),
        back=not answer.leaves and answer.period is None,
        progress=progress,
    )


def film_texts(answer: Answer) -> dict:
    """Return what the film of an answer says about it: title, facts, goals and command."""
    return {
        "goals": answer.goals,
        "title": headline(answer),
        "facts": tuple(facts(answer)),
        "command": answer.command,
    }


def _written(made: Scene, kind: str, back: bool, progress: Progress | None) -> str | bytes:
    if kind == ".svg":
        from wiggleroom.report.films.film_svg import moving_svg

        return moving_svg(made, back=back)
    from wiggleroom.report.films.film_frames import gif, mp4

    return (gif if kind == ".gif" else mp4)(made, RATES[kind], back=back, progress=progress)
