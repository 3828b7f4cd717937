"""Cutting sheets put together and judged from outside: `python -m benchmarks.sheets [--boxes | --held-out] [--hints 3]`.

Own sheets are drawn by `sheet_drawings`, whose designs are known. With --boxes the generators of boxes.py named here draw
theirs at default settings (boxes.py must be importable). Right is a sheet of theirs if as many rows of fingers lie in each other as
the generator drew pairs of, every panel with such a row is placed, panels without are left out as loose or fit as their voids say,
and nothing overlaps. --hints N lets a person who knows the design say up to N things where it is not right. A folder may hold others
(.svg): of these it is asked whether every panel is placed, nothing overlaps, and all voids that joints could have are filled.
--table prints Markdown.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.boxes_sheets import DrawnSheet, draw, generators
from benchmarks.joint_judge import judge_joints
from benchmarks.sheet_drawings import Design, designs, other_styles
from benchmarks.sheet_judge import Judged, judge
from benchmarks.sheet_user import next_hint
from wiggleroom.errors import InputError
from wiggleroom.mating.assembled_sheet import AssembledSheet, assemble_sheet
from wiggleroom.mating.cutting_sheet import read_sheet
from wiggleroom.mating.hints import Hints, read_hints
from wiggleroom.mating.plates_writer import write_plates

OVERLAP = 1e-5
"""Volume [mm3] below which nothing overlaps: a square of 3 mm to a depth of 1e-6 mm."""
FILLED = 0.97
GENERATORS = """
ABox AngledCutJig BasedBox BeeQueenCage BeeQueenTransportBox BinTray BirdHouse BookHolder BottleStack BrickSorter
CanStorage CardBox CardHolder Castle ClosedBox CoinDisplay CompartmentBox Console Crate DiceTower DiscRack Dispenser
DisplayCase DisplayShelf DrillBox DrillStand ElectronicsBox EuroRackSkiff FilamentSpool GearBox GridfinityBase
GridfinityDrillBox HalfBox Hook IntegratedHingeBox KeyHolder Keypad LaserClamp MagazineFile MakitaPowerSupply Matrix
NemaMount NotesHolder OpenBox OrganPipe PaintStorage PhoneHolder Rack10Box Rack19Box Rack19HalfWidth RackBox
RegularBox RegularStarBox RollHolder SBCMicroRack SideHingeBox SlantedTray SlidingLidBox Spool StorageShelf Tetris
WallCaliper WallDrillBox WallEdges WallHook WallHopper WallPinRow WallPliersHolder WallRack WallRollHolder
WallSlottedHolder WallStackableBin WallStairs WallWrenchHolder
"""
"""Generators of boxes.py whose sheets have 3 to 14 rigid panels of which at least two rows of fingers meet."""
HELD_OUT = """
AngledBox Desksign DiceBox DinRailBox PirateChest PizzaShovel Ramp Silverware SlidingDrawer StackableBin StorageRack
TrafficLight TwoPiece TypeTray UnevenHeightBox UniversalBox WallConsole WallPlaneHolder WallTypeTray ZBeam
"""
"""Twenty of the same kind, drawn by lot, on which nothing was tried out before they were measured."""


def main() -> None:
    """Print one line for every sheet, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--folder", type=Path, help="also put together every .svg in this folder; NAME.toml beside it has hints"
    )
    parser.add_argument("--only", nargs="*", help="names of the sheets in the folder")
    parser.add_argument("--thickness", type=float, default=3.0, help="of the sheets in the folder [mm]")
    parser.add_argument("--boxes", action="store_true", help="also put together what generators of boxes.py draw")
    parser.add_argument("--held-out", action="store_true", help="the same for the twenty that were held out")
    parser.add_argument("--hints", type=int, default=0, help="how many things a person may say of each of them")
    parser.add_argument("--table", action="store_true", help="print a table in Markdown")
    asked = parser.parse_args()
    if asked.table:
        print(
            "| sheet | panels placed | joints | voids filled | processor s | verdict |\n| --- | --- | --- | --- | --- | --- |"
        )
    else:
        print(f"{'sheet':24} {'panels':>7} {'joints':>6} {'voids':>9} {'overlap':>9} {'s':>6}  verdict")
    with tempfile.TemporaryDirectory() as folder:
        if not asked.only:
            _sum("own", [_own(design, Path(folder), asked.table) for design in designs()])
            _sum("own, other styles", [_own(design, Path(folder), asked.table) for design in other_styles()])
        lists = [("boxes.py", GENERATORS)] * asked.boxes + [("held out", HELD_OUT)] * asked.held_out
        for what, names in lists:
            known = generators()
            drawn = (draw(known[name], Path(folder)) for name in asked.only or names.split())
            _sum(what, [_boxes(sheet, Path(folder), asked.hints, asked.table) for sheet in drawn])
        if asked.folder:
            sheets = sorted(path for path in asked.folder.glob("*.svg") if not asked.only or path.stem in asked.only)
            _sum("folder", [_other(path, Path(folder), asked.thickness, asked.table) for path in sheets])


