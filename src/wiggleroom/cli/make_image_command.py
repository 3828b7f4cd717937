"""`wiggleroom make image`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from wiggleroom.cli.options import Many
from wiggleroom.cli.outputs import Force, check_outputs


def image(
    file: Path,
    /,
    *,
    output: Annotated[Path, Parameter(name=("--output", "-o"))],
    blocks: int | None = None,
    threshold: float = 0.5,
    islands: Literal["largest", "all"] = "largest",
    joint: str = "tee",
    gap: float = 0.01,
    pitch: float = 1.0,
    size: Many = (),
    fix: Many = (),
    pull: Many = (),
    turn: Many = (),
    force: Force = False,
) -> int:
    """Make an assembly of blocks from the dark part of a picture.

    Blocks are joined to their neighbours on four sides; holes stay open. Block b12-3 lies in column 12 of the third row from below.

    Example: wiggleroom make image cat.png --blocks 40 --fix b3-1,b30-1 -o cat.json

    Parameters
    ----------
    file
        The picture: PNG, JPEG, ... Needs the extra image.
    output
        The assembly file that is written: .json.
    blocks
        Blocks in the width of the whole picture. By default one a pixel, at most 60.
    threshold
        What is darker than this is dark: between 0 (black) and 1 (white).
    islands
        largest: blocks that do not hang together with most others are left out. all: they stay, each island with its
        first block fixed.
    joint
        Family of the joints: tee, dovetail, swallowtail, revolute, finger or jigsaw.
    gap
        Clearance across every joint [mm].
    pitch
        Side of a block [mm].
    size
        One size of the joint, as a fraction of the pitch: NAME=0.2. May repeat.
    fix
        Blocks that stand: A,B. May repeat. By default the first one, leftmost in the bottom row.
    pull
        A block and the way it is pulled, as NAME:+y. May repeat; pulls add up. By default the last block in +y.
    turn
        A block that is turned: NAME:ccw or NAME:cw. May repeat.
    force
        Write over a file that was not made by this program, or was changed since.
    """
    from wiggleroom.assembly import patterns
    from wiggleroom.cli.asking import goals
    from wiggleroom.cli.make_command import pitch_misfits, sizes_of, write_made
    from wiggleroom.drawing import read_bitmap
    from wiggleroom.errors import InputError

    sizes, wrong = sizes_of(size)
    asked, odd = goals(pull, turn)
    wrong += [*odd, *pitch_misfits(pitch)]
    if wrong:
        raise InputError(wrong)
    check_outputs(str(file), {"--output": (output, (".json",))}, force)
    dark = read_bitmap(file, blocks, threshold)
    fixed = [name for text in fix for name in text.split(",") if name]
    assembly = patterns.image(dark, joint, gap, pitch, islands, fixed, asked, **sizes)
    return write_made(assembly.drawing, output)
