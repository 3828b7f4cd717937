"""What an assembly file may hold, and decoding errors as plain lines."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Literal, TypeVar

import msgspec

from wiggleroom.drawing.readers.source import Source
from wiggleroom.errors import InputError

FORMAT = "wiggleroom/1"
Point = tuple[float, float]
T = TypeVar("T")


class Entry(msgspec.Struct, forbid_unknown_fields=True):
    """Base of everything in the file: nothing that is not known is let through."""

    LISTS: ClassVar[dict[str, str]] = {}
    """What a list of some length holds, by its name."""


class OutlineEntry(Entry):
    """One outer outline and its holes."""

    outline: list[Point]
    holes: list[list[Point]] = []


class ShapeEntry(Entry):
    """Material by one outline or by several."""

    outline: list[Point] | None = None
    holes: list[list[Point]] = []
    outlines: list[OutlineEntry] | None = None


class PartEntry(Entry):
    """One part: material of its own or that of a shape, and where it lies."""

    LISTS: ClassVar[dict[str, str]] = {"at": "[x, y, degrees]"}
    name: str
    shape: str | None = None
    outline: list[Point] | None = None
    holes: list[list[Point]] = []
    outlines: list[OutlineEntry] | None = None
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    fixed: bool = False
    offset: float = 0.0


class GapEntry(Entry):
    """The gap of one joint."""

    parts: tuple[str, str]
    gap: float


class ToleranceEntry(Entry, omit_defaults=True):
    """How far a part, one outline of it, or the gap of a joint may lie from where it should."""

    plus: float
    minus: float
    part: str | None = None
    parts: tuple[str, str] | None = None
    outline: int | Literal["thickness"] | None = None
    nominal: float | None = None


class PullEntry(Entry, omit_defaults=True):
    """One term of what is asked: a direction, a turn, or the paper's W."""

    part: str
    direction: Point | None = None
    point: Point | None = None
    turn: Literal["ccw", "cw"] | None = None
    w: tuple[float, float, float] | None = None
    weight: float = 1.0


class HeadEntry(Entry):
    """What files of every format hold; their parts are looked at one by one, so that every finding is told at once."""

    format: str
    parts: list[Any]
    unit: str = "mm"
    gap: float = 0.0
    glue: list[Any] = []
    ignore: list[Any] = []
    gaps: list[Any] = []
    tolerances: list[Any] = []
    pull: list[Any] = []


class FileEntry(HeadEntry):
    """The whole file in the plane."""

    shapes: dict[str, Any] = {}
    objective: str | None = None


class SoundFileEntry(FileEntry):
    """The same where every part and every shape is as it should be: what most files are decoded to at once."""

    parts: list[PartEntry]
    shapes: dict[str, ShapeEntry] = {}


class AssemblyFile(Entry, kw_only=True):
    """The whole file with everything in it: what its published schema says."""

    format: Literal["wiggleroom/1"]
    unit: Literal["mm", "cm", "m", "in"] = "mm"
    gap: float = 0.0
    shapes: dict[str, ShapeEntry] = {}
    parts: list[PartEntry]
    glue: list[list[str]] = []
    ignore: list[tuple[str, str]] = []
    gaps: list[GapEntry] = []
    tolerances: list[ToleranceEntry] = []
    pull: list[PullEntry] = []
    objective: Literal["translation", "closer"] | None = None


def decode_json(source: Source) -> Any:
    """JSON text as plain lists and dictionaries.

    Raises
    ------
    InputError
        With line and column, where the text is not JSON.

    Examples
    --------
    >>> decode_json(Source("a.json", "[1]"))
    [1]
    """
    try:
        return msgspec.json.decode(source.text)
    except RecursionError:
        message = f"{source.name}: lists are nested too deep; an assembly needs five levels"
    except msgspec.DecodeError as error:
        found = re.search(r"^(?:JSON is malformed: )?(.*?)(?: \(byte (\d+)\))?$", str(error), re.DOTALL)
        reason, byte = (found.group(1), found.group(2)) if found else (str(error), None)
        before = source.text.encode()[: int(byte)].decode(errors="ignore") if byte else source.text
        line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
        where, reason = f"{source.name}: line {line}, column {column}", reason.partition(" - at ")[0].lower()
        message = f"{where}: is not JSON ({reason}); it must be one JSON object"
    raise InputError(message)


def decode_sound(source: Source, kind: type[T]) -> T | None:
    """JSON text as one type, or None where it is anything else.

    Examples
    --------
    >>> decode_sound(Source("a.json", '{"parts": ["a", "b"], "gap": 1}'), GapEntry)
    GapEntry(parts=('a', 'b'), gap=1.0)
    """
    try:
        return msgspec.json.decode(source.text, type=kind)
    except (msgspec.DecodeError, RecursionError):
        return None


