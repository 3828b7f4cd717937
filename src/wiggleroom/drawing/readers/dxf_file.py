"""Load a DXF with ezdxf, and say in plain words what is wrong with the file."""

from __future__ import annotations

import io
import logging
import re
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wiggleroom.drawing.readers.source import read_bytes
from wiggleroom.drawing.units import UNITS, millimetres
from wiggleroom.errors import InputError, require_extra

_BINARY = b"AutoCAD Binary DXF\r\n\x1a\x00"
_DWG = b"AC10"
"""DWG files begin with this."""
_UNITS = {1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0, 8: 25.4e-6, 9: 25.4e-3, 10: 914.4, 13: 1e-3, 14: 100.0}
"""Length of the units of $INSUNITS that parts are drawn in [mm]."""
INCHES = (12.0, 96.0, 2.0)
"""An imperial drawing no larger than the first is in inches; so is one no larger than the second, half of whose elements are
smaller than the third."""
_CUTTABLE = (1.0, 2500.0)
"""No laser or router cuts what is smaller or larger than this [mm]: the unit of a file that says so is that of a template."""
_IMPERIAL = (1, 2, 8, 9, 10)
"""Inches, feet, microinches, mils and yards as $INSUNITS."""
_POLYLINE = re.compile(r"^[ ]*0\r?\n[ ]*LWPOLYLINE[ ]*\r?\n((?:[ ]*[1-9]\d*[ ]*\r?\n.*\n)+)", re.MULTILINE)
"""A polyline of one entity, its values caught."""


@dataclass(frozen=True)
class DxfFile:
    """A DXF that was loaded.

    Parameters
    ----------
    name : str
    document : ezdxf document
    unit : int
        Code of its unit, 0 where it says none.
    imperial : bool
        Whether it says that it measures in inches, though not its unit.
    notes : tuple of str
    """

    name: str
    document: Any
    unit: int
    imperial: bool
    notes: tuple[str, ...]


def load_dxf(path: Path) -> DxfFile:
    """Document of a DXF, text or binary, and notes.

    Files with faults that can be mended without guessing at outlines are mended, which a note says.

    Raises
    ------
    InputError
        If there is no such file, or it is empty, cut short or no DXF.
    MissingExtraError
        If ezdxf is not installed.
    """
    ezdxf = import_ezdxf("read")
    raw = read_bytes(path)
    _check(raw, path.name)
    try:
        return _loaded(path.name, ezdxf.readfile(path), raw, ())
    except Exception:  # whatever the fault is, the reader below knows more of them
        pass
    from ezdxf import recover

    plain = b"AcDb" not in raw and not raw.startswith(_BINARY)
    text = _with_vertices(raw) if plain else raw
    try:
        document, audit = recover.read(io.BytesIO(text))
    except Exception as error:
        said = " ".join(str(error).split())[:120] or type(error).__name__
        message = f"{path.name}: is damaged or not a DXF drawing ({said}); export it again"
        raise InputError(message) from None
    if audit.has_errors:
        message = f"{path.name}: is damaged in {len(audit.errors)} places; export it again"
        raise InputError(message)
    note = f"{path.name}: has faults that were mended on reading; see that no part is missing"
    return _loaded(path.name, document, raw, (note,))


def _with_vertices(raw: bytes) -> bytes:
    """A text whose polylines are written as in R12: programs such as OpenJSCAD write newer ones without the classes these need."""
    return _POLYLINE.sub(_as_vertices, raw.decode("latin-1")).encode("latin-1")


def _as_vertices(found: re.Match[str]) -> str:
    """A polyline of one entity as one with vertices."""
    lines = [line.strip() for line in found[1].splitlines()]
    tags = list(zip(lines[::2], lines[1::2], strict=False))
    common = [tag for tag in tags if tag[0] in ("6", "8", "62")]
    made = [("0", "POLYLINE"), *common, ("66", "1"), *(tag for tag in tags if tag[0] == "70")]
    for tag in tags:
        if tag[0] == "10":
            made += [("0", "VERTEX"), *common]
        made += [tag] if tag[0] in ("10", "20", "42") else []
    return "".join(f"{code}\n{value}\n" for code, value in [*made, ("0", "SEQEND"), *common])


