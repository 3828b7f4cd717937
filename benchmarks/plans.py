"""Plans measured: `python -m benchmarks.plans [trays N | families]` prints a line for each puzzle, and medians of the trays.

Trays are judged by an exhaustive search on the grid, which knows nothing of gaps and turns. Every step's path is judged anew by polygon
intersections at dense samples.
"""

from __future__ import annotations

import sys
import time
from itertools import pairwise

import numpy as np
import shapely

import wiggleroom as wr
from benchmarks import plan_families as families
from wiggleroom.assembly.assembly import Assembly, place
from wiggleroom.planning.plan import Plan

SAMPLES = 12
"""Poses looked at on every piece of a path."""


def deepest(found: Plan) -> float:
    """Largest common area of two parts anywhere on a plan's path, at samples [mm2]; parts that left are out of the game."""
    assembly = found.assembly
    shapes = [shapely.union_all([shapely.Polygon(r.outer, r.holes) for r in p.regions]) for p in assembly.parts]
    worst = 0.0
    for step in found.steps:
        moving = {assembly.names.index(n) for n in step.parts}
        for one, other in pairwise(step.path):
            for t in np.linspace(0, 1, SAMPLES):
                pose = assembly.rest + one + t * (other - one)
                at = [shapely.transform(s, lambda p, q=q: place(p, q)) for s, q in zip(shapes, pose, strict=True)]
                for i in moving:
                    for j in np.flatnonzero(step.there):
                        if i != j and at[i].intersects(at[j]):
                            worst = max(worst, at[i].intersection(at[j]).area)
    return worst


def planned(name: str, assembly: Assembly, targets: tuple[str, ...] = ()) -> tuple[Plan, float]:
    """Plan one puzzle, print what came out, and return it with the processor time [s]."""
    began = time.process_time()
    found = wr.plan(assembly, targets)
    took = time.process_time() - began
    left = sum(map(len, found.order))
    least = min((s.clearance for s in found.steps), default=float("nan"))
    print(
        f"{name:14} {found.verdict:12} {found.certainty:9} leave {left:2} of {len(assembly.parts) - 1:2}  moves {found.moves:3}  "
        f"states {found.states:6}  questions {found.questions:3}  {took:6.2f} s  clearance {least:.3f}  overlap {deepest(found):.1e}",
        flush=True,
    )
    return found, took


def family_rows() -> None:
    """The families of known truth."""
    for count in (2, 3, 5, 8):
        planned(f"latches {count}", families.latches(count), ("bolt",))
    planned("tray 2x3", families.tray(*families.tray_of_squares(3, 2, 2)))
    planned("tray 3x3", families.tray(*families.tray_of_squares(3, 3, 1)))
    for count in (3, 4, 5, 6):
        planned(f"pinwheel {count}", families.pinwheel(count))
    planned("lock 3", families.tumbler_lock(3), ("bolt",))
    planned("frame 20", families.frame_puzzle())


def tray_rows(count: int, first: int = 1000) -> None:
    """Random 4 x 4 trays beside the exhaustive search on the grid."""
    times, wrong, unknown, turned = [], 0, 0, 0
    for seed in range(first, first + count):
        pieces, wall = families.random_tray(seed)
        truth, exhausted = families.grid_search(pieces, wall)
        found, took = planned(f"tray {seed}", families.tray(pieces, wall))
        gone = {name for parts in found.order for name in parts}
        times.append(took)
        wrong += exhausted and not gone >= truth
        turned += exhausted and gone > truth
        unknown += found.verdict == "unknown"
    print(
        f"{count} trays: median {np.median(times):.2f} s, longest {max(times):.1f} s, less than the grid {wrong}, more (by turns) "
        f"{turned}, unknown {unknown}"
    )


if __name__ == "__main__":
    if sys.argv[1:2] == ["trays"]:
        tray_rows(int(sys.argv[2]), *map(int, sys.argv[3:4]))
    else:
        family_rows()
