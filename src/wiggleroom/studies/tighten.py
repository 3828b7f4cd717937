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
    """Which parts to make tighter for the least motion, or the fewest for a wanted limit.

    A tightened part is made larger: every joint's gap is half its own and half its neighbour's share, and its own share
    shrinks until `gap` would be left if the neighbour did the same. It grows alike everywhere: a joint with a larger gap of
    its own keeps what that is more, one with a smaller gap limits both its parts. Parts are chosen by their rank, some at a
    time, and ranked again as the others tighten. Choices of as many parts at random are tried beside that, all of them where they are no
    more than `draws`; the best choice that was seen is taken, and `Tightening.chosen_by` says where it comes from. Unless all were
    tried, it is a good one, not provably the best.

    Parameters
    ----------
    assembly : Assembly or Answer
        An answer is studied as it is; else the motion is looked for first.
    goals : Pull, Turn and others, or several that add up
        By default what the assembly's file asks for.
    parts : int
        How many to choose. Or:
    limit : float [mm]
        Choose as few as bring the motion down to this.
    gap : float, optional [mm]
        What a tightened part aims at; by default a tenth of the gap. The paper (section 6.2) does not say what it took.
    draws : int
        Choices at random.
    seed : int
    workers : int, optional
        Processes on this machine; by default one for each processor.
    cluster : str, optional
        Address of a Dask scheduler, tcp://host:port, that gets the work instead (extra `cluster`).
    stop, progress : optional
        Anything with `is_set()`; told how many choices are done, and how many there are.

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
    """Say which parts to make tighter for the least motion, or the fewest that keep it below a limit.

    Example: wiggleroom tighten frame.json --parts 11 --picture tighter.svg

    Parameters
    ----------
    parts
        How many parts to choose.
    limit
        Or: choose as few as keep the motion below this [mm, turns in rad].
    to
        Gap that a tightened part aims at [mm]: it is made larger until its own half of the gap is half of this. By
        default a tenth of the gap. Joints with a larger gap of their own keep what theirs is more.
    draws
        Choices at random to compare with.
    seed
        Same seed, same choices at random.
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
