"""Assemblies in space and what was found about them, as the page reads it: the words and numbers of its protocol."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import InputError
from wiggleroom.report.page.page_messages import flex_reply
from wiggleroom.report.page.solid_page import packed
from wiggleroom.report.results.answer_words import fact_lines, sure_rows
from wiggleroom.report.solids.exploded_view import exploded_offsets
from wiggleroom.report.solids.spatial_path import along_path, with_quaternions
from wiggleroom.report.solids.spatial_table import (
    check_sentence,
    departure_words,
    spatial_bound_sentence,
    spatial_headline,
    spatial_sentence,
)
from wiggleroom.schema.fields import ContactEntry
from wiggleroom.schema.replies import FlexReply, Opened, PartShape, Solids, SolidShape
from wiggleroom.schema.requests import Design, GoalEntry, Goals
from wiggleroom.schema.study_replies import CheckReply, LeavingEntry
from wiggleroom.spatial.solids.spatial_model import (
    SpatialAssembly,
    SpatialDrawing,
    SpatialGoal,
    SpatialPull,
    SpatialTurn,
)
from wiggleroom.spatial.spatial_answer import SpatialAnswer, SpatialContact
from wiggleroom.spatial.spatial_disassembly import SpatialDisassembly

Floats = NDArray[np.float64]

MAX_FRAMES = 64
"""Frames of a path."""
MAX_FRAME_MOTIONS = 60_000
"""Motions of parts in all frames of a path together; at least two frames."""
DOWN = (0.0, 0.0, -1.0)


def spatial_opened(drawing: SpatialDrawing, assembly: SpatialAssembly, name: str) -> Opened:
    """An assembly in space and what it asks; solids as they are in `assembly`."""
    reference = assembly.reference
    corners = np.vstack([m.surface.vertices @ p.R.T + p.at for p, m in zip(assembly.parts, assembly.made, strict=True)])
    (x0, y0, _), (x1, y1, _) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return Opened(
        name=name,
        gap=drawing.gap,
        notes=list(drawing.notes),
        size=(x0, y0, x1, y1),
        parts=[
            PartShape(part.name, (float(at[0]), float(at[1]), 0.0), [])
            for part, at in zip(assembly.parts, reference, strict=True)
        ],
        ignore=list(drawing.ignore),
        design=spatial_design(drawing),
        dimension=3,
        solids=solids_message(assembly),
    )


def spatial_design(drawing: SpatialDrawing) -> Design:
    """What an assembly in space asks, as a design.

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


def _goals(goals: tuple[SpatialGoal, ...]) -> Goals:
    entries = []
    for goal in goals:
        match goal:
            case SpatialPull(part, direction, point, weight):
                entries.append(GoalEntry(part, direction=direction, point=point, weight=weight))
            case SpatialTurn(part, axis, weight):
                entries.append(GoalEntry(part, turn=axis, weight=weight))
            case _ if goal.direction == DOWN and goal.weight == 1 and len(goals) == 1:
                return "weight"
            case _:
                raise InputError("weight: in the page everything sinks in -z, and nothing else is pulled")
    return entries


def solids_message(assembly: SpatialAssembly) -> Solids:
    """Surfaces about their reference points; parts that are alike share theirs."""
    reference = assembly.reference
    shapes: list[SolidShape] = []
    of: list[int] = []
    known: dict[tuple[int, bytes], int] = {}
    for part, made, at in zip(assembly.parts, assembly.made, reference, strict=True):
        key = (id(made), part.R.tobytes())
        if key not in known:
            known[key] = len(shapes)
            world = made.surface.vertices @ part.R.T + part.at
            shapes.append(SolidShape(packed(world - at, "<f4"), packed(made.surface.faces, "<u4")))
        of.append(known[key])
    aside = exploded_offsets(assembly)
    return Solids(shapes, of, _triples(reference), _triples(aside))


def _triples(points: Floats) -> list[tuple[float, float, float]]:
    return [(float(x), float(y), float(z)) for x, y, z in points]


def spatial_answer_message(answer: SpatialAnswer, command: str) -> FlexReply:
    """What an answer says, in the words of the commands."""
    return flex_reply(
        answer,
        command,
        spatial_headline(answer),
        fact_lines(answer),
        sure_rows(answer, spatial_sentence(answer), spatial_bound_sentence(answer)),
        spatial_contacts_message(answer.contacts),
    )


def spatial_contacts_message(contacts: Iterable[SpatialContact]) -> list[ContactEntry]:
    """Contacts with a force, the strongest first."""
    return [ContactEntry(c.parts, c.point, c.normal, c.force) for c in contacts if c.force > 0]


def spatial_check_message(found: SpatialDisassembly, command: str) -> CheckReply:
    """Whether it comes apart, who leaves in which order and how, and how sure that is."""
    return CheckReply(
        verdict=found.verdict,
        certainty=found.certainty,
        words=f"{found.verdict}: {check_sentence(found)}",
        sure=[
            ("verdict", f"{found.verdict}: {check_sentence(found)}"),
            ("certainty", found.certainty),
            ("took", f"{found.seconds:.2f} seconds, {found.questions} questions"),
        ],
        escapes=[LeavingEntry(list(e.parts), departure_words(found, e)) for e in found.escapes],
        spins=[],
        remains=list(found.remains),
        border=None,
        command=command,
    )


def spatial_frames(assembly: SpatialAssembly, points: Floats) -> Floats:
    """Motions (k, n, 7) along a path (m, n, 6), evenly along it: displacements [mm] and quaternions x, y, z, w.

    Between two frames positions go straight and turns about one constant axis, as between waypoints; the first and the last of
    the path are as they are.
    """
    if len(points) == 1:
        return with_quaternions(points)
    most = max(2, min(MAX_FRAMES, MAX_FRAME_MOTIONS // max(1, len(assembly.parts))))
    return with_quaternions(along_path(assembly, points, np.linspace(0.0, 1.0, most)))
