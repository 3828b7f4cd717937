"""What the FreeCAD macro does outside FreeCAD: outlines in, an answer of the command line out."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import pytest

MACRO = Path(__file__).parents[1] / "extras" / "freecad" / "wiggleroom.FCMacro"


@pytest.fixture(scope="module")
def macro() -> dict:
    return runpy.run_path(str(MACRO), run_name="macro")


@pytest.fixture
def program(tmp_path: Path) -> str:
    """The command line as one word."""
    script = tmp_path / "program.py"
    script.write_text("import sys\nfrom wiggleroom.cli import main\nsys.exit(main())\n")
    return f"{sys.executable} {script}"


def square(half: float) -> list[tuple[float, float]]:
    return [(-half, -half), (half, -half), (half, half), (-half, half)]


def test_a_peg_in_a_hole_moves_by_its_play(macro: dict, program: str) -> None:
    parts = [
        macro["part_of"]("rim", [square(5.2), square(10.0)], True),
        macro["part_of"]("peg", [square(5.0)], False),
    ]
    assert len(parts[0]["holes"]) == 1
    answer = macro["ask"](macro["question"](parts, 0.1, "peg", (1, 0)), program)
    assert answer["parts"]["peg"]["dx"] == pytest.approx(0.3, rel=1e-6)
    assert answer["verdict"] in ("proven", "optimal")
    assert macro["sentence"](answer, "peg") == f"peg moves 0.3 mm ({answer['verdict']})"


def test_what_is_wrong_is_told_in_the_words_of_the_program(macro: dict, program: str) -> None:
    parts = [macro["part_of"]("peg", [square(5.0)], False)]
    with pytest.raises(RuntimeError, match="nothing is fixed"):
        macro["ask"](macro["question"](parts, 0.1, "peg", (1, 0)), program)
