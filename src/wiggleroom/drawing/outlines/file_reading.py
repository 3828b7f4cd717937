"""What reading a file gives: a drawing, and what is wrong with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wiggleroom.drawing.model import Drawing
from wiggleroom.errors import InputError

if TYPE_CHECKING:
    from wiggleroom.drawing.outlines.traced_outlines import Remark


@dataclass(frozen=True, eq=False)
class Reading:
    """How a file was read.

    Parameters
    ----------
    drawing : Drawing
        Its parts, as far as they were found, and notes.
    layers : tuple of str
        The layer of each part.
    findings : tuple of str
        What is wrong, one line each; a drawing with findings is not to be worked with.
    remarks : tuple of Remark
        Places of what is wrong, left out or assumed.
    """

    drawing: Drawing
    layers: tuple[str, ...] = ()
    findings: tuple[str, ...] = ()
    remarks: tuple[Remark, ...] = ()


def sound(reading: Reading) -> Drawing:
    """The drawing, where nothing is wrong with it.

    Raises
    ------
    InputError
        With one line per finding.
    """
    if reading.findings:
        raise InputError(reading.findings)
    return reading.drawing
