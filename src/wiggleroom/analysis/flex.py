"""How far can it move: the question, and the answer put together from the search."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from wiggleroom.analysis.answer import Answer
from wiggleroom.analysis.finish import answer_of
from wiggleroom.analysis.prepare import Prepared, prepare
from wiggleroom.analysis.search import Found, Progress, Search
from wiggleroom.assembly.findings import role_findings
from wiggleroom.assembly.model import Assembly
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError
from wiggleroom.program.objectives import objective
from wiggleroom.solve import solver_named
from wiggleroom.solve.newton import Stop


def flex(
    assembly: Assembly | Prepared,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    solver: str = "interior-point",
    start: Answer | None = None,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Answer:
    """How far the assembly can move.

    Parameters
    ----------
    assembly : Assembly or Prepared
    goals : Pull, Turn or W, or several that add up
        By default what the assembly's file asks for.
    solver : str
        "interior-point", or "ipopt" (needs the extra `ipopt`).
    start : Answer, optional
        An earlier answer of the same prepared assembly; the search starts near its motion.
    stop : optional
        Anything with `is_set()`, for example a `threading.Event`; asked every iteration.
    progress : callable, optional
        Told a `Progress` every iteration.

    Returns
    -------
    Answer
        A motion without overlap, and how sure it is.

    Raises
    ------
    InputError
        If nothing is fixed or pulled, or a goal names an unknown part.
    TouchingError
        If two parts touch at rest.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> answer = wr.flex(wr.patterns.chain(2, joint="tee", gap=0.01))
    >>> round(answer.objective, 4)
    0.0261

    Source: Mind the Gap, section 4; walls instead of the hull, and the iterative re-approximation of its outlook.
    """
    began = time.perf_counter()
    tell = progress or _silent
    its = assembly if isinstance(assembly, Assembly) else assembly.assembly
    asked = its.goals if goals is None else tuple(goals) if isinstance(goals, Sequence) else (goals,)
    findings = role_findings(replace(its.drawing, goals=asked))
    if findings:
        raise InputError(findings)
    solve = solver_named(solver)
    tell(Progress("pairs"))
    ready = prepare(assembly) if isinstance(assembly, Assembly) else assembly
    search = Search(ready, objective(its, ready.bodies, asked), solve, stop, tell)
    search.seconds["freespace"] += time.perf_counter() - began
    if start is not None:
        search.resume(_trail(start, ready))
    search.run()
    return answer_of(search, asked, solver, began)


def _trail(start: Answer, ready: Prepared) -> Found:
    """How an earlier answer for the same prepared assembly was found."""
    if not isinstance(start.trail, Found) or start.trail.program.bodies is not ready.bodies:
        finding = "start: the earlier answer belongs to another prepared assembly; ask the same one, from prepare()"
        raise InputError(finding)
    return start.trail


def _silent(_: Progress) -> None:
    """Tell nobody."""
