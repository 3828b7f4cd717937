"""What both formats of assembly files have in common: their head, names of parts, and what is wrong with them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Any, Generic, TypeVar

from wiggleroom.drawing.limits import LARGEST
from wiggleroom.drawing.model import JointGap, Tolerance
from wiggleroom.drawing.readers.assembly_schema import (
    HeadEntry,
    ToleranceEntry,
    convert,
    decode_json,
    decode_sound,
    repeated_fields,
)
from wiggleroom.drawing.readers.source import Source
from wiggleroom.drawing.readers.tolerances import tolerance_findings
from wiggleroom.drawing.units import UNITS
from wiggleroom.errors import InputError

E = TypeVar("E", bound=HeadEntry)

FORMATS = ("wiggleroom/1", "wiggleroom/2")
_FILE_UNITS = {unit: UNITS[unit] for unit in ("mm", "cm", "m", "in")}


def entry_of(text: Source, kind: type[E], sound: type[E] | None = None) -> E:
    """Top level of an assembly file.

    Parameters
    ----------
    text : Source
    kind : type
        In which parts may be anything, so that each is looked at by itself.
    sound : type, optional
        The same with the types of its parts, for files that fit it: decoded at once they take half the time.

    Raises
    ------
    InputError
        If it is no JSON object, of another format, or a field is unknown, missing, given twice or of another type.
    """
    findings: list[str] = []
    entry = None if sound is None else decode_sound(text, sound)
    if entry is None:
        raw = decode_json(text)
        if not isinstance(raw, dict):
            message = f'{text.name}: must be one JSON object with "format" and "parts"'
            raise InputError(message)
        _check_format(text, raw.get("format"))
        entry = convert(raw, kind, text.name, findings)
    if entry is not None:
        _check_format(text, entry.format)
        findings += repeated_fields(text)
    if entry is None or findings:
        raise InputError(findings)
    return entry


def _check_format(text: Source, form: object) -> None:
    """Refuse text of a format that is not known: its fields are not to be judged by those of another one."""
    if isinstance(form, str) and form not in FORMATS:
        known = " or ".join(f'"{name}"' for name in FORMATS)
        message = f'{text.name}: format is "{form[:40]}"; it must be {known}'
        raise InputError(message)


def name_of(value: Any) -> str | None:
    """Name of a part as it was decoded, None where it has none."""
    name = value.get("name") if isinstance(value, dict) else getattr(value, "name", None)
    return name if isinstance(name, str) else None


class EntryReader(Generic[E]):
    """Goes through one assembly file and collects what is wrong with it.

    Parameters
    ----------
    file : str
        Name of the file, for findings.
    entry : HeadEntry
        Its top level.
    """

    def __init__(self, file: str, entry: E) -> None:
        self._file, self._entry = file, entry
        self._findings: list[str] = []
        self._mm = _FILE_UNITS.get(entry.unit, 1.0)
        self._fixed: set[str] = set()
        self._names = Counter(name for value in entry.parts if (name := name_of(value)) is not None)

    def _check_head(self, form: str) -> None:
        entry = self._entry
        if entry.format != form:
            self._say("", f'format is "{entry.format[:40]}"; it must be "{form}"')
        if entry.unit not in _FILE_UNITS:
            self._say("", f'unit is "{entry.unit[:40]}"; it must be one of {", ".join(_FILE_UNITS)}')
        if not entry.parts:
            self._say("", "has no parts; at least one is needed")

    def _check_names(self) -> None:
        for name, count in self._names.items():
            if count > 1:
                self._say(f'part "{name}"', f"name is used {count} times; every part needs its own")

    def _say(self, where: str, what: str) -> None:
        self._findings.append(f"{self._file}: {where}: {what}" if where else f"{self._file}: {what}")

    def _length(self, value: float, where: str, what: str, *, least: float = -LARGEST) -> float:
        """Scale a number to [mm]; `what` is said where it is out of bounds."""
        scaled = value * self._mm
        if not least <= scaled <= LARGEST:
            asked = f"{least:g} or more" if abs(scaled) <= LARGEST else f"within {LARGEST:g} mm"
            self._say(where, f"{what} is {value:g}; it must be {asked}")
            return 0.0
        return scaled

    def _check_repeated(self, gaps: Iterable[JointGap]) -> None:
        for pair, count in Counter(frozenset(joint.parts) for joint in gaps).items():
            if count > 1:
                self._say("gaps", f"parts {' and '.join(sorted(pair))} are given {count} times; once is right")

    def _known(self, where: str, names: Iterable[str]) -> None:
        for name in names:
            if name not in self._names:
                self._say(where, f'there is no part "{name}"; it must be the name of a part')

    def _together(self, where: str, value: Any) -> tuple[str, ...]:
        names = convert(value, list[str], f"{self._file}: {where}", self._findings)
        if names is None:
            return ()
        self._known(where, names)
        if len(set(names)) < max(2, len(names)):
            self._say(where, "must name at least two different parts, each once")
        return tuple(names)

    def _pair(self, where: str, value: Any) -> tuple[str, str]:
        names = convert(value, tuple[str, str], f"{self._file}: {where}", self._findings)
        if names is None:
            return ("", "")
        self._known(where, names)
        if names[0] == names[1]:
            self._say(where, "must name two different parts")
        return names

    def _tolerances(self) -> tuple[Tolerance, ...]:
        """All tolerances of the file."""
        return tuple(one for i, value in enumerate(self._entry.tolerances) if (one := self._tolerance(i, value)))

    def _tolerance(self, i: int, value: Any) -> Tolerance | None:
        where = f"tolerances[{i}]"
        entry = convert(value, ToleranceEntry, f"{self._file}: {where}", self._findings)
        if entry is None:
            return None
        wrong = tolerance_findings(entry)
        for line in wrong:
            self._say(where, line)
        if wrong:
            return None
        names = self._pair(where, entry.parts) if entry.parts else (entry.part or "",)
        self._known(where, names)
        plus, minus = (self._length(number, where, "tolerance", least=0.0) for number in (entry.plus, entry.minus))
        nominal = None if entry.nominal is None else self._length(entry.nominal, where, "nominal")
        return Tolerance(names, plus, minus, nominal, entry.outline)
