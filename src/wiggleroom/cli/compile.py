"""Compile the numerical kernels before they are needed.

`python -m wiggleroom.cli.compile` compiles for this processor and keeps that beside the package; `python -m wiggleroom.cli.compile
FOLDER` compiles for every processor of this platform into a folder that a wheel carries.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path


def compile_kernels() -> None:
    """Answer tiny questions by every model and one about many bodies; what they compile is kept beside the package."""
    from wiggleroom.assembly import patterns
    from wiggleroom.disassembly.interlock import check
    from wiggleroom.maximise import flex

    for model in ("walls", "hull", "halfplane"):
        flex(patterns.chain(2), model=model)
    flex(patterns.grid(19, 19), search=0)
    check(patterns.chain(2, joint="swallowtail", gap=0.08))


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
