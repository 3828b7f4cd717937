"""Answers to a fixed collection of questions, class by class: `python -m benchmarks.gate FILE [--against FILE] [--full]`.

Each answer is a line of FILE: verdict, value, certainty, counted work and processor time. A run that is interrupted goes on where it
stopped. `--against` names an earlier run: the table says for each class of questions how many answers were lost and won, and what they
cost. `--full` asks the whole collection, in an hour or two; without it a small one is asked in about eight minutes.

An answer is lost where the value fell by more than 1e-3 of itself, where an end became unknown or another one, or where it is less
certain. It is not said which of two different answers is true: that is for the tests and for `benchmarks.attack`.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

import wiggleroom as wr
from benchmarks import plan_families
from benchmarks.attack.families import FAMILIES, draw
from benchmarks.attack.families_solid import draw_solids
from benchmarks.values import CASES
from wiggleroom.bench.puzzles import PUZZLES
from wiggleroom.errors import WiggleroomError

EXAMPLES = Path(__file__).parents[1] / "examples"
LOSS = 1e-3
"""A smaller share of a value counts as the same."""
FIRST = 700_000
"""Number of the first random assembly; those of the figures in the docs are others."""
SURE = {"proven": 3, "optimal": 2, "unbounded": 2, "stationary": 1, "stopped": 0}
"""How certain the end of a largest motion is."""
LARGE = 50
"""Largest motions of more parts belong to the whole collection only."""


@dataclass(frozen=True)
class Record:
    """What was answered to one question, and what that took.

    Parameters
    ----------
    kind, name : str
        Class of the question, and what it is about.
    verdict, certainty : str
    value : float or None
        None where nothing stops the motion, or where the answer has no value.
    sure : int
        Answers of a larger number are more certain.
    work : int
        Iterations and rounds, or questions.
    seconds : float
        Processor time [s].
    """

    kind: str
    name: str
    verdict: str
    certainty: str
    value: float | None
    sure: int
    work: int
    seconds: float


Question = tuple[str, str, Callable[[], Any], Callable[[Any], Any]]
"""Class, name, what makes the assembly, and what is asked about it."""


def questions(full: bool) -> Iterator[Question]:
    """All questions of the collection."""
    for name, make in CASES.items():
        if full or len(make().parts) <= LARGE:
            yield "flex, patterns and drawings", name, make, wr.flex
    for number in range(FIRST, FIRST + (1000 if full else len(FAMILIES))):
        yield "flex, random", str(number), _planar(number), wr.flex
    for number in range(FIRST, FIRST + (300 if full else 30)):
        yield "check, random", str(number), _planar(number), wr.check
    for puzzle in PUZZLES:
        yield "check, known", puzzle.name, puzzle.assembly, wr.check
    for name, make in _puzzles():
        yield "check, known", name, make, wr.check
    for number in range(FIRST, FIRST + (300 if full else 45)):
        yield "flex in space, random", str(number), _spatial(number), wr.flex
        yield "check in space, random", str(number), _spatial(number), wr.check
    for file in sorted(EXAMPLES.glob("[45]*/*.json")):
        if '"wiggleroom/2"' in file.read_text(encoding="utf-8"):
            yield "check in space, examples", file.stem, _read(file), wr.check
    for number in range(FIRST, FIRST + (60 if full else 8)):
        yield "largest gap, random", str(number), _planar(number), wr.largest_gap
        yield "importance, random", str(number), _planar(number), lambda assembly: wr.rank(wr.flex(assembly))


def _puzzles() -> Iterator[tuple[str, Callable[[], wr.Assembly]]]:
    for count in (2, 4):
        yield f"{count} latches", lambda count=count: plan_families.latches(count)
    for count in (3, 4, 5):
        yield f"pinwheel of {count}", lambda count=count: plan_families.pinwheel(count)
    yield "lock of 2 tumblers", lambda: plan_families.tumbler_lock(2)
    yield "a bar that must be turned", plan_families.turning_room
    for seed in range(6):
        yield f"tray {seed}", lambda seed=seed: plan_families.tray(*plan_families.random_tray(seed))


def _read(file: Path) -> Callable[[], Any]:
    return lambda: wr.read(file)


def _planar(number: int) -> Callable[[], Any]:
    def make() -> Any:
        made = draw(number)[1]
        if made is None:
            return None
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "drawn.json"
            file.write_text(json.dumps(made), encoding="utf-8")
            return wr.read(file)

    return make


def _spatial(number: int) -> Callable[[], Any]:
    def make() -> Any:
        made = draw_solids(number)[1]
        if made is None:
            return None
        with tempfile.TemporaryDirectory() as folder:
            return wr.read(made.write(Path(folder)))

    return make


def ask(kind: str, name: str, make: Callable[[], Any], question: Callable[[Any], Any]) -> Record | None:
    """The answer to one question; None where nothing was drawn."""
    try:
        assembly = make()
        if assembly is None:
            return None
        began = time.process_time()
        answer = question(assembly)
    except WiggleroomError as error:
        return Record(kind, name, "refused", str(error).splitlines()[0], None, 0, 0, 0.0)
    seconds = round(time.process_time() - began, 3)
    return Record(kind, name, *_summary(answer), seconds)


def _summary(answer: Any) -> tuple[str, str, float | None, int, int]:
    if hasattr(answer, "escapes"):
        verdict, certainty = str(answer.verdict), str(answer.certainty)
        gone = sum(len(escape.parts) for escape in answer.escapes)
        known = verdict != "unknown"
        work = answer.questions + getattr(answer, "states", 0)
        return verdict, certainty, float(gone), known + (known and certainty == "proven"), work
    if hasattr(answer, "iterations"):
        verdict = str(answer.verdict)
        return verdict, str(answer.path), answer.objective, SURE.get(verdict, 0), answer.rounds + answer.iterations
    if hasattr(answer, "holds"):
        holds = answer.holds
        return "answered", "", None if holds is None else float(holds), int(holds is not None), 0
    return "answered", "", float(np.abs(answer.looser).sum()), 1, 0


def change(before: Record, now: Record) -> int:
    """-1 where an answer was lost, 1 where one was won, 0 where they are as good."""
    if before.verdict == "refused" or now.verdict == "refused":
        return (before.verdict == "refused") - (now.verdict == "refused")
    endless = ("unbounded", "comes apart")
    if (before.verdict in endless) != (now.verdict in endless):
        return 1 if now.verdict in endless else -1
    if before.value is not None and now.value is not None:
        share = (now.value - before.value) / max(abs(before.value), 1e-12)
        if abs(share) > LOSS:
            return 1 if share > 0 else -1
    return (now.sure > before.sure) - (now.sure < before.sure)


def read(file: Path) -> dict[tuple[str, str], Record]:
    """Records of an earlier run."""
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    records = [Record(**json.loads(line)) for line in lines if line.endswith("}")]
    return {(record.kind, record.name): record for record in records}


def table(now: dict[tuple[str, str], Record], before: dict[tuple[str, str], Record]) -> Iterator[str]:
    """One row for each class of questions, in Markdown, and a line for each answer that was lost or won."""
    yield "| class | asked | lost | won | work | before | seconds | before |"
    yield "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
    lines = []
    for kind in dict.fromkeys(kind for kind, _ in now):
        mine = [record for record in now.values() if record.kind == kind]
        pairs = [(before[kind, r.name], r) for r in mine if (kind, r.name) in before]
        changes = [change(*pair) for pair in pairs]
        of_before = [one for one, _ in pairs]
        yield (
            f"| {kind} | {len(mine)} | {changes.count(-1)} | {changes.count(1)} | {sum(r.work for r in mine)} | "
            f"{sum(r.work for r in of_before)} | {sum(r.seconds for r in mine):.1f} | "
            f"{sum(r.seconds for r in of_before):.1f} |"
        )
        for (old, new), sign in zip(pairs, changes, strict=True):
            if sign:
                was, became = (f"{r.verdict} {r.certainty} {r.value}" for r in (old, new))
                lines.append(f"{'lost' if sign < 0 else 'won'}: {kind}, {new.name}: {was} -> {became}")
    yield from lines


def main() -> None:
    """Ask what is not in FILE yet, then print the table; exit status 1 where a class lost more than 1 % of its answers."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("--against", type=Path)
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--only", default="", help="part of the name of a class")
    asked = parser.parse_args()
    done = read(asked.file)
    wanted = [one for one in questions(asked.full) if asked.only in one[0]]
    with asked.file.open("a", encoding="utf-8") as file:
        for kind, name, make, question in wanted:
            if (kind, name) in done:
                continue
            record = ask(kind, name, make, question)
            if record is not None:
                done[kind, name] = record
                file.write(json.dumps(asdict(record)) + "\n")
                file.flush()
    before = read(asked.against) if asked.against else {}
    print("\n".join(table(done, before)))
    kinds = {kind for kind, _ in done}
    for kind in kinds:
        changes = [change(before[k], done[k]) for k in done if k[0] == kind and k in before]
        if changes and (changes.count(-1) - changes.count(1)) > 0.01 * len(changes):
            raise SystemExit(1)


if __name__ == "__main__":
    main()
