"""Cutting sheets put together and judged from outside: `python -m benchmarks.sheets [--boxes] [--folder SHEETS]`.

Own sheets are drawn by `sheet_drawings`, whose designs are known. With --boxes the generators of boxes.py named here draw
theirs at default settings (boxes.py must be importable), a folder may hold others (.svg). Of these it is asked whether every
panel is placed, nothing overlaps, and all voids that joints could have are filled. --table prints Markdown.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

from benchmarks.sheet_drawings import Design, designs
from benchmarks.sheet_judge import Judged, judge
from wiggleroom.mating.assembled_sheet import AssembledSheet, assemble_sheet
from wiggleroom.mating.cutting_sheet import read_sheet
from wiggleroom.mating.hints import read_hints
from wiggleroom.mating.plates_writer import write_plates

OVERLAP = 1e-5
"""Volume [mm3] below which nothing overlaps: a square of 3 mm to a depth of 1e-6 mm."""
FILLED = 0.97
GENERATORS = """
ABox BasedBox BeeQueenCage BeeQueenTransportBox BinTray BirdHouse BookHolder BottleStack BrickSorter
CanStorage CardHolder Castle ClosedBox CoinDisplay Console Crate DiceTower DiscRack Dispenser DisplayCase
DisplayShelf DrillBox DrillStand ElectronicsBox EuroRackSkiff GridfinityDrillBox HalfBox IntegratedHingeBox
KeyHolder Keypad MagazineFile MakitaPowerSupply Matrix NotesHolder OpenBox OrganPipe PaintStorage PhoneHolder
Rack10Box Rack19Box Rack19HalfWidth RackBox Ramp RegularBox RollHolder SBCMicroRack Silverware SlantedTray
SlidingDrawer SlidingLidBox StackableBin StorageRack StorageShelf Tetris TwoPiece TypeTray UnevenHeightBox
UniversalBox WallConsole WallDrillBox WallHopper WallPinRow WallPlaneHolder WallPliersHolder WallRollHolder
WallSlottedHolder WallStackableBin WallStairs WallTypeTray WallWrenchHolder
"""
"""Generators of boxes.py whose sheets have 3 to 12 rigid panels with finger joints, holes or slots."""


def main() -> None:
    """Print one line for every sheet, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--folder", type=Path, help="also put together every .svg in this folder; NAME.toml beside it has hints"
    )
    parser.add_argument("--only", nargs="*", help="names of the sheets in the folder")
    parser.add_argument("--thickness", type=float, default=3.0, help="of the sheets in the folder [mm]")
    parser.add_argument(
        "--seconds", type=float, default=15.0, help="processor time after which no wider search is begun"
    )
    parser.add_argument("--boxes", action="store_true", help="also put together what generators of boxes.py draw")
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
            _sum("own", [_own(design, Path(folder), asked.seconds, asked.table) for design in designs()])
        if asked.boxes:
            sheets = _drawn_by_boxes(Path(folder), asked.only or GENERATORS.split())
            _sum("boxes.py", [_other(path, Path(folder), 3.0, asked.seconds, asked.table) for path in sheets])
        if asked.folder:
            sheets = sorted(path for path in asked.folder.glob("*.svg") if not asked.only or path.stem in asked.only)
            _sum("folder", [_other(path, Path(folder), asked.thickness, asked.seconds, asked.table) for path in sheets])


def _drawn_by_boxes(folder: Path, names: list[str]) -> list[Path]:
    """Sheets of generators of boxes.py at default settings: 3 mm, a burn of 0.1 mm."""
    from boxes.generators import getAllBoxGenerators

    found = {generator.__name__: generator for generator in getAllBoxGenerators().values()}
    paths = []
    for name in names:
        drawing = found[name]()
        drawing.parseArgs(["--format=svg"])
        drawing.open()
        drawing.render()
        paths.append(folder / f"{name}.svg")
        paths[-1].write_bytes(drawing.close().getvalue())
    return paths


def _own(design: Design, folder: Path, seconds: float, table: bool) -> tuple[bool, bool]:
    sheet = folder / "sheet.svg"
    sheet.write_text(design.svg(seed=len(design.name)))
    begin = time.process_time()
    found = assemble_sheet(read_sheet(sheet), design.thickness, seconds=seconds)
    spent = time.process_time() - begin
    judged = _judged(found, folder)
    right = judged.overlap < OVERLAP and set(judged.names) == set(design.panels)
    # Which of two equal panels is which cannot be told, so joints are compared by number.
    right &= len(found.joints) == len(design.joined) and len(judged.touching) >= len(design.joined)
    right &= max(abs(a - b) for a, b in zip(judged.size, sorted(design.size), strict=True)) < 0.02
    return _told(design.name, found, judged, right, spent, len(design.panels), table)


def _other(path: Path, folder: Path, thickness: float, seconds: float, table: bool) -> tuple[bool, bool]:
    sheet = read_sheet(path)
    begin = time.process_time()
    hints = path.with_suffix(".toml")
    found = assemble_sheet(sheet, thickness, hints=read_hints(hints) if hints.exists() else None, seconds=seconds)
    spent = time.process_time() - begin
    judged = _judged(found, folder)
    right = judged.overlap < OVERLAP and len(judged.names) == len(sheet.panels)
    right &= judged.filled >= FILLED * judged.voids
    return _told(path.stem, found, judged, right, spent, len(sheet.panels), table)


def _judged(found: AssembledSheet, folder: Path) -> Judged:
    out = folder / "out.json"
    out.write_text(write_plates(found))
    return judge(out)


def _told(
    name: str, found: AssembledSheet, judged: Judged, right: bool, spent: float, panels: int, table: bool
) -> tuple[bool, bool]:
    verdict = ("right" if right else "not right") + (", sure" if found.sure else "")
    if table:
        shown = f"{len(judged.names)}/{panels} | {len(found.joints)} | {judged.filled}/{judged.voids} | {spent:.1f}"
        print(f"| {name} | {shown} | {verdict} |", flush=True)
        return right, found.sure
    size = " x ".join(f"{x:.1f}" for x in judged.size)
    print(
        f"{name:24} {len(judged.names):3}/{panels:<3} {len(found.joints):6} {judged.filled:4}/{judged.voids:<4} "
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
