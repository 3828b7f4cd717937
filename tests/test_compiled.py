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
    inner.write_text(inner.read_text().replace("2.0", "3.0"))
    assert run(package, ASK).split() == ["31.0", "0"]
    assert run(package, ASK).split() == ["31.0", "1"]


def test_kernels_of_the_package_depend_on_what_they_call(package: Path) -> None:
    code = """
from wiggleroom.freespace.cells import grow
from wiggleroom.compiled.jit_options import source_key
from pathlib import Path
print(source_key(Path(grow.__file__)))
"""
    before = run(package, code)
    edges = package / "wiggleroom" / "freespace" / "cells" / "pair_edges.py"
    edges.write_text(edges.read_text() + "\n# another line\n")
    assert run(package, code) != before


def test_what_was_kept_of_other_sources_is_not_even_opened(package: Path) -> None:
    assert run(package, ASK).split() == ["21.0", "0"]
    for index in (package / "wiggleroom" / "geometry" / "__pycache__").glob("*.nbi"):
        index.write_bytes(b"not an index")
    inner = package / "wiggleroom" / "geometry" / "inner.py"
    inner.write_text(inner.read_text().replace("2.0", "4.0"))
    assert run(package, ASK).split() == ["41.0", "0"]
