"""Rankings, checks and sweeps as the page reads them; a module of its own, because it imports all that works them out."""

from __future__ import annotations

from msgspec import UNSET

from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.disassembly.largest_gap import LargestGap
from wiggleroom.report.results.answer_words import per_gap
from wiggleroom.report.results.rank_words import ranking_sure
from wiggleroom.report.results.separability import border_sentence, check_sure, leaves, why
from wiggleroom.schema.study_replies import CheckReply, ImportanceEntry, JointEntry, LeavingEntry, RankReply, StepReply
from wiggleroom.sensitivity.rank import Ranking
from wiggleroom.sensitivity.sweep import SweepStep


def ranking_message(ranking: Ranking, command: str) -> RankReply:
    """Whose gap matters, of parts and of joints, the most important first."""
    names = ranking.answer.assembly.names
    return RankReply(
        parts={
            names[k]: ImportanceEntry(float(ranking.looser[k]), float(ranking.tighter[k]), float(ranking.percent[k]))
            for k in ranking.order.tolist()
        },
        joints=[
            JointEntry(
                (names[ranking.joints[k, 0]], names[ranking.joints[k, 1]]),
                float(ranking.joint_looser[k]),
                float(ranking.joint_percent[k]),
            )
            for k in ranking.joint_order.tolist()
        ],
        per=per_gap(ranking.answer.goals),
        unique=bool(ranking.unique.all()),
        note="by " + "; ".join(line for _, line in ranking_sure(ranking)),
        command=command,
    )


def check_message(found: Interlock, command: str, border: LargestGap | None = None) -> CheckReply:
    """Whether it comes apart, who leaves in which order and how, and how sure that is."""
    return CheckReply(
        verdict=found.verdict,
        certainty=found.certainty,
        words=f"{found.verdict}: {why(found)}",
        sure=check_sure(found),
        escapes=[LeavingEntry(list(e.parts), leaves(found, e)) for e in found.escapes],
        spins=list(found.spins),
        remains=list(found.remains),
        border=None if border is None else border_sentence(border),
        command=command,
    )


def step_message(step: SweepStep) -> StepReply:
    """One gap of a sweep."""
    at_most = UNSET if step.at_most is None else step.at_most
    return StepReply(
        gap=step.gap, objective=step.objective, verdict=step.verdict, checked=step.checked, at_most=at_most
    )
