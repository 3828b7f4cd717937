"""Boxes with five and more walls: put together, judged by solids built from the file alone, and sure only where nothing else fits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

pytest.importorskip("manifold3d")

from benchmarks.sheet_drawings import Design, burnt
from benchmarks.sheet_judge import judge

from tests.prism_sheets import prism, regular, turning
from wiggleroom.mating.assembled_sheet import AssembledSheet, assemble_sheet
from wiggleroom.mating.congruence import PanelIsometries
from wiggleroom.mating.cutting_sheet import read_sheet
from wiggleroom.mating.plates_writer import write_plates

Floats = np.ndarray
OVERLAP = 1e-5


def irregular(seed: int, radius: float) -> Floats:
    turns = (np.arange(6) + np.random.default_rng(seed).uniform(-0.25, 0.25, 6)) * np.pi / 3
    return radius * np.column_stack([np.cos(turns), np.sin(turns)])


def assembled(folder: Path, design: Design, seed: int = 3, extra: str = "") -> AssembledSheet:
    sheet = folder / "sheet.svg"
    sheet.write_text(design.svg(seed).replace("</svg>", extra + "</svg>"))
    return assemble_sheet(read_sheet(sheet), design.thickness, burn=design.burn or None)


def assert_is_prism(found: AssembledSheet, folder: Path, design: Design, corners: Floats) -> None:
    """No overlap, all joints, all walls upright on one side of the floor and turned as its edges."""
    (folder / "out.json").write_text(write_plates(found))
    judged = judge(folder / "out.json")
    assert set(judged.names) == set(design.panels)
    assert judged.overlap < OVERLAP
    assert len(found.joints) == len(design.joined)
    (body,) = found.bodies
    normal = {found.plates[row].name: turn[:, 2] for row, turn in zip(body.rows, body.turns, strict=True)}
    move = {found.plates[row].name: move for row, move in zip(body.rows, body.moves, strict=True)}
    walls = [name for name in normal if name.startswith("wall")]
    across = [float((move[name] - move["floor"]) @ normal["floor"]) for name in walls]
    assert abs(np.sign(across).sum()) == len(walls)
    assert max(abs(float(normal[name] @ normal["floor"])) for name in walls) < 1e-6
    turned = np.cumsum(turning(corners))
    got, asked = (
        sorted(np.abs(np.array(each) @ np.array(each).T).ravel())
        for each in ([normal[name] for name in walls], np.column_stack([np.cos(turned), np.sin(turned)]))
    )
    assert np.abs(np.array(got) - asked).max() < 0.01


@pytest.mark.parametrize(
    ("corners", "more"),
    [
        (regular(6, 40), {"lid": True}),
        (irregular(0, 55), {}),
        (np.array([[-60.0, 0], [-30, -40], [30, -40], [60, 0], [30, 40], [-30, 40]]), {}),
    ],
    ids=["hexagon with lid", "irregular", "flat"],
)
def test_a_prism_comes_together_and_nothing_else_fits(tmp_path: Path, corners: Floats, more: dict) -> None:
    design = prism(corners, 70, 3.0, **more)
    found = assembled(tmp_path, design)
    assert_is_prism(found, tmp_path, design, corners)
    assert found.sure


def test_burn_engraving_and_labels_change_nothing(tmp_path: Path) -> None:
    design, corners = burnt(prism(regular(6, 40), 70, 3.0, lid=True), 0.08), regular(6, 40)
    marks = '<text x="20" y="20" font-size="5">lid</text><path d="M60,20 l8,0 l0,8" fill="none" stroke="red"/>'
    found = assembled(tmp_path, design, extra=marks)
    assert_is_prism(found, tmp_path, design, corners)
    assert found.sure


def test_equal_outlines_of_two_thicknesses_do_not_stand_for_each_other() -> None:
    plate = shapely.box(-9, -6, 9, 6)
    assert PanelIsometries({0: plate, 1: plate}, thickness={0: 3.0, 1: 3.0}).between(0, 1)
    assert not PanelIsometries({0: plate, 1: plate}, thickness={0: 3.0, 1: 6.0}).between(0, 1)


@pytest.mark.slow
def test_a_prism_without_one_wall_is_not_sure(tmp_path: Path) -> None:
    design = prism(regular(5, 43), 70, 3.0)
    del design.panels["wall 4"]
    found = assembled(tmp_path, design)
    assert not found.sure
