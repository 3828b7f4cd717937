"""Whose gap matters: the question."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from wiggleroom.context import Context
from wiggleroom.errors import Stop
from wiggleroom.studies.question import Question

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.drawing.model import Goal
    from wiggleroom.search.answer import Answer
    from wiggleroom.search.prepare import Prepared
    from wiggleroom.sensitivity.rank import Ranking


def rank(
    question: Assembly | Prepared | Answer,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    by: str = "duals",
    exact: bool = False,
    workers: int | None = None,
    cluster: str | None = None,
    stop: Stop | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Ranking:
    """Rank the gap of every part, and of every joint, by its effect on the largest motion.

    Parameters
    ----------
    question : Assembly, Prepared or Answer
        An answer is ranked as it is; otherwise the motion is computed first.
    goals : Pull, Turn and others, or several that add up
        By default the question of the assembly's file.
    by : str
        "duals": all parts from the multipliers of one solve. "differences": one solve per part with a gap a thousandth
        larger, and one smaller, as in the paper.
    exact : bool
        Solve again for the parts whose derivative is not unique.
    workers : int, optional
        Processes on this machine; by default one for each processor.
    cluster : str, optional
        Address of a Dask scheduler, tcp://host:port, that takes the work (extra `cluster`).
    stop, progress : optional
        Anything with `is_set()`; called with the numbers of finished and of all differences.

    Returns
    -------
    Ranking

    Raises
    ------
    InputError
        If nothing stops the motion or the search for it was cut short.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> ranking = wr.rank(wr.patterns.chain(5, joint="tee", gap=0.01))
    >>> [ranking.answer.assembly.names[k] for k in ranking.order]
    ['b2', 'b3', 'b1', 'b4', 'b5']
    """
    from wiggleroom.sensitivity.rank import rank as work_out
    from wiggleroom.studies.gap_study_of import gap_study_of

    context = Context(workers=workers, cluster=cluster, stop=stop, counted=progress)
    return work_out(gap_study_of(question, goals), by=by, exact=exact, context=context)


@dataclass(frozen=True, kw_only=True)
class RankQuestion(Question):
    """Rank the gaps of parts and of joints by their effect on the motion.

    Importance is mm of motion per mm of extra gap round one part, whose outline alone moves inward by half of it.

    Example: wiggleroom rank puzzle.svg --gap 0.2 --fix p1 --pull p20:+x --picture blame.svg

    Parameters
    ----------
    by
        duals: all parts from the forces of one solve. differences: one more solve for every part, as a check.
    exact
        Solve again for the parts whose importance is not unique.
    """

    name: ClassVar[str] = "rank"
    counts: ClassVar[str] = "differences"
    parallel: ClassVar[bool] = True

    by: Literal["duals", "differences"] = "duals"
    exact: bool = False

    def ask(self, about: Any, context: Context) -> Ranking:
        """Rank the gaps."""
        return rank(
            about, by=self.by, exact=self.exact, workers=context.workers, cluster=context.cluster,
            stop=context.stop, progress=context.counted,
        )  # fmt: skip
