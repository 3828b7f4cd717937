"""The wheel holds what it needs, and kernels are compiled for it; that packages are the same when built again, `make dist` shows."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

pytest.importorskip("build")
from release.build_twice import build


@pytest.mark.slow
def test_the_wheel_holds_what_it_needs(tmp_path: Path) -> None:
    _, wheel = build(tmp_path, 1_700_000_000)
    assert wheel.name.endswith("-py3-none-any.whl")
    names = zipfile.ZipFile(wheel).namelist()
    for needed in (
        "report/web/page.js",
        "report/web/index.html",
        "report/web/space-view.js",
        "py.typed",
        "cli/__init__.py",
    ):
        assert f"wiggleroom/{needed}" in names
    assert any(name.endswith("licenses/LICENSE") for name in names)
    assert not any("__pycache__" in name or name.startswith("tests") for name in names)
