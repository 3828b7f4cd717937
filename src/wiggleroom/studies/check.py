"""Whether it comes apart: the question."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from wiggleroom.studies.question import Question

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wiggleroom.context import Context
    from wiggleroom.report.results.separability import Checked


@dataclass(frozen=True, kw_only=True)
class CheckQuestion(Question):
    """Check whether an assembly comes apart: whether some parts can move without limit away from the others.

    Reports the parts that leave, alone or together, their order and their paths, every step checked for overlap; or
    that the parts interlock, proven or searched. Fixed parts stand; if none is fixed, the largest part stands. Turning
    in place is not coming apart. Exit code: 0 interlocked, 1 comes apart, 3 unknown.

    Example: wiggleroom check puzzle.svg --gap 0.2 --picture apart.gif

    Parameters
    ----------
    largest_gap
        Also find the gap at which it comes apart, to 0.1 %, with a verified state on both sides; wiggleroom gap --holds
        does only that.
    """

    name: ClassVar[str] = "check"
    shows: ClassVar[Literal["curve", "path", "end"]] = "end"

    largest_gap: bool = False

    @property
    def asks_motion(self) -> bool:
        """False: nothing need be fixed or pulled."""
        return False

    def ask(self, about: Any, context: Context) -> Checked:
        """Look for paths out, and for the border where that is wanted."""
        from wiggleroom.questions import check, largest_gap
        from wiggleroom.report.results.separability import Checked

        found = check(about, stop=context.stop, progress=context.progress)
        if not self.largest_gap:
            return Checked(found)
        return Checked(found, largest_gap(about, stop=context.stop, progress=context.progress))

    @staticmethod
    def end(found: Checked) -> NDArray[Any]:
        """Where the paths out have taken the parts."""
        from wiggleroom.report.results.separability import as_answer

        return as_answer(found.found).motion
