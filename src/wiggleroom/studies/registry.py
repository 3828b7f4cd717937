"""All questions that are declared, and the question that a result answers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wiggleroom.studies.check import CheckQuestion
from wiggleroom.studies.clearances import ClearancesQuestion
from wiggleroom.studies.flex import FlexQuestion
from wiggleroom.studies.gap import GapQuestion
from wiggleroom.studies.plan import PlanQuestion
from wiggleroom.studies.question import Question
from wiggleroom.studies.rank import RankQuestion
from wiggleroom.studies.sample import SampleQuestion
from wiggleroom.studies.sweep import SweepQuestion
from wiggleroom.studies.tighten import TightenQuestion
from wiggleroom.studies.tolerances import TolerancesQuestion

if TYPE_CHECKING:
    from wiggleroom.report.finding import Finding

QUESTIONS: tuple[type[Question], ...] = (
    FlexQuestion, CheckQuestion, PlanQuestion, GapQuestion, RankQuestion, TightenQuestion, SweepQuestion, SampleQuestion,
    TolerancesQuestion, ClearancesQuestion,
)  # fmt: skip
BY_NAME = {question.name: question for question in QUESTIONS}

_OF_RESULTS: dict[str, type[Question]] = {
    "AllowableGap": GapQuestion,
    "Clearances": ClearancesQuestion,
    "Ranking": RankQuestion,
    "Sample": SampleQuestion,
    "Sweep": SweepQuestion,
    "Tightening": TightenQuestion,
    "WorstCase": TolerancesQuestion,
}
"""By the name of what they return, whose module is slow to import."""


def finding_of(found: Any, command: str = "") -> Finding | None:
    """What a result of a declared question says; None of any other result."""
    question = _OF_RESULTS.get(type(found).__name__)
    return None if question is None else question.finding(found, command)
