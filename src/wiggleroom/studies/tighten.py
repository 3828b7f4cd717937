"""Which parts to make tighter: the question."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from wiggleroom.context import Context
from wiggleroom.errors import InputError, Stop
from wiggleroom.studies.question import Option, Question

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.drawing.model import Goal
    from wiggleroom.search.answer import Answer
    from wiggleroom.sensitivity.tighten import Tightening


def tighten(
    assembly: Assembly | Answer,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    parts: int | None = None,
    limit: float | None = None,
    gap: float | None = None,
    draws: int = 50,
    seed: int = 0,
    workers: int | None = None,
    cluster: str | None = None,
    stop: Stop | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Tightening:
    """Choose the parts to make tighter for the least motion, or the fewest that keep it below a limit.

    A tightened part is made larger. Each part contributes half of every joint's gap, and a tightened part grows evenly
    until its half is that of a joint with the gap `gap`. A joint with a larger gap of its own keeps the difference, one
    with a smaller gap limits both its parts. Parts are chosen by rank, some at a time, and ranked again as the others
    tighten. Random choices of as many parts are tried as well, all of them if there are no more than `draws`. The best
    choice is taken, with its origin in `Tightening.chosen_by`. Unless all were tried, it is not provably the best.

    Parameters
    ----------
    assembly : Assembly or Answer
        An answer is used as it is; otherwise the motion is computed first.
    goals : Pull, Turn and others, or several that add up
        By default the question of the assembly's file.
    parts : int
        Number of parts to choose. Or:
    limit : float [mm]
        Choose the fewest parts that bring the motion down to this.
    gap : float, optional [mm]
        Gap that a tightened part aims at; by default a tenth of the gap. The paper (section 6.2) does not state its
        value.
    draws : int
        Number of random choices.
    seed : int
    workers : int, optional
        Processes on this machine; by default one for each processor.
    cluster : str, optional
        Address of a Dask scheduler, tcp://host:port, that takes the work (extra `cluster`).
    stop, progress : optional
        Anything with `is_set()`; called with the numbers of finished and of all choices.

    Returns
    -------
    Tightening

    Raises
    ------
    InputError
        If neither or both of `parts` and `limit` are given, or a number makes no sense, or nothing stops the motion.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> better = wr.tighten(wr.patterns.chain(5, joint="tee", gap=0.01), parts=2, draws=5)
    >>> better.chosen, round(better.lowered)
    (('b2', 'b3'), 55)
    """
    from wiggleroom.sensitivity.tighten import tighten as work_out
    from wiggleroom.studies.gap_study_of import gap_study_of

    context = Context(workers=workers, cluster=cluster, stop=stop, counted=progress)
    study = gap_study_of(assembly, goals)
    return work_out(study, parts=parts, limit=limit, gap=gap, draws=draws, seed=seed, context=context)


@dataclass(frozen=True, kw_only=True)
class TightenQuestion(Question):
    """Choose the parts to make tighter for the least motion, or the fewest that keep it below a limit.

    Example: wiggleroom tighten frame.json --parts 11 --picture tighter.svg

    Parameters
    ----------
    parts
        Number of parts to choose.
    limit
        Or choose the fewest parts that keep the motion below this [mm, turns in rad].
    to
        Gap that a tightened part aims at [mm]: it grows until its half of the gap is half of this. Default: a tenth of
        the gap. Joints with a larger gap of their own keep the difference.
    draws
        Number of random choices for comparison.
    seed
        The same seed gives the same random choices.
    """

    name: ClassVar[str] = "tighten"
    heading: ClassVar[str] = "Which parts should be tighter?"
    button: ClassVar[str] = "Find them"
    counts: ClassVar[str] = "choices at random"
    parallel: ClassVar[bool] = True

    parts: Annotated[int | None, Option(title="how many", least=1, suggested=3, of_parts=True)] = None
    limit: Annotated[float | None, Option(title="or as few as keep", unit="mm")] = None
    to: Annotated[float | None, Option(title="down to a gap of", unit="mm", least=0)] = None
    draws: Annotated[int, Option(title="choices at random", least=0, suggested=0)] = 50
    seed: int = 0

    def check(self, dimension: int) -> None:  # noqa: ARG002
        """Check the numbers of choices."""
        if self.draws < 0 or self.seed < 0:
            wrong = f"--draws {self.draws} --seed {self.seed}: both must be 0 or more"
            raise InputError(wrong)

    def ask(self, about: Any, context: Context) -> Tightening:
        """Choose the parts."""
        found = tighten(
            about, parts=self.parts, limit=self.limit, gap=self.to, draws=self.draws, seed=self.seed,
            workers=context.workers, cluster=context.cluster, stop=context.stop, progress=context.counted,
        )  # fmt: skip
        return replace(found, stopped=context.stopped)
