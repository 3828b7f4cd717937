"""Questions asked of a cutting sheet: nothing is answered where its assembly is not sure or its plates are thicker than slots."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
import shapely
from benchmarks.sheet_drawings import Design, box, burnt, egg_crate, shelf, stool
from benchmarks.sheet_judge import judge

from wiggleroom.errors import InputError
from wiggleroom.mating.assembled_sheet import AssembledSheet, assemble_sheet
from wiggleroom.mating.cutting_sheet import read_sheet
from wiggleroom.mating.hints import Hints
from wiggleroom.mating.plates_writer import write_plates

pytest.importorskip("manifold3d")

Command = Callable[..., int]


@pytest.fixture
def sheet(tmp_path: Path) -> Path:
    """A closed box of which only one assembly is possible."""
    path = tmp_path / "sheet.svg"
    path.write_text(box("box", 75, 52, 38, 3, 8).svg(1))
    return path


def test_flex_of_a_sheet_is_flex_of_what_assemble_writes(command: Command, tmp_path: Path, sheet: Path) -> None:
    question = ("--gap", 0.1, "--fix", "bottom", "--pull", "top:+z", "--pull", "top:+x")
    plates, here, there = (tmp_path / name for name in ("plates.json", "here.json", "there.json"))
    assert command("assemble", sheet, "--thickness", 3, "-o", plates) == 0
    assert command("flex", sheet, "--thickness", 3, *question, "--json", here) == 0
    assert command("flex", plates, *question, "--json", there) == 0
    one, other = (json.loads(path.read_text()) for path in (here, there))
    assert one["dimension"] == 3
    assert one["verdict"] == other["verdict"]
    assert one["objective"] == other["objective"]


def test_a_sheet_that_is_not_sure_is_not_answered(
    command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sheet, answer = tmp_path / "crate.svg", tmp_path / "answer.json"
    sheet.write_text(egg_crate("crate", [30, 75, 110], [25, 60], 40, 3, 150, 90).svg())
    question = ("--gap", 0.1, "--fix", "x0", "--pull", "x1:+x", "--json", answer)
    assert command("flex", sheet, "--thickness", 3, *question) == 3
    said = capsys.readouterr().err.strip().splitlines()
    assert any("more than one way" in line for line in said)
    assert "is not sure" in said[-1]
    assert all(line.startswith(f"{sheet}: ") for line in said)
    assert not answer.exists()


def test_a_panel_without_a_place_is_named(command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import shapely

    design = stool("stool", 60, 50, 3)
    design.panels["plain"] = shapely.box(0, 0, 50, 40)
    sheet = tmp_path / "stool.svg"
    sheet.write_text(design.svg())
    assert command("check", sheet, "--thickness", 3, "--gap", 0.1, "--fix", "seat") == 3
    assert "not placed: plain" in capsys.readouterr().err


def test_one_panel_of_a_sheet_may_be_thinner(command: Command, tmp_path: Path, sheet: Path) -> None:
    """The lid of a box sticks in the walls' fingers: a thinner one has more room up and down."""
    moved = []
    for more in ((), ("--thickness", "top:2.6")):
        answer = tmp_path / "answer.json"
        question = ("--gap", 0.1, "--fix", "front,back,left,right,bottom", "--pull", "top:-z")
        assert command("flex", sheet, "--thickness", 3, *more, *question, "--json", answer) == 0
        moved.append(json.loads(answer.read_text())["objective"])
    assert moved[0] > 0
    assert moved[1] == pytest.approx(moved[0] + 0.2, abs=1e-4)  # the middle of the thickness stays where it was


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--thickness", "lid:x"), "it must be a length in mm larger than 0, or NAME:2.8"),
        (("--thickness", "top:2.8"), "the thickness of the material is not known"),
        (("--thickness", "3", "--burn", "-1"), "--burn -1: it must be 0 mm or more"),
        (("--burn", "0.1"), "--burn goes with --thickness"),
        (("--thickness", "3", "--flatten", "0.1"), "--flatten is for parts in the plane"),
        (("--thickness", "3", "--thickness", "topp:2.8"), 'there is no panel "topp"; did you mean "top"?'),
    ],
)
def test_bad_options_of_a_sheet_are_one_line(
    command: Command, sheet: Path, capsys: pytest.CaptureFixture[str], options: tuple[str, ...], said: str
) -> None:
    assert command("flex", sheet, *options, "--gap", 0.1, "--fix", "bottom", "--pull", "top:+z") == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert sum(said in line for line in lines) == 1


