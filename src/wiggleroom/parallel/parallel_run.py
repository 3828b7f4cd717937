"""Many independent solves: in this process, in processes of this machine, or on a Dask cluster, with the same results.

Every task is a function of what all share and of itself alone, so where it runs and in which order changes nothing.
A process or a cluster's worker that dies costs the time of its task, which is done again elsewhere.
"""

from __future__ import annotations

import os
import pickle
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from wiggleroom.context import Context
from wiggleroom.errors import Stop, StoppedError, WiggleroomError, is_asked, require_extra
from wiggleroom.parallel.batches import usable_cores

Work = Callable[[Any, Any], Any]
"""A function of a module: work(shared, task) -> result; everything can be pickled."""

MIN_PARALLEL_SECONDS = 5.0
"""Processes are started where one would need longer than this [s]: they take a second to get going."""
MAX_RETRIES = 3
"""A task is given up after its worker died this many times."""


@dataclass(frozen=True)
class StopHere:
    """What stops work within a task, as a part of what tasks share: in this process; others are ended.

    Parameters
    ----------
    stop : optional
        Anything with `is_set()`.
    """

    stop: Stop | None = None

    def is_set(self) -> bool:
        """True to stop."""
        return is_asked(self.stop)

    def __reduce__(self) -> tuple[type[StopHere], tuple[()]]:
        """What other processes are sent: nothing that stops."""
        return StopHere, ()


def run_each(work: Work, shared: Any, tasks: Sequence[Any], context: Context) -> list[Any]:
    """Result of every task, in order; None for those that were not done before it was asked to stop, or raised StoppedError here.

    Raises
    ------
    WiggleroomError
        If the cluster cannot be reached, or workers die again and again on the same task.
    MissingExtraError
        If a cluster is named and the extra is missing.
    """
    run = _Run(work, shared, tasks, context)
    if context.cluster is not None:
        _on_cluster(run)
    else:
        began, rest = time.perf_counter(), list(range(len(tasks)))
        workers = context.workers or usable_cores()
        while rest and not context.stopped:
            spent = time.perf_counter() - began
            if workers > 1 and run.results and spent / len(run.results) * len(rest) > MIN_PARALLEL_SECONDS:
                _in_processes(run, rest, min(workers, len(rest)))
                break
            k = rest.pop(0)
            with suppress(StoppedError):
                run.keep(k, work(shared, tasks[k]))
    return [run.results.get(k) for k in range(len(tasks))]


@dataclass(frozen=True, eq=False)
class _Run:
    """Tasks, and the results of those that are done."""

    work: Work
    shared: Any
    tasks: Sequence[Any]
    context: Context
    results: dict[int, Any] = field(default_factory=dict)

    def keep(self, k: int, result: Any) -> None:
        """Keep the result of a task, and tell how many are done."""
        self.results[k] = result
        if self.context.counted is not None:
            self.context.counted(len(self.results), len(self.tasks))


def child_environment() -> dict[str, str]:
    """Environment of a Python process that finds the modules that this one finds."""
    return os.environ | {"PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}


class _Process:
    """One worker process, which imports nothing of the program that asks: no script runs twice."""

    def __init__(self, greeting: bytes) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "wiggleroom.parallel.process_worker"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=child_environment(),
            start_new_session=True,  # Ctrl-C is for the program that asks
        )  # fmt: skip
        self._send(greeting)

    def _send(self, data: bytes) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(data)
        self._process.stdin.flush()

    def ask(self, task: Any) -> tuple[bool, Any]:
        """Send a task and wait for its result; raises OSError or EOFError where the process is gone."""
        assert self._process.stdout is not None
        self._send(pickle.dumps(task))
        return pickle.load(self._process.stdout)

    def end(self) -> None:
        """Kill the process."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            try:
                if pipe is not None:
                    pipe.close()
            except OSError:
                pass


def _in_processes(run: _Run, rest: list[int], workers: int) -> None:
    """Do `rest` in worker processes, each looked after by a thread."""
    greeting = pickle.dumps((run.work, run.shared))
    todo: queue.SimpleQueue[int | None] = queue.SimpleQueue()
    done: queue.SimpleQueue[tuple[int, bool, Any]] = queue.SimpleQueue()
    losses: dict[int, int] = {}
    living: set[_Process] = set()
    ending = threading.Event()

    def look_after() -> None:
        process: _Process | None = None
        k = todo.get()
        while k is not None and not ending.is_set():
            try:
                if process is None:
                    process = _Process(greeting)
                    living.add(process)
                good, result = process.ask(run.tasks[k])
            except (OSError, EOFError, ValueError, pickle.UnpicklingError):  # its pipe was closed while it was read
                if process is not None:
                    living.discard(process)
                    process.end()
                    process = None
                if ending.is_set():
                    return
                losses[k] = losses.get(k, 0) + 1
                if losses[k] <= MAX_RETRIES:
                    continue  # the same task again, in a new process
                good, result = False, WiggleroomError(f"worker processes died {losses[k]} times on one task")
            done.put((k, good, result))
            k = todo.get()
        if process is not None:
            process.end()

    threads = [threading.Thread(target=look_after, daemon=True) for _ in range(workers)]
    for k in rest:
        todo.put(k)
    for thread in threads:
        todo.put(None)
        thread.start()
    try:
        left = len(rest)
        while left and not run.context.stopped:
            try:
                k, good, result = done.get(timeout=0.1)
            except queue.Empty:
                continue
            if not good:
                raise result
            left -= 1
            run.keep(k, result)
    finally:
        ending.set()
        for process in list(living):
            process.end()


def _on_cluster(run: _Run) -> None:
    """Hand all tasks to a Dask scheduler; it gives those of a lost worker to others."""
    require_extra("cluster", "a cluster needs the extra", "distributed")
    import logging
    import warnings

    from distributed import Client, as_completed

    for name in ("distributed.client", "distributed.batched", "distributed.core"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        client = Client(run.context.cluster, timeout="10s", set_as_default=False)
    except (OSError, ValueError, TypeError):
        message = f"no Dask scheduler answers at {run.context.cluster}: start one with `dask scheduler`, and give tcp://host:port"
        raise WiggleroomError(message) from None
    with client, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what tasks share may be large: it travels once
        # a task of its own: a worker that loses it can work it out again
        common = client.submit(pickle.loads, pickle.dumps(run.shared), pure=False)
        futures = {client.submit(run.work, common, task, pure=False): k for k, task in enumerate(run.tasks)}
        waiting = as_completed(futures, loop=client.loop)
        while waiting.count() and not run.context.stopped:
            if waiting.is_empty():
                time.sleep(0.05)
                continue
            for future in waiting.next_batch(block=False):
                run.keep(futures[future], future.result())
        client.cancel(list(futures), force=True)