def _own(design: Design, folder: Path, table: bool) -> tuple[bool, bool]:
    sheet = folder / "sheet.svg"
    sheet.write_text(design.svg(seed=len(design.name)))
    begin = time.process_time()
    found = assemble_sheet(read_sheet(sheet), design.thickness, burn=design.burn)
    spent = time.process_time() - begin
    judged = _judged(found, folder)
    right = judged.overlap < OVERLAP and set(judged.names) == set(design.panels)
    # Which of two equal panels is which cannot be told, so joints are compared by number.
    right &= len(found.joints) == len(design.joined) and len(judged.touching) >= len(design.joined)
    right &= max(abs(a - b) for a, b in zip(judged.size, sorted(design.size), strict=True)) < 0.02
    return _told(design.name, found, judged, right, spent, len(design.panels), table)


def _other(path: Path, folder: Path, thickness: float, table: bool) -> tuple[bool, bool]:
    sheet = read_sheet(path)
    begin = time.process_time()
    hints = path.with_suffix(".toml")
    found = assemble_sheet(sheet, thickness, hints=read_hints(hints) if hints.exists() else None)
    spent = time.process_time() - begin
    judged = _judged(found, folder)
    right = judged.overlap < OVERLAP and len(judged.names) == len(sheet.panels)
    right &= judged.filled >= FILLED * judged.voids
    return _told(path.stem, found, judged, right, spent, len(sheet.panels), table)


def _boxes(drawn: DrawnSheet, folder: Path, most: int, table: bool) -> tuple[bool, bool]:
    sheet = read_sheet(drawn.path)
    every = {panel.name: panel.polygon for panel in sheet.panels}
    hints = Hints()
    count, spent, misled = 0, 0.0, False
    best: tuple[tuple[bool, int], AssembledSheet, Judged, str, int] | None = None
    while True:
        begin = time.process_time()
        try:
            found = assemble_sheet(sheet, 3.0, hints=hints)
        except InputError:  # what was said does not fit
            break
        spent = max(spent, time.process_time() - begin)
        panels = {name: polygon for name, polygon in every.items() if name not in hints.skip}
        poses = _poses(found)
        joints = judge_joints(drawn, panels, poses)
        judged = _judged(found, folder, joints.joined)
        names = [plate.name for plate in found.plates]
        loose = {names[row] for row in found.loose}
        right = judged.overlap < OVERLAP and joints.closed == joints.asked and joints.joined <= set(poses)
        right &= set(panels) - set(poses) <= loose
        right &= not judged.unfilled & (set(poses) - joints.joined)
        if not joints.asked:  # slots alone: of them nothing was written down
            right &= set(panels) == set(poses) and judged.filled >= FILLED * judged.voids > 0
        shown = f"{joints.closed}/{joints.asked}"
        misled |= found.sure and not right
        if best is None or (right, joints.closed) >= best[0]:
            best = (right, joints.closed), found, judged, shown, count
        if right or count == most:
            break
        more = next_hint(drawn, panels, poses, joints, judged, hints, 3.0)
        if more is None:
            break
        hints, count = more, count + 1
    assert best is not None
    (right, _), found, judged, shown, said = best
    verdict = ", ".join([f"{said} hints"] * bool(most) + ["SURE AND NOT RIGHT"] * misled)
    told = _told(drawn.name, found, judged, right, spent, len(every), table, shown, verdict)
    return (False, True) if misled else told


def _poses(found: AssembledSheet) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """By panel, the motion that takes the sheet to where the panel is."""
    poses = {}
    for body in found.bodies:
        for row, turn, move in zip(body.rows, body.turns, body.moves, strict=True):
            plate = found.plates[row]
            poses[plate.name] = turn, move - turn[:, :2] @ plate.centre
    return poses


def _judged(found: AssembledSheet, folder: Path, without: frozenset[str] = frozenset()) -> Judged:
    out = folder / "out.json"
    out.write_text(write_plates(found))
    return judge(out, without=without)


def _told(
    name: str,
    found: AssembledSheet,
    judged: Judged,
    right: bool,
    spent: float,
    panels: int,
    table: bool,
    rows: str = "",
    more: str = "",
) -> tuple[bool, bool]:
    verdict = ", ".join(["right" if right else "not right", *["sure"] * found.sure, *[more] * bool(more)])
    rows = rows or str(len(found.joints))
    if table:
        shown = f"{len(judged.names)}/{panels} | {rows} | {judged.filled}/{judged.voids} | {spent:.1f}"
        print(f"| {name} | {shown} | {verdict} |", flush=True)
        return right, found.sure
    size = " x ".join(f"{x:.1f}" for x in judged.size)
    print(
        f"{name:24} {len(judged.names):3}/{panels:<3} {rows:>6} {judged.filled:4}/{judged.voids:<4} "
        f"{judged.overlap:9.1e} {spent:6.2f}  {verdict} ({size})",
        flush=True,
    )
    return right, found.sure


def _sum(what: str, rows: list[tuple[bool, bool]]) -> None:
    right, sure = sum(r for r, _ in rows), sum(s for _, s in rows)
    wrong = sum(s and not r for r, s in rows)
    print(f"{what}: {right} of {len(rows)} right, {sure} sure, {wrong} sure and not right")


if __name__ == "__main__":
    main()
