"""How sure a ranking is, in words."""

from __future__ import annotations

from wiggleroom.report.results.answer_words import number
from wiggleroom.sensitivity.rank import Ranking

BY = {"duals": "the forces that hold the answer", "differences": "answers with each part a little smaller"}
"""What a ranking is worked out from."""


def ranking_sure(ranking: Ranking) -> list[tuple[str, str]]:
    """How sure the ranking is: a word and a sentence each."""
    boundary = "faces" if ranking.answer.assembly.dimension == 3 else "outline"
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
