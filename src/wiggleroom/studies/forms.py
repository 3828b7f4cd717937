"""Panels of the page that ask declared questions."""

from __future__ import annotations

import dataclasses
import inspect
import typing
from typing import Any, Literal

from wiggleroom.schema.study_replies import StudyField, StudyForm
from wiggleroom.studies.question import Option, Question
from wiggleroom.studies.registry import QUESTIONS


def study_forms() -> list[StudyForm]:
    """A panel for each question that has a heading."""
    return [_form(question) for question in QUESTIONS if question.heading]


def _form(question: type[Question]) -> StudyForm:
    return StudyForm(
        of=question.name,
        title=question.heading,
        text=(inspect.getdoc(question) or "").partition("\n")[0],
        button=question.button,
        spatial=question.spatial,
        needs_end=question.needs_end,
        fields=_fields(question),
    )


def _fields(question: type[Question]) -> list[StudyField]:
    """Options as the panel shows them; those without an `Option` are left out."""
    found, kinds = [], typing.get_type_hints(question, include_extras=True)
    for field in dataclasses.fields(question):
        kind, *shown = typing.get_args(kinds[field.name]) if hasattr(kinds[field.name], "__metadata__") else (None,)
        option = next((one for one in shown if isinstance(one, Option)), None)
        if option is not None:
            default = None if field.default is dataclasses.MISSING else field.default
            found.append(
                StudyField(
                    name=field.name,
                    title=option.title,
                    kind=_kind(kind),
                    unit=option.unit,
                    least=option.least,
                    default=default if option.suggested is None else option.suggested,
                    of_gap=option.of_gap,
                    of_parts=option.of_parts,
                )
            )
    return found


def _kind(kind: Any) -> Literal["number", "count", "flag"]:
    kinds = typing.get_args(kind) or (kind,)
    return "flag" if bool in kinds else "count" if int in kinds else "number"
