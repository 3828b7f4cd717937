"""Read an assembly file: JSON with parts, gaps, glue and what is asked."""

from __future__ import annotations

import gc
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from wiggleroom.drawing.limits import LARGEST, SMALLEST
from wiggleroom.drawing.model import WHOLE, Drawing, Goal, JointGap, Part, Points, Pull, Region, Turn, W
from wiggleroom.drawing.outlines.naming import is_printable
from wiggleroom.drawing.outlines.rings import are_clean, clean_ring, extents
from wiggleroom.drawing.readers.assembly_schema import (
    FORMAT,
    FileEntry,
    GapEntry,
    OutlineEntry,
    PartEntry,
    Point,
    PullEntry,
    ShapeEntry,
    SoundFileEntry,
    convert,
)
from wiggleroom.drawing.readers.entry_reader import EntryReader, entry_of, name_of
from wiggleroom.drawing.readers.source import load
from wiggleroom.errors import InputError


def read_assembly(source: str | Path) -> Drawing:
    """Parts and questions of an assembly file.

    Parameters
    ----------
    source : str or Path
        Path of the file, or its text.

    Raises
    ------
    InputError
        With one line per finding, all of them at once.

    Examples
    --------
    >>> text = '{"format": "wiggleroom/1", "parts": [{"name": "a", "outline": [[0, 0], [2, 0], [2, 1]]}]}'
    >>> read_assembly(text).parts[0].name
    'a'
    """
    text = load(source, opening="{[", name="assembly")
    with _without_garbage_collection():
        return _PlanarReader(text.name, entry_of(text, FileEntry, SoundFileEntry)).drawing()


