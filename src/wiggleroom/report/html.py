"""The report of an answer: one HTML file with everything about it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from wiggleroom.analysis.answer import Answer
from wiggleroom.analysis.rank import Ranking, rank_at_once
from wiggleroom.analysis.vary import can_be_ranked
from wiggleroom.assembly.model import Assembly
from wiggleroom.drawing.model import Goal
from wiggleroom.report.layout import magnification
from wiggleroom.report.page import Section, figure, items, page, table
from wiggleroom.report.picture import picture
from wiggleroom.report.player import player
from wiggleroom.report.ranking import ranking_unique
from wiggleroom.report.scene import scene
from wiggleroom.report.words import certainty, facts, headline, number, proven, short, unit

_RATE = 16.0


def report(answer: Answer) -> str:
    """Answer as one HTML page: picture, film, parts, contacts, whose gap matters, how sure it is, and the command.

    Whose gap matters is said where the motion ends at walls, from the forces of the answer itself.
    """
    ranked = ranking_sections(rank_at_once(answer)) if answer.model == "walls" and can_be_ranked(answer) else []
    sections = [
        Section("Picture", figure(picture(answer, framed=False), magnified(answer)), wide=True),
        film_of(answer),
        parts_section(answer),
        contacts_section(answer),
        *ranked,
        Section("How sure is it", items(answer_sure(answer)), wide=True),
    ]
    return page(headline(answer), facts(answer), sections, answer.command)


def film_of(answer: Answer) -> Section:
    """Film of the way of an answer."""
    heading = "Film, from rest to the end of the way"
    return film_section(answer.assembly, answer.waypoints, heading, goals=answer.goals, back=not answer.leaves)


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


def ranking_sections(ranking: Ranking) -> list[Section]:
    """Whose gap matters most, parts and joints, in tables that sort by a click."""
    names, per = ranking.answer.assembly.names, f"{unit(ranking.answer.goals)} per mm of gap".strip()
    both = not ranking.unique.all()
    parts: list[list[str | float]] = []
    for k in ranking.order.tolist():
        side = [float(ranking.tighter[k])] if both else []
        parts.append([names[k], float(ranking.looser[k]), *side, float(ranking.percent[k])])
    joints = [
        (" | ".join(short(names[i]) for i in pair), float(value), float(share))
        for pair, value, share in zip(ranking.joints.tolist(), ranking.joint_looser, ranking.joint_percent, strict=True)
    ]
    joints.sort(key=lambda row: -row[1])
    heads = ["part", per, *(["if tighter"] if both else []), "%"]
    note = f"<p>Not unique {ranking_unique(ranking).removeprefix('not ')}</p>" if both else ""
    return [
        Section("Whose gap matters most", table(heads, parts) + note),
        Section("Which joint's gap matters most", table(["joint", per, "%"], joints)),
    ]


def magnified(answer: Answer) -> str:
    """Say by how much a picture enlarges the motion, where it does."""
    factor = magnification(answer.assembly, answer.motion)
    return "" if factor == 1 else f"motion x {number(factor)}"


def parts_section(answer: Answer) -> Section:
    """Motions of all parts, those that move most first."""
    moved = np.hypot(answer.motion[:, 0], answer.motion[:, 1])
    rows = [
        (answer.assembly.names[k], *answer.motion[k, :2].tolist(), math.degrees(answer.motion[k, 2]), float(moved[k]))
        for k in np.argsort(-moved, kind="stable").tolist()
    ]
    return Section("Parts", table(["part", "dx mm", "dy mm", "turn °", "moved mm"], rows))


def contacts_section(answer: Answer) -> Section:
    """Contacts with a force, the largest first."""
    held = sorted((c for c in answer.contacts if c.force > 0), key=lambda c: (-c.force, c.parts, c.point))
    rows: list[tuple[str | float, ...]] = [
        (" | ".join(short(n) for n in c.parts), *map(float, (*c.point, c.force))) for c in held
    ]
    return Section("Contacts that hold the motion", table(["between", "x mm", "y mm", "force"], rows))


def answer_sure(answer: Answer) -> list[tuple[str, str]]:
    """How sure an answer is, and what it cost: a word and a sentence each."""
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
