"""Cutting sheets as assemblies in space: the options that say so, and the assembly they make."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cyclopts import Group, Parameter

from wiggleroom.cli.options import Many
from wiggleroom.context import Context

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wiggleroom.drawing.strokes.read_options import ReadOptions
    from wiggleroom.errors import Stop
    from wiggleroom.mating.assembled_sheet import AssembledSheet
    from wiggleroom.mating.hints import Hints

SHEET = Group("Cutting sheet", sort_key=1)
PRESSES = 0.1
"""Plates that may overlap are put together where they fit with outlines further in by up to this share of their thickness."""


@Parameter(name="*", group=SHEET)
@dataclass(frozen=True, kw_only=True)
class SheetOptions:
    """What is known of a cutting sheet whose plates are put together in space.

    Parameters
    ----------
    thickness
        Thickness of the material for which joints are drawn [mm]. The drawing is then a cutting sheet of plates,
        assembled in space. NAME:2.8 gives the real thickness of one panel. May repeat.
    burn
        Enlargement of the drawn outlines [mm], half the width of the cut. Default: the value on the sheet; otherwise
        the least, up to 0.15, that lets plates of this thickness fit, with a note.
    relieve
        Largest distance by which outlines may move inward if plates do not fit as cut [mm]. Default: 0, which reports
        the plates too thick for their slots.
    hints
        A TOML file with hints about the plates: thickness, thicknesses, burn, groups, join, flush, plate, skip.
    """

    thickness: Many = ()
    burn: float | None = None
    relieve: float | None = None
    hints: Path | None = None

    @property
    def given(self) -> bool:
        """Whether a drawing is meant as a sheet of plates."""
        return bool(self.thickness) or self.hints is not None

    def check(self, file: str, *, in_plane: bool = False) -> None:
        """Check that the options go with the file; whether burn alone makes sense, as it does for a puzzle in the plane.

        Raises
        ------
        InputError
            Where a file is no drawing, or a number makes no sense.
        """
        from wiggleroom.errors import InputError

        if self.burn is not None and not 0 <= self.burn < math.inf:
            message = f"--burn {self.burn:g}: it must be 0 mm or more"
            raise InputError(message)
        if self.relieve is not None and not 0 <= self.relieve < math.inf:
            message = f"--relieve {self.relieve:g}: it must be 0 mm or more"
            raise InputError(message)
        for option, value in (("burn", None if in_plane else self.burn), ("relieve", self.relieve)):
            if value is not None and not self.given:
                message = f"--{option} goes with --thickness; give the thickness of the material of {file}, such as --thickness 3"
                raise InputError(message)
        if self.given and Path(file).suffix.lower() == ".json":
            message = "--thickness, --burn, --relieve and --hints are for drawings of cutting sheets"
            message += f"; {file} is an assembly: leave them out"
            raise InputError(message)

    def known(self, file: str) -> tuple[float | None, Hints]:
        """Thickness of the material [mm], and everything else that is known; the command line goes before the file of hints.

        Raises
        ------
        InputError
            With everything that is wrong, one line each.
        """
        from dataclasses import replace

        from wiggleroom.errors import InputError
        from wiggleroom.mating.hints import Hints, read_hints

        self.check(file)
        said = read_hints(self.hints) if self.hints else Hints()
        common, single = _thicknesses(self.thickness)
        said = replace(said, thicknesses=said.thicknesses | single)
        common = common if common is not None else said.thickness
        if common is None and self.given:
            message = f"{file}: the thickness of the material is not known; give it, such as --thickness 3"
            raise InputError(message)
        return common, said


def assembled_sheet(
    file: str,
    sheet: SheetOptions,
    *,
    unit: str | None,
    options: ReadOptions,
    stop: Stop | None = None,
    overlapping: bool = False,
) -> AssembledSheet:
    """Panels of a drawing put together in space; where they may overlap, as they are cut.

    Raises
    ------
    InputError
        With everything that is wrong with the drawing, the options or the hints.
    """
    from wiggleroom.mating.assembled_sheet import assemble_sheet
    from wiggleroom.mating.cutting_sheet import read_sheet

    thickness, hints = sheet.known(file)
    read = read_sheet(Path(file), unit=unit, options=options)
    thick = thickness or 0.0
    relieve = sheet.relieve or (PRESSES * thick if overlapping else 0.0)
    found = assemble_sheet(read, thick, burn=sheet.burn, relieve=relieve, hints=hints, context=Context(stop=stop))
    return found.as_cut if overlapping and sheet.relieve is None else found


def sure_text(file: str, found: AssembledSheet) -> str:
    """Text of the assembly file of a sheet of which it is sure where panels belong.

    Raises
    ------
    UnsureError
        With what is not sure, one line each, and what to do.
    """
    from wiggleroom.errors import UnsureError
    from wiggleroom.mating.plates_writer import write_plates

    if found.doubts:
        advice = (
            f"look at it with wiggleroom assemble --picture, then say in a file for --hints {_missing_hint(found)},"
        )
        advice += " or ask the assembly file that assemble writes"
        raise UnsureError(
            [
                *(f"{file}: {doubt}" for doubt in found.doubts),
                f"{file}: how its panels go together is not sure: {advice}",
            ]
        )
    return write_plates(found)


def _missing_hint(found: AssembledSheet) -> str:
    """What a person could say of a sheet that is not sure."""
    names = [plate.name for plate in found.plates]
    if found.unplaced:
        return f'where {names[found.unplaced[0]]} belongs ([[plate]] with panel = "{names[found.unplaced[0]]}")'
    if found.joints:
        joint = found.joints[-1]
        a, b = (f"{names[row]}:{_side(found, row, joint.flanks[:, k])}" for k, row in enumerate(joint.panels))
        return f'which edges belong together (such as join = [["{a}", "{b}"]])'
    return "which panels make one body (groups)"


def _side(found: AssembledSheet, row: int, flanks: NDArray[np.int64]) -> str:
    """The side of a panel, as it lies on the sheet, to which some of its flanks are nearest."""
    plate = found.plates[row]
    left, bottom, right, top = plate.polygon.bounds
    x, y = plate.middle[flanks].mean(axis=0)
    return min(
        {"left": x - left, "right": right - x, "bottom": y - bottom, "top": top - y}.items(), key=lambda e: e[1]
    )[0]


def _thicknesses(said: tuple[str, ...]) -> tuple[float | None, dict[str, float]]:
    """Thickness of the material and of single panels [mm]."""
    from wiggleroom.errors import InputError

    common, single = None, {}
    for text in said:
        name, _, number = text.rpartition(":")
        try:
            size = float(number)
        except ValueError:
            size = 0.0
        if not 0 < size < 1e6:
            message = f"--thickness {text}: it must be a length in mm larger than 0, or NAME:2.8"
            raise InputError(message)
        if name:
            single[name] = size
        else:
            common = size
    return common, single