def _loaded(name: str, document: Any, raw: bytes, notes: tuple[str, ...]) -> DxfFile:
    """With the unit that the file says: where it says none, ezdxf has a unit of its own."""
    unit, imperial = (
        int(document.header.get(key, otherwise)) if key.encode() in raw else otherwise
        for key, otherwise in (("$INSUNITS", 0), ("$MEASUREMENT", 1))
    )
    return DxfFile(name, document, unit, imperial == 0, notes)


def import_ezdxf(done: str) -> Any:
    """Give the module ezdxf.

    Raises
    ------
    MissingExtraError
        If it is not installed.
    """
    require_extra("dxf", f"DXF files are {done} with ezdxf, which is not installed", "ezdxf")
    import ezdxf

    logging.getLogger("ezdxf").setLevel(logging.CRITICAL)  # what matters is said in our own notes
    return ezdxf


def scale_of(file: DxfFile, unit: str | None, sizes: Callable[[], Sequence[float]]) -> tuple[float, tuple[str, ...]]:
    """Millimetres per unit of the drawing, and notes.

    Parameters
    ----------
    file : DxfFile
    unit : str, optional
        What one unit is, whatever the file says.
    sizes : callable
        Longer sides of the whole drawing and of all its elements, in units.

    Raises
    ------
    InputError
        If `unit` is not known.
    """
    if unit is not None:
        try:
            return millimetres(unit), ()
        except InputError as error:
            message = f"{file.name}: {error}"
            raise InputError(message) from None
    which = f"says no unit that is known here ($INSUNITS {file.unit})" if file.unit else "says no unit"
    imperial = "that it is imperial ($MEASUREMENT 0)" if file.imperial else ""
    if file.unit in _UNITS:
        scale = _UNITS[file.unit]
        if scale == UNITS["mm"]:
            return scale, ()
        size = scale * sizes()[0]
        if _CUTTABLE[0] <= size <= _CUTTABLE[1]:
            return scale, ()
        long = f"{size:.3g} mm" if size < _CUTTABLE[0] else f"{size / 1000:.3g} m"
        which = f"would be {long} large in its unit ($INSUNITS {file.unit}), which is taken as none"
        imperial = "the unit is imperial" if file.unit in _IMPERIAL else ""
    if imperial and _are_inches(sizes()):
        return UNITS["in"], (
            f"{file.name}: {which}, but {imperial}, and its numbers are small; "
            "1 unit is taken as 1 inch (--unit says otherwise)",
        )
    return UNITS["mm"], (f"{file.name}: {which}; 1 unit is taken as 1 mm (--unit says otherwise)",)


def _are_inches(sizes: Sequence[float]) -> bool:
    """Whether numbers are more likely inches than millimetres, where the file says that it is imperial."""
    whole, *elements = sizes
    return whole <= INCHES[0] or (whole <= INCHES[1] and statistics.median(elements) < INCHES[2])


def _check(raw: bytes, name: str) -> None:
    """Refuse what is no whole DXF; ezdxf would read the first half of a file without a word."""
    wrong = ""
    if not raw.strip():
        wrong = "is empty; a drawing with at least one part is needed"
    elif raw.startswith(_BINARY):
        if b"EOF\x00" not in raw[-64:]:
            wrong = "is cut short, its end (EOF) is missing; export it again"
    elif raw.startswith(_DWG):
        wrong = "is a DWG drawing, not a DXF; export it as DXF"
    else:
        first = raw.removeprefix(b"\xef\xbb\xbf")[:4000].splitlines()
        lines = [line.strip() for line in first]
        lines = lines[next((i for i in range(0, len(lines) - 1, 2) if lines[i] != b"999"), 0) :]
        if lines[:2] != [b"0", b"SECTION"]:
            wrong = "is not a DXF drawing; it must begin with a section"
        elif raw[-400:].split()[-1:] != [b"EOF"]:
            wrong = "is cut short, its end (EOF) is missing; export it again"
    if wrong:
        message = f"{name}: {wrong}"
        raise InputError(message)
