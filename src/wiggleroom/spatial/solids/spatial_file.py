"""Read a file of format wiggleroom/2: solids, where they lie, and what is asked."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.dimension import PUZZLES, SPATIAL_FORMAT
from wiggleroom.drawing.limits import LARGEST, MOST_DEGREES
from wiggleroom.drawing.model import AXES, Boxes, Drawing, Goal, JointGap, Part, Plate, Pull, Region, Solid, Turn
from wiggleroom.drawing.outlines.naming import is_printable
from wiggleroom.drawing.outlines.rings import clean_ring
from wiggleroom.drawing.readers.assembly_schema import GapEntry, convert
from wiggleroom.drawing.readers.entry_reader import EntryReader, entry_of
from wiggleroom.drawing.readers.source import load
from wiggleroom.drawing.readers.voxel_puzzle import read_puzzle
from wiggleroom.errors import InputError, Stop
from wiggleroom.files import leads_back
from wiggleroom.spatial.bodies.rotations import fixed_axes
from wiggleroom.spatial.solids.box_union import union_of_boxes
from wiggleroom.spatial.solids.mesh_file import MeshFiles
from wiggleroom.spatial.solids.solid_boolean import require_solid_library
from wiggleroom.spatial.solids.spatial_schema import SolidEntry, SpatialFileEntry, SpatialPullEntry

MAX_PARTS = 20_000
"""Files of more parts are refused."""


def read_spatial(source: str | Path, *, alone: bool = False, stop: Stop | None = None) -> Drawing:
    """Parts and questions of a file of format wiggleroom/2, or of a voxel puzzle, in millimetres.

    Parameters
    ----------
    source : str or Path
        Path of the file, or its text; what a text names beside itself is not opened.
    alone : bool
        True: neither is what a file names.
    stop : optional
        Anything with `is_set()`.

    Raises
    ------
    InputError
        With one line per finding, all of them at once.
    StoppedError
        If it was asked to stop.

    Examples
    --------
    >>> text = '{"format": "wiggleroom/2", "parts": [{"name": "a", "boxes": [[0, 0, 0, 4, 2, 2]]}]}'
    >>> read_spatial(text).parts[0].name
    'a'
    """
    if isinstance(source, Path) and source.suffix.lower() in PUZZLES:
        require_solid_library()
        return read_puzzle(source)
    text = load(source, opening="{[", name="assembly")
    folder = Path(source).parent if isinstance(source, Path) or text.name != "assembly" else None
    require_solid_library()
    return _SpatialReader(text.name, folder, entry_of(text, SpatialFileEntry), alone, stop).drawing()


class _SpatialReader(EntryReader[SpatialFileEntry]):
    """Goes through one file and collects what is wrong with it."""

    def __init__(self, file: str, folder: Path | None, entry: SpatialFileEntry, alone: bool, stop: Stop | None) -> None:
        super().__init__(file, entry)
        self._folder, self._alone = folder, alone
        self._notes: list[str] = []
        self._meshes = MeshFiles(self._mm, stop)
        self._solids: dict[tuple[object, ...], Solid | None] = {}

    def drawing(self) -> Drawing:
        """Return the drawing, or raise an InputError with every finding."""
        entry = self._entry
        self._check_head(SPATIAL_FORMAT)
        if len(entry.parts) > MAX_PARTS:
            self._say("", f"has {len(entry.parts)} parts; at most {MAX_PARTS} are read")
            raise InputError(self._findings)
        gap = self._length(entry.gap, "", "gap", least=0.0)
        self._check_names()
        parts = tuple(part for i, value in enumerate(entry.parts) if (part := self._part(i, value)))
        self._fixed = {part.name for part in parts if part.fixed}
        glue = tuple(self._together(f"glue[{i}]", value) for i, value in enumerate(entry.glue))
        ignore = tuple(self._pair(f"ignore[{i}]", value) for i, value in enumerate(entry.ignore))
        gaps = tuple(joint for i, value in enumerate(entry.gaps) if (joint := self._joint_gap(i, value)))
        self._check_repeated(gaps)
        tolerances = self._tolerances()
        goals = tuple(goal for i, value in enumerate(entry.pull) if (goal := self._goal(i, value)))
        if self._findings:
            raise InputError(self._findings)
        self._notes += filter(None, [self._meshes.unit_in_doubt])
        notes = tuple(dict.fromkeys(self._notes))
        return Drawing(parts, gap, glue, ignore, gaps, goals, self._file, notes, tolerances)

    def _numbers(self, values: Iterable[float], where: str, what: str) -> NDArray[np.float64]:
        """Lengths scaled to [mm], within bounds."""
        found = np.array(list(values), dtype=float) * self._mm
        if not (np.isfinite(found).all() and np.abs(found).max(initial=0.0) <= LARGEST):
            self._say(where, f"{what} has numbers beyond {LARGEST:g} mm; move or scale it")
            return np.zeros_like(found)
        return found

    def _part(self, i: int, value: Any) -> Part | None:
        named = value.get("name") if isinstance(value, dict) else None
        where = f'part "{named}"' if isinstance(named, str) else f"parts[{i}]"
        entry = convert(value, SolidEntry, f"{self._file}: {where}", self._findings)
        if entry is None:
            return None
        if not is_printable(entry.name):
            self._say(f"parts[{i}]", "name must be printable text that is not empty")
        x, y, z = self._numbers(entry.at, where, "at").tolist()
        if not all(abs(angle) <= MOST_DEGREES for angle in entry.rotate):
            self._say(where, f"rotate must be three angles in degrees, none beyond {MOST_DEGREES:g}")
            return None
        lock = frozenset(entry.lock)
        odd = sorted(lock - set(AXES))
        if odd:
            self._say(where, f'lock names "{odd[0][:20]}"; it must be among {", ".join(AXES)}')
        if not (math.isfinite(entry.density) and entry.density > 0):
            self._say(where, f"density is {entry.density:g}; it must be more than 0")
        offset = float(self._numbers([entry.offset], where, "offset")[0])
        solid = self._solid(where, entry)
        if solid is None:
            return None
        R = fixed_axes(np.array(entry.rotate))
        return Part(
            entry.name,
            at=(x, y, z),
            fixed=entry.fixed,
            offset=offset,
            solid=solid,
            R=R,
            lock=lock,
            density=entry.density,
        )

    def _solid(self, where: str, entry: SolidEntry) -> Solid | None:
        """The part's solid; the same outline, boxes or mesh is read once."""
        material = [key for key in ("outline", "mesh", "boxes") if getattr(entry, key) is not None]
        if len(material) != 1:
            has = " and ".join(f'"{key}"' for key in material) or "none of them"
            self._say(where, f'must have one of "outline", "mesh" or "boxes"; it has {has}')
            return None
        if entry.outline is None and (entry.holes or entry.thickness is not None):
            self._say(where, '"holes" and "thickness" go with "outline" only; leave them out')
            return None
        key = (repr(entry.outline), repr(entry.holes), entry.thickness, entry.mesh, repr(entry.boxes))
        if key not in self._solids:
            if entry.outline is not None:
                self._solids[key] = self._plate(where, entry)
            elif entry.boxes is not None:
                self._solids[key] = self._boxes(where, entry)
            else:
                self._solids[key] = self._mesh(where, entry.mesh or "")
        return self._solids[key]

    def _plate(self, where: str, entry: SolidEntry) -> Plate | None:
        if entry.thickness is None:
            self._say(where, '"thickness" is missing; an outline needs one')
            return None
        thickness = entry.thickness * self._mm
        if not 0 < thickness <= LARGEST:
            asked = "more than 0" if thickness <= 0 else f"within {LARGEST:g} mm"
            self._say(where, f"thickness is {entry.thickness:g}; it must be {asked}")
            return None
        if isinstance(entry.outline, str):
            if entry.holes:
                self._say(where, '"holes" go with corners of an outline; those of a sheet are taken from there')
            regions = self._from_sheet(where, entry.outline)
            return Plate(regions, thickness) if regions else None
        rings, known = [], len(self._findings)
        for k, corners in enumerate([entry.outline or [], *entry.holes]):
            label = f"hole {k}" if k else "outline"
            given = self._numbers([c for corner in corners for c in corner], where, label).reshape(-1, 2)
            if len(self._findings) > known:
                return None
            ring = clean_ring(given, clockwise=k > 0)
            if len({tuple(corner) for corner in corners}) < 3 or len(ring) < 3:
                self._say(where, f"{label} needs at least 3 corners that are not on one line")
                return None
            rings.append(ring)
        return Plate((Region(rings[0], tuple(rings[1:])),), thickness)

    def _inside(self, where: str, name: str, what: str) -> Path | None:
        """Path of a file that a part names, inside the folder of the assembly file."""
        if self._alone:
            self._say(
                where,
                f'{what} "{name[:60]}" names another file, which is not opened for a file that was given here: '
                "start wiggleroom serve with it, or give numbers",
            )
            return None
        if self._folder is None:
            self._say(where, f'{what} "{name[:60]}" names a file, but this assembly is no file itself; give numbers')
            return None
        path = self._folder / name
        if leads_back(path):
            self._say(where, f'{what} "{name[:60]}" is a link that leads back to itself; put the file there')
            return None
        try:
            whole, folder = path.resolve(), self._folder.resolve()
        except (OSError, ValueError):
            whole, folder = path, path
        if Path(name).is_absolute() or "\x00" in name or not whole.is_relative_to(folder) or whole == folder:
            self._say(where, f'{what} "{name[:60]}" must lie in the folder of the assembly file or below it')
            return None
        return path

    def _from_sheet(self, where: str, reference: str) -> tuple[Region, ...] | None:
        from wiggleroom.drawing import read_drawing

        file, _, name = reference.partition("#")
        if not file or not name:
            self._say(where, f'outline "{reference[:60]}" must be corners, or a sheet and a name as "sheet.svg#lid"')
            return None
        path = self._inside(where, file, "outline")
        if path is None:
            return None
        if path.suffix.lower() not in (".svg", ".dxf"):
            self._say(where, f'outline "{reference[:60]}": a sheet is an SVG or DXF file')
            return None
        try:
            sheet = read_drawing(path, gap=self._entry.gap * self._mm)
        except InputError as problem:
            self._findings += [f"{self._file}: {where}: {line}" for line in problem.findings]
            return None
        self._notes += list(sheet.notes)
        found = [part for part in sheet.parts if part.name == name]
        if not found:
            known = ", ".join(f'"{part.name}"' for part in sheet.parts[:8])
            self._say(where, f'{file} has no part "{name[:40]}"; its parts are {known}')
            return None
        from wiggleroom.assembly.assembly import place

        part = found[0]
        return tuple(
            Region(place(r.outer, part.at), tuple(place(hole, part.at) for hole in r.holes)) for r in part.regions
        )

    def _boxes(self, where: str, entry: SolidEntry) -> Boxes | None:
        known = len(self._findings)
        numbers = self._numbers([x for box in entry.boxes or [] for x in box], where, "boxes").reshape(-1, 2, 3)
        if len(self._findings) > known:
            return None
        if not len(numbers):
            self._say(where, '"boxes" is empty; at least one is needed')
            return None
        for k, (low, high) in enumerate(numbers):
            if not (low < high).all():
                self._say(
                    where, f"boxes[{k}] must be x, y, z of the lower and then of the upper corner, and have a volume"
                )
                return None
        pieces = union_of_boxes(numbers).lumps if len(numbers) > 1 else 1
        if pieces > 1:
            self._notes.append(f"{where}: boxes make {pieces} pieces that share no face; they move as one")
        return Boxes(numbers)

    def _mesh(self, where: str, reference: str) -> Solid | None:
        file, _, body = reference.partition("#")
        path = self._inside(where, file, "mesh")
        if path is None:
            return None
        try:
            surface, notes = self._meshes.read(path, body)
        except InputError as problem:
            self._findings += [f"{self._file}: {where}: {line}" for line in problem.findings]
            return None
        self._notes += notes
        return surface

    def _joint_gap(self, i: int, value: Any) -> JointGap | None:
        where = f"gaps[{i}]"
        entry = convert(value, GapEntry, f"{self._file}: {where}", self._findings)
        if entry is None:
            return None
        return JointGap(self._pair(where, entry.parts), self._length(entry.gap, where, "gap", least=0.0))

    def _goal(self, i: int, value: Any) -> Goal | None:
        where = f"pull[{i}]"
        entry = convert(value, SpatialPullEntry, f"{self._file}: {where}", self._findings)
        if entry is None:
            return None
        self._known(where, [entry.part])
        if entry.part in self._fixed:
            self._say(where, f'part "{entry.part}" is fixed and cannot be pulled; pull another or free it')
        if (entry.direction is None) == (entry.turn is None):
            self._say(where, 'must have either "direction" or "turn"')
            return None
        if entry.point is not None and entry.direction is None:
            self._say(where, '"point" goes with "direction" only; leave it out')
        vector = entry.direction or entry.turn or (0.0, 0.0, 0.0)
        if not any(vector) or not all(map(math.isfinite, vector)):
            self._say(where, "the direction is zero; at least one number must not be")
        if entry.weight == 0 or not math.isfinite(entry.weight):
            self._say(where, f"weight is {entry.weight:g}; leave the entry out, or give it a weight")
        if entry.turn is not None:
            return Turn(entry.part, entry.turn, entry.weight)
        point = None
        if entry.point is not None:
            x, y, z = self._numbers(entry.point, where, "point").tolist()
            point = (x, y, z)
        return Pull(entry.part, vector, point, entry.weight)
