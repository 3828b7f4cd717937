"""Motion when gaps vary at random: the question."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from wiggleroom.context import Context
from wiggleroom.errors import InputError, Stop
from wiggleroom.studies.question import Option, Question

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.drawing.model import Goal
    from wiggleroom.search.answer import Answer
    from wiggleroom.sensitivity.gap_distribution import Spread
    from wiggleroom.sensitivity.sample import Sample


def sample(
    assembly: Assembly | Answer,
    spread: Spread | float,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    draws: int = 1000,
    seed: int = 0,
    limit: float | None = None,
    workers: int | None = None,
    cluster: str | None = None,
    stop: Stop | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Sample:
    """Largest motion when the gap round every part varies at random.

    Parameters
    ----------
    assembly : Assembly or Answer
        An answer is used as it is; otherwise the motion is computed first.
    spread : Spread or float [mm]
        Distribution of the extra gap round a part; a number is the standard deviation of a normal distribution. Extra
        gap e moves the part's boundary inward by e/2, in space all its faces.
    goals : Pull, Turn and others, or several that add up
        By default the question of the assembly's file.
    draws, seed : int
        The same seed gives the same draws.
    limit : float, optional
        Largest motion of a good assembly.
    workers : int, optional
        Processes on this machine; by default one for each processor.
    cluster : str, optional
        Address of a Dask scheduler, tcp://host:port, that takes the work (extra `cluster`).
    stop, progress : optional
        Anything with `is_set()`; called with the numbers of finished and of all draws and searches.

    Returns
    -------
    Sample

    Raises
    ------
    InputError
        If numbers make no sense, or nothing stops the motion without variation.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> some = wr.sample(wr.patterns.chain(3, joint="tee", gap=0.02), 0.002, draws=20, limit=0.3)
    >>> some.good, some.misfits
    (20, 0)
    """
    from wiggleroom.sensitivity.sample import sample as work_out
    from wiggleroom.studies.gap_study_of import gap_study_of

    context = Context(workers=workers, cluster=cluster, stop=stop, counted=progress)
    return work_out(gap_study_of(assembly, goals), spread, draws=draws, seed=seed, limit=limit, context=context)


@dataclass(frozen=True, kw_only=True)
class SampleQuestion(Question):
    """Find the motion when the gap round every part varies at random.

    Reports mean, quantiles, worst case, the contribution of each part, and the share that keeps a limit.

    Example: wiggleroom sample puzzle.svg --gap 0.2 --fix p1 --pull p20:+x --spread 0.02 --limit 5
        --picture draws.svg

    Parameters
    ----------
    spread
        Variation of the gap round one part [mm]: the standard deviation; for uniform half of the range.
    kind
        Distribution: normal, uniform, or truncated (normal, cut at two standard deviations).
    sheet
        Correlation of all parts, as with a drifting kerf of a sheet: 0 independent, 1 all alike.
    bias
        Mean of the extra gap [mm].
    draws
        Number of random assemblies.
    seed
        The same seed gives the same draws.
    limit
        Largest motion of a good assembly [mm, turns in rad].
    """

    name: ClassVar[str] = "sample"
    heading: ClassVar[str] = "When gaps vary"
    button: ClassVar[str] = "Try random gaps"
    counts: ClassVar[str] = "draws"
    parallel: ClassVar[bool] = True

    spread: Annotated[float, Option(title="standard deviation", unit="mm", least=0, of_gap=0.05)]
    kind: Literal["normal", "uniform", "truncated"] = "normal"
    sheet: Annotated[float, Option(title="shared by the sheet", least=0)] = 0.0
    bias: Annotated[float, Option(title="mean", unit="mm")] = 0.0
    draws: Annotated[int, Option(title="tries", least=1, suggested=100)] = 1000
    seed: int = 0
    limit: Annotated[float | None, Option(title="good up to", unit="mm")] = None

    def check(self, dimension: int) -> None:  # noqa: ARG002
        """Check the distribution and the seed."""
        from wiggleroom.sensitivity.gap_distribution import Spread

        if self.seed < 0:
            wrong = f"--seed {self.seed}: it must be 0 or more"
            raise InputError(wrong)
        Spread(self.spread, self.kind, self.sheet, self.bias)

    def ask(self, about: Any, context: Context) -> Sample:
        """Draw assemblies and ask each."""
        from wiggleroom.sensitivity.gap_distribution import Spread

        return sample(
            about, Spread(self.spread, self.kind, self.sheet, self.bias), draws=self.draws, seed=self.seed,
            limit=self.limit, workers=context.workers, cluster=context.cluster, stop=context.stop,
            progress=context.counted,
        )  # fmt: skip
