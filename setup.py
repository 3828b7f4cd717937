"""The build of a wheel compiles the numerical kernels, so that a fresh installation answers without a compiler.

With `WIGGLEROOM_KERNELS=none` it does not: then the wheel is the same wherever it is built.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py


class BuildWithKernels(build_py):
    """Copies the package, then adds its kernels as machine code for this platform; others compile at first use."""

    def run(self) -> None:
        """Build."""
        super().run()
        if self.editable_mode or os.environ.get("WIGGLEROOM_KERNELS") == "none":
            return
        built = Path(self.build_lib).resolve()
        folder = built / "wiggleroom" / "compiled" / "kernels"
        path = os.pathsep.join([str(built), *os.environ.get("PYTHONPATH", "").split(os.pathsep)]).rstrip(os.pathsep)
        # the path that is there leads to what pip has installed for the build
        here = os.environ | {"PYTHONPATH": path, "PYTHONHASHSEED": "0", "PYTHONDONTWRITEBYTECODE": "1"}
        done = subprocess.run([sys.executable, "-m", "wiggleroom.cli.compile", str(folder)], env=here, cwd=built)
        if done.returncode:
            print("the kernels could not be compiled; the first answer will compile them", file=sys.stderr)


setup(cmdclass={"build_py": BuildWithKernels})
