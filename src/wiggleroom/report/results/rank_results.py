"""A ranking as JSON and as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wiggleroom.report.results.answer_words import headline, number, per_gap, short
from wiggleroom.report.results.json_results import dimension
from wiggleroom.report.results.table import columns
from wiggleroom.schema.study_schema import JointImportance, PartImportance, RankResult
from wiggleroom.sensitivity.rank import Ranking

if TYPE_CHECKING:
    from rich.console import Group

MAX_RANKED_PARTS = 15
"""Rows of the table of parts."""
MAX_RANKED_JOINTS = 8
"""Rows of the table of joints."""


def rank_result(ranking: Ranking, command: str = "") -> RankResult:
    """Everything `rank --json` says, parts and joints in order of importance."""
    answer, names = ranking.answer, ranking.answer.assembly.names
    parts = {
        names[k]: PartImportance(
            float(ranking.looser[k]),
            float(ranking.percent[k]),
            float(ranking.tighter[k]),
            float(ranking.by_duals[k]),
            bool(ranking.unique[k]),
            float(ranking.importance[k]),
        )
        for k in ranking.order.tolist()
    }
    joints = [
        JointImportance(
            (names[ranking.joints[k, 0]], names[ranking.joints[k, 1]]),
            float(ranking.joint_looser[k]),
            float(ranking.joint_percent[k]),
            bool(ranking.joint_unique[k]),
            float(ranking.joint_tighter[k]),
            float(ranking.joint_importance[k]),
        )
        for k in ranking.joint_order.tolist()
    ]
    return RankResult(
        dimension=dimension(answer.assembly),
        objective=answer.objective,
        verdict=answer.verdict,
        by=ranking.by,
        parts=parts,
        joints=joints,
        ranges=ranking.ends,
        virtual_percent=float(100 * ranking.virtual),
        notes=list(answer.assembly.drawing.notes),
        command=command,
    )


def rank_table(ranking: Ranking) -> Group:
    """Page that `rank` prints."""
    from rich.console import Group
    from rich.text import Text

    answer, names = ranking.answer, ranking.answer.assembly.names
    both = not ranking.unique.all()
    per = per_gap(answer.goals)
    found = columns("part", per, *(["if tighter"] if both else []), "%")
    for k in ranking.order[:MAX_RANKED_PARTS].tolist():
        side = [number(ranking.tighter[k])] if both else []
        found.add_row(short(names[k]), number(ranking.looser[k]), *side, f"{ranking.percent[k]:.1f}")
    rest = len(names) - MAX_RANKED_PARTS
    if rest > 0:
        left = 100 - ranking.percent[ranking.order[:MAX_RANKED_PARTS]].sum()
        found.add_row(f"... and {rest} more", "", *([""] if both else []), f"{max(left, 0.0):.1f}", style="dim")
    ranged = not ranking.joint_unique.all()
    joints = columns("joint", per, *(["if tighter"] if ranged else []), "%")
    order = ranking.joint_order
    for k in order[:MAX_RANKED_JOINTS].tolist():
        pair = " | ".join(short(names[i]) for i in ranking.joints[k].tolist())
        side = [number(ranking.joint_tighter[k])] if ranged else []
        joints.add_row(pair, number(ranking.joint_looser[k]), *side, f"{ranking.joint_percent[k]:.1f}")
    if len(order) > MAX_RANKED_JOINTS:
        joints.add_row(f"... and {len(order) - MAX_RANKED_JOINTS} more", "", *([""] if ranged else []), "", style="dim")
    lines = [Text(f"{term + ':':<9} {line}") for term, line in ranking_sure(ranking)]
    return Group(Text(headline(answer), style="bold"), Text(), found, Text(), joints, Text(), *lines)


BY = {"duals": "the forces that hold the answer", "differences": "answers with each part a little smaller"}
"""What a ranking is worked out from."""


def ranking_sure(ranking: Ranking) -> list[tuple[str, str]]:
    """How sure the ranking is: a word and a sentence each."""
    boundary = "faces" if dimension(ranking.answer.assembly) == 3 else "outline"
    said = [("by", f"{ranking.by}: {BY[ranking.by]}; extra gap moves a part's own {boundary} inward by half of it")]
    if not ranking.unique.all():
        said.append(("unique", ranking_unique(ranking)))
    if ranking.virtual > 1e-6:
        held = f"{number(100 * ranking.virtual, 2)} % of the force is held where nothing touches: these numbers are no surer than that"
        said.append(("walls", held))
    return said


def ranking_unique(ranking: Ranking) -> str:
    """Say for how many parts both sides of a derivative differ."""
    many = int((~ranking.unique).sum())
    ends = "" if ranking.ends == "whole" else " (at least so wide)"
    parts = f"{many} {'part' if many == 1 else 'parts'}"
    return f"not for {parts}: a looser and a tighter gap count differently{ends}; order and % by their middle"
