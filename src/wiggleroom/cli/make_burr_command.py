"""`wiggleroom make burr`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from wiggleroom.cli.outputs import Force, check_outputs


def burr(
    *sticks: int,
    output: Annotated[Path, Parameter(name=("--output", "-o"))],
    length: int = 6,
    cell: float = 10.0,
    gap: float = 0.2,
    way: int = 1,
    force: Force = False,
) -> int:
    """Make an assembled six-piece burr from the numbers of its sticks.

    Numbers are those of Kaenel and Cutler, from 1, the solid stick, to 4096.

    Example: wiggleroom make burr 1 256 824 928 975 1024 -o burr.json

    Parameters
    ----------
    sticks
        Six numbers.
    output
        Assembly file to write: .json.
    length
        Length of a stick, in cells: 6, 8, ...
    cell
        Side of a cell; a stick is two cells wide [mm].
    gap
        Clearance between sticks [mm].
    way
        Number of the way to put these sticks together, if there are several.
    force
        Overwrite a file that this program did not make, or that was changed since.
    """
    from wiggleroom.assembly import patterns
    from wiggleroom.cli.make_command import write_made

    drawing = patterns.burr(sticks, gap, cell, length, way)
    check_outputs("", {"--output": (output, (".json",))}, force)
    return write_made(drawing, output)
