"""True optima of chains of ten blocks for `wiggleroom bench chains`: `python -m benchmarks.optima` works them out anew.

They come from the exact dynamic programme over the turns of the links in tests/oracle/chain.py.
"""

from __future__ import annotations

import json
from pathlib import Path

from tests.oracle.chain import reach, slices

FILE = Path(__file__).parents[1] / "src" / "wiggleroom" / "bench" / "optima.json"
JOINTS, GAPS, BLOCKS = ("tee", "swallowtail"), (0.005, 0.01, 0.015, 0.02, 0.025, 0.03), 10


def main() -> None:
    """Write the file, the better of two first grids for every chain."""
    found = {}
    for joint in JOINTS:
        for gap in GAPS:
            pair = slices(joint, gap)
            found[f"{joint} {gap}"] = max(reach(pair, BLOCKS, cells=cells).value for cells in (150, 113))
            print(joint, gap, found[f"{joint} {gap}"], flush=True)
    about = f"largest +y move [mm] of the last of {BLOCKS} unit-pitch blocks, the first fixed, by joint and gap [mm]; accurate to 1e-9"
    record = {"about": about, "command": "python -m benchmarks.optima", "blocks": BLOCKS, "optima": found}
    FILE.write_text(json.dumps(record, indent=1) + "\n")


if __name__ == "__main__":
    main()
