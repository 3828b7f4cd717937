"""The packages: built twice they are the same, and the wheel holds what it needs."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

pytest.importorskip("build")
from release.build_twice import build, digest


@pytest.mark.slow
def test_packages_are_the_same_when_they_are_built_again(tmp_path: Path) -> None:
    first, second = (build(tmp_path / name, 1_700_000_000) for name in ("one", "two"))
    assert [(p.name, digest(p)) for p in first] == [(p.name, digest(p)) for p in second]
    _, wheel = first
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
