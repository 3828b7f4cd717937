"""How much of a pair's free space the cells cover, and how much of them overlaps: `python -m benchmarks.freespace`."""

from __future__ import annotations

import sys
import time
from itertools import product

import numpy as np
from rich.console import Console
from rich.table import Table
from tests.audit import audit, polygon

from wiggleroom.assembly import patterns
from wiggleroom.freespace.free_space import free_space

FAMILIES = ("tee", "swallowtail", "dovetail", "revolute", "finger", "jigsaw")
GAPS = (0.01, 0.02)


def main(samples: int = 1_000_000) -> None:
    """Print one line for every family, direction and gap."""
    free_space(patterns.chain(2), "b1", "b2")
    table = Table(
        "family",
        "neighbours",
        *(f"{name}" for name in ("gap", "cells", "rows", "covered %", "samples", "unsafe", "lost %", "seconds")),
    )
    for family, (where, size, names), gap in product(FAMILIES, _places(), GAPS):
        assembly = patterns.chain(2, family, gap) if where == "chain" else patterns.grid(*size, family, gap)
        began = time.perf_counter()
        space = free_space(assembly, *names)
        seconds = time.perf_counter() - began
        shapes = [polygon(p) for p in assembly.parts]
        found = audit(space, *shapes, np.array(assembly.parts[1].at[:2]), samples)
        figures = (gap, len(space.cells.a), space.rows, f"{100 * space.coverage:.2f}", found.samples, found.unsafe)
        table.add_row(family, where, *map(str, figures), f"{100 * found.lost / found.free:.3f}", f"{seconds:.2f}")
    Console(width=120).print(table)


def _places() -> list[tuple[str, tuple[int, int], tuple[str, str]]]:
    return [("chain", (2, 1), ("b1", "b2")), ("grid, above", (1, 2), ("b1-1", "b1-2"))]


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
