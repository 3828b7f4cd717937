"""Pictures of answers, as SVG text that is the same for the same answer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Pull, part_of
from wiggleroom.report.pictures import frame, layout, palette
from wiggleroom.report.pictures.arrows import Mark, contact_mark, goal_mark, obstacles
from wiggleroom.report.pictures.layout import View
from wiggleroom.report.pictures.names import names_group
from wiggleroom.report.pictures.part_paths import (
    PartPaths,
    colour_attributes,
    line_width,
    rest_outlines,
    role,
    spot,
    use,
)
from wiggleroom.report.pictures.text import escape
from wiggleroom.report.results.answer_words import facts, headline, number

if TYPE_CHECKING:
    from wiggleroom.search.answer import Answer

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class PartColours:
    """Colours that say something about parts: fill by name, and what the legend says."""

    fill: dict[str, str]
    legend: tuple[frame.LegendEntry, ...]


@dataclass(frozen=True)
class LegendWords:
    """What the legend calls the parts that are pulled, their arrows, and the thin outlines."""

    pulled: str = "pulled"
    arrow: str = "gained along the pull"
    rest: str = "at rest"


FLEX_WORDS = LegendWords()
"""Of an answer."""


def picture(
    answer: Answer,
    *,
    magnify: float | None = None,
    tints: PartColours | None = None,
    title: str | None = None,
    said: Sequence[str] | None = None,
    words: LegendWords = FLEX_WORDS,
) -> str:
    """Answer as an SVG picture.

    Parts at rest are thin grey lines under the moved parts; fixed parts are red, pulled parts blue; contacts are dots
    with arrows as long as their force.

    Parameters
    ----------
    magnify : float, optional
        Factor by which the motion is enlarged; by default 1, unless the motion is too small to be seen.
        The picture says so.
    tints : PartColours, optional
        Colours of the parts in place of the usual ones.
    title, said : str and sequence of str, optional
        Headline and facts in place of those of the answer.
    words : LegendWords
        Of what the answer stands for.
    """
    factor = layout.magnification(answer.assembly, answer.motion) if magnify is None else float(magnify)
    said = [*(facts(answer) if said is None else said), *([f"motion x {number(factor)}"] if factor != 1 else [])]
    assembly, rest = answer.assembly, answer.assembly.rest
    shown = rest + factor * answer.motion
    both = np.vstack([layout.boxes(assembly, rest), layout.boxes(assembly, shown)])
    box = layout.bounding_box(both)
    canvas = layout.view(box, 0.0).canvas
    title = title or headline(answer)
    head, below = frame.header(title, said, canvas - 2 * palette.MARGIN)
    view = layout.view(box, below + palette.HEAD_SPACING)
    rooms = (both[len(rest) :, 2:] - both[len(rest) :, :2]).max(axis=1) * view.scale
    room = float(np.median(rooms))
    rows = {name: k for k, name in enumerate(assembly.names)}
    marked = [(g, rows[name]) for g in answer.goals if (name := part_of(g)) in rows]
    marks = [contact_mark(view, answer, rest, shown, room)]
    marks += [goal_mark(view, assembly, g, rest, shown, rooms[row]) for g, row in marked]
    pulled = {assembly.names[row] for _, row in marked}
    body = drawn_parts(view, assembly, shown, colours_of(assembly, pulled, tints), marks, room, rest)
    legend = _legend(answer, bool(pulled), tints, words)
    foot, height = frame.footer(view, view.y + view.height + palette.HEAD_SPACING + 16, legend, answer.command)
    return frame.document(view.canvas, height, title, said, answer.command, [*head, *body, *foot])


def colours_of(assembly: Assembly, pulled: set[str], tints: PartColours | None = None) -> dict[str, tuple[str, str]]:
    """Colours inside and of the outline of every part: those of its role, with others inside where parts are tinted."""
    role_colours = {part.name: palette.ROLE_COLOURS[role(part, pulled)] for part in assembly.parts}
    return {
        name: (fill if tints is None else tints.fill[name], stroke) for name, (fill, stroke) in role_colours.items()
    }


def drawn_parts(
    view: View,
    assembly: Assembly,
    shown: Floats,
    colours: Mapping[str, tuple[str, str]],
    marks: list[Mark],
    room: float,
    rest: Floats | None = None,
) -> list[str]:
    """Everything inside the drawing, bottom first: rest outlines, parts in their colours, marks, names."""
    strong = {name for name, (_, outline) in colours.items() if outline != palette.NEUTRAL[1]}
    shapes, still, places = PartPaths(view.scale), [], []
    drawn: dict[tuple[str, str], list[str]] = {own: [] for own in palette.ROLE_COLOURS.values()}
    for k, (part, pose) in enumerate(zip(assembly.parts, shown.tolist(), strict=True)):
        shape, place = shapes.of(part), spot(view, part, pose)
        if rest is not None:
            still.append(use(shape, spot(view, part, tuple(rest[k].tolist()))))
        drawn.setdefault(colours[part.name], []).append(use(shape, place, escape(part.name)))
        places.append((part.name, shape, place))
    tree = obstacles(marks) if marks else shapely.STRtree([])
    line = line_width(room)
    found = [f"<defs>{shapes.definitions}</defs>"]
    if still:
        found.append(rest_outlines("\n".join(still), line))
    if assembly.drawing.ignore:  # parts lie above each other: what stands lies at the bottom
        drawn = {palette.ROLE_COLOURS["fixed"]: drawn.pop(palette.ROLE_COLOURS["fixed"]), **drawn}
    for own, uses in drawn.items():
        if uses:
            style = colour_attributes(own, line)
            found.append(f'<g fill-rule="evenodd" {style} stroke-linejoin="round">' + "\n".join(uses) + "</g>")
    found += [mark.svg for mark in marks]
    found.append(names_group(places, strong, room, tree))
    return found


_ARROW = (
    f'<path d="M3,6h7" stroke="{palette.MOTION}" stroke-width="2"/><path d="M16,6l-7,-3.5v7z" fill="{palette.MOTION}"/>'
    f'<circle cx="3" cy="6" r="2.4" fill="{palette.PAPER}" stroke="{palette.MOTION}" stroke-width="1.4"/>'
)


_FORCE_ARROW = (
    f'<path d="M3,6h7" stroke="{palette.FORCE}" stroke-width="1.6"/>'
    f'<path d="M16,6l-7,-3v6z" fill="{palette.FORCE}"/><circle cx="3" cy="6" r="2.6" fill="{palette.INK}"/>'
)


def _legend(answer: Answer, asked: bool, tints: PartColours | None, words: LegendWords) -> list[frame.LegendEntry]:
    """Only what the picture shows."""
    found = [] if tints is None else list(tints.legend)
    filled = tints is None
    if any(p.fixed for p in answer.assembly.parts):
        found.append((frame.swatch(palette.FIXED[0] if filled else palette.PAPER, palette.FIXED[1]), "fixed"))
    if asked:
        found.append((frame.swatch(palette.PULLED[0] if filled else palette.PAPER, palette.PULLED[1]), words.pulled))
        if any(isinstance(g, Pull) for g in answer.goals):
            found.append((_ARROW, words.arrow))
    found.append((frame.swatch("none", palette.REST), words.rest))
    if any(c.force > 0 for c in answer.contacts):
        found.append((_FORCE_ARROW, "contact and force"))
    return found
