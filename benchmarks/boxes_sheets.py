"""Sheets that generators of boxes.py draw, with the joints that the generators themselves ask for.

A sheet does not say which edge belongs to which, and neither does boxes.py. But its generators draw every row of fingers and of holes
by one call, and these calls are written down while it draws: where the row lies on the sheet, how long it is, and whether it is the
tabs or the notches. That is the truth that `joint_judge` uses; nothing of it comes from the outlines that the program reads.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class JointRow:
    """One row of fingers, or of the notches or holes for them.

    Parameters
    ----------
    tabs : bool
        Whether it is the tabs.
    ends : (2, 2) float64 [mm]
        On the sheet, in the middle of the depth of the joint.
    angle : float [degrees]
        For which the fingers are made: 90 for plates square to each other.
    depth : float [mm]
        How deep the joint is: that of one plate, or of several on each other.
    """

    tabs: bool
    ends: Floats
    angle: float
    depth: float = 3.0

    @property
    def length(self) -> float:
        """[mm]."""
        return float(np.hypot(*(self.ends[1] - self.ends[0])))


@dataclass(frozen=True, eq=False)
class DrawnSheet:
    """A sheet and the joints on it.

    Parameters
    ----------
    name : str
    path : Path
    rows : tuple of JointRow
    slots : (n, 2, 2) float64 [mm]
        Bottoms of the slots of cross laps, end to end.
    """

    name: str
    path: Path
    rows: tuple[JointRow, ...]
    slots: Floats


def generators() -> dict[str, type]:
    """Generators of boxes.py by name; boxes.py must be importable."""
    from boxes.generators import getAllBoxGenerators

    return {generator.__name__: generator for generator in getAllBoxGenerators().values()}


def draw(generator: type, folder: Path, arguments: tuple[str, ...] = ()) -> DrawnSheet:
    """One generator's sheet at default settings, 3 mm thick and with a burn of 0.1 mm, unless arguments say otherwise."""
    drawing = generator()
    with contextlib.redirect_stderr(io.StringIO()):
        drawing.parseArgs(["--format=svg", *arguments])
    drawing.open()
    with _recorded() as (rows, slots):
        drawing.render()
    surface = drawing.surface
    extents = surface.extents()
    corner = np.array([extents.xmin - 10.0, extents.ymin - 10.0])  # drawings are moved to 10 mm from the origin
    path = folder / f"{generator.__name__}.svg"
    path.write_bytes(drawing.close().getvalue())
    found = tuple(JointRow(tabs, ends - corner, angle, depth) for tabs, ends, angle, depth in rows)
    return DrawnSheet(generator.__name__, path, found, np.array([ends - corner for ends in slots]).reshape(-1, 2, 2))


@contextlib.contextmanager
def _recorded() -> Iterator[tuple[list[tuple[bool, Floats, float, float]], list[Floats]]]:
    """Lists that fill while a generator draws."""
    from boxes import edges

    rows: list[tuple[bool, Floats, float, float]] = []
    slots: list[Floats] = []
    draw_edge, draw_holes, draw_slot = edges.FingerJointEdge.__call__, edges.FingerHoles.__call__, edges.Slot.__call__

    def record(joint, begin: tuple[float, float], end: tuple[float, float], tabs: bool, bolts) -> None:
        matrix = joint.boxes.ctx._m
        fingers, leftover = joint.calcFingers(end[0] - begin[0], bolts)
        if fingers or leftover > 0.75 * joint.settings.thickness:
            ends = np.array([matrix * begin, matrix * end])
            rows.append((tabs, ends, float(joint.settings.angle), float(joint.settings.thickness)))

    def edge(self, length, bedBolts=None, bedBoltSettings=None, **more):
        first, second = self.fingerLength(self.settings.angle)
        middle = self.boxes.burn + (-0.5 if self.positive else 0.5) * (first - second)
        record(self, (0.0, middle), (length, middle), self.positive, bedBolts)
        return draw_edge(self, length, bedBolts, bedBoltSettings, **more)

    def holes(self, x, y, length, angle=90, bedBolts=None, bedBoltSettings=None):
        with self.boxes.saved_context():
            self.boxes.moveTo(x, y, angle)
            record(self, (0.0, 0.0), (length, 0.0), False, bedBolts)
        return draw_holes(self, x, y, length, angle, bedBolts, bedBoltSettings)

    def slot(self, length, **more):
        if self.depth:
            matrix, deep = self.boxes.ctx._m, self.boxes.burn + self.depth
            slots.append(np.array([matrix * (0.0, deep), matrix * (length, deep)]))
        return draw_slot(self, length, **more)

    edges.FingerJointEdge.__call__, edges.FingerHoles.__call__, edges.Slot.__call__ = edge, holes, slot
    try:
        yield rows, slots
    finally:
        edges.FingerJointEdge.__call__, edges.FingerHoles.__call__, edges.Slot.__call__ = (
            draw_edge, draw_holes, draw_slot,
        )  # fmt: skip
