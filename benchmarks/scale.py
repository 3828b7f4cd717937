"""Whole commands on large assemblies, beside what is asked of them: `python -m benchmarks.scale [ROW ...] [--long] [--times 3]`.

Every assembly is written to a file, and `wiggleroom flex FILE --json ANSWER` runs in a process of its own. The best of so many runs
counts: wall and processor time, largest memory. What is asked stands in brackets beside each figure, and the last column says what is
missed. Floor: 30 Cholesky factorisations of the condensed matrix at the speed at which this machine multiplies matrices, on all cores,
both measured here; below that no interior-point method of 30 steps can come.

Without rows all but the long ones are asked; `--long` adds these, `--list` prints the names of all.
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
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wiggleroom.assembly import patterns
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.joints import JOINTS
from wiggleroom.drawing.writers.assembly_writer import write_assembly
from wiggleroom.program.multifrontal import FrontalPlan
from wiggleroom.program.sparsity_pattern import pattern
from wiggleroom.search.prepare import survey

GAP = 0.01
MIN_FACTORISATIONS = 30
FLEX = "import sys; from wiggleroom.cli import main; sys.exit(main())"
IMPORTS = (
    "import gc; from wiggleroom.cli import COLLECTION_THRESHOLD; gc.set_threshold(COLLECTION_THRESHOLD); "
    "import wiggleroom.cli.study_command, wiggleroom.maximise, wiggleroom.report.findings.flex, wiggleroom.report.results.json_results"
)
"""All that `flex` imports, as the command does it."""
READ = "import sys; from wiggleroom.questions import read; read(sys.argv[1])"
EXPECTED_GROWTH = 2.0
"""Iterations from the first row of `GROWTH` to the last may grow by this factor."""


@dataclass(frozen=True)
class Arrow:
    """A barbed head on a stem: a joint that nothing was tuned for."""

    def profile(self) -> np.ndarray:
        """Corners of the line."""
        half = [(-0.5, 0.0), (-0.08, 0.0), (-0.08, -0.12), (-0.2, -0.1)]
        return np.array([*half, (0.0, -0.3), *[(-x, y) for x, y in half[::-1]]])


JOINTS["arrow"] = Arrow


@dataclass(frozen=True)
class Case:
    """An assembly, more options of its command, and what is asked: wall time [s], motion [mm] and memory [MB]; none where infinite or 0."""

    make: Callable[[], Assembly]
    seconds: float = np.inf
    least: float = 0.0
    memory: float = np.inf
    options: tuple[str, ...] = ()
    long: bool = False


CASES = {
    "27 x 25 tee": Case(lambda: patterns.grid(27, 25, "tee", GAP), least=3.043),
    "27 x 25 tee, one climb": Case(lambda: patterns.grid(27, 25, "tee", GAP), options=("--search", "0")),
    "64 x 64 tee": Case(lambda: patterns.grid(64, 64, "tee", GAP), 3, 8.957),
    "64 x 64 dovetail": Case(lambda: patterns.grid(64, 64, "dovetail", GAP), 4, 11.7571),
    "64 x 64 swallowtail": Case(lambda: patterns.grid(64, 64, "swallowtail", GAP), 4, 12.2362),
    "64 x 64 revolute": Case(lambda: patterns.grid(64, 64, "revolute", GAP), 4, 9.1497),
    "40 x 40 arrow": Case(lambda: patterns.grid(40, 40, "arrow", GAP), 4, 4.6751),
    "30 x 30 jigsaw pieces": Case(lambda: patterns.jigsaw(30, 30, GAP), 6, 4.4335),
    "128 x 128 tee": Case(lambda: patterns.grid(128, 128, "tee", GAP), 15, 20.55),
    "100 x 100 jigsaw pieces": Case(lambda: patterns.jigsaw(100, 100, GAP), 25, long=True),
    "256 x 256 tee": Case(lambda: patterns.grid(256, 256, "tee", GAP), 180, long=True),
    "1000 x 1000 tee": Case(lambda: patterns.grid(1000, 1000, "tee", GAP), 5400, memory=16_000, long=True),
}
"""Least motions of the joints that the targets give none for: what was found before, less 1e-4 of it."""
GROWTH = "27 x 25 tee, one climb", "256 x 256 tee"
IMPORT_ROW, READ_ROW = "imports", "reading 10,000 different pieces"
PARTS = {IMPORT_ROW: 0.35, READ_ROW: 0.5}
"""Parts of a command, and the most that each may take [s]."""


@dataclass(frozen=True)
class Run:
    """One process: wall and processor time [s], memory [MB], and what it said."""

    wall: float
    processor: float
    memory: float
    said: str


def run(words: Sequence[str], said: Path) -> Run:
    """Run Python with some arguments in a new process; it may keep byte code, as where it is installed."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    began = time.perf_counter()
    with (
        said.open("w") as text,
        subprocess.Popen([sys.executable, *words], stdout=text, stderr=subprocess.STDOUT, env=environment) as process,
    ):
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    wall = time.perf_counter() - began
    if process.returncode != 0:
        raise SystemExit(f"{said.stem}: exit {process.returncode}: {said.read_text()[-500:]}")
    return Run(wall, used.ru_utime + used.ru_stime, used.ru_maxrss / 1000, said.read_text())


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
    surveyed = survey(assembly)
    bodies = surveyed.bodies
    free = np.flatnonzero(~bodies.fixed)
    slot = np.full(len(bodies.fixed), -1)
    slot[free] = np.arange(len(free))
    found = pattern(surveyed.near.a, surveyed.near.b, slot, bodies.rest[free, :2])
    return FrontalPlan(found.at, found.indptr, found.indices, 3).operations


