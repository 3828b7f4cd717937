"""What was found as the page reads it: the words and numbers of its protocol, the same from the server and in a file."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from wiggleroom.assembly.assembly import rings_at
from wiggleroom.drawing.model import Drawing, Goal, Part, Weight
from wiggleroom.drawing.writers.assembly_writer import goal_entries
from wiggleroom.errors import InputError
from wiggleroom.report.results.answer_words import answer_sure, facts, force_bearing_contacts, headline
from wiggleroom.report.results.json_results import contact_entry
from wiggleroom.schema.fields import ContactEntry
from wiggleroom.schema.replies import FlexReply, Opened, PartShape
from wiggleroom.schema.reply_base import Outline
from wiggleroom.schema.requests import Design, Goals
from wiggleroom.search.answer import Answer, Contact

if TYPE_CHECKING:
    from wiggleroom.drawing.model import Drawing

DOWN = (0.0, 0.0, -1.0)
"""Where everything sinks in the page."""
OUTLINE_DIGITS = 7
"""Significant digits of outlines, relative to the drawing's size: no more than eyes and screens can tell apart."""


def drawing_message(drawing: Drawing, parts: Sequence[Part], name: str) -> Opened:
    """A drawing and what it asks; outlines as they are in `parts`, at rest in world coordinates [mm]."""
    corners = np.vstack([ring for part in parts for ring in rings_at(part)])
    (x0, y0), (x1, y1) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return Opened(
        name=name,
        gap=drawing.gap,
        notes=list(drawing.notes),
        size=(x0, y0, x1, y1),
        parts=[
            PartShape(part.name, (part.at[0], part.at[1], math.degrees(part.at[2])), rings)
            for part, rings in zip(parts, rings_message(parts), strict=True)
        ],
        ignore=list(drawing.ignore),
        design=design_message(drawing),
    )


def design_message(drawing: Drawing) -> Design:
    """What a drawing or an assembly in space asks, as a design.

    Raises
    ------
    InputError
        If parts sink in another direction than -z, or are pulled besides.
    """
    return Design(
        gap=drawing.gap,
        gaps=[(*joint.parts, joint.gap) for joint in drawing.gaps],
        fixed=[part.name for part in drawing.parts if part.fixed],
        glue=[list(group) for group in drawing.glue],
        goals=_goals(drawing.goals),
    )


def _goals(goals: tuple[Goal, ...]) -> Goals:
    if not any(isinstance(goal, Weight) for goal in goals):
        return msgspec.convert(goal_entries(goals), Goals)
    if goals == (Weight(DOWN),):
        return "weight"
    raise InputError("weight: in the page everything sinks in -z, and nothing else is pulled")


def rings_message(parts: Sequence[Part]) -> list[Outline]:
    """Outlines and holes of all parts at rest, in world coordinates [mm]."""
    rings = [rings_at(part) for part in parts]
    size = float(np.ptp(np.vstack([ring for one in rings for ring in one]), axis=0).max())
    digits = digits_of(size)
    return [[ring.round(digits).tolist() for ring in one] for one in rings]


def digits_of(size: float) -> int:
    """Digits after the point with which lengths in a drawing of this size [mm] are told."""
    return max(0, OUTLINE_DIGITS - math.floor(math.log10(size)))


def answer_message(answer: Answer, command: str) -> FlexReply:
    """What an answer says, in the words of the commands."""
    return FlexReply(
        objective=answer.objective,
        verdict=answer.verdict,
        headline=headline(answer),
        facts=facts(answer),
        sure=answer_sure(answer),
        at_most=answer.at_most,
        leaves=list(answer.leaves),
        turns=list(answer.turns),
        contacts=contacts_message(answer.contacts),
        collision_free=bool(answer.collision_free),
        path=answer.path,
        seconds=answer.seconds.get("total", 0.0),
        command=command,
        search=answer.search_state,
    )


def contacts_message(contacts: Iterable[Contact]) -> list[ContactEntry]:
    """Contacts with a force, the strongest first."""
    return [contact_entry(contact) for contact in force_bearing_contacts(contacts)]
