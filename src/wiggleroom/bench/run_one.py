"""One assembly and one method in a process of its own: `python -m wiggleroom.bench.run_one JOB`, the job as JSON.

It writes a line of JSON after the preparation and another one at the end, so that whoever ends it early knows how far it came.
Before the clock starts a tiny assembly is solved the same way: what is loaded and compiled once does not count.
"""

from __future__ import annotations

import json
import sys
import time

from wiggleroom.assembly import patterns
from wiggleroom.bench.large_assemblies import CASES, make_assembly
from wiggleroom.bench.result import Record
from wiggleroom.context import Context
from wiggleroom.deadline import Deadline
from wiggleroom.freespace.models.pair_models import HalfPlane, Hull, PairModel, Walls
from wiggleroom.maximise import prepare, witness

METHODS: dict[str, tuple[PairModel, str]] = {
    "walls": (Walls(), "interior-point"),
    "hull + our solver": (Hull("joint"), "interior-point"),
    "hull + IPOPT": (Hull("joint"), "ipopt"),
    "half-planes": (HalfPlane(), "interior-point"),
}
"""Registry: model and solver of each method, ours first."""


def main() -> None:
    """Do the job, and say what it took."""
    job = json.loads(sys.argv[1])
    model, solver = METHODS[job["method"]]
    (case,) = [c for c in CASES if c.name == job["case"]]
    witness(patterns.chain(2), model=model, solver=solver)
    assembly = make_assembly(case)
    clock = Deadline(job["limit"])
    began, worked = time.perf_counter(), time.process_time()
    ready = prepare(assembly, model)
    prepared = time.perf_counter()
    _say({"preprocess_seconds": prepared - began})
    answer = witness(ready, solver=solver, context=Context(stop=clock))
    solved = time.perf_counter()
    _say(
        {
            "solve_seconds": solved - prepared,
            "total_seconds": solved - began,
            "processor_seconds": time.process_time() - worked,
            "peak_mb": peak(),
            "moves_mm": answer.objective,
            "overlap_mm": 0.0 if answer.collision_free else answer.deepest_overlap,
            "verdict": str(answer.verdict),
            "path": answer.path,
            "solver": answer.solver,
            "rounds": answer.rounds,
            "iterations": answer.iterations,
            "late": clock.is_set(),
        }
    )


def peak() -> float | None:
    """Largest memory of this process so far [MB]; None where the system does not say."""
    try:
        import resource
    except ImportError:
        return None
    unit = 1e6 if sys.platform == "darwin" else 1e3
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def _say(record: Record) -> None:
    sys.stdout.write(json.dumps(record) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
