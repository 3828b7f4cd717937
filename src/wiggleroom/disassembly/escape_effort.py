"""How much work goes into looking for the next parts that leave, and what is known from other gaps."""

from __future__ import annotations

from dataclasses import dataclass, field

from wiggleroom.disassembly.escape_by_pairs import NamedPairs
from wiggleroom.disassembly.escape_search import MAX_QUESTIONS, GoalSequence
from wiggleroom.disassembly.passages_by_gap import PassagesByGap
from wiggleroom.disassembly.slide_search import WORK_BUDGET

BOXES_FOR_ONE_BODY = 150_000
"""Boxes judged at most where one body alone can leave; a few seconds."""


@dataclass(frozen=True, eq=False)
class EscapeEffort:
    """How long is looked for the next parts that leave.

    Parameters
    ----------
    boxes : int
        Boxes of motions judged at most for the only body that can leave, before largest motions are searched.
    questions : int
        Largest motions searched at most.
    work : float
        Work of the search over slides, in pairs of edges compared.
    passages : PassagesByGap
        Those known from other gaps of the assembly at rest; what is found is added.
    exits : list of goals
        What led apart at other gaps, the newest last, which is asked first; what is found is added.
    passed : list of pairs of names
        The same of bodies that were led out.
    """

    boxes: int = BOXES_FOR_ONE_BODY
    questions: int = MAX_QUESTIONS
    work: float = WORK_BUDGET
    passages: PassagesByGap = field(default_factory=PassagesByGap)
    exits: list[GoalSequence] = field(default_factory=list)
    passed: list[NamedPairs] = field(default_factory=list)
