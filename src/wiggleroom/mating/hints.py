"""What a person says about a sheet: thickness, burn, which panels belong together, and single joints."""

from __future__ import annotations

import json
import math
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from wiggleroom.errors import InputError

SIDES = ("left", "right", "bottom", "top")
EDGE_WORDS = (
    f'an edge is "lid:top" ({", ".join(SIDES)}), or "lid@12.5,40" for the one next to a point of the sheet [mm, y up]'
)


@dataclass(frozen=True)
class EdgeReference:
    """An edge of a panel as it lies on the sheet.

    Parameters
    ----------
    panel : str
        Empty: whichever panel lies at the point.
    side : str
        left, right, bottom or top; empty where a point is given.
    point : (x, y) [mm], optional
        On the sheet, y up; the edge is what is nearest to it.

    Examples
    --------
    >>> str(EdgeReference("lid", "top")), str(EdgeReference("lid", point=(12.5, 40.0)))
    ('lid:top', 'lid@12.5,40')
    """

    panel: str
    side: str = ""
    point: tuple[float, float] | None = None

    def __str__(self) -> str:
        """As it stands in a file of hints."""
        return (
            f"{self.panel}:{self.side}" if self.point is None else f"{self.panel}@{self.point[0]:g},{self.point[1]:g}"
        )


def edge_reference(text: str) -> EdgeReference | None:
    """An edge from its text; None where it is none.

    Examples
    --------
    >>> edge_reference("lid:top"), edge_reference("lid") is None
    (EdgeReference(panel='lid', side='top', point=None), True)
    >>> edge_reference("@12.5,40").point
    (12.5, 40.0)
    """
    name, at, place = text.rpartition("@")
    if at:
        try:
            x, y = (float(number) for number in place.split(","))
        except ValueError:
            x = y = math.nan
        if math.isfinite(x + y):
            return EdgeReference(name, point=(x, y))
    name, _, side = text.rpartition(":")
    return EdgeReference(name, side) if name and side in SIDES else None


EdgePair = tuple[EdgeReference, EdgeReference]


@dataclass(frozen=True)
class FixedPlate:
    """Where a panel belongs.

    Parameters
    ----------
    panel : str
    centre : (x, y, z) [mm]
        Of the panel's centroid, in the middle of its thickness, in the frame of the panel `frame`.
    right, up : (x, y, z)
        Where the sheet's x and y point.
    frame : str
        A panel in whose frame this is said: origin in its centroid, x and y as on the sheet.
    """

    panel: str
    centre: tuple[float, float, float]
    right: tuple[float, float, float]
    up: tuple[float, float, float]
    frame: str


@dataclass(frozen=True)
class Hints:
    """Everything that was said.

    Parameters
    ----------
    thickness : float [mm], optional
    thicknesses : dict of str to float [mm]
        Real thickness of single panels, in place of that.
    burn : float [mm], optional
    groups : tuple of tuples of names
        Panels that make one body each.
    joins : tuple of (EdgeReference, EdgeReference)
        Edges of which one holds the other.
    flush : tuple of (EdgeReference, EdgeReference)
        Edges that end in one plane.
    plates : tuple of FixedPlate
    skip : tuple of names
        Outlines that are no panels.
    """

    thickness: float | None = None
    thicknesses: dict[str, float] = field(default_factory=dict)
    burn: float | None = None
    groups: tuple[tuple[str, ...], ...] = ()
    joins: tuple[EdgePair, ...] = ()
    flush: tuple[EdgePair, ...] = ()
    plates: tuple[FixedPlate, ...] = ()
    skip: tuple[str, ...] = ()


def read_hints(path: str | Path) -> Hints:
    """Hints from a TOML file.

    Raises
    ------
    InputError
        With one line per finding.
    """
    path = Path(path)
    try:
        raw = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        message = f"{path}: cannot be read ({(error.strerror or 'no access').lower()}); give a TOML file that is there"
        raise InputError(message) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        message = f"{path.name}: is not TOML ({error}); see the page on cutting sheets for an example"
        raise InputError(message) from None
    return _Hinted(path.name, raw).hints()


