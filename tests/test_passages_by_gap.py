"""What is known of passages at one gap, at the others: asked no more often than it must be, and never for what it does not say."""

from __future__ import annotations

import numpy as np
import pytest

import wiggleroom as wr
from wiggleroom.context import UNLIMITED
from wiggleroom.disassembly.closed_pairs import closed_pairs, enclosed_links
from wiggleroom.disassembly.enclosure import enclosed
from wiggleroom.disassembly.passages_by_gap import PassagesByGap
from wiggleroom.freespace.subdivision.passage import Passage
from wiggleroom.search.prepare import Prepared, survey

A, B = np.array([0]), np.array([1])
CLOSED, HELD = Passage(False, True, None, np.zeros(2)), Passage(True, True, None, np.zeros(2))
OPEN, UNDECIDED = Passage(False, False, np.zeros((2, 3)), np.zeros(2)), Passage(False, False, None, np.zeros(2))


def ready_at(gap: float, joint: str = "swallowtail", count: int = 2) -> Prepared:
    return wr.prepare(wr.patterns.chain(count, joint=joint, gap=gap))


@pytest.mark.parametrize(
    ("found", "at", "known", "asked"),
    [
        (CLOSED, 0.03, [0.01, 0.02, 0.03], [0.031, 0.05]),
        (HELD, 0.03, [0.01, 0.02, 0.03], [0.031, 0.05]),
        (OPEN, 0.03, [0.03, 0.05], [0.01, 0.029]),
        (None, 0.03, [0.03, 0.05], [0.01, 0.029]),
        (UNDECIDED, 0.03, [0.03], [0.01, 0.05]),
    ],
)
def test_what_is_known_holds_on_one_side_only(
    found: Passage | None, at: float, known: list[float], asked: list[float]
) -> None:
    for gap in known + asked:
        passages, looks = PassagesByGap(), []
        passages.look(ready_at(at), A, B, 100, lambda: found, UNLIMITED)
        passages.look(ready_at(gap), B, A, 100, lambda looks=looks: looks.append(1) or UNDECIDED, UNLIMITED)
        assert bool(looks) == (gap in asked)


def test_other_parts_are_other_passages() -> None:
    passages, looks = PassagesByGap(), []
    ready = ready_at(0.02, count=3)
    passages.look(ready, A, B, 100, lambda: CLOSED, UNLIMITED)
    passages.look(ready, B, np.array([2]), 100, lambda: looks.append(1) or CLOSED, UNLIMITED)
    assert looks


@pytest.mark.parametrize("joint", ["swallowtail", "tee", "finger"])
def test_pairs_are_tied_as_without_it(joint: str) -> None:
    passages = PassagesByGap()
    for gap in (0.02, 0.05, 0.03, 0.01):
        ready = ready_at(gap, joint, 3)
        surveyed = survey(ready.assembly)
        around = enclosed(surveyed.bodies, surveyed.geometry, surveyed.ignored)
        begin = enclosed_links(surveyed.bodies.fixed, around)
        alone, among = (closed_pairs(ready, begin, known) for known in (PassagesByGap(), passages))
        assert np.array_equal(alone.group, among.group)
        assert np.array_equal(alone.held, among.held)
