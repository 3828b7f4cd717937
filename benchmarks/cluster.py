"""A study on a Dask cluster of this machine: `python -m benchmarks.cluster [--draws 300] [--workers 1 2 4]`.

`sample` on the frame of 56 tees, in this process alone, then by a scheduler with so many workers of one thread each, started and
waited for before the clock starts. Draws must be the same to the last digit wherever they were worked out.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import wiggleroom as wr
from wiggleroom.sensitivity.sample import Sample

FRAME = Path(__file__).parents[1] / "examples" / "06_frame" / "frame.json"
DEVIATION = 0.001


def timed(study: Callable[[], Sample]) -> tuple[Sample, float]:
    """What a study found, and its wall time [s]."""
    began = time.perf_counter()
    found = study()
    return found, time.perf_counter() - began


def main() -> None:
    """Print one line for each number of workers."""
    from distributed import Client, LocalCluster

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--draws", type=int, default=300)
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2, 4])
    asked = parser.parse_args()
    assembly = wr.read(FRAME)
    alone, one = timed(lambda: wr.sample(assembly, DEVIATION, draws=asked.draws, workers=1))
    print(f"{asked.draws} draws, {os.cpu_count()} processors\n")
    print("| where | wall s | times as quick as one process | largest difference |\n| --- | ---: | ---: | ---: |")
    print(f"| this process | {one:.1f} | 1 | 0 |", flush=True)
    for count in asked.workers:
        with LocalCluster(n_workers=count, threads_per_worker=1, dashboard_address=None) as cluster:
            with Client(cluster) as client:
                client.wait_for_workers(count)
            address = cluster.scheduler_address
            found, seconds = timed(
                lambda address=address: wr.sample(assembly, DEVIATION, draws=asked.draws, cluster=address)
            )
        off = float(np.abs(found.value - alone.value).max())
        print(
            f"| Dask, {count} worker{'s' * (count > 1)} | {seconds:.1f} | {one / seconds:.2f} | {off:.1g} |", flush=True
        )


if __name__ == "__main__":
    main()
