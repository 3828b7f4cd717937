"""Cutting sheets put together and judged from outside: `python -m benchmarks.sheets [--folder SHEETS]`.

Own sheets are drawn by `sheet_drawings`, whose designs are known. A folder may hold other sheets (.svg), such as those that
boxes.py draws at its default settings; of these it is asked whether anything overlaps and whether all voids are filled.
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
    asked = parser.parse_args()
    print(f"{'sheet':24} {'panels':>7} {'joints':>6} {'voids':>9} {'overlap':>9} {'s':>6}  verdict")
    with tempfile.TemporaryDirectory() as folder:
        _sum("own", [_own(design, Path(folder), asked.seconds) for design in designs()])
        if asked.folder:
            sheets = sorted(path for path in asked.folder.glob("*.svg") if not asked.only or path.stem in asked.only)
            _sum("folder", [_other(path, Path(folder), asked.thickness, asked.seconds) for path in sheets])


def _own(design: Design, folder: Path, seconds: float) -> tuple[bool, bool]:
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
    return _told(design.name, found, judged, right, spent, len(design.panels))


def _other(path: Path, folder: Path, thickness: float, seconds: float) -> tuple[bool, bool]:
    sheet = read_sheet(path)
    begin = time.process_time()
    hints = path.with_suffix(".toml")
    found = assemble_sheet(sheet, thickness, hints=read_hints(hints) if hints.exists() else None, seconds=seconds)
    spent = time.process_time() - begin
    judged = _judged(found, folder)
    right = judged.overlap < OVERLAP and len(judged.names) == len(sheet.panels)
    right &= judged.filled >= FILLED * judged.voids
    return _told(path.stem, found, judged, right, spent, len(sheet.panels))


def _judged(found: AssembledSheet, folder: Path) -> Judged:
    out = folder / "out.json"
    out.write_text(write_plates(found))
    return judge(out)


def _told(
    name: str, found: AssembledSheet, judged: Judged, right: bool, spent: float, panels: int
) -> tuple[bool, bool]:
    verdict = ("right" if right else "not right") + (", sure" if found.sure else "")
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
