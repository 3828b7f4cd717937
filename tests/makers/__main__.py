"""Table of the files of makers and how each is read: `python -m tests.makers`."""

from __future__ import annotations

import sys
import tempfile
from collections import defaultdict
from pathlib import Path

from tests.makers.by_hand import FINDINGS, LIGHTBURN, STYLES
from tests.makers.by_library import CASES
from wiggleroom.assembly.findings import examine
from wiggleroom.drawing.read import reading
from wiggleroom.drawing.strokes.read_options import ReadOptions


def main() -> None:
    """Print one row a program: how many of its files are read as their makers expect."""
    rows: dict[str, list[bool]] = defaultdict(list)
    for case in (*FINDINGS, *STYLES, *LIGHTBURN, *CASES):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / case.name
            path.write_bytes(case.data)
            options = dict(case.options)
            gap = options.pop("gap", None)
            found = reading(path, gap=gap, options=ReadOptions(**options))
        findings = [*found.findings, *(examine(found.drawing)[1] if found.drawing.parts else ())]
        holes = sum(len(region.holes) for part in found.drawing.parts for region in part.regions)
        same = (len(found.drawing.parts), holes) == (case.parts, case.holes)
        named = {part.name for part in found.drawing.parts} >= set(case.names)
        refused = any(case.refused in line for line in findings)
        rows[case.program].append(refused if case.refused else same and named and not findings)
    lines = ["| program | files | as expected |", "| --- | --- | --- |"]
    lines += [
        f"| {program} | {len(good)} | {sum(good)} |"
        for program, good in sorted(rows.items(), key=lambda r: r[0].lower())
    ]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
