"""Tolerances: worst case against closed forms and against every corner, tables and files."""

from __future__ import annotations

import csv
import itertools
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import wiggleroom as wr
from tests.test_allowable_gap import peg_in_slot
from tests.test_spatial import PEG, PLATE, spatial
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing import read_drawing, write_drawing
from wiggleroom.drawing.model import Pull, Tolerance
from wiggleroom.sensitivity.worst_case import deviated
from wiggleroom.verdict import Certainty


def test_a_stack_of_tolerances_has_a_closed_form() -> None:
    """The peg moves 3 mm and the gap; each outline further in adds what it lies further in."""
    some = [
        Tolerance(("peg",), plus=0.01, minus=0.02),
        Tolerance(("rim",), plus=0.03, minus=0.04, outline=2),
        Tolerance(("rim",), plus=0.5, minus=0.5, outline=1),  # the rim's outside holds nothing
    ]
    found = wr.worst_case(assemble(peg_in_slot(), gap=0.2), some, limit=3.3)
    assert found.nominal.objective == pytest.approx(3.2, rel=1e-6)
    assert found.loosest.objective == pytest.approx(3.26, rel=1e-6)
    assert found.tightest is not None
    assert found.tightest.objective == pytest.approx(3.16, rel=1e-6)
    assert found.first_order == pytest.approx(3.26, rel=1e-5)
    assert found.root_sum_square == pytest.approx(3.2 + np.hypot(0.02, 0.04), rel=1e-5)
    assert [c.tolerance.outline for c in found.contributions] == [2, None, 1]
    assert found.percent == pytest.approx([200 / 3, 100 / 3, 0], abs=1e-2)
    assert found.keeps


def test_the_worst_of_all_corners() -> None:
    chain = wr.patterns.chain(3, joint="swallowtail", gap=0.02)
    some = [
        Tolerance(("b1",), 0.001, 0.002),
        Tolerance(("b3",), 0.002, 0.001, outline=1),
        Tolerance(("b2", "b3"), 0.003, 0.004, nominal=0.022),
    ]
    values = []
    for signs in itertools.product((1, -1), repeat=3):
        off = [(t, t.plus if sign > 0 else -t.minus) for t, sign in zip(some, signs, strict=True)]
        values.append(wr.flex(assemble(deviated(chain.drawing, off)), search=0).objective)
    found = wr.worst_case(chain, some)
    assert found.loosest.objective == pytest.approx(max(values), rel=1e-6)
    assert found.tightest is not None
    assert found.tightest.objective == pytest.approx(min(values), rel=1e-6)
    assert found.loosest.path == "checked"


def test_a_limit_is_proven_kept_or_broken() -> None:
    chain = wr.patterns.chain(3, joint="tee", gap=0.02)
    some = [Tolerance(("b2",), 0.001, 0.001)]
    worst = wr.worst_case(chain, some).loosest.objective
    assert worst is not None
    kept, broken = (wr.worst_case(chain, some, limit=share * worst) for share in (1.05, 0.95))
    assert (kept.keeps, kept.certainty) == (True, Certainty.PROVEN)
    assert kept.loosest.at_most is not None
    assert worst <= kept.loosest.at_most <= 1.05 * worst
    assert (broken.keeps, broken.certainty) == (False, Certainty.PROVEN)


def test_parts_that_do_not_fit_at_their_largest() -> None:
    found = wr.worst_case(assemble(peg_in_slot(), gap=0.1), [Tolerance(("peg",), plus=0.2, minus=0.0)])
    assert found.tightest is None
    assert "overlap" in found.misfit
    assert found.loosest.objective == pytest.approx(found.nominal.objective, rel=1e-9)


def test_nothing_stops_it_at_the_loose_end() -> None:
    chain = wr.patterns.chain(2, joint="tee", gap=0.02)
    found = wr.worst_case(chain, [Tolerance(("b1", "b2"), plus=0.4, minus=0.0)], limit=1.0)
    assert found.loosest.objective is None
    assert found.keeps is False


@pytest.mark.parametrize(
    ("some", "said"),
    [
        ([], "none are given"),
        ([Tolerance(("nobody",), 0.1, 0.1)], "there is no part"),
        ([Tolerance(("peg",), 0.1, 0.1, outline=2)], "has 1 outlines, not 2"),
        ([Tolerance(("peg",), 0.1, 0.1)] * 2, "given twice"),
        ([Tolerance(("peg",), 0.1, -0.1)], "0 or more"),
    ],
)
def test_what_makes_no_sense(some: list[Tolerance], said: str) -> None:
    with pytest.raises(wr.InputError, match=said):
        wr.worst_case(assemble(peg_in_slot(), gap=0.1), some)


