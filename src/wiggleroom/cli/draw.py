"""`wiggleroom draw`."""

from __future__ import annotations

import sys
from pathlib import Path

from wiggleroom.cli.options import Asked, read
from wiggleroom.cli.outputs import Force, check, write_picture
from wiggleroom.report.endings import STILLS

_NONE_ASKED = Asked()


def draw(file: str, out: Path, /, *, asked: Asked = _NONE_ASKED, force: Force = False) -> int:
    """Draw the parts at rest, gap applied, with what is fixed and pulled.

    Example: wiggleroom draw puzzle.svg parts.png --gap 0.2

    Parameters
    ----------
    file
        A drawing (.svg, .dxf) or an assembly file (.json).
    out
        The picture: .svg or .png.
    force
        Write over a file that was not made by this program, or was changed since.
    """
    import shlex

    from wiggleroom.report.picture import picture_of_assembly

    check(file, {"OUT": (out, STILLS)}, force)
    command = shlex.join(["wiggleroom", *sys.argv[1:]])
    write_picture(picture_of_assembly(read(file, asked), command=command), out)
    return 0
