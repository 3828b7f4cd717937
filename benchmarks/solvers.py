"""Both solvers on the same programs: `python -m benchmarks.solvers [--sizes 30,182,675,1890,4096]`.

Each program is the first round of `wiggleroom flex` on a grid of tee blocks, gap 0.01: one cell a pair, first block
fixed, last one pulled. Times are of `solve` alone, from the finished arrays to the optimum, CasADi's expressions
included. Both answers must pass the same optimality conditions.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass

import numpy as np

from wiggleroom.assembly import patterns
from wiggleroom.program.nonlinear_program import Program, build_program
from wiggleroom.program.objectives import objective
from wiggleroom.search.prepare import prepare_as_drawn
from wiggleroom.solve import SOLVERS, solver_named
from wiggleroom.solve.kkt_conditions import conditions

GRIDS = {30: (6, 5), 182: (14, 13), 675: (27, 25), 1890: (45, 42), 4096: (64, 64)}
GAP = 0.01
TOLERANCE = 1e-5
OURS, THEIRS = SOLVERS


@dataclass(frozen=True)
class Run:
    """One solver on one program: wall time [s], iterations, objective [mm], whether the optimality conditions hold."""

    seconds: float
    iterations: int
    value: float
    holds: bool


def program(nx: int, ny: int) -> tuple[Program, float]:
    """First program of a grid of tee blocks, and the grid's size [mm]."""
    assembly = patterns.grid(nx, ny, gap=GAP)
    ready = prepare_as_drawn(assembly)
    goal = objective(assembly, ready.bodies, assembly.goals)
    return build_program(ready.bodies, ready.cells, goal, length=ready.clearance), ready.size


def run(name: str, of: Program, size: float) -> Run:
    """Solve once."""
    solve = solver_named(name)
    began = time.perf_counter()
    solution = solve(of, tolerance=TOLERANCE)
    seconds = time.perf_counter() - began
    good = solution.status == "converged" and conditions(of, solution.u, solution.lam).hold(size)
    return Run(seconds, solution.iterations, of.objective.value(of.motion(solution.u)), good)


def exponent(times: dict[int, float]) -> float:
    """Growth of the time with the number of parts, between the smallest and the largest."""
    parts = np.array([min(times), max(times)], dtype=float)
    seconds = np.array([times[min(times)], times[max(times)]])
    return float(np.diff(np.log(seconds))[0] / np.diff(np.log(parts))[0])


def main() -> None:
    """Print one line a grid, then how the times grow."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", default="30,182,675,1890,4096", help=f"of {', '.join(map(str, GRIDS))}")
    sizes = [int(word) for word in parser.parse_args().sizes.split(",")]
    if not set(sizes) <= set(GRIDS):
        parser.error(f"sizes are {', '.join(map(str, GRIDS))}")
    warm, size = program(*GRIDS[30])
    for name in SOLVERS:  # compiled kernels and libraries are loaded before the clock starts
        run(name, warm, size)
    print(f"{'parts':>6} {'rows':>7} {OURS:>29} {THEIRS:>29} {'ratio':>6} {'difference':>11}")
    times: dict[str, dict[int, float]] = {name: {} for name in SOLVERS}
    for parts in sizes:
        of, size = program(*GRIDS[parts])
        both = {name: run(name, of, size) for name in SOLVERS}
        for name, one in both.items():
            times[name][parts] = one.seconds
        ours, theirs = both[OURS], both[THEIRS]
        cells = " ".join(
            f"{r.iterations:4d} it {r.seconds:8.3f} s {r.value:9.5f}{' ' if r.holds else '!'}" for r in both.values()
        )
        apart = (ours.value - theirs.value) / theirs.value
        print(f"{parts:6d} {of.rows:7d} {cells} {theirs.seconds / ours.seconds:6.1f} {apart:11.1e}", flush=True)
    for name in SOLVERS:
        large = {parts: seconds for parts, seconds in times[name].items() if parts >= 675}
        if len(large) > 1:
            print(f"{name}: time grows with parts ^ {exponent(large):.2f} from {min(large)} to {max(large)}")
    print("! the optimality conditions do not hold")


if __name__ == "__main__":
    main()
