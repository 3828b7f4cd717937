"""What a person says about a sheet: thickness, burn, which panels belong together, and single joints."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from wiggleroom.errors import InputError

SIDES = ("left", "right", "bottom", "top")


@dataclass(frozen=True)
class Join:
    """One joint that is known: an edge of one panel holds an edge of another.

    Parameters
    ----------
    panels : (str, str)
    sides : (str, str)
        left, right, bottom or top of each panel as it lies on the sheet.
    """

    panels: tuple[str, str]
    sides: tuple[str, str]


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
    joins : tuple of Join
    plates : tuple of FixedPlate
    """

    thickness: float | None = None
    thicknesses: dict[str, float] = field(default_factory=dict)
    burn: float | None = None
    groups: tuple[tuple[str, ...], ...] = ()
    joins: tuple[Join, ...] = ()
    plates: tuple[FixedPlate, ...] = ()


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


class _Hinted:
    def __init__(self, file: str, raw: dict[str, Any]) -> None:
        self._file, self._raw = file, raw
        self._findings: list[str] = []

    def hints(self) -> Hints:
        known = ("thickness", "thicknesses", "burn", "groups", "join", "plate")
        for key in self._raw:
            if key not in known:
                self._say(key, f"is not known; it must be one of {', '.join(known)}")
        thicknesses = self._raw.get("thicknesses", {})
        if not isinstance(thicknesses, dict):
            self._say("thicknesses", "must be a table, such as thicknesses = {lid = 2.8}")
            thicknesses = {}
        joins = tuple(found for i, value in enumerate(self._list("join")) if (found := self._join(i, value)))
        plates = tuple(plate for i, value in enumerate(self._list("plate")) if (plate := self._plate(i, value)))
        result = Hints(
            thickness=self._length("thickness", self._raw.get("thickness")),
            thicknesses={n: size for n, v in thicknesses.items() if (size := self._length(n, v)) is not None},
            burn=self._length("burn", self._raw.get("burn"), zero=True),
            groups=tuple(self._names(f"groups[{i}]", value) for i, value in enumerate(self._list("groups"))),
            joins=joins,
            plates=plates,
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

    def _join(self, i: int, value: Any) -> Join | None:
        ends = [str(end).rpartition(":") for end in value] if isinstance(value, list) else []
        if len(ends) != 2 or any(side not in SIDES or not name for name, _, side in ends):
            self._say(
                f"join[{i}]", f'must be two edges, such as ["lid:top", "back:bottom"]; edges are {", ".join(SIDES)}'
            )
            return None
        return Join((ends[0][0], ends[1][0]), (ends[0][2], ends[1][2]))

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
