"""Pictures of a ranking, parts coloured by their importance, and of what was made tighter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.report.pictures import frame, palette
from wiggleroom.report.pictures.picture import PartColours, picture
from wiggleroom.report.results.answer_words import number, per_gap, short, unit
from wiggleroom.report.results.study_results import at_random, reduction_text
from wiggleroom.search.answer import Answer
from wiggleroom.sensitivity.rank import Ranking
from wiggleroom.sensitivity.tighten import Tightening


def picture_of_ranking(ranking: Ranking, *, command: str = "") -> str:
    """Answer as an SVG picture, its parts coloured by how much their gap matters."""
    answer = ranking.answer
    tints = tinted(answer, ranking.importance, per_gap(answer.goals))
    return picture(replace(answer, command=command), tints=tints, said=ranking_facts(ranking))


def ranking_facts(ranking: Ranking) -> list[str]:
    """Facts under the headline of a ranking."""
    answer, first = ranking.answer, ranking.order[0]
    value = f"{number(max(float(ranking.importance[first]), 0.0), 3)} {per_gap(answer.goals)}"
    return [
        f"{short(answer.assembly.names[first])} matters most: {value}, {ranking.percent[first]:.0f} % of all",
        f"{answer.verdict}, gap {number(answer.assembly.gap)} mm",
    ]


def tinted(answer: Answer, values: NDArray[np.float64], what: str) -> PartColours:
    """Colours of the parts of an answer by a number each, from nothing to the largest.

    Parameters
    ----------
    values : (n,) float64
        What is below nothing, or not known, counts as nothing.
    what : str
        Unit of the numbers, for the legend.
    """
    value = np.maximum(np.nan_to_num(values), 0.0)
    most = float(value.max(initial=0.0))
    share = value / most if most > 0 else value
    legend = tuple(
        (frame.swatch(shade(level), palette.NEUTRAL[1]), f"{number(level * most, 2)}{f' {what}' if level == 1 else ''}")
        for level in (0.0, 0.25, 0.5, 1.0)
    )
    fill = {name: shade(s) for name, s in zip(answer.assembly.names, share.tolist(), strict=True)}
    return PartColours(fill, legend)


def shade(share: float) -> str:
    """Colour of an importance between 0 and 1.

    >>> shade(0.0), shade(1.0)
    ('#f3f1ec', '#b0508c')
    """
    place = min(max(share, 0.0), 1.0) * (len(palette.IMPORTANCE_COLOURS) - 1)
    low = min(int(place), len(palette.IMPORTANCE_COLOURS) - 2)
    mixed = (
        round(int(a, 16) + (place - low) * (int(b, 16) - int(a, 16)))
        for a, b in (
            (palette.IMPORTANCE_COLOURS[low][k : k + 2], palette.IMPORTANCE_COLOURS[low + 1][k : k + 2])
            for k in (1, 3, 5)
        )
    )  # fmt: skip
    return "#" + "".join(f"{v:02x}" for v in mixed)


def picture_of_tightening(found: Tightening, *, command: str = "") -> str:
    """The motion that is left, the tightened parts coloured."""
    answer = found.after
    fill = dict.fromkeys(answer.assembly.names, palette.NEUTRAL[0]) | dict.fromkeys(found.chosen, palette.CHOSEN)
    legend = ((frame.swatch(palette.CHOSEN, palette.NEUTRAL[1]), "made tighter"),)
    tints = PartColours(fill, legend)
    return picture(replace(answer, command=command), tints=tints, said=tightening_facts(found))


def tightening_facts(found: Tightening) -> list[str]:
    """Facts under the headline of what tightening leaves."""
    what, many = unit(found.before.goals), len(found.chosen)
    said = [
        f"instead of {number(found.before.objective or 0.0)} {what}".rstrip(),
        f"{many} {'part' if many == 1 else 'parts'} to a gap of {number(found.gap)} mm",
    ]
    if len(found.random):
        others = "the mean of all such choices" if found.chosen_by == "all" else "as many at random"
        said.append(f"{reduction_text(found.lowered, 0)}; {others}: {at_random(found, 0)}")
    return said
