"""What a solver process does before anyone asks: load libraries and compiled kernels, in steps that work may cut short."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

MODULES = ("wiggleroom.assembly.build", "wiggleroom.analysis.flex", "wiggleroom.app.desk", "wiggleroom.drawing.svg")


def steps() -> list[Callable[[], object]]:
    """Steps, the most needed first."""
    return [*(lambda name=name: import_module(name) for name in MODULES), _solve]


def _solve() -> None:
    """Answer a tiny question, for the kernels."""
    from wiggleroom.analysis.flex import flex
    from wiggleroom.assembly import patterns

    flex(patterns.chain(2, gap=0.02))
