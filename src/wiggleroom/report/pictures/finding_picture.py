"""Figures of findings as SVG: curves, histograms, bars, and parts coloured by what was found of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wiggleroom.errors import InputError
from wiggleroom.report.finding import Bars, Curve, Figure, Finding, Histogram, PartTints
from wiggleroom.report.pictures import frame, palette
from wiggleroom.report.pictures.picture import PartColours, picture
from wiggleroom.report.pictures.plots import Heading, bars, curve, histogram
from wiggleroom.report.results.answer_words import number
from wiggleroom.search.answer import Answer


def picture_of_finding(finding: Finding, *, command: str = "") -> str:
    """The figure of a finding, or the motion it is about with coloured parts, as an SVG picture.

    Raises
    ------
    InputError
        If there is neither.
    """
    if finding.figure is not None:
        return figure_svg(finding.figure, Heading(finding.title, subtitle(finding), command))
    if isinstance(finding.motion, Answer) and finding.tints is not None:
        tints = part_colours(finding.tints, finding.assembly.names)
        return picture(replace(finding.motion, command=command), tints=tints, said=finding.facts)
    message = f"{finding.title}: there is nothing to draw"
    raise InputError(message)


def subtitle(finding: Finding) -> Sequence[str]:
    """Facts under the title of a picture; how sure it is where there are none."""
    return finding.facts or [f"{term}: {sentence}" for term, sentence in finding.sure]


def figure_svg(figure: Figure, heading: Heading) -> str:
    """A figure as SVG."""
    match figure:
        case Curve():
            return curve(figure, heading)
        case Histogram():
            return histogram(figure, heading)
        case Bars():
            return bars(figure, heading)


def part_colours(tints: PartTints, names: Sequence[str]) -> PartColours:
    """Colours of parts by name, and their legend; what is below nothing, or not known, counts as nothing."""
    line = palette.NEUTRAL[1]
    if not tints.unit:
        fill = dict.fromkeys(names, palette.NEUTRAL[0]) | dict.fromkeys(tints.values, palette.CHOSEN)
        return PartColours(fill, ((frame.swatch(palette.CHOSEN, line), tints.legend),))
    value = np.maximum(np.nan_to_num([tints.values.get(name, 0.0) for name in names]), 0.0)
    most = float(value.max(initial=0.0))
    share = value / most if most > 0 else value
    legend = tuple(
        (frame.swatch(shade(level), line), f"{number(level * most, 2)}{f' {tints.unit}' if level == 1 else ''}")
        for level in (0.0, 0.25, 0.5, 1.0)
    )
    return PartColours({name: shade(s) for name, s in zip(names, share.tolist(), strict=True)}, legend)


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
