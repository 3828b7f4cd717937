"""`wiggleroom make`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from wiggleroom.cli.options import Many
from wiggleroom.cli.outputs import Force, check_outputs

if TYPE_CHECKING:
    from wiggleroom.drawing.model import Drawing

NO_SIZES = ("joint", "gap", "pitch", "n", "nx", "ny", "dark", "islands", "fix", "goals")
"""Arguments of patterns that `--size` must not reach."""


def make(
    pattern: Literal["grid", "chain", "frame", "jigsaw"],
    nx: int,
    ny: int | None = None,
    /,
    *,
    output: Annotated[Path, Parameter(name=("--output", "-o"))],
    joint: str | None = None,
    gap: float = 0.01,
    pitch: float = 1.0,
    size: Many = (),
    force: Force = False,
) -> int:
    """Make an assembly of joints: its first block is fixed, its last one pulled in +y.

    Example: wiggleroom make grid 6 5 --joint swallowtail --size neck=0.15 --gap 0.02 -o grid.json

    Parameters
    ----------
    pattern
        grid: blocks joined on all sides. chain: blocks in a row. frame: the border of a grid. jigsaw: pieces with
        random knobs, all different.
    nx
        Blocks in a row.
    ny
        Rows; a chain has none.
    output
        Assembly file to write: .json.
    joint
        Family of the joints: tee, dovetail, swallowtail, revolute, finger or jigsaw. By default tee.
    gap
        Clearance across every joint [mm].
    pitch
        Side of a block [mm].
    size
        One size of the joint, as a fraction of the pitch: NAME=0.2. May repeat.
    force
        Overwrite a file that this program did not make, or that was changed since.
    """
    from wiggleroom.assembly import patterns
    from wiggleroom.errors import InputError

    sizes, wrong = sizes_of(size)
    wrong += _misfits(pattern, ny, pitch, drawn_at_random=joint is None and not sizes)
    if wrong:
        raise InputError(wrong)
    check_outputs("", {"--output": (output, (".json",))}, force)
    family: dict[str, Any] = {} if pattern == "jigsaw" else {"joint": joint or "tee", **sizes}
    counts = (nx,) if ny is None else (nx, ny)
    assembly = getattr(patterns, pattern)(*counts, gap=gap, pitch=pitch, **family)
    return write_made(assembly.drawing, output)


def write_made(drawing: Drawing, output: Path) -> int:
    """Write the assembly file that was made, and say what it holds."""
    from wiggleroom.cli.say import note
    from wiggleroom.drawing import write_drawing

    write_drawing(drawing, output)
    for line in (*drawing.notes, f"{len(drawing.parts)} parts: {output}"):
        note(line)
    return 0


def _misfits(pattern: str, ny: int | None, pitch: float, *, drawn_at_random: bool) -> list[str]:
    """One line for each thing that the pattern cannot use."""
    wrong = []
    if (pattern == "chain") != (ny is None):
        wrong.append(f"{pattern}: give {'one number, the blocks' if pattern == 'chain' else 'columns and rows'}")
    if pattern == "jigsaw" and not drawn_at_random:
        wrong.append("jigsaw: its knobs are drawn at random, it takes no --joint and no --size")
    return wrong + pitch_misfits(pitch)


def pitch_misfits(pitch: float) -> list[str]:
    """One line if this is no side of a block."""
    return [] if math.isfinite(pitch) and pitch > 0 else [f"--pitch {pitch:g}: it must be more than 0"]


def sizes_of(texts: tuple[str, ...]) -> tuple[dict[str, float], list[str]]:
    """Sizes by name, and one line for each text that cannot be read."""
    found: dict[str, float] = {}
    wrong = []
    for text in texts:
        name, equals, value = text.partition("=")
        try:
            found[name] = float(value)
        except ValueError:
            wrong.append(f"--size {text}: write NAME=0.2")
            continue
        if not (equals and name.isidentifier() and name not in NO_SIZES):
            wrong.append(f"--size {text}: {name} is no size of a joint")
    return found, wrong