@contextmanager
def _without_garbage_collection() -> Iterator[None]:
    """Without garbage collection: reading makes millions of lists, none is garbage, and looking through them takes longer than reading."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


class _RawOutline(NamedTuple):
    """An outline as it was given, where it stands, which way it should run, and how much was found to be wrong before it."""

    ring: Points
    where: str
    label: str
    clockwise: bool
    findings: int


class _PlanarReader(EntryReader[FileEntry]):
    """Goes through one file and collects what is wrong with it."""

    def __init__(self, file: str, entry: FileEntry) -> None:
        super().__init__(file, entry)
        self._rings: list[_RawOutline] = []

    def drawing(self) -> Drawing:
        """Return the drawing, or raise an InputError with every finding."""
        entry = self._entry
        self._head()
        gap = self._length(entry.gap, "", "gap", least=0.0)
        shapes = {name: self._shape(name, value) for name, value in entry.shapes.items()}
        self._check_names()
        parts = [part for i, value in enumerate(entry.parts) if (part := self._part(i, value, shapes))]
        parts = self._with_clean_rings(parts)
        self._fixed = {part.name for part in parts if part.fixed}
        glue = tuple(self._together(f"glue[{i}]", value) for i, value in enumerate(entry.glue))
        ignore = tuple(self._pair(f"ignore[{i}]", value) for i, value in enumerate(entry.ignore))
        gaps = tuple(found for i, value in enumerate(entry.gaps) if (found := self._gap(i, value)))
        self._check_repeated(gaps)
        tolerances = self._tolerances()
        goals: tuple[Goal, ...] = tuple(goal for i, value in enumerate(entry.pull) if (goal := self._goal(i, value)))
        if entry.objective in WHOLE:
            goals = (WHOLE[entry.objective](),)
        if not self._findings:
            self._whole_size(parts)
        if self._findings:
            raise InputError(self._findings)
        return Drawing(tuple(parts), gap, glue, ignore, gaps, goals, self._file, tolerances=tolerances)

    def _head(self) -> None:
        entry = self._entry
        self._check_head(FORMAT)
        if entry.objective is not None and entry.objective not in WHOLE:
            known = " or ".join(f'"{name}"' for name in WHOLE)
            self._say("", f'objective is "{entry.objective[:40]}"; it must be {known}')
        if entry.objective is not None and entry.pull:
            self._say("", '"objective" stands in place of "pull"; leave one of them out')

    def _shape(self, name: str, value: Any) -> tuple[Region, ...]:
        where = f'shape "{name}"'
        entry = convert(value, ShapeEntry, f"{self._file}: {where}", self._findings)
        if entry is None:
            return ()
        if (entry.outline is None) == (entry.outlines is None):
            self._say(where, 'must have either "outline" or "outlines"')
            return ()
        return self._regions(where, entry)

    def _part(self, i: int, value: Any, shapes: dict[str, tuple[Region, ...]]) -> Part | None:
        named = name_of(value)
        where = f"parts[{i}]" if named is None else f'part "{named}"'
        entry = convert(value, PartEntry, f"{self._file}: {where}", self._findings)
        if entry is None:
            return None
        if not is_printable(entry.name):
            self._say(f"parts[{i}]", "name must be printable text that is not empty")
        material = [key for key in ("shape", "outline", "outlines") if getattr(entry, key) is not None]
        if len(material) != 1:
            has = " and ".join(f'"{key}"' for key in material) or "none of them"
            self._say(where, f'must have one of "shape", "outline" or "outlines"; it has {has}')
            return None
        if entry.shape is None:
            regions = self._regions(where, entry)
        elif entry.shape in shapes:
            regions = shapes[entry.shape]
        else:
            self._say(where, f'shape "{entry.shape}" is not among "shapes"; give it there')
            return None
        x, y = (self._length(number, where, "at") for number in entry.at[:2])
        return Part(
            name=entry.name,
            regions=regions,
            at=(x, y, math.radians(entry.at[2])),
            fixed=entry.fixed,
            offset=self._length(entry.offset, where, "offset"),
        )

    def _regions(self, where: str, entry: ShapeEntry | PartEntry) -> tuple[Region, ...]:
        if entry.outlines is not None:
            if not entry.outlines:
                self._say(where, '"outlines" is empty; at least one is needed')
            if entry.holes:
                self._say(where, '"holes" must stand in the entry of "outlines" that they belong to')
            pieces, labels = entry.outlines, [f"outlines[{i}]" for i in range(len(entry.outlines))]
        else:
            pieces, labels = [OutlineEntry(entry.outline or [], entry.holes)], ["outline"]
        return tuple(
            Region(
                self._ring(where, label, piece.outline),
                tuple(
                    self._ring(where, f"hole {i + 1} of {label}" if len(pieces) > 1 else f"hole {i + 1}", hole, True)
                    for i, hole in enumerate(piece.holes)
                ),
            )
            for piece, label in zip(pieces, labels, strict=True)
        )

    def _ring(self, where: str, label: str, corners: list[Point], clockwise: bool = False) -> Points:
        """An outline as it was given; all of them together are cleaned later."""
        ring = np.fromiter(chain.from_iterable(corners), dtype=float, count=2 * len(corners)).reshape(-1, 2)
        if self._mm != 1.0:
            ring *= self._mm
        self._rings.append(_RawOutline(ring, where, label, clockwise, len(self._findings)))
        return ring

    def _with_clean_rings(self, parts: list[Part]) -> list[Part]:
        """The parts with outlines that are clean; what is wrong with one is said where it stands in the file."""
        given = self._rings
        clean = are_clean([one.ring for one in given], np.array([one.clockwise for one in given], dtype=bool), LARGEST)
        if clean.all():
            return parts
        said, self._findings, done = self._findings, [], 0
        made: dict[int, Points] = {}
        for k in np.flatnonzero(~clean).tolist():
            self._findings += said[done : given[k].findings]
            done = given[k].findings
            made[id(given[k].ring)] = self._cleaned(given[k])
        self._findings += said[done:]
        regions: dict[int, Region] = {}  # a shape may be there many times
        for region in (region for part in parts for region in part.regions):
            if id(region) not in regions:
                outer, *holes = (made.get(id(ring), ring) for ring in (region.outer, *region.holes))
                regions[id(region)] = Region(outer, tuple(holes))
        return [replace(part, regions=tuple(regions[id(region)] for region in part.regions)) for part in parts]

    def _cleaned(self, given: _RawOutline) -> Points:
        """An outline cleaned, or a finding and something that stands for it."""
        where, label = given.where, given.label
        if given.ring.size and not np.abs(given.ring).max() <= LARGEST:
            self._say(where, f"{label} has coordinates beyond {LARGEST:g} mm; move or scale it")
            return np.zeros((0, 2))
        ring = clean_ring(given.ring, clockwise=given.clockwise)
        if len(ring) >= 3 and (ring[2:] != ring[:-2]).any():  # else two corners take turns
            return ring
        distinct = len(np.unique(given.ring, axis=0))
        if distinct < 3:
            self._say(where, f"{label} has {distinct} corners; at least 3 are needed")
        elif len(ring) < 3:
            self._say(where, f"{label} has all corners on one line or in one place; it must enclose an area")
        return ring

    def _gap(self, i: int, value: Any) -> JointGap | None:
        where = f"gaps[{i}]"
        entry = convert(value, GapEntry, f"{self._file}: {where}", self._findings)
        if entry is None:
            return None
        return JointGap(self._pair(where, entry.parts), self._length(entry.gap, where, "gap", least=0.0))

    def _goal(self, i: int, value: Any) -> Goal | None:
        where = f"pull[{i}]"
        entry = convert(value, PullEntry, f"{self._file}: {where}", self._findings)
        if entry is None:
            return None
        self._known(where, [entry.part])
        if entry.part in self._fixed:
            self._say(where, f'part "{entry.part}" is fixed and cannot be pulled; pull another or free it')
        asked = [key for key in ("direction", "turn", "w") if getattr(entry, key) is not None]
        if len(asked) != 1:
            self._say(where, f'must have one of "direction", "turn" or "w"; it has {" and ".join(asked) or "none"}')
            return None
        if entry.point is not None and entry.direction is None:
            self._say(where, '"point" goes with "direction" only; leave it out')
        vector = entry.direction or entry.w
        if vector is not None and not any(vector):
            self._say(where, f"{asked[0]} is zero; at least one number must not be")
        if entry.weight == 0:
            self._say(where, "weight is 0; leave the entry out, or give it a weight")
        if entry.turn is not None:
            return Turn(entry.part, entry.turn, entry.weight)
        if entry.w is not None:
            return W(entry.part, entry.w, entry.weight)
        point = None
        if entry.point is not None:
            point = self._length(entry.point[0], where, "point"), self._length(entry.point[1], where, "point")
        return Pull(entry.part, entry.direction or (0.0, 0.0), point, entry.weight)

    def _whole_size(self, parts: list[Part]) -> None:
        outer = {
            id(region): region.outer for part in parts for region in part.regions
        }  # a shape may be there many times
        size = float(extents(list(outer.values())).max())
        size = max(size, *(float(np.ptp([part.at[k] for part in parts])) for k in (0, 1)))
        if size < SMALLEST:
            self._say("", f"is {size:.3g} mm large; it must be at least {SMALLEST:g} mm")
