"""What the program says about one assembly, and what the judge finds wrong with it."""

from __future__ import annotations

import json
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.attack.drawing import Json
from benchmarks.attack.oracle import TOLERANCE, Ground
from benchmarks.attack.search import Climber, Reached

LOW = 0.01
"""An answer that is beaten by more than this share is low."""
PROGRAMS = 120
"""Linear programs that the search for a better motion may use."""
CHECK_SECONDS, BOXES, QUESTIONS = 1.5, 20_000, 12
"""After so long `check` is asked to stop; so many boxes and questions it may use."""
STUDIES = ("sweep", "gap", "sample", "rank", "tighten")
"""Kinds of what is wrong with a study."""
UNLIMITED = 4.5
"""Motions are compared up to this multiple of the size."""


@dataclass
class Finding:
    """What became of one assembly.

    Parameters
    ----------
    family, number
        What was drawn.
    verdict, path, value
        What `flex` said; "refused" where it took the file for wrong, "crash" or "hang" where it gave no answer at all.
    check : str
        What `check` said.
    seconds : float
        Processor time of `flex`.
    wrong : list of str
        What does not hold, one line each; every line begins with its kind.
    """

    family: str
    number: int
    verdict: str = ""
    path: str = ""
    value: float | None = None
    check: str = ""
    seconds: float = 0.0
    wrong: list[str] = field(default_factory=list)
    better: list[list[list[float]]] | None = None

    def line(self) -> str:
        """One line of the campaign's log."""
        return json.dumps({k: v for k, v in asdict(self).items() if k != "better"})


def ask(family: str, number: int, made: Json, programs: int = PROGRAMS) -> Finding:
    """Ask `flex` and `check` about an assembly, and judge what they say; without linear programs, the way of `flex` alone."""
    import wiggleroom as wr

    out = Finding(family, number)
    ground = Ground(made)
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / f"{family}_{number}.json"
        file.write_text(json.dumps(made), encoding="utf-8")
        assembly = wr.read(str(file))
        answer = answered(lambda: wr.flex(assembly), out)
        if answer is None:
            return out
        _judge_motion(ground, answer, out)
        if programs:
            _judge_value(ground, answer, number, programs, out)
            _judge_check(ground, wr, assembly, answer, out)
    return out


def answered(question: Callable[[], Any], out: Finding) -> Any:
    """The answer of a question, noted; None, and that it was refused, where there is none."""
    from wiggleroom.errors import InputError

    began = time.process_time()
    try:
        answer = question()
    except InputError as error:
        out.verdict = "refused"
        out.wrong.append(f"refused: {error}")
        return None
    out.seconds = round(time.process_time() - began, 3)
    out.verdict, out.path, out.value = str(answer.verdict), answer.path, answer.objective
    return answer


def judge_begin(path: np.ndarray, fixed: np.ndarray | list[int], out: Finding) -> None:
    """Note a path that does not begin at rest, or moves what is fixed."""
    if np.abs(path[0]).max() > 0 or np.abs(path[:, fixed]).max(initial=0.0) > 0:
        out.wrong.append("path: it does not begin at rest, or moves what is fixed")


def _judge_motion(ground: Ground, answer, out: Finding) -> None:
    path = answer.waypoints
    judge_begin(path, ground.fixed, out)
    if not np.array_equal(path[-1], answer.motion):
        out.wrong.append("path: it does not end at the motion")
    found = ground.overlap(answer.motion)
    if found is not None:
        out.wrong.append(f"end: {found}")
    if answer.path == "checked":
        found = ground.overlap_on(path)
        if found is not None:
            out.wrong.append(f"path: {found}")
    else:
        out.wrong.append("unchecked: the way is not checked")
    if answer.objective is not None:
        value = ground.value(answer.motion)
        if abs(value - answer.objective) > 1e-9 * ground.size + 1e-9 * abs(value):
            out.wrong.append(f"value: {answer.objective!r} is said, the motion is worth {value!r}")


def _judge_value(ground: Ground, answer, number: int, programs: int, out: Finding) -> None:
    if answer.verdict == "unbounded":
        return
    value = answer.objective
    most = UNLIMITED * ground.size
    least = 1e-6 * ground.size
    climber = Climber(ground, number, programs)
    best: Reached = climber.search(most)
    bound = answer.at_most
    if bound is not None and best.value > bound * (1 + 1e-6) + least:
        _confirm(ground, best, out, f"bound: at most {bound:.9g} is said, {best.value:.9g} is reached")
    if best.value > value * (1 + LOW) + least:
        kind = (
            "low-proven"
            if answer.verdict == "proven"
            else "low"
            if answer.verdict == "optimal"
            else "low-" + str(answer.verdict)
        )
        _confirm(ground, best, out, f"{kind}: {value:.9g} is said, {best.value:.9g} is reached")


def _confirm(ground: Ground, best: Reached, out: Finding, said: str) -> None:
    """Say it where the better path holds when it is looked at once more, as a whole."""
    path = np.array(best.path)
    if ground.overlap_on(path) is None:
        out.wrong.append(said)
        out.better = path.tolist()


def _judge_check(ground: Ground, wr, assembly, answer, out: Finding) -> None:
    stop = threading.Event()
    clock = threading.Timer(CHECK_SECONDS, stop.set)
    clock.start()
    try:
        found = wr.check(assembly, stop=stop, boxes=BOXES, questions=QUESTIONS)
    except wr.InputError as error:
        out.check = "refused"
        out.wrong.append(f"refused by check: {error}")
        return
    finally:
        clock.cancel()
    out.check = f"{found.verdict}, {found.certainty}"
    gone: set[str] = set()
    for escape in found.escapes:
        overlap = ground.overlap_on(np.asarray(escape.path), without=gone)
        gone |= set(escape.parts)  # out of the game
        if overlap is not None:
            out.wrong.append(f"escape of {', '.join(escape.parts)}: {overlap}")
    if found.verdict == "interlocked" and found.certainty == "proven" and answer.leaves:
        out.wrong.append(f"check: interlocked is said to be proven, and flex lets {', '.join(answer.leaves)} leave")


def severe(finding: Finding) -> bool:
    """True where the program said something that is wrong, or nothing at all."""
    kinds = ("path", "end", "escape", "value", "bound", "check:", "crash", "hang", "low-proven", *STUDIES)
    return any(line.startswith(kinds) for line in finding.wrong)


__all__ = ["TOLERANCE", "Finding", "ask", "severe"]
