"""STEP files: the same part as boxes and as STEP gives the same answer; bodies by name; what is wrong in one line."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wiggleroom as wr
from wiggleroom.errors import MissingExtraError
from wiggleroom.spatial.solids.solid_boolean import centroid_of
from wiggleroom.spatial.solids.spatial_file import read_spatial

LID = [[0, 0, 30, 60, 40, 33], [3, 3, 27, 57, 37, 30]]
CASE = [
    [0, 0, 0, 60, 40, 3], [0, 0, 0, 3, 40, 30], [57, 0, 0, 60, 40, 30], [0, 0, 0, 60, 3, 30], [0, 37, 0, 60, 40, 30],
]  # fmt: skip


def box(low: list[float], high: list[float]) -> Any:
    prim = pytest.importorskip("OCP.BRepPrimAPI")
    gp = pytest.importorskip("OCP.gp")
    return prim.BRepPrimAPI_MakeBox(gp.gp_Pnt(*map(float, low)), gp.gp_Pnt(*map(float, high))).Shape()


def union(boxes: list[list[float]]) -> Any:
    algo = pytest.importorskip("OCP.BRepAlgoAPI")
    found = box(boxes[0][:3], boxes[0][3:])
    for b in boxes[1:]:
        found = algo.BRepAlgoAPI_Fuse(found, box(b[:3], b[3:])).Shape()
    return found


def write(path: Path, shapes: dict[str, Any], unit: str = "MM") -> None:
    from OCP.collections import Sequence_TDF_Label  # noqa: F401
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.STEPControl import STEPControl_AsIs
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("made"))
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    for name, shape in shapes.items():
        TDataStd_Name.Set_s(tool.AddShape(shape, False), TCollection_ExtendedString(name))
    writer = STEPCAFControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", unit)
    writer.Transfer(document, STEPControl_AsIs)
    writer.Write(str(path))
    Interface_Static.SetCVal_s("write.step.unit", "MM")


def assembly(folder: Path, *parts: dict) -> Path:
    path = folder / "box.json"
    path.write_text(json.dumps({"format": "wiggleroom/2", "gap": 0.2, "parts": list(parts)}))
    return path


@pytest.mark.parametrize("unit", ["MM", "INCH"])
def test_the_same_parts_as_boxes_and_as_step_give_the_same_answer(tmp_path: Path, unit: str) -> None:
    pytest.importorskip("OCP")
    write(tmp_path / "box.step", {"case": union(CASE), "lid": union(LID)}, unit)
    lock = {"lock": ["z", "rx", "ry"]}
    made = assembly(
        tmp_path,
        {"name": "case", "mesh": "box.step#case", "fixed": True},
        {"name": "lid", "mesh": "box.step#lid", **lock},
    )
    step = wr.read(made)
    plain = wr.read(
        assembly(tmp_path, {"name": "case", "boxes": CASE, "fixed": True}, {"name": "lid", "boxes": LID, **lock})
    )
    for pull in (wr.Pull("lid", (1, 0, 0)), wr.Pull("lid", (0.3, 0.7, 0), (0, 40, 33)), wr.Turn("lid", (0, 0, 1))):
        one, other = wr.flex(step, pull), wr.flex(plain, pull)
        assert one.verdict == other.verdict == "optimal"
        assert one.objective == pytest.approx(other.objective, abs=1e-9)


def test_a_turned_part_is_as_exact(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf

    turn = gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(0.3, -0.5, 0.8)), 0.7)
    write(tmp_path / "turned.step", {"lid": BRepBuilderAPI_Transform(union(LID), turn, True).Shape()})
    surface = read_spatial(assembly(tmp_path, {"name": "lid", "mesh": "turned.step"})).parts[0].solid
    volume = 60 * 40 * 3 + 54 * 34 * 3
    assert centroid_of(surface)[0] == pytest.approx(volume, rel=1e-12)  # type: ignore[arg-type]


def test_curved_faces_are_said_and_near(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder

    write(tmp_path / "pin.stp", {"pin": BRepPrimAPI_MakeCylinder(5.0, 20.0).Shape()})
    drawing = read_spatial(assembly(tmp_path, {"name": "pin", "mesh": "pin.stp"}))
    assert any("curved faces are flattened to" in note for note in drawing.notes)
    corners = drawing.parts[0].solid.vertices  # type: ignore[union-attr]
    assert np.abs(np.hypot(corners[:, 0], corners[:, 1]) - 5.0).max() < 1e-9
    assert centroid_of(drawing.parts[0].solid)[0] == pytest.approx(np.pi * 25 * 20, rel=0.01)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("reference", "says"),
    [
        ("two.step", "name one as"), ("two.step#c", 'no body "c"'), ("bad.step", "cannot be read as STEP"),
        ("empty.step", "is empty"), ("none.step", "no such file"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_step_file_is_one_line(
    tmp_path: Path, reference: str, says: str, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("OCP")
    write(tmp_path / "two.step", {"a": box([0, 0, 0], [1, 1, 1]), "b": box([5, 0, 0], [6, 1, 1])})
    (tmp_path / "bad.step").write_text("ISO-10303-21;\nHEADER;\nnonsense")
    (tmp_path / "empty.step").write_text("")
    capfd.readouterr()
    with pytest.raises(wr.InputError, match=says) as problem:
        read_spatial(assembly(tmp_path, {"name": "x", "mesh": reference}))
    assert len(problem.value.findings) == 1
    said = capfd.readouterr()
    assert said.out + said.err == ""  # the library writes nothing


def test_without_the_extra_it_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.step").write_text("ISO-10303-21;")
    monkeypatch.setitem(sys.modules, "OCP", None)
    monkeypatch.setattr("wiggleroom.errors.find_spec", lambda name: None if name == "OCP" else object())
    with pytest.raises(MissingExtraError, match=r"\[step\]"):
        read_spatial(assembly(tmp_path, {"name": "x", "mesh": "a.step"}))
