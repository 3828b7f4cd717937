"""Table 3: which methods see whether an assembly comes apart, on assemblies of which it is known.

Where a method answers by pulling, every part is pulled in a fan of directions and turned both ways until one of the questions has no end.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from itertools import product

import numpy as np

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.bench.published import INTERLOCK
from wiggleroom.bench.puzzles import APART, LOCKED, PUZZLES
from wiggleroom.bench.result import Bench, Column, Record, ResultTable
from wiggleroom.context import Context
from wiggleroom.disassembly.interlock import interlock
from wiggleroom.disassembly.translation import translation_escape
from wiggleroom.drawing.model import Goal, Pull, Turn
from wiggleroom.errors import InputError, Stop
from wiggleroom.form_closure.blocking_graph import blocking
from wiggleroom.form_closure.mobility import tight_verdict
from wiggleroom.freespace.models.pair_models import HalfPlane, Hull, PairModel, Walls
from wiggleroom.geometry.rigid_motions import of_bodies
from wiggleroom.maximise import ApproximateModel, PreparedModel, prepare
from wiggleroom.search.answer import Answer
from wiggleroom.verdict import Verdict

SHORT = {LOCKED: "locked", APART: "apart"}
PULL_FAN = 8
"""Directions in which every part is pulled."""

Method = Callable[[Assembly, Stop | None], str]
"""Says "locked", "comes apart", or in a word why neither."""


def by_pulls(*models: PairModel) -> Method:
    """Method that asks `flex` with pair models, one after the other."""

    def ask(assembly: Assembly, stop: Stop | None) -> str:
        for ready, goal in product([prepare(assembly, model) for model in models], list(_goals(assembly))):
            if stop is not None and stop.is_set():
                return "interrupted"
            answer = ready.flex(goal, stop=stop)
            if (answer.verdict is Verdict.UNBOUNDED and answer.leaves) or _gets_out(ready, answer):
                return APART
        return LOCKED

    return ask


def by_check(assembly: Assembly, stop: Stop | None) -> str:
    """Method that asks `check`; the first parts that leave are enough."""
    return {"interlocked": LOCKED, "comes apart": APART, "unknown": "unknown"}[
        interlock(assembly, every=False, context=Context(stop=stop)).verdict
    ]


def by_first_order(assembly: Assembly, _: Stop | None) -> str:
    """Method that asks for motions that keep all contacts of the parts as drawn, without gap, to first order."""
    return LOCKED if tight_verdict(assembly).verdict == "locked" else APART


def by_blocking_graphs(assembly: Assembly, _: Stop | None) -> str:
    """Method that asks directional blocking graphs of the parts as drawn, without gap; a key that can leave lets the others go."""
    return LOCKED if blocking(assembly).verdict == "locked" else APART


METHODS: dict[str, Method] = {
    "check": by_check,
    "walls": by_pulls(Walls()),
    "hull": by_pulls(Hull("reference"), Hull("joint")),
    "hull, 8 rounds": by_pulls(Hull("reference"), Hull("joint", rounds=8)),
    "half-planes": by_pulls(HalfPlane()),
    "first order": by_first_order,
    "blocking graphs": by_blocking_graphs,
}
"""Registry: every method that is asked."""


def interlock_table(*, stop: Stop | None = None, progress: Callable[[int, int], None] | None = None) -> Bench:
    """Ask every method about every assembly, and compare with the truth.

    Parameters
    ----------
    stop, progress : optional
        Asked all the time; told how many questions are done, and how many there are.

    Source: Mind the Gap, Table 3 and Fig. 10.
    """
    found: list[Record] = []
    for k, puzzle in enumerate(PUZZLES):
        assembly = puzzle.assembly()
        for i, (name, method) in enumerate(METHODS.items()):
            if stop is not None and stop.is_set():
                break
            if progress is not None:
                progress(k * len(METHODS) + i, len(PUZZLES) * len(METHODS))
            began = time.perf_counter()
            try:
                says = method(assembly, stop)
            except InputError as error:
                says = f"refused: {error.findings[0]}"
            seconds = time.perf_counter() - began
            found.append(
                {"assembly": puzzle.name, "truth": puzzle.truth, "why": puzzle.why, "gap_mm": assembly.drawing.gap, "method": name,
                 "says": says, "right": says == puzzle.truth, "seconds": seconds, "published": False}
            )  # fmt: skip
    notes = (
        "A cross: it says the opposite. Spinning in place is not coming apart. Check: `wiggleroom check`. Walls, hull and "
        f"half-planes: every part pulled in {PULL_FAN} directions and turned both ways, until a part leaves: walls say so; the "
        "others keep everything within a window, so parts count as out where, from the end of their motion, they leave straight. "
        "Hull: about the reference point, then about the joint; the latter in one round as in the paper, and in eight, "
        "its outlook.",
        "First order, blocking graphs: tests of parts as drawn tight, without gap. They ask whether parts can begin to "
        "move; what can, counts as coming apart.",
        "† Published in Mind the Gap, Table 3: what each kind of method can do; ours stands for PuzzleFlex and "
        "its own.",
    )
    cut = stop is not None and stop.is_set()
    return Bench(
        "interlock",
        "Does it come apart: methods against the truth",
        tuple(found),
        _sheets(found),
        notes,
        "wiggleroom bench interlock",
        cut,
    )


def _gets_out(ready: PreparedModel | ApproximateModel, answer: Answer) -> bool:
    """Whether parts leave straight from where a model that knows no motion without end has moved them to."""
    if answer.model == "walls":
        return False
    them = ready.bodies
    motion = of_bodies(answer.assembly, them, answer.motion[None])[0]
    ground = int(np.flatnonzero(them.fixed)[0])
    return translation_escape(ready, motion, ground, np.arange(len(motion))) is not None


def _goals(assembly: Assembly) -> Iterator[Goal]:
    """Pulls and turns of every part that is not fixed."""
    angles = 2 * np.pi * np.arange(PULL_FAN) / PULL_FAN
    for part in assembly.parts:
        if part.fixed:
            continue
        for angle in angles.tolist():
            yield Pull(part.name, (float(np.cos(angle)), float(np.sin(angle))))
        for sense in ("ccw", "cw"):
            yield Turn(part.name, sense)


def _sheets(found: list[Record]) -> tuple[ResultTable, ...]:
    """Answers with a column for every method, how many are right, and the paper's table."""
    rows: dict[str, Record] = {}
    for r in found:
        truth = SHORT[r["truth"]]
        row = rows.setdefault(r["assembly"], {"assembly": r["assembly"], "truth": truth, "why": r["why"]})
        row[r["method"]] = "✓" if r["right"] else "✗" if r["says"] in SHORT else r["says"]
    asked = [name for name in METHODS if any(r["method"] == name for r in found)]
    mine = [[r for r in found if r["method"] == name] for name in asked]
    score: Record = {"assembly": "right", "truth": f"of {len(rows)}"}
    score |= {name: str(sum(r["right"] for r in some)) for name, some in zip(asked, mine, strict=True)}
    spent: Record = {"assembly": "seconds", "truth": "in all"}
    spent |= {name: f"{sum(r['seconds'] for r in some):.1f}" for name, some in zip(asked, mine, strict=True)}
    columns = (
        Column("assembly", "assembly"),
        Column("truth", "truth"),
        Column("why", "why", wide=True),
        *[Column(m, m) for m in asked],
    )
    said = {True: "yes", False: "no"}
    theirs = tuple(
        {k: said[v] if isinstance(v, bool) else v for k, v in r.items()} | {"published": True} for r in INTERLOCK
    )
    names = ("blocking graphs", "infinitesimal", "ours")
    return (
        ResultTable("", columns, (*rows.values(), score, spent)),
        ResultTable("Mind the Gap, Table 3 †", (Column("property", "method"), *[Column(n, n) for n in names]), theirs),
    )
