"""`wiggleroom space`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wiggleroom.cli.options import QuestionOptions, read
from wiggleroom.cli.outputs import PictureOutputs, command_line
from wiggleroom.report.pictures.file_endings import PAGE, ending

if TYPE_CHECKING:
    from wiggleroom.compare.monte_carlo import SampledAccuracy
    from wiggleroom.freespace.free_space import FreeSpace

_NONE_ASKED, _NO_OUTPUTS = QuestionOptions(), PictureOutputs()


def space(
    file: str,
    a: str,
    b: str,
    /,
    *,
    asked: QuestionOptions = _NONE_ASKED,
    outputs: PictureOutputs = _NO_OUTPUTS,
    samples: int = 0,
    seed: int = 0,
) -> int:
    """Compute the free space of a pair: the motions of one part against another, with all others left out.

    Example: wiggleroom space puzzle.svg p1 p2 --gap 0.2 --samples 20000 --picture space.svg

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json).
    a
        Name of the fixed part.
    b
        Name of the moving part.
    samples
        Number of random motions to judge by polygon intersection, as a test of the cells.
    seed
        Seed of these random motions.
    """
    from wiggleroom.errors import InputError

    if samples < 0 or seed < 0:
        wrong = f"--samples {samples} --seed {seed}: they must be 0 or more"
        raise InputError(wrong)
    outputs.check(file)
    assembly = read(file, asked)

    from wiggleroom.freespace.free_space import free_space

    found = free_space(assembly, a, b)
    judged = None
    if samples:
        from wiggleroom.compare.monte_carlo import sampled_accuracy

        judged = sampled_accuracy(found, assembly, samples, seed=seed)
    if outputs.json != "-":
        from wiggleroom.cli.say import show
        from wiggleroom.report.free_space.space_report import space_table

        show(space_table(found, judged))
    _write(found, judged, outputs, command_line(), assembly.drawing.notes)
    return 0


def _write(
    found: FreeSpace, judged: SampledAccuracy | None, outputs: PictureOutputs, command: str, notes: tuple[str, ...]
) -> None:
    """JSON and picture, where they are asked for."""
    from wiggleroom.cli.outputs import write_picture, write_result
    from wiggleroom.report.free_space.space_report import space_result

    if outputs.json is not None:
        write_result(space_result(found, judged, command, notes), outputs.json)
    if outputs.picture is not None:
        if ending(outputs.picture) == PAGE:
            from wiggleroom.report.page.pages import page_of_space as show
        else:
            from wiggleroom.report.free_space.space_report import space_picture as show
        write_picture(show(found, judged, command=command), outputs.picture)
