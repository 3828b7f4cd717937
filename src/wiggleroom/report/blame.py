"""Pictures of a ranking, parts coloured by their importance, and of what was made tighter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wiggleroom.analysis.rank import Ranking
from wiggleroom.analysis.tighten import Tightening
from wiggleroom.report import frame, palette
from wiggleroom.report.picture import Tints, picture
from wiggleroom.report.words import headline, number, short, unit


def picture_of_ranking(ranking: Ranking, *, command: str = "") -> str:
    """Answer as an SVG picture, its parts coloured by how much their gap matters."""
    answer, names = ranking.answer, ranking.answer.assembly.names
    value = np.maximum(np.nan_to_num(ranking.looser), 0.0)
    most = float(value.max(initial=0.0))
    share = value / most if most > 0 else value
    per = f"{unit(answer.goals)} per mm of gap".strip()
    first = ranking.order[0]
    said = (
        f"{short(names[first])} matters most: {number(float(value[first]), 3)} {per}, {ranking.percent[first]:.0f} % of all",
        f"{answer.verdict}, gap {number(answer.assembly.gap)} mm",
    )
    legend = tuple(
        (frame.swatch(shade(level), palette.NEUTRAL[1]), f"{number(level * most, 2)}{f' {per}' if level == 1 else ''}")
        for level in (0.0, 0.25, 0.5, 1.0)
    )
    fill = {name: shade(s) for name, s in zip(names, share.tolist(), strict=True)}
    return picture(replace(answer, command=command), tints=Tints(fill, legend, headline(answer), said))


def shade(share: float) -> str:
    """Colour of an importance between 0 and 1.

    >>> shade(0.0), shade(1.0)
    ('#f3f1ec', '#b0508c')
    """
    place = min(max(share, 0.0), 1.0) * (len(palette.BLAME) - 1)
    low = min(int(place), len(palette.BLAME) - 2)
    mixed = (
        round(int(a, 16) + (place - low) * (int(b, 16) - int(a, 16)))
        for a, b in (
            (palette.BLAME[low][k : k + 2], palette.BLAME[low + 1][k : k + 2])
            for k in (1, 3, 5)
        )
    )  # fmt: skip
    return "#" + "".join(f"{v:02x}" for v in mixed)


def picture_of_tightening(found: Tightening, *, command: str = "") -> str:
    """The motion that is left, the tightened parts coloured."""
    answer = found.after
    fill = dict.fromkeys(answer.assembly.names, palette.NEUTRAL[0]) | dict.fromkeys(found.chosen, palette.CHOSEN)
    said = [
        f"instead of {number(found.before.objective or 0.0)}",
        f"{len(found.chosen)} parts to a gap of {number(found.gap)} mm",
    ]
    if len(found.random):
        said.append(f"{found.lowered:.0f} % less; as many at random: {found.lowered_at_random:.0f} %")
    legend = ((frame.swatch(palette.CHOSEN, palette.NEUTRAL[1]), "made tighter"),)
    return picture(replace(answer, command=command), tints=Tints(fill, legend, headline(answer), tuple(said)))