def repeated_fields(source: Source) -> list[str]:
    """Findings about fields that one object of a JSON text gives more than once; decoding keeps the last of them unsaid.

    Examples
    --------
    >>> repeated_fields(Source("a.json", '{"parts": [{"name": "lid", "offset": 0, "offset": 1}]}'))
    ['a.json: part "lid": field "offset" is given twice; leave one out']
    """
    findings: list[str] = []

    def look(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        entry = dict(pairs)
        if len(entry) < len(pairs):
            keys = [key for key, _ in pairs]
            name = entry.get("name", entry.get("part"))
            where = f'{source.name}: part "{name}"' if isinstance(name, str) and name.isprintable() else source.name
            again = [key for key in entry if keys.count(key) > 1]
            findings.extend(f'{where}: field "{key}" is given twice; leave one out' for key in again)
        return entry

    try:
        json.loads(_without_numbers(source.text), object_pairs_hook=look)
    except json.JSONDecodeError:  # an array of numbers and objects was cut in two
        findings.clear()
        json.loads(source.text, object_pairs_hook=look, parse_int=float)
    return findings


def _without_numbers(text: str) -> str:
    """Text with 0 in place of arrays without strings and objects, most of a large file: no field stands in them.

    Searching for single characters is much quicker than a regular expression that does the same.

    Examples
    --------
    >>> _without_numbers('{"a": [[1.5, 2.5], [3.5, 4.5]], "b": [{"c": []}]}')
    '{"a": 0, "b": [{"c": 0}]}'
    """
    kept: list[str] = []
    begin, first = 0, text.find("[")
    ends = dict.fromkeys('"{}', -1)
    while first >= 0:
        for mark, place in ends.items():
            if place < first:
                ends[mark] = text.find(mark, first) % (len(text) + 1)  # the end of the text where there is none
        end = min(ends.values())
        last = text.rfind("]", first, end)
        if last >= 0:
            kept += text[begin:first], "0"
            begin = last + 1
        first = text.find("[", end)
    return "".join([*kept, text[begin:]])


def convert(value: Any, kind: type[T], where: str, findings: list[str]) -> T | None:
    """Check and return an entry, or None and a finding that begins with `where`.

    Examples
    --------
    >>> findings = []
    >>> convert({"parts": ["a", "b"], "gap": "1"}, GapEntry, "x.json: gaps[0]", findings)
    >>> findings
    ['x.json: gaps[0]: gap must be a number, not text']
    """
    try:
        return msgspec.convert(value, kind)
    except msgspec.ValidationError as error:
        lists = kind.LISTS if issubclass(kind, Entry) else {}
        findings.append(f"{where}: {plain_finding(str(error), lists)}")
        return None


_WORDS = {
    "array": "a list",
    "object": "an object",
    "float": "a number",
    "int": "a number",
    "str": "text",
    "bool": "true or false",
    "null": "nothing",
}


def plain_finding(text: str, lists: Mapping[str, str] = MappingProxyType({})) -> str:
    """Line of the schema library in the words of the file; `lists` say by its name what a list holds."""
    text, _, path = text.partition(" - at `")
    place = path.rstrip("`").removeprefix("$").removeprefix(".").replace("[...]", "") or "it"
    if found := re.match(r"Expected `(.*?)` of length (\d+), got (\d+)", text):
        holding = f"{lists[place]}, " if place in lists else ""
        return f"{place} must be {holding}a list of {found.group(2)}, not of {found.group(3)}"
    if found := re.match(r"Expected `(.*?)`, got `(.*?)`", text):
        wanted = [_WORDS.get(word.strip(), word.strip()) for word in found.group(1).split("|") if "null" not in word]
        return f"{place} must be {' or '.join(wanted)}, not {_WORDS.get(found.group(2), found.group(2))}"
    if found := re.match(r"Expected `\w+` (>=|<=) ([-+.\de]+)$", text):
        return f"{place} must be {float(found.group(2)):.12g} or {'more' if found.group(1) == '>=' else 'less'}"
    if found := re.match(r"Object contains unknown field `(.*?)`", text):
        here = "here" if place == "it" else f"in {place}"
        return f'field "{found.group(1)}" is not known {here}; leave it out or correct its name'
    if found := re.match(r"Object missing required field `(.*?)`", text):
        return f'field "{found.group(1)}" is missing; it is needed' + ("" if place == "it" else f" in {place}")
    if found := re.match(r"Invalid enum value '(.*?)'", text):
        return f'{place} is "{found.group(1)}"; it must be "ccw" or "cw"'
    return f"{place}: {text[:1].lower()}{text[1:]}"
