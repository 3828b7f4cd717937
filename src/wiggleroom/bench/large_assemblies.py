"""Large assemblies that are timed: the grids of the paper's Table 2, and two pictures made of blocks as in its Fig. 8b."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly import patterns
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Pull

GAP = 0.01
"""Of all assemblies [mm]; blocks have side 1."""


@dataclass(frozen=True)
class LargeAssembly:
    """One assembly.

    Parameters
    ----------
    name : str
    parts : int
    joint : str
        Family, or "image" for a picture made of tees.
    size : (columns, rows)
        Of a grid.
    picture : str
        File in the folder `assemblies`, without its ending: a line of # and . for each row of cells.
    fix : tuple of names
    pull : tuple of Pull
    """

    name: str
    parts: int
    joint: str
    size: tuple[int, int] = (0, 0)
    picture: str = ""
    fix: tuple[str, ...] = ()
    pull: tuple[Pull, ...] = ()


def _grid(nx: int, ny: int, joint: str) -> LargeAssembly:
    return LargeAssembly(f"{nx * ny:,} {joint}", nx * ny, joint, (nx, ny))


CASES = (
    _grid(6, 5, "tee"),
    _grid(14, 13, "tee"),
    _grid(27, 25, "tee"),
    _grid(45, 42, "tee"),
    _grid(64, 64, "tee"),
    _grid(64, 64, "dovetail"),
    _grid(64, 64, "swallowtail"),
    _grid(64, 64, "revolute"),
    LargeAssembly("1,669 elephant", 1669, "image", picture="elephant", fix=("b9-1", "b47-1"), pull=(Pull("b49-42", (0.0, 1.0)),)),
    LargeAssembly(
        "532 butterfly", 532, "image", picture="butterfly", fix=("b20-15",),
        pull=(Pull("b3-23", (-1.0, 0.0)), Pull("b37-23", (1.0, 0.0))),
    ),
)  # fmt: skip
"""Assemblies in the order they are asked."""


def make_assembly(case: LargeAssembly) -> Assembly:
    """Make it."""
    if case.picture:
        return patterns.image(dark_cells(case.picture), "tee", GAP, fix=case.fix, goals=case.pull)
    return patterns.grid(*case.size, case.joint, GAP)


def dark_cells(picture: str) -> NDArray[np.bool_]:
    """Which cells (rows, columns) of a picture are dark, the first row on top."""
    text = files("wiggleroom.bench").joinpath("assemblies", f"{picture}.txt").read_text(encoding="utf-8")
    return np.array([[cell == "#" for cell in row] for row in text.split()])
