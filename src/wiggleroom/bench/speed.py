"""Table 2: time and memory of large assemblies, for preparation and solving; each question in a process of its own.

Other methods are given a multiple of the time that walls took, so that a run ends; who needs more is said to.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import wiggleroom
from wiggleroom.bench.large_assemblies import CASES, GAP, LargeAssembly
from wiggleroom.bench.published import published_speed as published
from wiggleroom.bench.result import Bench, Column, Record, ResultTable
from wiggleroom.bench.run_one import METHODS
from wiggleroom.errors import InputError, Stop, require_extra
from wiggleroom.solve.ipopt import described
from wiggleroom.solve.linear_programming import linear_solver

PATIENCE, SHORTEST, LONGEST = 30.0, 60.0, 600.0
"""Other methods may take this many times as long as walls, and at least and at most this long [s]."""
TIME_LIMIT_FACTOR = 1.5
"""A method that does not heed the limit is ended after this many times the limit."""
POLL_INTERVAL = 0.2
"""How often a running process is looked at [s]."""

COLUMNS = (
    Column("assembly", "assembly"),
    Column("method", "method"),
    Column("preprocess_seconds", "prep s", 2),
    Column("solve_seconds", "solve s", 2),
    Column("total_seconds", "total s", 2),
    Column("processor_seconds", "processor s", 2),
    Column("iterations", "iterations", 0, wide=True),
    Column("peak_mb", "peak MB", 0),
    Column("moves_mm", "moves mm", 3, star="overlap_mm"),
    Column("overlap_mm", "overlap mm", 4, wide=True),
    Column("times_walls", "times walls", 1),
    Column("ended", "ended"),
)


def speed(
    max_parts: int | None = None,
    *,
    limit: float | None = None,
    stop: Stop | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Bench:
    """Time every method on every assembly.

    Parameters
    ----------
    max_parts : int, optional
        Leave out larger assemblies.
    limit : float, optional [s]
        What the methods beside walls may take; by default 30 times what walls took, within 60 and 600 seconds.
    stop, progress : optional
        Asked all the time; told how many questions are done, and how many there are.

    Raises
    ------
    InputError
        If no assembly is so small, or the limit is no time.
    MissingExtraError
        If the solver of a method is not installed.

    Source: Mind the Gap, Table 2.
    """
    cases = checked_cases(max_parts, limit)
    found: list[Record] = []
    count = 0
    for case in cases:
        ours = 0.0
        for method in METHODS:
            if stop is not None and stop.is_set():
                break
            if progress is not None:
                progress(count, len(cases) * len(METHODS))
            first = method == next(iter(METHODS))
            allowed = None if first else limit or min(max(PATIENCE * ours, SHORTEST), LONGEST)
            record = measure_in_process(case, method, allowed, stop)
            if first:
                ours = record.get("total_seconds", LONGEST)
            elif "total_seconds" in record and ours:
                record["times_walls"] = record["total_seconds"] / ours
            found.append(record)
            count += 1
        found += [{"assembly": case.name, **row} for row in published(case.parts, case.joint)]
    cut = stop is not None and stop.is_set()
    notes = (
        f"Wall-clock seconds, gap {GAP:g}, first block fixed, last one pulled in +y (of the pictures "
        "as in the paper's Fig. 8b: elephant, two feet fixed, the head pulled up; butterfly, the middle fixed, both "
        "sides pulled apart); libraries and compiled code loaded before the clock starts. "
        "Walls: interior point, all rounds, the check of the end and of the path "
        "from rest included. Processor: seconds of all processors for preparing and solving. "
        "Hull: about the joint, three slices, one round; with IPOPT "
        f"({described()}), and with our interior-point solver. Half-planes: step by step, linear "
        f"programs by {linear_solver()}. Peak: memory of the whole process.",
        "Ended: what the method itself says; a time with > (in the picture an arrow) is where it was stopped at its limit, and its motion "
        "the best until then. A star, overlap: parts lie that deep in each other in its answer.",
        "† Published in Mind the Gap, Table 2 and Fig. 8, on their machine; PuzzleFlex (Julia) as timed there.",
    )
    words = [f"--max-parts {max_parts}"] if max_parts is not None else []
    words += [f"--limit {limit:g}"] if limit is not None else []
    command = " ".join(["wiggleroom bench speed", *words])
    return Bench(
        "speed",
        "Large assemblies: time and memory",
        tuple(found),
        (ResultTable("", COLUMNS, tuple(found)),),
        notes,
        command,
        cut,
    )


def checked_cases(max_parts: int | None, limit: float | None) -> list[LargeAssembly]:
    """Assemblies that are measured, once it is seen that they can be; raises as `speed` does."""
    cases = [case for case in CASES if max_parts is None or case.parts <= max_parts]
    wrong = []
    if not cases:
        wrong.append(f"max-parts {max_parts}: the smallest assembly has {min(c.parts for c in CASES)} parts")
    if limit is not None and not 0 < limit < float("inf"):
        wrong.append(f"limit {limit:g} s: it must be a time above 0")
    if wrong:
        raise InputError(wrong)
    require_extra("bench", "bench speed compares with IPOPT", "casadi")
    return cases


def measure_in_process(case: LargeAssembly, method: str, limit: float | None, stop: Stop | None = None) -> Record:
    """Figures of one method on one assembly, from a process of its own that ends a while after `limit` [s] at the latest."""
    record: Record = {
        "assembly": case.name,
        "parts": case.parts,
        "joint": case.joint,
        "method": method,
        "published": False,
    }
    job = {"case": case.name, "method": method, "limit": limit}
    source = str(Path(wiggleroom.__file__).parents[1])
    where = os.pathsep.join([source, *filter(None, [os.environ.get("PYTHONPATH")])])
    with subprocess.Popen(
        [sys.executable, "-m", "wiggleroom.bench.run_one", json.dumps(job)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": where}, start_new_session=True,
    ) as process:  # fmt: skip
        said, wrong, asked = _heard(process, limit, stop)
    for line in said.splitlines():
        record |= json.loads(line)
    late = record.pop("late", False)
    if asked:
        return record | {"ended": "interrupted"}
    if "total_seconds" not in record:
        if process.returncode > 0 or limit is None:
            last = (wrong.strip().splitlines() or ["no reason given"])[-1]
            return record | {"ended": f"failed: {last}"}
        late = True
        record |= {"total_seconds": limit, "verdict": "no answer"}
    if late:
        return record | {
            "limit_seconds": limit,
            "at_least": ["solve_seconds", "total_seconds", "times_walls"],
            "ended": record["verdict"],
        }
    return record | {"ended": record["verdict"]}


def _heard(process: subprocess.Popen[str], limit: float | None, stop: Stop | None) -> tuple[str, str, bool]:
    """What the process says and complains of; ended long after its limit, or when asked to stop, which is the third value."""
    end = None
    asked = False
    while True:
        try:
            said, wrong = process.communicate(timeout=POLL_INTERVAL)
        except subprocess.TimeoutExpired:
            asked = asked or (stop is not None and stop.is_set())
            end = end or (None if limit is None else time.monotonic() + TIME_LIMIT_FACTOR * limit + SHORTEST)
            if asked or (end is not None and time.monotonic() > end):
                process.kill()
        else:
            return said, wrong, asked
