"""What an idle solver process does: load libraries and compiled kernels, in steps that work comes between or ends."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from wiggleroom.context import Context
from wiggleroom.errors import Stop

MODULES = (
    "wiggleroom.drawing.readers.svg",
    "wiggleroom.drawing.readers.assembly_file",
    "wiggleroom.maximise",
    "wiggleroom.app.motion_requests",
    "wiggleroom.app.study_requests",
)


LARGE = (11, 10)
"""Columns and rows of an assembly that is answered as large ones are."""


def preload_steps(stop: Stop) -> list[Callable[[], object]]:
    """Steps, the most needed first; those that solve end when `stop` says so."""
    return [
        *(lambda name=name: import_module(name) for name in MODULES),
        lambda: _solve(stop),
        lambda: _solve_large(stop),
    ]


def _solve(stop: Stop) -> None:
    """Answer a tiny question, for the kernels."""
    from wiggleroom.assembly import patterns
    from wiggleroom.maximise import witness

    witness(patterns.chain(2, gap=0.02), context=Context(stop=stop))


def _solve_large(stop: Stop) -> None:
    """The same for those of large assemblies."""
    from wiggleroom.assembly import patterns
    from wiggleroom.drawing.model import Pull
    from wiggleroom.live.live_session import Live

    grid = patterns.grid(*LARGE, gap=0.02)
    pulled, at = grid.names[-1], grid.rest[-1]
    live = Live(grid)
    live.settle(Pull(pulled, (1.0, 0.0)), stop=stop)
    live.drag(pulled, (at[0], at[1]), (at[0] + 0.05, at[1]), within=4, stop=stop)
