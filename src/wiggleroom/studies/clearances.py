"""How far near parts are apart, or in each other: the question."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from wiggleroom.errors import InputError
from wiggleroom.studies.question import Option, Question

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.assembly.clearances import Clearances
    from wiggleroom.context import Context
    from wiggleroom.errors import Stop


def clearances(
    assembly: Assembly,
    within: float | None = None,
    xy: float | None = None,
    z: float | None = None,
    stop: Stop | None = None,
) -> Clearances:
    """The least gap of every near pair of parts, with its place and direction; negative where they overlap.

    Parameters
    ----------
    assembly : Assembly
        As made, gap applied; it may be read with `overlapping`.
    within : float, optional [mm]
        Pairs nearer than this. By default twice the gap, and no less than 2 % of the median part's size, `xy` and `z`.
    xy, z : float, optional [mm]
        In space: the least distance at one height, along the layers of a print, and above each other, across them.
    stop : optional
        Anything with `is_set()`.

    Returns
    -------
    Clearances

    Raises
    ------
    InputError
        If a number makes no sense.
    StoppedError
        If it was asked to stop.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = wr.clearances(wr.patterns.chain(2, joint="tee", gap=0.02))
    >>> found.gap.round(9).tolist(), round(found.offset, 9)
    ([0.02], 0.01)
    """
    ClearancesQuestion(within=within, xy=xy, z=z).check(assembly.dimension)
    if assembly.dimension == 3:
        from wiggleroom.spatial.solid_clearances import solid_clearances

        return solid_clearances(assembly, within, xy, z, stop)
    from wiggleroom.assembly.outline_clearances import outline_clearances

    return outline_clearances(assembly, within, stop)


@dataclass(frozen=True, kw_only=True)
class ClearancesQuestion(Question):
    """Measure how near parts are to each other, or how deep they overlap, and where.

    Parts may overlap as drawn; the gap of an overlapping pair is negative. The answer includes the offset of all
    outlines at which all parts fit, as a width of cut. Exit code: 0, also if parts do not fit or are too near.

    Example: wiggleroom clearances box.svg --gap 0

    Example: wiggleroom clearances hinge.json --xy 0.3 --z 0.4 --csv gaps.csv

    Parameters
    ----------
    within
        Pairs nearer than this [mm]. By default twice the gap, and no less than 2 % of the median part's size, --xy and --z.
    xy
        In space: the least distance that a printer keeps open along its layers [mm], between points at one height.
    z
        In space: the same across its layers [mm], between points above each other.
    """

    name: ClassVar[str] = "clearances"
    heading: ClassVar[str] = "How near are the parts?"
    button: ClassVar[str] = "Measure"
    needs_end: ClassVar[bool] = False

    within: Annotated[float | None, Option(title="nearer than", unit="mm", least=0)] = None
    xy: Annotated[float | None, Option(title="print in place: along layers", unit="mm", least=0)] = None
    z: Annotated[float | None, Option(title="across layers", unit="mm", least=0)] = None

    @property
    def asks_motion(self) -> bool:
        """Never."""
        return False

    @property
    def may_overlap(self) -> bool:
        """Always."""
        return True

    def check(self, dimension: int) -> None:
        """Check the distances."""
        wrong = [
            f"--{name} {value:g}: it must be a length in mm, 0 or more"
            for name, value in (("within", self.within), ("xy", self.xy), ("z", self.z))
            if value is not None and not 0 <= value < math.inf
        ]
        if dimension == 2 and not (self.xy is None and self.z is None):
            wrong.append("--xy and --z are for assemblies in space; --within is for drawings too")
        if wrong:
            raise InputError(wrong)

    def ask(self, about: Any, context: Context) -> Clearances:
        """Measure the gaps."""
        return clearances(about, self.within, self.xy, self.z, context.stop)
