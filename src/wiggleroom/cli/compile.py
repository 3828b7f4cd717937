"""Compile the numerical kernels before they are needed.

`python -m wiggleroom.cli.compile` compiles for this processor and keeps that beside the package; `python -m wiggleroom.cli.compile
FOLDER` compiles for every processor of this platform into a folder that a wheel carries.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

from wiggleroom.errors import MissingExtraError

_BARS = [[-6, -6, -1, 6, -4, 1], [-6, 4, -1, 6, 6, 1], [-6, -4, -1, -4, 4, 1], [4, -4, -1, 6, 4, 1]]
_OPEN_BARS = [
    [0, -1, -6, 2, 1, 6],
    [2, -1, 4, 12, 1, 6],
    [2, -1, -6, 12, 1, -4],
    [10, -1, 0.5, 12, 1, 4],
    [10, -1, -4, 12, 1, -0.5],
]
OPEN_RING = [{"name": "eye", "boxes": _BARS, "fixed": True}, {"name": "hook", "boxes": _OPEN_BARS}]
"""A closed square ring, and one that stands in it, whose opening is half as wide as the bars are thick."""


def compile_kernels() -> None:
    """Answer tiny questions of every kind and one about many bodies; what they compile is kept beside the package."""
    in_the_plane()
    of_a_sheet()
    with suppress(MissingExtraError):  # nobody can ask about solids
        in_space()


def in_the_plane() -> None:
    """The largest motion by every model, whose gap it is due to, a free space, and what interlocks."""
    from wiggleroom.assembly import patterns
    from wiggleroom.disassembly.interlock import interlock
    from wiggleroom.freespace.free_space import free_space
    from wiggleroom.maximise import flex
    from wiggleroom.sensitivity.planar_study import study_of
    from wiggleroom.sensitivity.rank import rank

    for model in ("walls", "hull", "halfplane"):
        flex(patterns.chain(2), model=model)
    rank(study_of(flex(patterns.jigsaw(2, 2, gap=0.02)), None))
    flex(patterns.grid(19, 19), search=0)
    free_space(patterns.chain(2), "b1", "b2")
    interlock(patterns.chain(2, joint="swallowtail", gap=0.02))


def in_space() -> None:
    """The largest motion of a burr, that it does not come apart, and that an open ring stays in a closed one."""
    from wiggleroom.app.spatial_samples import SPATIAL_SAMPLES
    from wiggleroom.questions import check, flex
    from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
    from wiggleroom.spatial.solids.spatial_file import read_spatial

    burr = assemble_spatial(read_spatial(SPATIAL_SAMPLES["burr"].text()))
    flex(burr)
    check(burr)
    check(assemble_spatial(read_spatial(json.dumps({"format": "wiggleroom/2", "parts": OPEN_RING}))))


def of_a_sheet() -> None:
    """The panels of a box put together."""
    from wiggleroom.app.sheet_sample import THICKNESS, sheet
    from wiggleroom.drawing.writers.assembly_writer import write_assembly
    from wiggleroom.mating.assembled_sheet import assemble_sheet
    from wiggleroom.mating.cutting_sheet import read_sheet

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sheet.json"
        path.write_text(write_assembly(sheet().drawing), encoding="utf-8")
        assemble_sheet(read_sheet(path), THICKNESS)


def compile_into(folder: Path) -> int:
    """Compile for the least processor of this platform, in a process that has not loaded numba; how many files it made."""
    with tempfile.TemporaryDirectory() as kept:
        os.environ |= {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", "NUMBA_CACHE_DIR": kept}
        compile_kernels()
        from wiggleroom.compiled.jit_options import ship

        return ship(folder)


def main() -> None:
    """Compile for this machine, or into the folder that is named."""
    if len(sys.argv) > 1:
        compile_into(Path(sys.argv[1]))
    else:
        compile_kernels()


if __name__ == "__main__":
    main()