def test_an_assembly_file_has_its_thickness_already(
    command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.json"
    path.write_text('{"format": "wiggleroom/2", "parts": [{"name": "a", "boxes": [[0, 0, 0, 4, 2, 2]]}]}')
    assert command("flex", path, "--thickness", 3, "--fix", "a") == 2
    assert "leave them out" in capsys.readouterr().err


# -- plates that are thicker than their slots ------------------------------------------------------------------------


def assembled(folder: Path, design: Design, thickness: float, **more: object) -> AssembledSheet:
    sheet = folder / "sheet.svg"
    sheet.write_text(design.svg(2))
    return assemble_sheet(read_sheet(sheet), thickness, **more)  # type: ignore[arg-type]


def overlap(folder: Path, found: AssembledSheet) -> float:
    (folder / "plates.json").write_text(write_plates(found))
    return judge(folder / "plates.json").overlap


def slotted(burn: float, slot: float = 3.0) -> Design:
    """A wall whose three tabs go through slots of a base, with room along them."""
    places = (10.0, 30.0, 50.0)
    base = shapely.box(0, 0, 60, 40)
    wall = shapely.box(0, 0, 60, 30)
    for x in places:
        base = base.difference(shapely.box(x - 1.6, 20 - slot / 2, x + 1.6, 20 + slot / 2))
        wall = wall.union(shapely.box(x - 1.5, 30, x + 1.5, 33))
    design = Design("slots", slot, {"base": base, "wall": wall}, {frozenset({"base", "wall"})}, (60, 40, 33))
    return burnt(design, burn) if burn else design


@pytest.mark.parametrize(("excess", "burn"), [(0.05, 0.06), (0.6, 0.0)])
def test_a_wall_thicker_than_its_slots_is_named_with_what_is_too_much(
    tmp_path: Path, excess: float, burn: float
) -> None:
    hints = Hints(thicknesses={"wall": 3 + excess})
    with pytest.raises(InputError) as said:
        assembled(tmp_path, slotted(burn), 3, burn=burn, hints=hints)
    (line,) = said.value.findings
    assert f'panel "wall" is {excess:g} mm too thick for three slots of "base": ' in line
    assert f"--relieve {excess / 2:g} " in line


def test_a_thinner_wall_fits_as_it_is(tmp_path: Path) -> None:
    found = assembled(tmp_path, slotted(0.06), 3, burn=0.06, hints=Hints(thicknesses={"wall": 2.7}))
    assert found.sure
    assert found.relief == 0
    assert overlap(tmp_path, found) < 1e-5


@pytest.mark.parametrize(
    ("design", "slots"),
    [
        (egg_crate("cross", [50], [40], 60, 5, 110, 90), {"two"}),
        (stool("stool", 60, 50, 3), {"six"}),
        (burnt(shelf("shelf", 120, 80, [40, 110], 4, 150), 0.08), {"eight"}),
    ],
    ids=["half laps", "stool", "shelf with burn"],
)
def test_material_thicker_than_all_slots(tmp_path: Path, design: Design, slots: set[str]) -> None:
    """Every slot is as wide as the material is said to be thick; so each is too narrow by the excess."""
    excess = 0.4
    with pytest.raises(InputError) as said:
        assembled(tmp_path, design, design.thickness + excess, burn=design.burn)
    (line,) = said.value.findings
    assert f" are {excess:g} mm too thick for " in line
    assert any(f"for {count} slots of" in line for count in slots)


def test_fingers_at_edges_have_room_outward(tmp_path: Path) -> None:
    """A closed box of fingers holds thicker plates: every one stands out by the excess, and nothing is shaved."""
    excess = 0.3
    found = assembled(tmp_path, box("box", 75, 52, 38, 3, 8), 3 + excess, burn=0.0)
    assert found.sure
    assert found.relief == 0
    (tmp_path / "plates.json").write_text(write_plates(found))
    judged = judge(tmp_path / "plates.json")
    assert judged.overlap < 1e-5
    assert judged.size == pytest.approx(sorted(size + 2 * excess for size in (75, 52, 38)), abs=1e-3)
    assert any("stand up to" in note for note in found.notes)


def test_fingers_wider_than_their_gaps_are_too_wide(tmp_path: Path) -> None:
    """Outlines drawn 0.1 mm larger of which only 0.07 is said: fingers are 0.06 mm wider each, gaps as much narrower."""
    with pytest.raises(InputError) as said:
        assembled(tmp_path, burnt(box("box", 75, 52, 38, 3, 8), 0.1), 3, burn=0.07)
    assert all(" 0.12 mm too wide for " in line for line in said.value.findings)
    assert len(said.value.findings) == 1


def test_a_burn_that_nobody_knows_is_said_and_bounded(tmp_path: Path) -> None:
    found = assembled(tmp_path, slotted(0.06), 3)
    assert found.sure
    assert found.relief == pytest.approx(0.06, abs=1e-4)
    assert any("--burn 0.06 says it" in note for note in found.notes)
    with pytest.raises(InputError, match="too thick for three slots"):
        assembled(tmp_path, slotted(0.0), 3.4)  # a cut would have to be 0.4 mm wide
    with pytest.raises(InputError, match=r"0\.1 mm too thick for three slots"):
        assembled(tmp_path, slotted(0.06), 3, hints=Hints(thicknesses={"wall": 3.1}))


def test_shaving_is_done_where_it_is_asked_for_and_is_not_sure(command: Command, tmp_path: Path) -> None:
    sheet, out, answer = (tmp_path / name for name in ("sheet.svg", "out.json", "answer.json"))
    sheet.write_text(slotted(0.06).svg())
    known = ("--thickness", 3, "--thickness", "wall:3.1", "--burn", 0.06)
    assert command("assemble", sheet, *known, "-o", out) == 2
    assert not out.exists()
    assert command("assemble", sheet, *known, "--relieve", 0.04, "-o", out) == 2
    assert command("assemble", sheet, *known, "--relieve", 0.05, "-o", out, "--json", answer) == 0
    said = json.loads(answer.read_text())
    assert said["certainty"] == "not sure"
    assert said["relief"] == pytest.approx(0.05, abs=1e-4)
    (misfit,) = said["misfits"]
    assert (misfit["kind"], misfit["panel"], misfit["slots_of"], misfit["places"]) == ("thickness", "wall", "base", 3)
    assert misfit["excess"] == pytest.approx(0.1, abs=1e-4)
    assert judge(out).overlap < 1e-5


@pytest.mark.parametrize("question", [("check",), ("flex", "--fix", "base", "--pull", "wall:+x")])
def test_questions_to_a_sheet_that_does_not_fit_are_refused(
    command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str], question: tuple[str, ...]
) -> None:
    """Whatever gap is asked for: it does not make plates thinner."""
    sheet = tmp_path / "sheet.svg"
    sheet.write_text(slotted(0.0).svg())
    known = (sheet, "--thickness", 3, "--thickness", "wall:3.1", "--burn", 0)
    assert command(question[0], *known, *question[1:], "--gap", 0.2) == 2
    assert '0.1 mm too thick for three slots of "base"' in capsys.readouterr().err
    assert command(question[0], *known, *question[1:], "--gap", 0.2, "--relieve", 0.05) in (0, 1)