def beside(figure: str, asked: float) -> str:
    """A figure with what is asked of it in brackets."""
    return f"{figure} ({asked:g})" if 0 < asked < np.inf else figure


def measured(name: str, case: Case, times: int, speed: float, folder: Path) -> tuple[str, int]:
    """The line of one assembly in the table, and its iterations."""
    assembly = case.make()
    file = folder / (re.sub(r"\W+", "-", name) + ".json")
    file.write_text(write_assembly(assembly.drawing))
    out, said = file.with_suffix(".answer.json"), file.with_suffix(".txt")
    runs = [run(["-c", FLEX, "flex", str(file), "--json", str(out), *case.options], said) for _ in range(times)]
    best = min(runs, key=lambda one: one.wall)
    answer, found = json.loads(out.read_text()), re.search(r"(\d+) iterations", best.said)
    iterations = int(found[1]) if found else 0
    moves = answer["objective"] or 0.0
    missed = [
        what
        for what, wrong in (
            ("time", best.wall > case.seconds),
            ("motion", moves < case.least),
            ("memory", best.memory > case.memory),
            ("path", answer["path"] != "checked" or not answer["collision_free"]),
        )
        if wrong
    ]
    floor = MIN_FACTORISATIONS * factor_operations(assembly) / speed
    cells = (
        name, f"{len(assembly.parts):,}", beside(f"{best.wall:.1f}", case.seconds), f"{min(r.processor for r in runs):.1f}", f"{floor:.2g}",
        beside(f"{best.memory:.0f}", case.memory), beside(f"{moves:.5f}", case.least), answer["verdict"], answer["path"],
        str(answer["rounds"]), str(iterations), ", ".join(missed) or "nothing",
    )  # fmt: skip
    return f"| {' | '.join(cells)} |", iterations


def measured_part(name: str, times: int, folder: Path) -> str:
    """The line of a part of a command."""
    words = ["-c", IMPORTS]
    if name == READ_ROW:
        file = folder / "pieces.json"
        if not file.is_file():
            file.write_text(write_assembly(patterns.jigsaw(100, 100, GAP).drawing))
        words = ["-c", READ, str(file)]
    runs = [run(words, folder / "said.txt") for _ in range(times)]
    wall, seconds = min(r.wall for r in runs), min(r.processor for r in runs)
    if name == READ_ROW:  # a process that reads next to nothing takes the rest of the time
        small = folder / "few.json"
        small.write_text(write_assembly(patterns.chain(2, "tee", GAP).drawing))
        idle = [run(["-c", READ, str(small)], folder / "said.txt") for _ in range(times)]
        wall, seconds = wall - min(r.wall for r in idle), seconds - min(r.processor for r in idle)
        name = f"{name}, {file.stat().st_size / 1e6:.0f} MB"
    limit = PARTS[READ_ROW] if name.startswith(READ_ROW) else PARTS[IMPORT_ROW]
    return f"| {name} | {beside(f'{wall:.2f}', limit)} | {seconds:.2f} | {'time' if wall > limit else 'nothing'} |"


def main() -> None:
    """Print one line an assembly, then one for each part of a command."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", nargs="*", metavar="ROW", help="rows of the tables, by name")
    parser.add_argument("--long", action="store_true", help="the long ones too")
    parser.add_argument("--list", action="store_true", help="print the names of all rows")
    parser.add_argument("--times", type=int, default=3, help="runs of each; the quickest counts")
    asked = parser.parse_args()
    if asked.list:
        print("\n".join([*CASES, *PARTS]))
        return
    if unknown := [name for name in asked.rows if name not in CASES | PARTS]:
        parser.error(f"{unknown[0]}: not one of {', '.join([*CASES, *PARTS])}")
    rows = asked.rows or [*(name for name, case in CASES.items() if asked.long or not case.long), *PARTS]
    speed, iterations = multiplication_speed(), {}
    print(
        f"A product of matrices: {speed / 1e9:.0f} Gflop/s. In brackets what is asked: at most, of motions at least.\n"
    )
    with tempfile.TemporaryDirectory() as folder:
        if any(name in CASES for name in rows):
            print(
                "| assembly | parts | wall s | processor s | floor s | MB | moves mm | verdict | path | rounds | iterations | missed |"
            )
            print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | --- | --- | ---: | ---: | --- |", flush=True)
        for name in (name for name in rows if name in CASES):
            line, iterations[name] = measured(name, CASES[name], asked.times, speed, Path(folder))
            print(line, flush=True)
        if all(name in iterations for name in GROWTH):
            growth = iterations[GROWTH[1]] / iterations[GROWTH[0]]
            print(f"\nIterations from {GROWTH[0]} to {GROWTH[1]}: times {growth:.2f} ({EXPECTED_GROWTH:g}).")
        if any(name in PARTS for name in rows):
            print("\n| part of a command | wall s | processor s | missed |\n| --- | ---: | ---: | --- |", flush=True)
        for name in (name for name in rows if name in PARTS):
            print(measured_part(name, asked.times, Path(folder)), flush=True)


if __name__ == "__main__":
    main()
