"""Whole commands on large assemblies, beside what the machine could do at best: `python -m benchmarks.scale [NAME ...] [--times 3]`.

Every assembly is written to a file, and `wiggleroom flex FILE --json ANSWER` runs in a process of its own. The best of so many runs
counts: wall and processor time, largest memory. Limit: 30 Cholesky factorisations of the condensed matrix at the speed at which this
machine multiplies matrices, on all cores, both measured here; below that no interior-point method of 30 steps can come.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wiggleroom.assembly import patterns
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.joints import JOINTS
from wiggleroom.drawing.assembly_writer import write_assembly
from wiggleroom.program.sparsity_pattern import pattern
from wiggleroom.search.prepare import survey
from wiggleroom.solve.multifrontal import Multifrontal

GAP = 0.01
LEAST_FACTORISATIONS = 30
RUN = "import sys; from wiggleroom.cli import main; sys.exit(main())"


@dataclass(frozen=True)
class Arrow:
    """A barbed head on a stem: a joint that nothing was tuned for."""

    def profile(self) -> np.ndarray:
        """Corners of the line."""
        half = [(-0.5, 0.0), (-0.08, 0.0), (-0.08, -0.12), (-0.2, -0.1)]
        return np.array([*half, (0.0, -0.3), *[(-x, y) for x, y in half[::-1]]])


JOINTS["arrow"] = Arrow

CASES: dict[str, Callable[[], Assembly]] = {
    "27 x 25 tee": lambda: patterns.grid(27, 25, "tee", GAP),
    "64 x 64 tee": lambda: patterns.grid(64, 64, "tee", GAP),
    "64 x 64 dovetail": lambda: patterns.grid(64, 64, "dovetail", GAP),
    "64 x 64 swallowtail": lambda: patterns.grid(64, 64, "swallowtail", GAP),
    "64 x 64 revolute": lambda: patterns.grid(64, 64, "revolute", GAP),
    "40 x 40 arrow": lambda: patterns.grid(40, 40, "arrow", GAP),
    "30 x 30 jigsaw pieces": lambda: patterns.jigsaw(30, 30, GAP),
    "128 x 128 tee": lambda: patterns.grid(128, 128, "tee", GAP),
}
LONG: dict[str, Callable[[], Assembly]] = {
    "100 x 100 jigsaw pieces": lambda: patterns.jigsaw(100, 100, GAP),
    "256 x 256 tee": lambda: patterns.grid(256, 256, "tee", GAP),
    "1000 x 1000 tee": lambda: patterns.grid(1000, 1000, "tee", GAP),
}
"""Only where they are named."""


@dataclass(frozen=True)
class Run:
    """One command: wall and processor time [s], memory [MB], iterations, and its answer."""

    wall: float
    processor: float
    memory: float
    iterations: int
    answer: dict


def run(file: Path) -> Run:
    """Ask once, in a new process."""
    out = file.with_suffix(".answer.json")
    began = time.perf_counter()
    words = [sys.executable, "-c", RUN, "flex", str(file), "--json", str(out)]
    said = file.with_suffix(".txt")
    with said.open("w") as text, subprocess.Popen(words, stdout=text, stderr=subprocess.STDOUT) as process:
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    wall = time.perf_counter() - began
    found = re.search(r"(\d+) iterations", said.read_text())
    if process.returncode != 0 or found is None:
        raise SystemExit(f"{file.stem}: exit {process.returncode}: {said.read_text()[-500:]}")
    seconds = used.ru_utime + used.ru_stime
    return Run(wall, seconds, used.ru_maxrss / 1000, int(found[1]), json.loads(out.read_text()))


def multiplication_speed() -> float:
    """Floating-point operations a second of a product of large matrices."""
    a = np.random.default_rng(0).random((1500, 1500))
    best = np.inf
    for _ in range(5):
        began = time.perf_counter()
        a @ a
        best = min(best, time.perf_counter() - began)
    return 2.0 * len(a) ** 3 / best


def factor_operations(assembly: Assembly) -> float:
    """Floating-point operations of one factorisation of the condensed matrix."""
    ground = survey(assembly)
    bodies = ground.bodies
    free = np.flatnonzero(~bodies.fixed)
    slot = np.full(len(bodies.fixed), -1)
    slot[free] = np.arange(len(free))
    found = pattern(ground.near.a, ground.near.b, slot, bodies.rest[free, :2])
    return Multifrontal(found.at, found.indptr, found.indices, 3).operations


def main() -> None:
    """Print one line an assembly."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="; ".join([*CASES, *LONG]) + "; by default all but the last three")
    parser.add_argument("--times", type=int, default=3, help="runs of each; the quickest counts")
    asked = parser.parse_args()
    known = CASES | LONG
    if unknown := [name for name in asked.names if name not in known]:
        parser.error(f"{unknown[0]}: not one of {', '.join(known)}")
    speed = multiplication_speed()
    print(f"a product of matrices: {speed / 1e9:.0f} Gflop/s")
    print("| assembly | parts | wall s | processor s | limit s | MB | moves mm | path | rounds | iterations |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | --- | ---: | ---: |")
    with tempfile.TemporaryDirectory() as folder:
        for name in asked.names or CASES:
            assembly = known[name]()
            file = Path(folder) / (name.replace(" ", "-") + ".json")
            file.write_text(write_assembly(assembly.drawing))
            runs = [run(file) for _ in range(asked.times)]
            best = min(runs, key=lambda one: one.wall)
            least = LEAST_FACTORISATIONS * factor_operations(assembly) / speed
            answer = best.answer
            print(
                f"| {name} | {len(assembly.parts):,} | {best.wall:.1f} | {min(r.processor for r in runs):.1f} | {least:.2g} | "
                f"{best.memory:.0f} | {answer['objective']:.5f} | {answer['path']} | {answer['rounds']} | {best.iterations} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
