"""How finely a mesh file says its coordinates: by the digits that its text has, or by the bytes of its numbers."""

from __future__ import annotations

import math
import re
import zipfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SINGLE = 2.0**-23
"""Step of numbers of four bytes, as a share of the number."""
FEWEST_DIGITS = 5
"""Numbers of fewer digits are what somebody has written: they are taken as they stand."""
TOKENS = 50_000
"""So many numbers of a file, spread over it, are looked at."""
_LINE = re.compile(rb"(?m)^[ \t]*v(?:ertex)?[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)")
_VERTEX = re.compile(rb"<vertex\b[^>]*>")
_VALUE = re.compile(rb"\b[xyz]\s*=\s*[\"']\s*([^\"'\s]+)")
_NUMBER = re.compile(rb"[+-]?(\d*)(?:\.(\d*))?(?:[eE]([+-]?\d+))?")


def coordinate_step(numbers: list[bytes] | None, vertices: Floats) -> float:
    """Step between neighbouring coordinates that a file can tell apart, in its unit, at its largest coordinate; 0 where they are exact.

    Parameters
    ----------
    numbers : list of bytes or None
        What `coordinates_as_written` says of the file.
    vertices : (v, 3) float64
        As the file has them, before it places them.
    """
    largest = float(np.abs(vertices).max(initial=0.0))
    if numbers is None:
        return SINGLE * largest
    step = step_of_numbers(numbers, largest)
    single = (np.abs(vertices - vertices.astype(np.float32)) <= 0.51 * step).all()
    return max(step, SINGLE * largest) if single else step


def step_of_numbers(numbers: list[bytes], largest: float) -> float:
    """Step of decimal numbers of that many decimals or digits, at the largest of them; 0 where they have few digits.

    Examples
    --------
    >>> step_of_numbers([b"0.125000", b"-12.345678"], 12.345678)
    1e-06
    >>> step_of_numbers([b"1.23456e+01", b"1.23456e-03"], 12.3456)
    0.0001
    >>> step_of_numbers([b"12.5", b"7"], 12.5)
    0.0
    """
    decimals, digits = 0, 0
    for number in numbers:
        found = _NUMBER.fullmatch(number)
        if found is None:
            continue
        whole, part, exponent = found[1], found[2] or b"", int(found[3] or 0)
        decimals = max(decimals, len(part) - exponent)
        digits = max(digits, len((whole + part).lstrip(b"0")))
    if digits < FEWEST_DIGITS or largest <= 0:
        return 0.0
    return 10.0 ** max(-decimals, math.floor(math.log10(largest)) + 1 - digits)


def coordinates_as_written(path: Path) -> list[bytes] | None:
    """Some of the coordinates of an STL, OBJ, PLY, GLB or 3MF file as it writes them; none where they have eight bytes, None where four."""
    ending = path.suffix.lower()
    if ending == ".glb":
        return None
    if ending == ".3mf":
        with zipfile.ZipFile(path) as archive:
            models = [archive.read(name) for name in archive.namelist() if name.lower().endswith(".model")]
        vertices = [found for model in models for found in _VERTEX.findall(model)]
        return [value for vertex in _some(vertices) for value in _VALUE.findall(vertex)]
    data = path.read_bytes()
    if ending == ".ply":
        head, _, body = data.partition(b"end_header")
        if b"format ascii" not in head:
            return [] if re.search(rb"property\s+(double|float64)\s+x", head) else None
        return [number for line in _some(body.split(b"\n")[1:]) for number in line.split()[:3]]
    lines = _LINE.findall(data)
    if ending == ".stl" and not (lines and data.lstrip()[:5].lower() == b"solid"):
        return None
    return [number for line in _some(lines) for number in line]


def _some(values: list) -> list:
    """Every so many of a long list."""
    return values[:: 1 + 3 * len(values) // TOKENS]
