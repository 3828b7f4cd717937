"""Pictures of studies of gaps in space: parts coloured by what their gap is worth, or by whether they were made tighter."""

from __future__ import annotations

from pathlib import Path

from wiggleroom.report import palette
from wiggleroom.report.importance_picture import ranking_facts, shade, tightening_facts
from wiggleroom.report.spatial_picture import draw_separation, write_moved_parts
from wiggleroom.report.spatial_table import spatial_headline
from wiggleroom.sensitivity.gap_trials import AllowableGap
from wiggleroom.sensitivity.rank import Ranking
from wiggleroom.sensitivity.tighten import Tightening
from wiggleroom.spatial.spatial_disassembly import SpatialDisassembly


def draw_spatial_study(found: Ranking | Tightening | AllowableGap, path: Path) -> None:
    """Write a picture of a study of an assembly in space.

    Raises
    ------
    InputError
        If the name has another ending than .svg, .png or .glb.
    """
    match found:
        case Ranking():
            value = found.importance.clip(min=0)
            most = float(value.max(initial=0.0)) or 1.0
            fill = [_rgb(shade(float(v) / most)) for v in value]
            answer, facts = found.answer, ranking_facts(found)
        case Tightening():
            answer, facts = found.after, tightening_facts(found)
            chosen, other = _rgb(palette.CHOSEN), _rgb(palette.NEUTRAL[0])
            fill = [chosen if name in found.chosen else other for name in answer.assembly.names]
        case AllowableGap():
            held, apart = found.sides
            state: SpatialDisassembly = apart or held
            draw_separation(state, path)
            return
    lines = [spatial_headline(answer), ", ".join(facts)]
    write_moved_parts(answer.assembly, answer.motion, path, lines, answer.contacts, fill)


def _rgb(colour: str) -> tuple[int, int, int]:
    """Red, green and blue of "#rrggbb".

    >>> _rgb("#0a10ff")
    (10, 16, 255)
    """
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
