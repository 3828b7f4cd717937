"""The wheel holds what it needs, and kernels are compiled for it; that packages are the same when built again, `make dist` shows."""

from __future__ import annotations

import os
import runpy
import subprocess
import zipfile
from pathlib import Path
from typing import Any

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


def test_kernels_are_compiled_with_what_is_installed_for_the_build(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    setuptools = pytest.importorskip("setuptools")
    made: dict[str, Any] = {}
    run: list[dict[str, str]] = []

    def ran(words: list[str], *, env: dict[str, str], **_: Any) -> subprocess.CompletedProcess[bytes]:
        run.append(env)
        return subprocess.CompletedProcess(words, 0)

    monkeypatch.setattr(setuptools, "setup", lambda **said: made.update(said))
    monkeypatch.setattr("setuptools.command.build_py.build_py.run", lambda _: None)
    monkeypatch.setattr(subprocess, "run", ran)
    monkeypatch.setenv("PYTHONPATH", "/installed/for/the/build")
    monkeypatch.delenv("WIGGLEROOM_KERNELS", raising=False)
    runpy.run_path(str(Path(__file__).parents[1] / "setup.py"))
    command = made["cmdclass"]["build_py"](setuptools.Distribution())
    command.build_lib, command.editable_mode = str(tmp_path), False
    command.run()
    assert run[0]["PYTHONPATH"].split(os.pathsep) == [str(tmp_path), "/installed/for/the/build"]
