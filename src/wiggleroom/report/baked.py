"""The live page as one file: answers at several gaps that need no server, and the same bundle that `serve` shows."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Sequence
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.analysis.answer import Answer
from wiggleroom.analysis.rank import Ranking
from wiggleroom.assembly.model import Assembly, place
from wiggleroom.drawing.assembly_writer import goal_entry
from wiggleroom.drawing.model import WHOLE, Part, Pull, Turn, W
from wiggleroom.report.html import answer_sure
from wiggleroom.report.ranking import ranking_sure
from wiggleroom.report.records import flex_record
from wiggleroom.report.text import escape
from wiggleroom.report.ways import way_frames
from wiggleroom.report.words import headline

Json = dict[str, Any]

_POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src blob: data:"
_DIGITS = 7
"""Outlines are told to so many digits of the drawing's size."""


def baked(
    answers: Sequence[Answer],
    *,
    name: str,
    ranking: Ranking | None = None,
    lost: tuple[float, float] | None = None,
    begin: float | None = None,
    command: str = "",
) -> str:
    """Answers at several gaps as one HTML page with a gap slider, films, contacts and how sure they are.

    Parameters
    ----------
    answers : sequence of Answer
        To the same question, one for each gap.
    name : str
        What the page is called, such as the name of the file.
    ranking : Ranking, optional
        Whose gap matters.
    lost : (float, float), optional [mm]
        Gaps between which the motion loses its end, from a `Sweep`.
    begin : float, optional [mm]
        The gap that is shown first; by default the smallest.
    command : str
        The command that makes the page.

    Raises
    ------
    ValueError
        Without an answer.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> answers = [wr.flex(wr.patterns.chain(2, joint="tee", gap=gap)) for gap in (0.01, 0.02)]
    >>> "b2 moves 0.02" in baked(answers, name="chain")
    True
    """
    if not answers:
        msg = "a page needs an answer"
        raise ValueError(msg)
    told: Json = {
        "opened": _opened(answers[0].assembly, name, begin),
        "answers": [_told(a, command) for a in sorted(answers, key=lambda a: a.assembly.gap)],
        "lost": lost,
    }
    if ranking is not None:
        told["rank"] = _ranked(ranking)
    data = json.dumps(told, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1, viewport-fit=cover">'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}"><meta name="color-scheme" content="light dark">'
        f'<link rel="icon" href="data:,"><title>{escape(name)}</title><style>{_shipped("page.css")}</style></head>\n'
        f'<body><div id="page"></div><script type="application/json" id="baked">{data}</script>\n'
        f'<script type="module">{_shipped("page.js")}</script></body></html>\n'
    )


def _shipped(name: str) -> str:
    text = (resources.files("wiggleroom.report") / "web" / name).read_text(encoding="utf-8")
    return text.replace("</script", "<\\/script")


def _opened(assembly: Assembly, name: str, begin: float | None) -> Json:
    """The drawing and what is asked, as the page's server tells them."""
    drawing = assembly.drawing
    rings = [_rings(part, assembly.size) for part in drawing.parts]
    corners = np.vstack([ring for one in rings for ring in one])
    whole = next((word for word, kind in WHOLE.items() if kind() in drawing.goals), None)
    return {
        "kind": "opened",
        "id": 0,
        "name": name,
        "gap": drawing.gap,
        "unit": "mm",
        "notes": [],
        "size": [*corners.min(axis=0).tolist(), *corners.max(axis=0).tolist()],
        "parts": [
            {"name": part.name, "at": [*part.at[:2], math.degrees(part.at[2])], "rings": [r.tolist() for r in one]}
            for part, one in zip(drawing.parts, rings, strict=True)
        ],
        "design": {
            "gap": drawing.gap if begin is None else begin,
            "extra": {},
            "fixed": [part.name for part in drawing.parts if part.fixed],
            "glue": [list(group) for group in drawing.glue],
            "goals": whole or [goal_entry(goal) for goal in drawing.goals if isinstance(goal, Pull | Turn | W)],
        },
    }


def _told(answer: Answer, command: str) -> Json:
    """One answer: what it says, its outlines, and the frames of its way."""
    record = flex_record(answer)
    said = {key: record[key] for key in ("objective", "verdict", "at_most", "collision_free", "path", "contacts")}
    frames = way_frames(answer.assembly, answer.waypoints).astype("<f4")
    rings = [[ring.tolist() for ring in _rings(part, answer.assembly.size)] for part in answer.assembly.parts]
    flex = said | {
        "kind": "flex",
        "id": 0,
        "headline": headline(answer),
        "sure": answer_sure(answer),
        "leaves": list(answer.leaves),
        "turns": list(answer.turns),
        "seconds": answer.seconds.get("total", 0.0),
        "rings": rings,
        "settled": True,
        "command": command,
    }
    return {"gap": answer.assembly.gap, "flex": flex, "frames": base64.b64encode(frames.tobytes()).decode()}


def _ranked(ranking: Ranking) -> Json:
    names = ranking.answer.assembly.names
    parts = {
        names[k]: {"mm_per_mm": float(ranking.looser[k]), "percent": float(ranking.percent[k])}
        for k in ranking.order.tolist()
    }
    note = "; ".join(line for _, line in ranking_sure(ranking)[1:])
    return {"kind": "rank", "id": 0, "parts": parts, "unique": bool(ranking.unique.all()), "note": note}


def _rings(part: Part, size: float) -> list[NDArray[np.float64]]:
    """Outlines and holes of a part at rest, in world coordinates [mm]."""
    digits = max(0, _DIGITS - math.floor(math.log10(size)))
    return [place(ring, part.at).round(digits) for r in part.regions for ring in (r.outer, *r.holes)]
