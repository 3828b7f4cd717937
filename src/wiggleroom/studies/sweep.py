"""Motion against gap: the question."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from wiggleroom.context import Context
from wiggleroom.errors import InputError, Stop
from wiggleroom.studies.question import Question

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.drawing.model import Goal
    from wiggleroom.sensitivity.sweep import Sweep, SweepStep


def sweep(
    assembly: Assembly,
    gaps: Sequence[float] | None = None,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    prove: float | None = None,
    seconds: float | None = None,
    stop: Stop | None = None,
    progress: Callable[[int, int], None] | None = None,
    each: Callable[[SweepStep, NDArray[np.float64] | None], None] | None = None,
) -> Sweep:
    """Largest motion for several gaps, and the gap from which on nothing stops it.

    Every gap is searched like a single question. A motion free at one gap is free at every larger one, because all
    parts become smaller; a motion at a smaller gap therefore counts at larger ones, and the curve never falls. The
    smallest gap at which nothing stops the motion is bracketed as well.

    Parameters
    ----------
    assembly : Assembly
    gaps : sequence of float, optional [mm]
        Replaces the file's gap, in any order; by default nine from a quarter of it to twice it.
    goals : Pull, Turn and others, or several that add up
        By default the question of the assembly's file.
    prove : float, optional
        For drawings only: prove a bound for every gap, at most this share above the motion, for a band round the whole
        curve.
    seconds : float, optional
        Time limit for the proof of one gap; by default a fixed amount of work. Then the best bound so far is used.
    stop, progress : optional
        Anything with `is_set()`; called with the numbers of finished and of all gaps. Proofs count once more.
    each : callable, optional
        Called with the step of every gap and the motion of the parts there (n, 3) [mm, mm, rad], in space (n, 6), None
        if the motion is unbounded. The gap at which the motion becomes unbounded comes last, and may make larger gaps
        unbounded.

    Returns
    -------
    Sweep

    Raises
    ------
    InputError
        If a gap makes no sense, nothing is fixed or pulled, or the objective has no bound.
    MissingExtraError
        If `prove` needs the extra of that name.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = wr.sweep(wr.patterns.chain(2, joint="tee"), [0.01, 0.02])
    >>> [round(step.objective, 4) for step in found.steps]
    [0.0261, 0.0539]
    """
    from wiggleroom.sensitivity.sweep import sweep as work_out
    from wiggleroom.studies.gap_study_of import unchecked_study_of

    if assembly.dimension == 3:
        from wiggleroom.questions import refuse_planar_options

        refuse_planar_options("sweep", prove=prove, seconds=seconds)
    context = Context(stop=stop, counted=progress)
    return work_out(unchecked_study_of(assembly, goals), gaps, prove=prove, seconds=seconds, each=each, context=context)


@dataclass(frozen=True, kw_only=True)
class SweepQuestion(Question):
    """Find the motion for several gaps, and the gap from which on nothing stops it.

    Example: wiggleroom sweep puzzle.svg --gaps 0.1:1:10 --fix p1 --pull p20:+x --picture curve.svg

    Parameters
    ----------
    gaps
        Gaps in mm: a list 0.1,0.2,0.5, or first, last and number as 0.1:1:10. Default: nine, from a quarter of the gap
        to twice it.
    prove
        Prove at every gap that no motion exceeds the answer by more than this share, for a band round the curve; 0.01
        is one per cent. Needs the extra prove. The proof of a gap takes at most a fixed amount of work.
    """

    name: ClassVar[str] = "sweep"
    counts: ClassVar[str] = "gaps"

    gaps: str | None = None
    prove: float | None = None

    def check(self, dimension: int) -> None:
        """Check the list of gaps, and that what is to be proven can be."""
        if self.gaps is not None:
            gaps_of(self.gaps)
        if self.prove is None:
            return
        if dimension == 3:
            raise InputError("--prove is for drawings, not for assemblies in space: leave it out")
        from wiggleroom.bound.prove import check_request
        from wiggleroom.solve.dual_linear_program import need_highs

        check_request(self.prove, names=("--prove", "--time"))
        need_highs()

    def ask(self, about: Any, context: Context) -> Sweep:
        """Sweep the gaps."""
        gaps = None if self.gaps is None else gaps_of(self.gaps)
        found = sweep(about, gaps, prove=self.prove, stop=context.stop, progress=context.counted)
        return replace(found, stopped=context.stopped)


def gaps_of(text: str) -> list[float]:
    """Gaps from "0.1,0.2" or "0.1:1:10".

    Raises
    ------
    InputError
        If the text says neither.

    >>> gaps_of("0.1,0.2"), gaps_of("1:2:3")
    ([0.1, 0.2], [1.0, 1.5, 2.0])
    """
    try:
        if ":" in text:
            low, high, count = text.split(":")
            first, last, many = float(low), float(high), int(count)
            if many < 2 or not (math.isfinite(first) and math.isfinite(last)):
                raise ValueError
            return [first + (last - first) * k / (many - 1) for k in range(many)]
        return [float(piece) for piece in text.split(",")]
    except ValueError:
        wrong = f"--gaps {text}: write gaps in mm as 0.1,0.2,0.5, or from, to and how many as 0.1:1:10"
        raise InputError(wrong) from None
