"""What a solver process does while nobody asks: load libraries and compiled kernels, in steps that work may come between."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

MODULES = (
    "wiggleroom.drawing.svg",
    "wiggleroom.drawing.assembly_file",
    "wiggleroom.maximise",
    "wiggleroom.app.motion_requests",
    "wiggleroom.app.study_requests",
)


def steps() -> list[Callable[[], object]]:
    """Steps, the most needed first."""
    return [*(lambda name=name: import_module(name) for name in MODULES), _solve]


def _solve() -> None:
    """Answer a tiny question, for the kernels."""
    from wiggleroom.assembly import patterns
    from wiggleroom.maximise import flex

    flex(patterns.chain(2, gap=0.02))