def write_hints(hints: Hints) -> str:
    """Text of a TOML file that says the same.

    Examples
    --------
    >>> print(write_hints(Hints(3.0, joins=((EdgeReference("lid", "top"), EdgeReference("back", point=(1, 2))),))))
    thickness = 3.0
    join = [
        ["lid:top", "back@1,2"],
    ]
    <BLANKLINE>
    """
    lines = [f"{key} = {value!r}" for key in ("thickness", "burn") if (value := getattr(hints, key)) is not None]
    lists: list[tuple[str, list[str]]] = [
        ("groups", [_text(list(group)) for group in hints.groups]),
        ("join", [_text([str(edge) for edge in pair]) for pair in hints.joins]),
        ("flush", [_text([str(edge) for edge in pair]) for pair in hints.flush]),
    ]
    for key, rows in lists:
        if rows:
            lines += [f"{key} = [", *(f"    {row}," for row in rows), "]"]
    if hints.skip:
        lines.append(f"skip = {_text(list(hints.skip))}")
    if hints.thicknesses:
        lines += ["", "[thicknesses]", *(f"{_text(name)} = {size!r}" for name, size in hints.thicknesses.items())]
    for plate in hints.plates:
        lines += ["", "[[plate]]", f"panel = {_text(plate.panel)}", f"frame = {_text(plate.frame)}"]
        lines += [f"{key} = {_text([*getattr(plate, key)])}" for key in ("centre", "right", "up")]
    return "\n".join([*lines, ""])


def _text(value: Any) -> str:
    """Strings and lists are written alike in TOML and in JSON."""
    return json.dumps(value, ensure_ascii=False)


class _Hinted:
    def __init__(self, file: str, raw: dict[str, Any]) -> None:
        self._file, self._raw = file, raw
        self._findings: list[str] = []

    def hints(self) -> Hints:
        known = ("thickness", "thicknesses", "burn", "groups", "join", "flush", "plate", "skip")
        for key in self._raw:
            if key not in known:
                self._say(key, f"is not known; it must be one of {', '.join(known)}")
        thicknesses = self._raw.get("thicknesses", {})
        if not isinstance(thicknesses, dict):
            self._say("thicknesses", "must be a table, such as thicknesses = {lid = 2.8}")
            thicknesses = {}
        plates = tuple(plate for i, value in enumerate(self._list("plate")) if (plate := self._plate(i, value)))
        result = Hints(
            thickness=self._length("thickness", self._raw.get("thickness")),
            thicknesses={n: size for n, v in thicknesses.items() if (size := self._length(n, v)) is not None},
            burn=self._length("burn", self._raw.get("burn"), zero=True),
            groups=tuple(self._names(f"groups[{i}]", value) for i, value in enumerate(self._list("groups"))),
            joins=self._pairs("join"),
            flush=self._pairs("flush"),
            plates=plates,
            skip=self._names("skip", self._raw.get("skip", [])),
        )
        if self._findings:
            raise InputError(self._findings)
        return result

    def _say(self, where: str, what: str) -> None:
        self._findings.append(f"{self._file}: {where}: {what}")

    def _list(self, key: str) -> list[Any]:
        value = self._raw.get(key, [])
        if isinstance(value, list):
            return value
        self._say(key, "must be a list")
        return []

    def _length(self, where: str, value: Any, *, zero: bool = False) -> float | None:
        if value is None:
            return None
        good = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
        if not good or value < 0 or (value == 0 and not zero):
            self._say(where, f"is {value!r}; it must be a length in mm larger than 0")
            return None
        return float(value)

    def _names(self, where: str, value: Any) -> tuple[str, ...]:
        if isinstance(value, list) and all(isinstance(name, str) for name in value):
            return tuple(value)
        self._say(where, "must be a list of names of panels")
        return ()

    def _pairs(self, key: str) -> tuple[EdgePair, ...]:
        found = []
        for i, value in enumerate(self._list(key)):
            two = isinstance(value, list) and len(value) == 2
            ends = [edge_reference(end) if isinstance(end, str) else None for end in value] if two else []
            if len(ends) == 2 and ends[0] and ends[1]:
                found.append((ends[0], ends[1]))
            else:
                self._say(f"{key}[{i}]", f'must be two edges, such as ["lid:top", "back:top"]; {EDGE_WORDS}')
        return tuple(found)

    def _plate(self, i: int, value: Any) -> FixedPlate | None:
        keys = ("panel", "centre", "right", "up", "frame")
        if not isinstance(value, dict) or sorted(value) != sorted(keys):
            self._say(f"plate[{i}]", f"must have exactly {', '.join(keys)}")
            return None
        rows = []
        for key in ("centre", "right", "up"):
            row = value[key]
            if not isinstance(row, list) or len(row) != 3 or not all(isinstance(x, int | float) for x in row):
                self._say(f"plate[{i}]", f"{key} must be three numbers")
                return None
            rows.append((float(row[0]), float(row[1]), float(row[2])))
        if (
            abs(sum(a * b for a, b in zip(rows[1], rows[2], strict=True))) > 1e-6
            or not any(rows[1])
            or not any(rows[2])
        ):
            self._say(f"plate[{i}]", "right and up must be square to each other and not zero")
            return None
        return FixedPlate(str(value["panel"]), rows[0], rows[1], rows[2], str(value["frame"]))
