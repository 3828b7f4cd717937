"""Assemblies of which it is known whether they come apart."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib.resources import files

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.readers.assembly_file import read_assembly

LOCKED, APART = "locked", "comes apart"


@dataclass(frozen=True)
class Puzzle:
    """One assembly with its truth.

    Parameters
    ----------
    name : str
    drawing : str
        File in the folder `assemblies`, without its ending.
    truth : str
        "locked" (spinning in place is not coming apart) or "comes apart".
    why : str
    gap : float, optional [mm]
        In place of the drawing's.
    glued : bool
        False: without the drawing's glue.
    """

    name: str
    drawing: str
    truth: str
    why: str
    gap: float | None = None
    glued: bool = True

    def assembly(self) -> Assembly:
        """Make it."""
        file = files("wiggleroom.bench").joinpath("assemblies", f"{self.drawing}.json")
        drawing = read_assembly(file.read_text(encoding="utf-8"))
        if not self.glued:
            drawing = replace(drawing, glue=())
        return assemble(drawing, gap=self.gap)


PUZZLES = (
    Puzzle("locked", "locked", LOCKED, "three blocks, T in T"),
    Puzzle("sequential", "sequential", APART, "the latch lets the drawer go"),
    Puzzle("simultaneous", "simultaneous", APART, "two parts leave together, each its own way (as in Fig. 10a)"),
    Puzzle("rotation", "rotation", APART, "a hook that must be turned out"),
    Puzzle("key not glued", "glued_key", APART, "each part of the key slides out its own way", glued=False),
    Puzzle("keyed by glue", "glued_key", LOCKED, "glued together they cannot (as in Fig. 10b)"),
    Puzzle("wedge gap 5.5", "gap", LOCKED, "neither straight nor turned (as in Fig. 10c)", gap=5.5),
    Puzzle("wedge gap 6.4", "gap", APART, "too wide to come straight, but turned it does", gap=6.4),
    Puzzle("wedge gap 7", "gap", APART, "straight", gap=7.0),
    Puzzle("through slot", "through_slot", APART, "a bar between two walls"),
    Puzzle("round plug", "round_plug", LOCKED, "it spins, and stays"),
)
