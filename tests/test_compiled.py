"""What was compiled follows the sources: an edit of an inner function reaches the outer ones that were kept."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1] / "src" / "wiggleroom"


def run(root: Path, code: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {"PYTHONPATH": str(root)},
    )
    return done.stdout.strip()


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """Directory with a copy of the package, and two compiled functions in it of which one calls the other."""
    shutil.copytree(ROOT, tmp_path / "wiggleroom", ignore=shutil.ignore_patterns("__pycache__", "web", "fonts"))
    head = "from wiggleroom.compiled.jit_options import NO_ALLOCATION, njit\n"
    inner = "FACTOR = 2.0\n\n@njit(**NO_ALLOCATION)\ndef scaled(x):\n    return FACTOR * x\n"
    outer = "from wiggleroom.geometry.inner import scaled\n\n@njit(**NO_ALLOCATION)\ndef applied(x):\n    return scaled(x) + 1.0\n"
    (tmp_path / "wiggleroom" / "geometry" / "inner.py").write_text(head + inner)
    (tmp_path / "wiggleroom" / "geometry" / "outer.py").write_text(head + outer)
    return tmp_path


ASK = """
from wiggleroom.geometry.outer import applied
print(applied(10.0), sum(applied.stats.cache_hits.values()))
"""


def test_an_edit_of_an_inner_function_reaches_the_outer_one(package: Path) -> None:
    assert run(package, ASK).split() == ["21.0", "0"]
    assert run(package, ASK).split() == ["21.0", "1"], "what was compiled is kept"
    inner = package / "wiggleroom" / "geometry" / "inner.py"
    inner.write_text(inner.read_text().replace("2.0", "3.25"))
    assert run(package, ASK).split() == ["33.5", "0"]
    assert run(package, ASK).split() == ["33.5", "1"]


def test_what_was_kept_is_loaded_without_the_tables_of_the_compiler(package: Path) -> None:
    made = package / "wiggleroom" / "geometry" / "made.py"
    made.write_text(
        "import numpy as np\nfrom wiggleroom.compiled.jit_options import OPTIONS, njit\n"
        "@njit(**OPTIONS)\ndef grown(n):\n    a = np.arange(n).reshape(2, -1)\n    if n > 9:\n        raise ValueError('too many')\n"
        "    return np.hstack((a, a.copy()))\n"
    )
    code = """
import sys
from wiggleroom.geometry.made import grown
said = []
try:
    grown(12)
except ValueError as error:
    said.append(str(error))
print(grown(6).sum(), *said, "numba.np.arrayobj" in sys.modules)
"""
    assert run(package, code).split() == ["30", "too", "many", "True"]
    assert run(package, code).split() == ["30", "too", "many", "False"]


def test_extensions_of_scipy_are_those_that_its_packages_have() -> None:
    code = """
import sys, numpy as np
from concurrent.futures import ThreadPoolExecutor
from wiggleroom.compiled.scipy_extensions import qhull
with ThreadPoolExecutor(4) as threads:
    assert len(set(threads.map(lambda _: qhull().ConvexHull, range(4)))) == 1
from wiggleroom.program import multifrontal
cube = np.stack(np.meshgrid(*[[0.0, 2.0]] * 3), -1).reshape(-1, 3)
print(qhull().ConvexHull(cube).volume, sorted({"scipy.linalg", "scipy.spatial", "scipy.sparse"} & set(sys.modules)))
import scipy.linalg, scipy.spatial
print(qhull().ConvexHull is scipy.spatial.ConvexHull, scipy.linalg.cholesky(4 * np.eye(1))[0, 0])
print(scipy.linalg.cython_blas.__name__, scipy.spatial._qhull.__name__)
"""
    said = run(ROOT.parent, code).splitlines()
    assert said == ["8.0 []", "True 2.0", "scipy.linalg.cython_blas scipy.spatial._qhull"]


def test_a_question_in_the_plane_with_a_quick_bound_does_without_what_is_slow_to_load() -> None:
    code = """
import sys, wiggleroom as wr
answer = wr.flex(wr.patterns.chain(5))
packages = {"scipy.linalg", "scipy.spatial", "scipy.special", "scipy.optimize", "wiggleroom.spatial.planes"}
print(answer.at_most is not None, sorted(packages & set(sys.modules)))
"""
    assert run(ROOT.parent, code) == "True []"
