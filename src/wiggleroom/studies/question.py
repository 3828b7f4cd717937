"""A question as commands and pages ask it, declared once: its options, its computation, and its finding."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wiggleroom.context import Context
    from wiggleroom.report.finding import Finding


@dataclass(frozen=True, kw_only=True)
class Option:
    """What a page shows of an option; one without is of commands alone.

    Parameters
    ----------
    title : str
        Before its box.
    unit : str
    least : float, optional
    suggested : float, optional
        In the box at first, in place of the default.
    of_gap : float, optional
        The same as a share of the gap.
    of_parts : bool
        Counts parts that can move: no more than these are suggested.
    """

    title: str
    unit: str = ""
    least: float | None = None
    suggested: float | None = None
    of_gap: float | None = None
    of_parts: bool = False


@dataclass(frozen=True, kw_only=True)
class Question:
    """Base of all questions: a subclass declares its options as fields.

    The docstring of the class is the help of the command; a type may be annotated with an `Option`. The module of a question imports
    nothing slow at its top: commands list their options, and the page its panels, before anything is worked out.
    """

    name: ClassVar[str]
    """Of the command, and of the page's request."""
    heading: ClassVar[str] = ""
    """Of the page's panel; without one, the page has a panel of its own for it or none."""
    button: ClassVar[str] = "Find out"
    shows: ClassVar[Literal["curve", "path", "end"]] = "curve"
    """What its files show: a curve or parts, paths and so films, or paths to an end whose outlines can be written too."""
    counts: ClassVar[str] = ""
    """What progress counts; empty where it tells the stages of a search."""
    signed: ClassVar[bool] = False
    """True where texts may begin with a minus, as directions do."""
    spatial: ClassVar[bool] = True
    """True where assemblies in space can be asked about."""
    parallel: ClassVar[bool] = False
    """True where the work may be shared among processes."""

    needs_end: ClassVar[bool] = True
    """True where the largest motion must end."""

    @property
    def asks_motion(self) -> bool:
        """True where something must be fixed and pulled."""
        return True

    @property
    def may_overlap(self) -> bool:
        """True where parts of a drawing may overlap as drawn."""
        return False

    def check(self, dimension: int) -> None:
        """Check the options before anything is read.

        Raises
        ------
        InputError
            With what is wrong, one line each.
        """

    def places(self) -> Mapping[str, tuple[Path | None, tuple[str, ...]]]:
        """Files that the options name, by option, and which endings they may have."""
        return {}

    def ask(self, about: Any, context: Context) -> Any:
        """Answer about an assembly, or where the largest motion is known about that answer."""
        raise NotImplementedError

    def timed(self, found: Any, read: float, total: float) -> Any:  # noqa: ARG002
        """What was found with the time [s] that reading took, and all together, where it tells them."""
        return found

    @classmethod
    def finding(cls, found: Any, command: str = "") -> Finding:
        """What was found, ready to be shown: by default as the module of the question's name in `report/findings` tells it."""
        told: Finding = import_module(f"wiggleroom.report.findings.{cls.name}").finding(found, command)
        return told

    @staticmethod
    def end(found: Any) -> NDArray[Any]:
        """Where the parts are at the end, of what shows an end."""
        raise NotImplementedError

    def notes(self, found: Any) -> list[str]:  # noqa: ARG002
        """What a reader of the command should know besides."""
        return []

    def write(self, found: Any, command: str) -> list[str]:  # noqa: ARG002
        """Write the files that the options name; a line for each."""
        return []
