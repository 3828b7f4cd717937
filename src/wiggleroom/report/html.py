"""The report of an answer: one HTML file with everything about it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wiggleroom.analysis.answer import Answer
from wiggleroom.assembly.model import Assembly
from wiggleroom.drawing.model import Goal
from wiggleroom.report.layout import magnification
from wiggleroom.report.page import Section, figure, items, page, table
from wiggleroom.report.picture import picture
from wiggleroom.report.player import player
from wiggleroom.report.scene import scene
from wiggleroom.report.words import certainty, facts, headline, number, proven, short, unit

_RATE = 16.0


def report(answer: Answer, *, more: Sequence[Section] = ()) -> str:
    """Answer as one HTML page: picture, film, parts, contacts, how sure it is, and the command.

    Parameters
    ----------
    answer : Answer
    more : sequence of Section
        What else is known, such as a ranking; shown after the film.
    """
    moving = film_section(
        answer.assembly,
        answer.waypoints,
        "Film, from rest to the end of the way",
        goals=answer.goals,
        back=not answer.leaves,
    )
    sections = [
        Section("Picture", figure(picture(answer, framed=False), _magnified(answer)), wide=True),
        moving,
        *more,
        Section("Parts", _parts(answer)),
        Section("Contacts that hold the motion", _contacts(answer)),
        Section("How sure is it", items(_sure(answer)), wide=True),
    ]
    return page(headline(answer), facts(answer), sections, answer.command)


def film_section(
    assembly: Assembly,
    way: NDArray[np.float64],
    heading: str,
    *,
    goals: tuple[Goal, ...] = (),
    back: bool = False,
    key: str = "f",
) -> Section:
    """Film of a way with a slider, as a section of a page.

    Parameters
    ----------
    way : (k, n, 3) float64 [mm, mm, rad]
        Motions along the way.
    back : bool
        True: playing returns to rest the same way.
    key : str
        One of its own for each film on a page, letters and digits.
    """
    made = scene(assembly, way, rate=_RATE, goals=goals, title=heading, facts=(), command="", framed=False, key=key)
    return Section(heading, player(made, back=back), wide=True)


def ranking(names: Sequence[str], mm_per_mm: Sequence[float], percent: Sequence[float]) -> Section:
    """Whose gap matters most, as a section for `report`; the columns sort by a click."""
    rows = sorted(zip(names, map(float, mm_per_mm), map(float, percent), strict=True), key=lambda r: -abs(r[1]))
    return Section("Whose gap matters most", table(["part", "mm of motion per mm of gap", "%"], rows))


def _magnified(answer: Answer) -> str:
    """Say by how much the picture enlarges the motion, where it does."""
    factor = magnification(answer.assembly, answer.motion)
    return "" if factor == 1 else f"motion x {number(factor)}"


def _parts(answer: Answer) -> str:
    """Motions of all parts, those that move most first."""
    moved = np.hypot(answer.motion[:, 0], answer.motion[:, 1])
    rows = [
        (answer.assembly.names[k], *answer.motion[k, :2].tolist(), math.degrees(answer.motion[k, 2]), float(moved[k]))
        for k in np.argsort(-moved, kind="stable").tolist()
    ]
    return table(["part", "dx mm", "dy mm", "turn °", "moved mm"], rows)


def _contacts(answer: Answer) -> str:
    held = sorted((c for c in answer.contacts if c.force > 0), key=lambda c: (-c.force, c.parts, c.point))
    rows: list[tuple[str | float, ...]] = [
        (" | ".join(short(n) for n in c.parts), *map(float, (*c.point, c.force))) for c in held
    ]
    return table(["between", "x mm", "y mm", "force"], rows)


def _sure(answer: Answer) -> list[tuple[str, str]]:
    most = proven(answer) or "not worked out"
    found = "nothing stops it" if answer.objective is None else f"{number(answer.objective, 6)} {unit(answer.goals)}"
    return [
        ("found", found.strip()),
        ("verdict", f"{answer.verdict.value}: {answer.verdict.sentence}"),
        ("checked", f"{certainty(answer)}; deepest overlap {number(answer.deepest_overlap, 2)} mm"),
        ("at most", most),
        ("solved", f"{answer.solver} on {answer.model}, {answer.rounds} rounds, {answer.iterations} iterations"),
        ("seconds", ", ".join(f"{stage} {spent:.2f}" for stage, spent in answer.seconds.items())),
    ]
