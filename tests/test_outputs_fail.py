"""Outputs that cannot be written, and links that lead nowhere: one line that names the file, and nothing half written."""

from __future__ import annotations

import errno
import json
import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from wiggleroom.files import write_whole

Command = Callable[..., int]
PLANE = {
    "format": "wiggleroom/1",
    "gap": 0.2,
    "parts": [
        {
            "name": "a",
            "outline": [[0, 0], [30, 0], [30, 10], [20, 10], [20, 5], [10, 5], [10, 10], [0, 10]],
            "fixed": True,
        },
        {"name": "b", "outline": [[10, 5], [20, 5], [20, 12], [10, 12]]},
    ],
    "pull": [{"part": "b", "direction": [1, 0], "point": [15, 8]}],
}
SPACE = {
    "format": "wiggleroom/2",
    "parts": [
        {"name": "a", "boxes": [[0, 0, 0, 4, 2, 2]], "fixed": True},
        {"name": "b", "boxes": [[5, 0, 0, 9, 2, 2]]},
    ],
    "pull": [{"part": "b", "direction": [-1, 0, 0]}],
}


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plane.json").write_text(json.dumps(PLANE))
    (tmp_path / "space.json").write_text(json.dumps(SPACE))
    (tmp_path / "sheet.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 90 40"><path d="M0 0h40v30h-40z"/><path d="M50 0h40v30h-40z"/></svg>'
    )
    return tmp_path


OUTPUTS = [
    ("flex", "plane.json", "--json", "a.json"),
    ("flex", "plane.json", "--picture", "a.svg"),
    ("flex", "plane.json", "--picture", "a.png"),
    ("flex", "plane.json", "--picture", "a.gif"),
    ("flex", "plane.json", "--picture", "a.film.svg"),
    ("flex", "plane.json", "--picture", "a.html"),
    ("flex", "plane.json", "--csv", "a.csv"),
    ("flex", "plane.json", "--moved", "a.dxf"),
    ("flex", "plane.json", "--arrays", "a.npz"),
    ("flex", "space.json", "--picture", "a.glb"),
    ("convert", "plane.json", "", "a.svg"),
    ("make", "grid 2 2", "-o", "g.json"),
    ("assemble", "sheet.svg", "-o", "as.json"),
]


def _arguments(question: str, source: str, option: str, place: str) -> list[str]:
    return [question, *source.split(), *([option] if option else []), place]


@pytest.mark.parametrize("output", OUTPUTS, ids=lambda output: f"{output[0]} {output[3]}")
def test_a_full_disk_names_the_file_and_leaves_nothing(
    here: Path,
    command: Command,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    output: tuple[str, ...],
) -> None:
    """As a real one does, the disk fails while data is written: the error of the system names no file."""
    real = Path.open

    class Full:
        def __init__(self, file: object) -> None:
            self.file = file

        def __enter__(self) -> Full:
            return self

        def __exit__(self, *_: object) -> None:
            self.file.close()  # type: ignore[attr-defined]

        def write(self, _: bytes) -> None:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(
        Path,
        "open",
        lambda self, mode="r", *a, **k: Full(real(self, mode, *a, **k)) if mode == "xb" else real(self, mode, *a, **k),
    )
    before = set(os.listdir())
    assert command(*_arguments(*output)) == 2
    last = capsys.readouterr().err.strip().splitlines()[-1]
    assert last.startswith(f"{output[3]}: ")
    assert "no space left on device" in last
    assert set(os.listdir()) == before


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
@pytest.mark.parametrize("output", OUTPUTS, ids=lambda output: f"{output[0]} {output[3]}")
def test_an_output_that_is_a_link_to_itself_is_one_line(
    here: Path, command: Command, capsys: pytest.CaptureFixture[str], output: tuple[str, ...]
) -> None:
    os.symlink(output[3], output[3])
    assert command(*_arguments(*output)) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert line.endswith(f"{output[3]}: this is a link that leads back to itself; give another name")


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
@pytest.mark.parametrize(
    ("question", "ending"), [("flex", "svg"), ("check", "dxf"), ("plan", "json"), ("parts", "lbrn2")]
)
def test_a_drawing_that_is_a_link_to_itself_is_one_line(
    here: Path, command: Command, capsys: pytest.CaptureFixture[str], question: str, ending: str
) -> None:
    os.symlink(f"loop.{ending}", f"loop.{ending}")
    assert command(question, f"loop.{ending}") == 2
    assert (
        capsys.readouterr().err.strip()
        == f"loop.{ending}: is a link that leads back to itself; give the path of a drawing"
    )


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_what_an_assembly_names_may_not_lead_back_to_itself(
    here: Path, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    os.symlink("loop.stl", "loop.stl")
    os.symlink("loop.svg", "loop.svg")
    parts = [{"name": "a", "mesh": "loop.stl", "fixed": True}, {"name": "b", "outline": "loop.svg#b", "thickness": 3}]
    (here / "named.json").write_text(json.dumps({"format": "wiggleroom/2", "parts": parts}))
    assert command("check", "named.json") == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert [line.partition("is a link")[2] for line in lines] == [" that leads back to itself; put the file there"] * 2


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
def test_a_full_device_is_named() -> None:
    with pytest.raises(OSError, match="/dev/full"):
        write_whole("/dev/full", "text")
