"""How the answer is told: whose gap matters."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from wiggleroom.report.finding import Cell, Finding, PartTints, Table
from wiggleroom.report.results.answer_words import headline, number, per_gap, short
from wiggleroom.report.results.json_results import dimension
from wiggleroom.schema.study_schema import JointImportance, PartImportance, RankResult

if TYPE_CHECKING:
    from wiggleroom.sensitivity.rank import Ranking


MAX_RANKED_PARTS, MAX_RANKED_JOINTS = 15, 8
"""Rows that the terminal shows."""


def finding(found: Ranking, command: str = "") -> Finding:
    """Parts and joints, the most important first, and the parts coloured."""
    from wiggleroom.report.results.rank_words import ranking_sure

    answer = found.answer
    names = answer.assembly.names

    def page() -> dict[str, Any]:
        from wiggleroom.report.page.study_messages import ranking_message

        return {"rank": ranking_message(found, command), "tab": "gaps"}

    return Finding(
        title=headline(answer),
        record=partial(_record, found, command),
        assembly=answer.assembly,
        facts=_facts(found),
        sure=ranking_sure(found),
        sections=(_parts(found), _joints(found)),
        data=_data(found),
        motion=answer,
        tints=PartTints(dict(zip(names, found.importance.tolist(), strict=True)), per_gap(answer.goals)),
        tab="Gaps",
        page=page,
    )


def _facts(found: Ranking) -> list[str]:
    answer, first = found.answer, found.order[0]
    value = f"{number(max(float(found.importance[first]), 0.0), 3)} {per_gap(answer.goals)}"
    return [
        f"{short(answer.assembly.names[first])} matters most: {value}, {found.percent[first]:.0f} % of all",
        f"{answer.verdict}, gap {number(answer.assembly.gap)} mm",
    ]


def _parts(found: Ranking) -> Table:
    both, names = not found.unique.all(), found.answer.assembly.names
    rows: list[tuple[Cell, ...]] = [
        (names[k], float(found.looser[k]), *([float(found.tighter[k])] if both else []), float(found.percent[k]))
        for k in found.order.tolist()
    ]
    left = 100 - float(found.percent[found.order[:MAX_RANKED_PARTS]].sum())
    heads = ("part", per_gap(found.answer.goals), *(["if tighter"] if both else []), "%")
    rest: list[Cell] = [*[""] * (len(heads) - 2), max(left, 0.0)]
    return Table(heads, rows, "Parts", MAX_RANKED_PARTS, rest=rest)


def _joints(found: Ranking) -> Table:
    both, names = not found.joint_unique.all(), found.answer.assembly.names
    rows: list[tuple[Cell, ...]] = [
        (
            " | ".join(short(names[i]) for i in found.joints[k].tolist()),
            float(found.joint_looser[k]),
            *([float(found.joint_tighter[k])] if both else []),
            float(found.joint_percent[k]),
        )
        for k in found.joint_order.tolist()
    ]
    return Table(
        ("joint", per_gap(found.answer.goals), *(["if tighter"] if both else []), "%"),
        rows,
        "Joints",
        MAX_RANKED_JOINTS,
    )


def _data(found: Ranking) -> Table:
    names = found.answer.assembly.names
    parts: list[tuple[Cell, ...]] = [
        ("part", names[k], "", float(found.looser[k]), float(found.tighter[k]), float(found.percent[k]))
        for k in found.order.tolist()
    ]
    joints: list[tuple[Cell, ...]] = [
        ("joint", names[i], names[j], float(found.joint_looser[k]), None, float(found.joint_percent[k]))
        for k, (i, j) in zip(found.joint_order.tolist(), found.joints[found.joint_order].tolist(), strict=True)
    ]
    return Table(("kind", "name", "other", "per_mm", "tighter_per_mm", "percent"), [*parts, *joints])


def _record(found: Ranking, command: str) -> RankResult:
    answer, names = found.answer, found.answer.assembly.names
    parts = {
        names[k]: PartImportance(
            float(found.looser[k]),
            float(found.percent[k]),
            float(found.tighter[k]),
            float(found.by_duals[k]),
            bool(found.unique[k]),
            float(found.importance[k]),
        )
        for k in found.order.tolist()
    }
    joints = [
        JointImportance(
            (names[found.joints[k, 0]], names[found.joints[k, 1]]),
            float(found.joint_looser[k]),
            float(found.joint_percent[k]),
            bool(found.joint_unique[k]),
            float(found.joint_tighter[k]),
            float(found.joint_importance[k]),
        )
        for k in found.joint_order.tolist()
    ]
    return RankResult(
        dimension=dimension(answer.assembly),
        objective=answer.objective,
        verdict=answer.verdict,
        by=found.by,
        parts=parts,
        joints=joints,
        ranges=found.ends,
        virtual_percent=float(100 * found.virtual),
        notes=list(answer.assembly.drawing.notes),
        command=command,
    )
