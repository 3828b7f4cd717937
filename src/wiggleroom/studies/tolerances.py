"""Worst case within tolerances: the question."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from wiggleroom.context import Context
from wiggleroom.errors import Stop
from wiggleroom.studies.question import Option, Question

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.drawing.model import Goal, Tolerance
    from wiggleroom.search.progress import Progress
    from wiggleroom.sensitivity.worst_case import WorstCase


def worst_case(
    assembly: Assembly,
    tolerances: Sequence[Tolerance] | None = None,
    goals: Goal | Sequence[Goal] | None = None,
    *,
    limit: float | None = None,
    workers: int | None = None,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> WorstCase:
    """Largest and smallest motion within tolerances, each solved at its corner, and the contribution of every tolerance.

    Parameters
    ----------
    assembly : Assembly
    tolerances : sequence of Tolerance, optional
        By default those of the assembly's file.
    goals : Pull, Turn and others, or several that add up
        By default the question of the assembly's file.
    limit : float, optional
        Largest acceptable motion.
    workers, stop, progress : optional
        As for `rank`; the processes solve for single outlines.

    Raises
    ------
    InputError
        If there are no tolerances, a name is unknown, parts do not fit even at their nominal sizes, or nothing stops
        the motion there.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> chain = wr.patterns.chain(2, joint="tee", gap=0.02)
    >>> found = wr.worst_case(chain, [wr.Tolerance(("b2",), plus=0.002, minus=0.002)])
    >>> found.tightest.objective < found.nominal.objective < found.loosest.objective
    True
    """
    from wiggleroom.sensitivity.worst_case import worst_case as work_out
    from wiggleroom.studies.gap_study_of import gap_study_of

    study = gap_study_of(assembly, goals)
    return work_out(study, tolerances, limit=limit, context=Context(workers=workers, stop=stop, progress=progress))


@dataclass(frozen=True, kw_only=True)
class TolerancesQuestion(Question):
    """Find the worst and the best case within tolerances, and the contribution of each tolerance.

    A tolerance limits the deviation of the outlines of a part (in space the cut edges of a plate, all faces of another
    solid), of one outline, of the thickness of a plate, or of the gap of a joint. In the worst case everything is as
    loose as allowed; the motion is solved there. --csv lists the contributors.

    Example: wiggleroom tolerances box.svg --gap 0.2 --fix box --pull lid:+x --tolerances sheet.csv --limit 0.5
        --csv contributors.csv

    Parameters
    ----------
    tolerances
        Table with the columns part, other, outline (a number, or thickness), nominal, plus, minus [mm]: .csv. Replaces
        the file's.
    limit
        Largest acceptable motion [mm, turns in rad].
    """

    name: ClassVar[str] = "tolerances"
    tolerances: Path | None = None
    limit: Annotated[float | None, Option(title="good up to", unit="mm")] = None

    def ask(self, about: Any, context: Context) -> WorstCase:
        """Solve the corners of the tolerances."""
        if self.tolerances is not None:
            from wiggleroom.drawing.readers.tolerances import read_tolerances

            table = read_tolerances(self.tolerances)
            about = replace(about, drawing=replace(about.drawing, tolerances=table))
        return worst_case(about, limit=self.limit, stop=context.stop, progress=context.progress)