def test_a_table_with_semicolons_and_decimal_commas(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text("Part;Other;Plus;Minus;Nominal\nlid;;0,05;0,1;\nlid;box;0,02;;0,3\n\n", encoding="utf-8")
    assert wr.read_tolerances(path) == (
        Tolerance(("lid",), 0.05, 0.1),
        Tolerance(("lid", "box"), 0.02, 0.0, nominal=0.3),
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a,b\n1,2\n", "the first line must name the columns"),
        ("part,plus,minus\nlid,x,1\n", "line 2: plus is x; it must be a number"),
        ("part,plus,minus\nlid,1,-1\n", "line 2: minus is -1; it must be 0 or more"),
        ("part,plus,size\nlid,1,1\n", 'there is no column "size"'),
        ("part,plus,minus\n,1,1\n", "line 2: part is missing"),
        ("part,plus,minus\n", "has no rows"),
    ],
)
def test_tables_that_cannot_be_read(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "t.csv"
    path.write_text(text)
    with pytest.raises(wr.InputError, match=said):
        wr.read_tolerances(path)


def test_tolerances_in_the_assembly_file_come_back(tmp_path: Path) -> None:
    some = (Tolerance(("peg",), 0.1, 0.2, outline=1), Tolerance(("rim", "peg"), 0.0, 0.1, nominal=0.3))
    write_drawing(replace(peg_in_slot(), tolerances=some), tmp_path / "a.json")
    assert read_drawing(tmp_path / "a.json").tolerances == some
    text = (tmp_path / "a.json").read_text().replace('"unit": "mm"', '"unit": "cm"')
    (tmp_path / "b.json").write_text(text)
    assert read_drawing(tmp_path / "b.json").tolerances[1] == Tolerance(("rim", "peg"), 0.0, 1.0, nominal=3.0)
    (tmp_path / "c.json").write_text(text.replace('"part":"peg","outline":1', '"part":"nobody","outline":1'))
    with pytest.raises(wr.InputError, match=r"tolerances\[0\]: there is no part"):
        read_drawing(tmp_path / "c.json")


def test_the_command_lists_who_contributes(
    command: Callable[..., int], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    write_drawing(peg_in_slot(), tmp_path / "a.json")
    (tmp_path / "t.csv").write_text("part,outline,plus,minus\npeg,,0.01,0.02\nrim,2,0.03,0.04\n")
    out = {kind: tmp_path / f"o.{kind}" for kind in ("csv", "json", "svg", "html")}
    words = ["tolerances", tmp_path / "a.json", "--gap", 0.2, "--tolerances", tmp_path / "t.csv", "--limit", 3.25]
    assert command(*words, "--csv", out["csv"], "--json", out["json"], "--picture", out["svg"]) == 0
    said = capfd.readouterr().out
    assert "3.26 mm at worst" in said
    assert "3.25 mm is not kept (proven)" in said
    rows = list(csv.DictReader(out["csv"].read_text().splitlines()))
    assert [(row["kind"], row["name"], row["outline"]) for row in rows] == [
        ("outline", "rim", "2"),
        ("part", "peg", ""),
    ]
    assert float(rows[0]["looser_mm"]) == pytest.approx(0.04, rel=1e-4)
    told = json.loads(out["json"].read_text())
    assert told["format"] == "wiggleroom.tolerances/1"
    assert told["worst"]["objective"] == pytest.approx(3.26, rel=1e-6)
    assert "rim, outline 2" in out["svg"].read_text()
    assert command(*words, "--picture", out["html"]) == 0


def test_a_stack_of_tolerances_in_space_has_a_closed_form() -> None:
    """A peg has 0.2 mm of room on every side and the gap: faces, cut edges, one outline and a joint add what they lie further in."""
    assembly = spatial(PLATE, PEG | {"lock": ["y", "z", "rx", "ry", "rz"]}, gap=0.1)
    some = [
        Tolerance(("peg",), 0.01, 0.02),
        Tolerance(("plate",), 0.0, 0.04, outline=2),
        Tolerance(("plate",), 0.3, 0.3, outline=1),
    ]
    found = wr.worst_case(assembly, some, Pull("peg", (1, 0, 0)), limit=0.37)
    assert found.nominal.objective == pytest.approx(0.3, abs=1e-6)
    assert found.loosest.objective == pytest.approx(0.36, abs=1e-6)
    assert found.tightest is not None
    assert found.tightest.objective == pytest.approx(0.29, abs=1e-6)
    assert found.first_order == pytest.approx(0.36, abs=1e-6)
    assert [c.tolerance.outline for c in found.contributions] == [2, None, 1]
    assert found.keeps
    whole = wr.worst_case(assembly, [Tolerance(("plate",), 0.05, 0.05)], Pull("peg", (1, 0, 0)))
    assert whole.loosest.objective == pytest.approx(0.35, abs=1e-6)
    assert whole.contributions[0].slope == pytest.approx(1.0, abs=1e-4)
    joint = wr.worst_case(assembly, [Tolerance(("plate", "peg"), 0.05, 0.05)], Pull("peg", (1, 0, 0)))
    assert joint.loosest.objective == pytest.approx(0.35, abs=1e-6)
    assert joint.contributions[0].slope == pytest.approx(1.0, abs=1e-4)


def test_the_thickness_of_a_plate_is_a_dimension_like_others() -> None:
    """A plate 3 mm thick in a slot of 3.2 mm, its middle where it was: half of what it is thinner is room to either side."""
    slot = {"name": "slot", "boxes": [[-20, -20, -5, 20, 20, 0], [-20, -20, 3.2, 20, 20, 8]], "fixed": True}
    sheet = {"name": "sheet", "outline": [[-5, -5], [5, -5], [5, 5], [-5, 5]], "thickness": 3, "at": [0, 0, 0.1]}
    assembly = spatial(slot, sheet | {"lock": ["x", "y", "rx", "ry", "rz"]})
    some = [Tolerance(("sheet",), 0.1, 0.06, outline="thickness")]
    found = wr.worst_case(assembly, some, Pull("sheet", (0, 0, 1)))
    assert found.nominal.objective == pytest.approx(0.1, abs=1e-6)
    assert found.loosest.objective == pytest.approx(0.13, abs=1e-6)
    assert found.tightest is not None
    assert found.tightest.objective == pytest.approx(0.05, abs=1e-6)
    assert found.contributions[0].slope == pytest.approx(0.5, abs=1e-4)
    with pytest.raises(wr.InputError, match="has no thickness"):
        wr.worst_case(assembly, [Tolerance(("slot",), 0.1, 0.1, outline="thickness")], Pull("sheet", (0, 0, 1)))


def test_the_worst_of_all_corners_in_space() -> None:
    joint = wr.read("examples/43_mortise_and_tenon/joint.json")
    goal = Pull("rail", (0, 0, 1), (120, 0, 0))
    some = [Tolerance(("post",), 0.01, 0.02), Tolerance(("rail",), 0.02, 0.01)]
    found = wr.worst_case(joint, some, goal)
    values = []
    for signs in itertools.product((1, -1), repeat=2):
        off = [(t, t.plus if sign > 0 else -t.minus) for t, sign in zip(some, signs, strict=True)]
        values.append(wr.flex(wr.assemble(deviated(joint.drawing, off)), goal, search=0).objective)
    assert found.loosest.objective == pytest.approx(max(values), rel=1e-6)
    assert found.tightest is not None
    assert found.tightest.objective == pytest.approx(min(values), rel=1e-6)
    assert found.first_order == pytest.approx(max(values), rel=1e-2)


def test_tolerances_of_a_file_in_space_by_the_command(
    command: Callable[..., int], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    tolerances = [
        {"part": "plate", "outline": "thickness", "plus": 0.1, "minus": 0.1},
        {"part": "peg", "plus": 0, "minus": 0.05},
    ]
    pull = [{"part": "peg", "direction": [1, 0, 0]}]
    parts = [PLATE, PEG | {"lock": ["rx", "ry", "rz"], "offset": -0.1}]
    file = {"format": "wiggleroom/2", "parts": parts, "pull": pull, "tolerances": tolerances}
    (tmp_path / "a.json").write_text(json.dumps(file))
    assert command("tolerances", tmp_path / "a.json", "--json", "-", "--picture", tmp_path / "a.html") == 0
    said = json.loads(capfd.readouterr().out)
    assert said["dimension"] == 3
    assert said["objective"] == pytest.approx(0.3, abs=1e-6)  # its offset is that of all faces
    assert said["worst"]["objective"] == pytest.approx(0.35, abs=1e-6)
    assert [entry["outline"] for entry in said["contributions"]] == [None, "thickness"]
    (tmp_path / "t.csv").write_text("part,outline,plus,minus\nplate,thickness,0.1,0.1\npeg,,0,0.05\n")
    assert wr.read_tolerances(tmp_path / "t.csv") == wr.read(tmp_path / "a.json").drawing.tolerances


def test_parts_in_space_that_do_not_fit_at_their_largest() -> None:
    found = wr.worst_case(spatial(PLATE, PEG), [Tolerance(("peg",), 0.3, 0.0)], Pull("peg", (1, 0, 0)))
    assert found.tightest is None
    assert "peg" in found.misfit
