"""Many solves: the same numbers wherever they run, and no result lost with a worker."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import wiggleroom as wr
from wiggleroom.context import Context
from wiggleroom.parallel import parallel_run as module
from wiggleroom.parallel.parallel_run import run_each


def square(shared: float, task: float) -> float:
    return shared * task * task


def dies_once(marker: str, task: int) -> int:
    """Kill the process that works on task 3, the first time."""
    if task == 3 and not Path(marker).exists():
        Path(marker).write_text("was here")
        os.kill(os.getpid(), signal.SIGKILL)
    return 10 * task


def always_dies(_: None, task: int) -> int:
    if task == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return task


def raises(_: None, task: int) -> int:
    if task == 2:
        raise ValueError("task 2")
    return task


def slow(_: None, task: int) -> int:
    time.sleep(0.2)
    return task


@pytest.fixture
def processes(monkeypatch: pytest.MonkeyPatch) -> Context:
    """Two processes, started at once however short the work is; the first task stays in this one."""
    monkeypatch.setattr(module, "MIN_PARALLEL_SECONDS", -1.0)
    return Context(workers=2)


def test_order_is_kept(processes: Context) -> None:
    tasks = list(range(1, 20))
    assert run_each(square, 2.0, tasks, processes) == [2.0 * t * t for t in tasks]


def test_a_process_that_dies_costs_no_result(processes: Context, tmp_path: Path) -> None:
    assert run_each(dies_once, str(tmp_path / "marker"), list(range(8)), processes) == [10 * t for t in range(8)]
    assert (tmp_path / "marker").exists()


def test_a_task_that_kills_every_process_is_given_up(processes: Context) -> None:
    with pytest.raises(wr.WiggleroomError, match="died"):
        run_each(always_dies, None, [0, 1, 2], processes)


@pytest.mark.parametrize("workers", [1, 2])
def test_errors_come_through(workers: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MIN_PARALLEL_SECONDS", -1.0)
    with pytest.raises(ValueError, match="task 2"):
        run_each(raises, None, [1, 2, 3], Context(workers=workers))


def test_it_can_be_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MIN_PARALLEL_SECONDS", -1.0)
    stop = threading.Event()
    context = Context(workers=2, stop=stop, counted=lambda done, _: stop.set() if done >= 3 else None)
    results = run_each(slow, None, list(range(40)), context)
    assert 3 <= sum(r is not None for r in results) < 12
    assert all(r in (None, k) for k, r in enumerate(results))


def test_progress_counts_up(processes: Context) -> None:
    told: list[tuple[int, int]] = []
    run_each(square, 1.0, [1.0, 2.0, 3.0], Context(workers=2, counted=lambda done, total: told.append((done, total))))
    assert told == [(1, 3), (2, 3), (3, 3)]


@pytest.mark.slow
def test_processes_give_the_same_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MIN_PARALLEL_SECONDS", -1.0)
    one, two = (wr.sample(wr.patterns.chain(4, gap=0.02), 0.002, draws=6, workers=w) for w in (1, 2))
    assert (one.value == two.value).all()
    assert (one.checked == two.checked).all()


@pytest.mark.slow
def test_a_cluster_that_is_not_there_is_said_so() -> None:
    pytest.importorskip("distributed")
    with pytest.raises(wr.WiggleroomError, match="no Dask scheduler answers"):
        run_each(square, 1.0, [1.0], Context(cluster="tcp://127.0.0.1:1"))


@pytest.fixture
def scheduler(tmp_path: Path):
    """A Dask scheduler and two workers on this machine: its address, and the workers' processes."""
    pytest.importorskip("distributed")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    run = [sys.executable, "-m", "distributed.cli.dask_scheduler"]
    options = {"cwd": tmp_path, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    options["env"] = os.environ | {"PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    started = [subprocess.Popen([*run, "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"], **options)]
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--no-nanny", "--nthreads", "1"]
    started += [subprocess.Popen([*worker, "--no-dashboard", "--name", f"w{k}"], **options) for k in range(2)]
    try:
        from distributed import Client

        with Client(address, timeout="30s", set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)
        yield address, started[1:]
    finally:
        for process in started:
            process.kill()
            process.wait()


@pytest.mark.slow
def test_a_cluster_gives_the_same_numbers_although_a_worker_dies(scheduler) -> None:
    address, workers = scheduler
    chain = wr.patterns.chain(8, joint="tee", gap=0.02)
    here = wr.sample(chain, 0.002, draws=24, workers=1)
    killed: list[int] = []

    def kill_one(done: int, _: int) -> None:
        if done >= 6 and not killed:
            workers[0].kill()
            killed.append(done)

    there = wr.sample(chain, 0.002, draws=24, cluster=address, progress=kill_one)
    assert killed
    assert workers[0].wait(timeout=10) != 0
    assert (there.value == here.value).all()
    ranked = wr.rank(here.answer, by="differences", cluster=address)
    assert (ranked.looser == wr.rank(here.answer, by="differences", workers=1).looser).all()
    assert np.isfinite(ranked.looser).all()
