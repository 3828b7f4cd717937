"""`wiggleroom coupon`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from wiggleroom.cli.make_command import sizes_of
from wiggleroom.cli.options import Many
from wiggleroom.cli.outputs import Force, check_outputs


def coupon(
    file: str | None = None,
    holder: str | None = None,
    key: str | None = None,
    /,
    *,
    output: Annotated[Path, Parameter(name=("--output", "-o"))],
    start: float = -0.3,
    stop: float = 0.3,
    step: float = 0.05,
    joint: str | None = None,
    pitch: float | None = None,
    size: Many = (),
    unit: Literal["mm", "cm", "m", "in", "px", "pt"] | None = None,
    dpi: float | None = None,
    flatten: float | None = None,
    force: Force = False,
) -> int:
    """Make a sheet to measure your kerf and choose your gap: one joint at many gaps, each engraved.

    Try one key in holders from tight to loose. Without a file the sheet is a comb of pockets for a joint family.

    Example: wiggleroom coupon --joint tee -o comb.dxf

    Example: wiggleroom coupon puzzle.svg p1 p2 --start -0.2 --stop 0.2 -o coupon.svg

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json) with a joint of your own.
    holder
        The part to make once for every gap. May be left out, with the next, if the file has two parts.
    key
        The part to try in all of them.
    output
        The sheet: .svg or .dxf, with names to engrave in a layer of their own, or .json.
    start
        Tightest gap [mm]; below 0 the holder is drawn smaller than the key.
    stop
        Widest gap [mm].
    step
        Step from one gap to the next [mm].
    joint
        Family of the comb: tee, dovetail, swallowtail, revolute, finger or jigsaw. By default tee.
    pitch
        Width of a pocket's place in the comb [mm]. By default 20.
    size
        One size of the joint, as a fraction of the pitch: NAME=0.2. May repeat.
    unit
        Unit of the drawing. Replaces the file's.
    dpi
        Units of the drawing per inch, such as 90 or 72. Replaces the file's.
    flatten
        Largest distance between a curve and its polygon [mm].
    force
        Overwrite a file that this program did not make, or that was changed since.
    """
    from wiggleroom.assembly import coupon as make
    from wiggleroom.assembly.inventory import size_lines
    from wiggleroom.cli.say import note
    from wiggleroom.drawing import read_drawing, write_drawing
    from wiggleroom.drawing.units import unit_of
    from wiggleroom.errors import InputError

    sizes, wrong = sizes_of(size)
    if file is not None and (joint is not None or pitch is not None or size):
        wrong.append("coupon: give a file with a joint of your own, or --joint, --pitch and --size, not both")
    if file is None and (unit is not None or dpi is not None or flatten is not None):
        wrong.append("coupon: --unit, --dpi and --flatten go with a file")
    if wrong:
        raise InputError(wrong)
    check_outputs(file or "", {"--output": (output, (".svg", ".dxf", ".json"))}, force)
    gaps = make.gap_steps(start, stop, step)
    if file is None:
        sheet = make.comb(joint or "tee", gaps, 20.0 if pitch is None else pitch, **sizes)
    else:
        drawing = read_drawing(file, unit=unit_of(unit, dpi), flatten=flatten)
        for line in (*size_lines(drawing), *drawing.notes):
            note(line)
        names = [part.name for part in drawing.parts]
        if holder is None and len(names) == 2:
            holder, key = names
        if holder is None or key is None:
            message = f"{drawing.source}: name the two parts of the joint: coupon {file} HOLDER KEY"
            raise InputError(message)
        sheet = make.row(drawing, holder, key, gaps)
    write_drawing(sheet.drawing, output, labels=sheet.labels)
    written = make.texts(gaps)
    note(f"{len(gaps)} gaps from {written[0]} to {written[-1]} mm and a key: {output}")
    return 0
