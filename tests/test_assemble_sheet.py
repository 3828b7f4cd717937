"""Cutting sheets put together, judged by booleans of solids that are built from the file alone."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import shapely

from wiggleroom.mating.joint_angles import plates_of

pytest.importorskip("manifold3d")

from benchmarks.sheet_drawings import Design, box, designs, egg_crate, shelf, stool
from benchmarks.sheet_judge import judge, rotation

from wiggleroom.errors import InputError
from wiggleroom.mating.assembled_sheet import AssembledSheet, assemble_sheet
from wiggleroom.mating.cutting_sheet import CuttingSheet, read_sheet
from wiggleroom.mating.edge_constraints import edge_flanks
from wiggleroom.mating.hints import EdgeReference, FixedPlate, Hints, edge_reference, read_hints, write_hints
from wiggleroom.mating.loose_panel_poses import laid_plates
from wiggleroom.mating.plates_writer import fixed_axis_turns, write_plates

SHEETS = Path(__file__).parent / "sheets"
OVERLAP = 1e-5


def sheet_of(folder: Path, text: str) -> CuttingSheet:
    path = folder / "sheet.svg"
    path.write_text(text)
    return read_sheet(path)


@pytest.mark.parametrize(
    ("name", "thickness", "panels", "joints", "size"),
    [
        ("egg_crate_even", 4, 6, 9, (30, 120, 120)),
        ("stool_small", 3, 3, 3, (53, 100, 100)),
        ("dog_bone_tray", 6, 5, 8, (70, 130, 180)),
        ("trapezoid", 3, 6, 8, (66, 80, 120)),
    ],
)
def test_sheets_come_together_as_they_were_designed(
    command: Callable[..., int],
    tmp_path: Path,
    name: str,
    thickness: int,
    panels: int,
    joints: int,
    size: tuple[int, ...],
) -> None:
    out, answer = tmp_path / "out.json", tmp_path / "answer.json"
    assert command("assemble", SHEETS / f"{name}.svg", "--thickness", thickness, "-o", out, "--json", answer) == 0
    judged = judge(out)
    assert len(judged.names) == panels
    assert judged.overlap < OVERLAP
    assert len(judged.touching) >= joints
    assert judged.size == pytest.approx(size, abs=0.02)
    said = json.loads(answer.read_text())
    assert len(said["joints"]) == joints
    assert said["unplaced"] == []


@pytest.mark.parametrize("seed", range(2))
def test_panels_may_lie_turned_and_mirrored(tmp_path: Path, seed: int) -> None:
    design = box("box", 75, 52, 38, 3, 8)
    found = assemble_sheet(sheet_of(tmp_path, design.svg(seed)), 3)
    assert found.sure
    assert len(found.joints) == 12


def test_an_assembly_with_an_equal_alternative_is_not_sure(tmp_path: Path) -> None:
    """Strips whose slots are as far apart when turned round, with ends of different length: each may be either way."""
    design = egg_crate("crate", [30, 75, 110], [25, 60], 40, 3, 150, 90)
    found = assemble_sheet(sheet_of(tmp_path, design.svg()), 3)
    assert not found.sure
    assert any("more than one way" in doubt for doubt in found.doubts)


def test_a_flank_without_partner_is_said(tmp_path: Path) -> None:
    design = shelf("shelf", 120, 80, [40, 110], 4, 150)
    del design.panels["board 1"]
    found = assemble_sheet(sheet_of(tmp_path, design.svg()), 4)
    assert not found.sure
    assert sum(map(len, found.open.values())) == 8
    assert not found.unplaced


def test_two_boxes_on_one_sheet_are_two_bodies(tmp_path: Path) -> None:
    design = box("a", 75, 52, 38, 3, 8)
    other = stool("b", 60, 50, 3)
    design.panels |= other.panels
    found = assemble_sheet(sheet_of(tmp_path, design.svg()), 3)
    assert sorted(len(body.rows) for body in found.bodies) == [3, 6]
    assert found.sure


def test_the_burn_is_taken_off(tmp_path: Path) -> None:
    design = box("box", 75, 52, 38, 3, 8)
    design.panels = {name: panel.buffer(0.1, join_style="mitre") for name, panel in design.panels.items()}
    found = assemble_sheet(sheet_of(tmp_path, design.svg()), 3, burn=0.1)
    assert found.sure
    assert found.plates[0].polygon.area == pytest.approx(
        box("box", 75, 52, 38, 3, 8).panels[found.plates[0].name].area, rel=1e-3
    )


def test_one_panel_may_be_thinner_than_its_slots(command: Callable[..., int], tmp_path: Path) -> None:
    out = tmp_path / "out.json"
    sheet = SHEETS / "stool_small.svg"
    assert command("assemble", sheet, "--thickness", 3, "--thickness", "seat:2.8", "-o", out) == 0
    parts = {part["name"]: part["thickness"] for part in json.loads(out.read_text())["parts"]}
    assert parts == {"seat": 2.8, "leg a": 3.0, "leg b": 3.0}
    assert judge(out).overlap < OVERLAP


def test_a_panel_goes_where_a_hint_puts_it(command: Callable[..., int], tmp_path: Path) -> None:
    design = stool("stool", 60, 50, 3)
    design.panels["plain"] = shapely.box(0, 0, 50, 40)
    sheet, hints, out = tmp_path / "sheet.svg", tmp_path / "hints.toml", tmp_path / "out.json"
    sheet.write_text(design.svg())
    place = 'panel = "plain"\nframe = "seat"\nright = [0, 1, 0]\nup = [-1, 0, 0]'
    hints.write_text(f"thickness = 3\n[[plate]]\n{place}\ncentre = [5, 0, 60]\n")
    assert command("assemble", sheet, "--hints", hints, "-o", out) == 0
    parts = {part["name"]: part for part in json.loads(out.read_text())["parts"]}
    frame = rotation(parts["seat"]["rotate"])
    apart = (np.array(parts["plain"]["at"]) - parts["seat"]["at"]) @ frame
    assert apart == pytest.approx([5, 0, 60], abs=1e-6)
    assert frame.T @ rotation(parts["plain"]["rotate"]) @ [1, 0, 0] == pytest.approx([0, 1, 0], abs=1e-9)
    hints.write_text(f"thickness = 3\n[[plate]]\n{place}\ncentre = [5, 0, 0]\n")
    assert command("assemble", sheet, "--hints", hints, "-o", out) == 2


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("thickness = -1", "thickness: is -1; it must be a length in mm larger than 0"),
        ("nonsense = 1", "nonsense: is not known"),
        ('join = [["lid", "back:top"]]', "join[0]: must be two edges"),
        ("thickness = ", "is not TOML"),
        ("groups = [3]", "groups[0]: must be a list of names"),
        ("[[plate]]\npanel = 'lid'", "plate[0]: must have exactly"),
    ],
)
def test_bad_hints_are_one_line(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "hints.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=said.replace("[", r"\[").replace("]", r"\]")) as caught:
        read_hints(path)
    assert len(caught.value.findings) == 1


def test_a_name_that_is_not_there_is_said_with_what_was_meant() -> None:
    sheet = read_sheet(SHEETS / "stool_small.svg")
    with pytest.raises(InputError, match='there is no panel "seet"; did you mean "seat"'):
        assemble_sheet(sheet, 3, hints=Hints(groups=(("seet",),)))


@pytest.mark.parametrize(
    "options", [("--thickness", "0"), ("--thickness", "lid:x"), ("--thickness", "3", "--burn", "-1")]
)
def test_bad_options_are_bad_usage(command: Callable[..., int], tmp_path: Path, options: tuple[str, ...]) -> None:
    out = tmp_path / "out.json"
    assert command("assemble", SHEETS / "stool_small.svg", *options, "-o", out) == 2
    assert not out.exists()


def test_turns_about_fixed_axes_make_the_rotation_again() -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        turn *= np.linalg.det(turn)
        assert rotation(fixed_axis_turns(turn).tolist()) == pytest.approx(turn, abs=1e-12)
    for sign in (1.0, -1.0):
        turn = rotation([20.0, 90.0 * sign, 35.0])
        assert rotation(fixed_axis_turns(turn).tolist()) == pytest.approx(turn, abs=1e-7)


def test_panels_that_differ_by_a_small_hole_are_not_the_same_kind(tmp_path: Path) -> None:
    """Two sides of a box, each with a 2 mm hole in another place: exchanging them makes another box."""
    design = box("box", 75, 52, 38, 3, 8)
    for name, x in (("left", 12), ("right", 20)):
        design.panels[name] = design.panels[name].difference(shapely.box(x, 14, x + 2, 16))
    found = assemble_sheet(sheet_of(tmp_path, design.svg()), 3)
    kinds = {plate.name: plate.kind for plate in found.plates}
    assert kinds["left"] != kinds["right"]
    assert not found.sure


@pytest.mark.slow
@pytest.mark.parametrize("design", designs(), ids=lambda design: design.name)
def test_no_wrong_assembly_is_sure(tmp_path: Path, design: Design) -> None:
    found = assemble_sheet(sheet_of(tmp_path, design.svg(1)), design.thickness)
    assert not found.sure or len(found.joints) == len(design.joined)


def test_a_panel_that_fits_nothing_lies_loose(command: Callable[..., int], tmp_path: Path) -> None:
    design = stool("stool", 60, 50, 3)
    design.panels["plain"] = shapely.box(0, 0, 50, 40)
    sheet, out, answer = tmp_path / "sheet.svg", tmp_path / "out.json", tmp_path / "answer.json"
    sheet.write_text(design.svg())
    assert command("assemble", sheet, "--thickness", 3, "-o", out, "--json", answer) == 3
    assert len(judge(out).names) == 3
    said = json.loads(answer.read_text())
    assert said["unplaced"] == said["loose"] == ["plain"]
    assert any("it lies loose" in doubt for doubt in said["doubts"])


def test_a_window_is_no_joint(tmp_path: Path) -> None:
    """An opening for a switch has steps as long as the plate is thick; nothing is missing there."""
    design = box("box", 75, 52, 38, 3, 8)
    window = shapely.union_all([shapely.box(20, 12, 32, 24), shapely.box(17, 15, 35, 18)])
    design.panels["front"] = design.panels["front"].difference(window)
    found = assemble_sheet(sheet_of(tmp_path, design.svg()), 3)
    assert len(found.joints) == 12
    assert not found.open


def test_what_is_sure_does_not_hang_on_the_clock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import time

    sheet = sheet_of(tmp_path, box("box", 75, 52, 38, 3, 8).svg(1))
    ticks = iter(range(0, 10**9, 1000))
    monkeypatch.setattr(time, "process_time", lambda: float(next(ticks)))
    monkeypatch.setattr(time, "perf_counter", lambda: float(next(ticks)))
    assert assemble_sheet(sheet, 3).sure


def crate() -> Design:
    return egg_crate("crate", [30, 75, 110], [25, 60], 40, 3, 150, 90)


def joined(found: AssembledSheet) -> set[frozenset[str]]:
    return {frozenset(found.plates[row].name for row in joint.panels) for joint in found.joints}


def test_a_group_keeps_two_equal_boxes_apart(tmp_path: Path) -> None:
    """Two open boxes of one size, of which one has a hole in every panel: only a person knows which walls go together."""
    design = box("a", 75, 52, 38, 3, 8, lid=False)
    panels = {f"one {name}": panel for name, panel in design.panels.items()}
    panels |= {f"two {name}": panel.difference(shapely.box(30, 20, 34, 25)) for name, panel in design.panels.items()}
    design.panels = panels
    sheet = sheet_of(tmp_path, design.svg())
    group = tuple(panel.name for panel in sheet.panels if panel.name.startswith("one"))
    assert not assemble_sheet(sheet, 3).sure
    found = assemble_sheet(sheet, 3, hints=Hints(groups=(group,)))
    assert len(found.joints) == 16
    assert {frozenset(found.plates[row].name[:3] for row in body.rows) for body in found.bodies} == {
        frozenset({"one"}),
        frozenset({"two"}),
    }


def test_panels_are_joined_by_points_of_the_sheet(tmp_path: Path) -> None:
    design = box("box", 75, 52, 38, 3, 8)
    sheet = sheet_of(tmp_path, design.svg(2))
    first = assemble_sheet(sheet, 3).joints[0]
    free = assemble_sheet(sheet, 3)
    ends = []
    for side, row in enumerate(first.panels):
        plate = free.plates[row]
        x, y = plate.middle[first.flanks[:, side]].mean(axis=0) + plate.centre
        ends.append(EdgeReference("", point=(float(x), float(y))))
    found = assemble_sheet(sheet, 3, hints=Hints(joins=((ends[0], ends[1]),)))
    assert found.sure
    pair = frozenset(found.plates[row].name for row in first.panels)
    assert pair in joined(found)
    assert len(found.joints) == 12


def test_a_flush_pair_chooses_which_way_round_a_strip_is(tmp_path: Path) -> None:
    """Slots of the strips are as far apart when these are turned round; that ends of two strips are flush says which way."""
    design = crate()
    long = design.panels["x0"]
    design.panels["x0"] = design.panels["x1"] = long.union(shapely.box(-10, 0, 0, 40))  # ends of different length
    sheet = sheet_of(tmp_path, design.svg())
    kept = []
    shapes = {panel.name: panel.polygon.bounds for panel in sheet.panels}
    sides = {
        name: ("left", "right") if x1 - x0 > y1 - y0 else ("bottom", "top") for name, (x0, y0, x1, y1) in shapes.items()
    }
    for side in sides["x0"]:
        for other in sides["x1"]:
            pair = EdgeReference("x0", side), EdgeReference("x1", other)
            try:
                found = assemble_sheet(sheet, 3, hints=Hints(flush=(pair,)))
            except InputError:
                continue
            body = found.bodies[0]
            place = {found.plates[row].name: k for k, row in enumerate(body.rows)}
            if not {"x0", "x1"} <= set(place):
                assert any("said to belong together" in doubt for doubt in found.doubts)
                continue
            kept.append(pair)
            planes = []
            for name, end in zip(("x0", "x1"), (side, other), strict=True):
                k = place[name]
                axis, last = {"left": (0, 0), "right": (0, 1), "bottom": (1, 0), "top": (1, 1)}[end]
                normal = body.turns[k][:, axis] * (2 * last - 1)
                corner = np.eye(3)[axis] * found.plates[body.rows[k]].polygon.bounds[axis + 2 * last]
                planes.append((normal, normal @ (body.turns[k] @ corner + body.moves[k])))
            assert planes[0][0] @ planes[1][0] > 0.99
            assert planes[0][1] == pytest.approx(planes[1][1], abs=0.6)
    assert kept


def test_what_is_no_part_is_left_out_and_said(command: Callable[..., int], tmp_path: Path) -> None:
    design = stool("stool", 60, 50, 3)
    design.panels["template"] = shapely.box(0, 0, 50, 40)
    sheet, hints, out = tmp_path / "sheet.svg", tmp_path / "hints.toml", tmp_path / "out.json"
    sheet.write_text(design.svg())
    hints.write_text('thickness = 3\nskip = ["template"]\n')
    assert command("assemble", sheet, "--hints", hints, "-o", out) == 0
    found = assemble_sheet(read_sheet(sheet), 3, hints=read_hints(hints))
    assert found.sure
    assert any("left out as said: template" in note for note in found.notes)


def test_a_hint_that_cannot_hold_is_one_line_that_says_what_would_be_right(tmp_path: Path) -> None:
    design = box("box", 75, 52, 38, 3, 8)
    design.panels["plain"] = shapely.box(0, 0, 50, 40)
    sheet = sheet_of(tmp_path, design.svg())

    def said(*pair: str) -> str:
        edges = tuple(edge for text in pair if (edge := edge_reference(text)))
        with pytest.raises(InputError) as caught:
            assemble_sheet(sheet, 3, hints=Hints(joins=((edges[0], edges[1]),)))
        assert len(caught.value.findings) == 1
        return str(caught.value.findings[0])

    assert "do not fit; what fits bottom:left is " in said("bottom:left", "top:bottom")
    assert "plain:left has no fingers" in said("plain:left", "bottom:left")
    assert "there is no panel at 900,900; the nearest is" in said("@900,900", "bottom:left")
    assert "is 8" in said("bottom@900,12", "front:left")
    assert "name two panels" in said("bottom:left", "bottom:right")


def test_hints_are_read_as_they_were_written(tmp_path: Path) -> None:
    pair = EdgeReference("a b", "top"), EdgeReference('quo"te', point=(1.5, -2.25))
    plate = FixedPlate("a b", (0.1, 0.0, 42.5), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), "c")
    hints = Hints(3.0, {"a b": 2.8}, 0.1, (("a b", "c"),), (pair,), (pair,), (plate,), ("d",))
    path = tmp_path / "hints.toml"
    path.write_text(write_hints(hints))
    assert read_hints(path) == hints


def test_a_loose_lid_is_laid_flush_on_the_walls(tmp_path: Path) -> None:
    design = box("tray", 90, 60, 45, 3, 9, lid=False)
    design.panels["cover"] = shapely.box(0, 0, 90, 60)
    sheet = sheet_of(tmp_path, design.svg())
    found = assemble_sheet(sheet, 3)
    cover, front = (next(p.polygon for p in sheet.panels if p.name == name) for name in ("cover", "front"))
    wall = next(p for p in found.plates if p.name == "front")
    # the plain edge of the wall: the one where no row of fingers lies
    x0, y0, x1, y1 = front.bounds
    sides = {
        "left": (x0, (y0 + y1) / 2),
        "right": (x1, (y0 + y1) / 2),
        "bottom": ((x0 + x1) / 2, y0),
        "top": ((x0 + x1) / 2, y1),
    }
    plain = next(point for side, point in sides.items() if not edge_flanks(wall, EdgeReference("front", side)))
    a0, b0, a1, b1 = cover.bounds
    edge = (a0, (b0 + b1) / 2) if a1 - a0 < b1 - b0 else ((a0 + a1) / 2, b0)
    ways = laid_plates(found, "cover", edge, "front", plain)
    result = assemble_sheet(sheet, 3, hints=Hints(plates=(ways[0],)))
    assert not result.unplaced
    out = tmp_path / "out.json"
    out.write_text(write_plates(result))
    judged = judge(out)
    assert judged.overlap < OVERLAP
    assert judged.size == pytest.approx((48, 60, 90), abs=0.02)
    assert {frozenset({"cover", wall}) for wall in ("front", "back", "left", "right")} <= judged.touching


def test_a_hair_on_an_outline_is_no_flank(tmp_path: Path) -> None:
    """A spike without width, as long as the plate is thick, goes on from an edge: it holds nothing."""
    design = stool("stool", 60, 50, 3)
    before = {plate.name: len(plate.length) for plate in assemble_sheet(sheet_of(tmp_path, design.svg()), 3).plates}
    leg = design.panels["leg a"]
    x, y, *_ = leg.bounds
    hair = shapely.Polygon([(x, y), (x, y + 0.001), (x - 3, y)])
    design.panels["leg a"] = leg.union(hair)
    found = assemble_sheet(sheet_of(tmp_path, design.svg()), 3)
    assert {plate.name: len(plate.length) for plate in found.plates} == before
    assert len(found.joints) == 3


def test_an_outline_that_almost_closes_is_a_panel(tmp_path: Path) -> None:
    """Cutting programs leave outlines open by a tenth of a millimetre; that is joined, and said."""
    head, leg, rest = stool("stool", 60, 50, 3).svg().partition('<path id="leg a" d="M')
    points, _, rest = rest.partition(" Z")
    x, y = points.split(" ", 1)[0].split(",")
    sheet = sheet_of(tmp_path, f"{head}{leg}{points} L{float(x) + 0.1:.3f},{y}{rest}")
    assert len(sheet.panels) == 3
    assert any("open ends were joined" in note for note in sheet.notes)


def test_notches_for_two_plates_on_each_other_hold_both() -> None:
    comb = shapely.box(0, 0, 60, 30)
    for x in (9.0, 21.0, 33.0, 45.0):
        comb = comb.difference(shapely.box(x, 24, x + 6, 31))
    (plate,) = plates_of(["comb"], [comb], [3.0], 0.0)
    assert sorted(round(float(y), 6) for y in set((plate.middle[:, 1] + plate.centre[1]).round(6))) == [25.5, 28.5]
    assert np.allclose(plate.length, 3.0)
    assert len(plate.length) == 16
    assert not plate.needed.any()


def test_a_panel_without_joints_is_left_out_and_the_rest_is_written(
    command: Callable[..., int], tmp_path: Path
) -> None:
    design = stool("stool", 60, 50, 3)
    design.panels["plain"] = shapely.box(0, 0, 50, 40)
    sheet, out = tmp_path / "sheet.svg", tmp_path / "out.json"
    sheet.write_text(design.svg())
    assert command("assemble", sheet, "--thickness", 3, "-o", out) == 3
    assert len(judge(out).names) == 3
