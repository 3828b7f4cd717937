"""Answers about assemblies that nobody drew by hand: always safe, honest about themselves, and not to be bettered nearby."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

import wiggleroom as wr
from tests.flex_truth import Ground, check_safe, climbed, off_outline, unbalanced
from tests.flexing import mirrored, random_assembly, random_goals, random_puzzle, scaled, shuffled
from wiggleroom.assembly.build import assemble

VERDICTS = ("proven", "optimal", "stationary", "unbounded", "stopped")
FEW, MANY = (
    [*range(8), 73, 205, 212],
    range(40, 52),
)  # 73: edges flat on each other; 205: virtual walls near the end; 212: turns and pulls far off weigh against each other
SMALL = [k for k in range(15) if k % 5 in (0, 4)]  # chains of one random joint, pegs in random holes
SAME = {"mirror": (mirrored, 1.0), "hundredth": (lambda d: scaled(d, 1e-2), 1e-2), "shuffled": (shuffled, 1.0)}
SAME["thousandfold"] = (lambda d: scaled(d, 1e3), 1e3)


@cache
def ask(seed, most=3):
    assembly = random_assembly(seed)
    return wr.flex(assembly, random_goals(assembly, seed, most), search=0)


def look(answer):
    """Everything that an answer must keep."""
    ground = Ground(answer.assembly)
    check_safe(answer, ground)
    assert answer.verdict in VERDICTS
    if answer.verdict == "unbounded":
        assert answer.path == "checked"
    if answer.verdict in ("proven", "optimal"):
        assert answer.contacts
        assert unbalanced(answer, ground) <= 1e-3
        assert off_outline(answer, ground) <= 1e-6 * ground.size
        if len(answer.assembly.parts) < 10:
            assert max(climbed(answer, ground, k) for k in range(2)) <= answer.objective * (1 + 1e-5)


@pytest.mark.parametrize("seed", FEW)
def test_random_question(seed):
    """Nobody stopped the search, so it came to an end, and knows a path."""
    answer = ask(seed)
    look(answer)
    assert answer.verdict != "stopped"
    assert answer.path == "checked"


@pytest.mark.slow
@pytest.mark.parametrize("seed", MANY)
def test_many_random_questions(seed):
    look(ask(seed))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1))
def test_thirty_parts(seed):
    assembly = random_puzzle(seed)
    look(wr.flex(assembly, random_goals(assembly, seed, 2), search=0))


@pytest.mark.parametrize("seed", SMALL)
@pytest.mark.parametrize("how", SAME)
def test_same_question_otherwise(seed, how):
    change, length = SAME[how]
    answer = ask(seed, most=1)
    drawing = replace(answer.assembly.drawing, goals=answer.goals)
    other = wr.flex(assemble(change(drawing)), search=0)
    check_safe(other)
    if answer.objective is None:
        assert other.objective is None
    else:
        assert other.objective == pytest.approx(answer.objective * length, rel=1e-6)
