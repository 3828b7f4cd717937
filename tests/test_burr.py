"""Six-piece burrs from the numbers of their sticks, against counts that are known and against cells counted here."""

from __future__ import annotations

import itertools
import sys
from collections import Counter
from pathlib import Path

import pytest

import wiggleroom as wr
from wiggleroom.cli import main
from wiggleroom.errors import InputError

KNOWN = [1, 256, 824, 928, 975, 1024]


def cells(drawing) -> Counter:
    every = Counter()
    for part in drawing.parts:
        for low, high in (part.solid.boxes / 10).round().astype(int).tolist():
            every.update(itertools.product(*map(range, low, high)))
    return every


@pytest.mark.parametrize(
    ("numbers", "ways"), [(KNOWN, 2), ([52, 615, 792, 960, 975, 992], 1), ([911, 975, 975, 792, 824, 824], 3)]
)
def test_sticks_without_holes_fill_the_burr_exactly(numbers, ways):
    """A burr of sticks of length 6 has 104 cells; the sum of bits of the numbers less one is what was cut away of 144."""
    assert sum(144 // 6 - (k - 1).bit_count() for k in numbers) == 104
    for way in range(1, ways + 1):
        found = cells(wr.patterns.burr(numbers, way=way))
        assert len(found) == 104
        assert set(found.values()) == {1}
    with pytest.raises(InputError, match=f"there are {ways}, from 1"):
        wr.patterns.burr(numbers, way=ways + 1)


def test_longer_sticks_have_two_more_cells_at_each_end():
    assert len(cells(wr.patterns.burr(KNOWN, length=8))) == 104 + 6 * 8


@pytest.mark.parametrize(
    ("numbers", "more", "said"),
    [
        (KNOWN[:5], {}, "burr: 5 numbers; a six-piece burr has 6"),
        ([0, *KNOWN[1:]], {}, "burr: stick 0; numbers go from 1 to 4096"),
        ([4096, *KNOWN[1:]], {}, "burr: stick 4096 falls to pieces; choose another number"),
        ([1, 1, 1, 1, 1, 1], {}, "these six sticks do not go together as a six-piece burr; choose others"),
        (KNOWN, {"length": 7}, "burr: length 7; it must be even, from 6 to 100 cells"),
        (KNOWN, {"gap": 12.0}, "burr: gap 12; it must be from 0 to less than a cell, 10 mm"),
        (KNOWN, {"cell": 0.0}, "burr: cell 0; it must be more than 0"),
    ],
)
def test_what_is_no_burr_is_said(numbers, more, said):
    with pytest.raises(InputError, match=said):
        wr.patterns.burr(numbers, **more)


def test_what_the_command_writes_comes_apart(tmp_path: Path, monkeypatch, capsys):
    file = tmp_path / "burr.json"
    monkeypatch.setattr(sys, "argv", ["wiggleroom", "make", "burr", *map(str, KNOWN), "-o", str(file)])
    assert main() == 0
    assert "way 1 of 2" in capsys.readouterr().err
    assert wr.plan(wr.read(file)).level == (1, 1, 1, 1, 1)
