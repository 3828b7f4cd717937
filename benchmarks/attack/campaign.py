"""Many assemblies, one after the other: each in a process that may die or hang, with a log to go on from."""

from __future__ import annotations

import json
import multiprocessing as mp
import os
import time
import traceback
from collections import Counter, defaultdict
from collections.abc import Iterable
from multiprocessing.connection import Connection
from pathlib import Path

from benchmarks.attack.families import draw
from benchmarks.attack.families_solid import draw_solids
from benchmarks.attack.judge import PROGRAMS, STUDIES, Finding, ask
from benchmarks.attack.judge_solids import ask_solids
from benchmarks.attack.solids import Solids
from benchmarks.attack.studies import ask_studies

HANG = 120.0
"""An assembly that takes longer than so many seconds of processor time hangs; a machine at work may take ten times as long."""
HANG_ON_A_BUSY_MACHINE = 10 * HANG
QUESTIONS = {"plane": (draw, ask), "studies": (draw, ask_studies), "space": (draw_solids, ask_solids)}
"""What draws an assembly by its number, and what asks about it."""
WARM_UP = 3
"""A process answers this number before it counts."""
LOG = "log.jsonl"


def run(count: int, first: int, out: Path, programs: int = PROGRAMS, questions: str = "plane") -> list[Finding]:
    """Ask about assemblies `first` to `first + count`, but those in the log already; findings of all of them.

    Questions are those of `QUESTIONS`: about the studies of gaps, or else by `flex` and `check`, in the plane or in space.
    """
    out.mkdir(parents=True, exist_ok=True)
    done = {f.number: f for f in read_log(out)}
    worker = _Worker(programs, questions)
    try:
        with (out / LOG).open("a", encoding="utf-8") as log:
            for number in range(first, first + count):
                if number in done:
                    continue
                finding = worker.ask(number)
                done[number] = finding
                log.write(finding.line() + "\n")
                log.flush()
                if finding.wrong and finding.verdict != "refused":
                    save(out, finding, questions)
    finally:
        worker.end()
    return [done[k] for k in sorted(done)]


def read_log(out: Path) -> list[Finding]:
    """What was found before."""
    log = out / LOG
    lines = log.read_text(encoding="utf-8").splitlines() if log.exists() else []
    return [Finding(**json.loads(line)) for line in lines if line.endswith("}")]


def save(out: Path, finding: Finding, questions: str = "plane") -> None:
    """Write an assembly to ask again, what was wrong, and the better path where there is one; those in space into folders."""
    made = QUESTIONS[questions][0](finding.number)[1]
    name = f"{finding.family}_{finding.number}"
    if isinstance(made, Solids):
        (out / name).mkdir(exist_ok=True)
        made.write(out / name)
    else:
        (out / f"{name}.json").write_text(json.dumps(made, indent=1), encoding="utf-8")
    said = [
        f"verdict {finding.verdict}, path {finding.path}, value {finding.value}, check {finding.check}",
        *finding.wrong,
    ]
    (out / f"{name}.txt").write_text("\n".join(said) + "\n", encoding="utf-8")
    if finding.better is not None:
        lines = [str(len(finding.better))]
        lines += [" ".join(repr(x) for part in state for x in part) for state in finding.better]
        (out / f"{name}.better_way.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")


class _Worker:
    """A process that answers one number after the other, and is started again where it dies or hangs."""

    def __init__(self, programs: int, questions: str) -> None:
        self._programs, self._questions = programs, questions
        self._start()

    def ask(self, number: int) -> Finding:
        """What becomes of one assembly."""
        family, made = QUESTIONS[self._questions][0](number)
        if made is None:
            return Finding(family, number, "not drawn")
        began, spent = time.monotonic(), self._processor_time()
        self._mine.send(number)
        while self._processor_time() - spent < HANG and time.monotonic() - began < HANG_ON_A_BUSY_MACHINE:
            if self._mine.poll(0.2):
                try:
                    return self._mine.recv()
                except EOFError:
                    break
            if not self._process.is_alive():
                break
        kind = "crash" if not self._process.is_alive() else "hang"
        self.end()
        self._start()
        return Finding(family, number, kind, wrong=[f"{kind}: no answer after {time.monotonic() - began:.0f} s"])

    def _processor_time(self) -> float:
        """What the process has spent so far [s]; where the system does not tell, the time that has passed."""
        stat = Path(f"/proc/{self._process.pid}/stat")
        try:
            user, system = stat.read_text(encoding="ascii").rpartition(")")[2].split()[11:13]
        except OSError:
            return time.monotonic()
        return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")

    def end(self) -> None:
        """Stop the process."""
        if self._process.is_alive():
            self._process.kill()
        self._process.join()

    def _start(self) -> None:
        self._mine, its = mp.get_context("spawn").Pipe()
        self._process = mp.get_context("spawn").Process(
            target=_serve, args=(its, self._programs, self._questions), daemon=True
        )
        self._process.start()
        self._mine.recv()  # what is compiled on first use does not count


def _serve(line: Connection, programs: int, questions: str) -> None:
    draw_one, question = QUESTIONS[questions]
    family, made = draw_one(WARM_UP)
    question(family, WARM_UP, made or {}, 1)
    line.send("ready")
    while True:
        number = line.recv()
        family, made = draw_one(number)
        try:
            finding = question(family, number, made or {}, programs)
        except Exception:
            finding = Finding(family, number, "crash", wrong=["crash: " + traceback.format_exc(limit=-3)])
        line.send(finding)


COLUMNS = {
    "checked": lambda f: f.path == "checked",
    "unchecked": lambda f: f.path == "not checked",
    "path wrong": lambda f: any(w.startswith(("path", "end", "escape", "value")) for w in f.wrong),
    "optimal": lambda f: f.verdict == "optimal",
    "low": lambda f: any(w.startswith("low:") for w in f.wrong),
    "proven": lambda f: f.verdict == "proven",
    "low proven": lambda f: any(w.startswith("low-proven") for w in f.wrong),
    "unbounded": lambda f: f.verdict == "unbounded",
    "stopped": lambda f: f.verdict == "stopped",
    "study wrong": lambda f: any(w.startswith(STUDIES) for w in f.wrong),
    "bound or check wrong": lambda f: any(w.startswith(("bound", "check:")) for w in f.wrong),
    "refused": lambda f: f.verdict == "refused",
    "crash": lambda f: f.verdict == "crash",
    "hang": lambda f: f.verdict == "hang",
}


def table(findings: Iterable[Finding]) -> str:
    """Findings by family, in Markdown."""
    rows: dict[str, Counter[str]] = defaultdict(Counter)
    for finding in findings:
        if finding.verdict == "not drawn":
            continue
        for family in (finding.family, "**all**"):
            rows[family]["asked"] += 1
            rows[family].update(name for name, holds in COLUMNS.items() if holds(finding))
    heads = ["asked", *COLUMNS]
    lines = ["| family | " + " | ".join(heads) + " |", "| --- |" + " --- |" * len(heads)]
    order = sorted(rows, key=lambda f: (f == "**all**", f))
    lines += [f"| {f} | " + " | ".join(str(rows[f][h]) for h in heads) + " |" for f in order]
    return "\n".join(lines)
