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
        Assembly file to write: .json.
    blocks
        Blocks in the width of the whole picture. By default one a pixel, at most 60.
    threshold
        Brightness below which a pixel is dark: between 0 (black) and 1 (white).
    islands
        largest: keep only the largest connected set of blocks. all: keep every island, each with its first block fixed.
    joint
        Family of the joints: tee, dovetail, swallowtail, revolute, finger or jigsaw.
    gap
        Clearance across every joint [mm].
    pitch
        Side of a block [mm].
    size
        One size of the joint, as a fraction of the pitch: NAME=0.2. May repeat.
    fix
        Fixed blocks: A,B. May repeat. Default: the first one, leftmost in the bottom row.
    pull
        A block and its pull, as NAME:+y. May repeat; pulls add up. Default: the last block in +y.
    turn
        A block to turn: NAME:ccw or NAME:cw. May repeat.
    force
        Overwrite a file that this program did not make, or that was changed since.
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
