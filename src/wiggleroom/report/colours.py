"""Numbers as colours on the parts, such as whose gap matters most."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.model import Assembly
from wiggleroom.errors import InputError
from wiggleroom.report import frame, layout, palette
from wiggleroom.report.names import label, usual
from wiggleroom.report.shapes import Shapes, spot, use
from wiggleroom.report.text import escape
from wiggleroom.report.words import number, short

Floats = NDArray[np.float64]

_GAP = 30.0
_UP = ("#f5f7dd", "#b9e1b6", "#62bcc2", "#3088ba", "#274f96")
_DOWN = ("#fdf4e6", "#fdd9a5", "#f0a656", "#c96f1b", "#8a430a")
"""From nothing to the largest number; both grow darker evenly, so that they hold for colour-blind eyes and in grey."""
_DARK = 0.68


def picture_of_values(
    assembly: Assembly,
    values: Floats,
    *,
    label_of: str,
    title: str,
    facts: Sequence[str] = (),
    command: str = "",
) -> str:
    """Parts at rest as an SVG picture, the colour of each by its number.

    Parameters
    ----------
    values : (n,) float64
        One for each part; where they are below nothing, towards brown. Not finite: no colour.
    label_of : str
        What the numbers are, with their unit.

    Raises
    ------
    InputError
        If there are not as many values as parts.
    """
    values = np.asarray(values, dtype=float)
    if values.shape != (len(assembly.parts),):
        finding = f"values have shape {values.shape}: there must be one for each of {len(assembly.parts)} parts"
        raise InputError(finding)
    largest = float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
    share = values / (largest or 1.0)
    box = layout.extent(layout.boxes(assembly, assembly.rest))
    top, below = frame.header(title, facts, layout.view(box, 0.0).canvas - 2 * palette.MARGIN)
    view = layout.view(box, below + _GAP)
    shapes = Shapes(view.scale, "v")
    of = [shapes.of(p) for p in assembly.parts]
    places = [spot(view, p, p.at) for p in assembly.parts]
    rooms = [float(np.ptp(shapely.get_coordinates(s.polygon), axis=0).max()) for s in of]
    room = float(np.median(rooms))
    drawn, names = [], []
    size, nothing = usual([(short(n), s) for n, s in zip(assembly.names, of, strict=True)], room), shapely.STRtree([])
    for part, shape, place, value, t in zip(assembly.parts, of, places, values.tolist(), share.tolist(), strict=True):
        colour = _colour(t)
        drawn.append(f'<g fill="{colour}">{use(shape, place, f"{escape(part.name)}: {number(value)}")}</g>')
        ink = palette.PAPER if np.isfinite(t) and abs(t) > _DARK else palette.INK
        names.append(f'<g fill="{ink}">{label(short(part.name), shape, place, size, nothing)}</g>')
    defs = "".join(f'<path id="{s.key}" d="{s.path}"/>' for s in shapes.known.values())
    line = min(max(0.015 * room, 0.3), 1.0)
    body = [
        *top,
        f"<defs>{defs}</defs>",
        f'<g fill-rule="evenodd" stroke="{palette.NEUTRAL[1]}" stroke-width="{line:.2f}">' + "\n".join(drawn) + "</g>",
        f'<g text-anchor="middle">{"".join(names)}</g>',
    ]
    steps = [-1.0, -0.5, 0.0, 0.5, 1.0] if (share < 0).any() else [0.0, 0.25, 0.5, 0.75, 1.0]
    legend = [(frame.swatch(_colour(t), palette.NEUTRAL[1]), number(t * largest, 3)) for t in steps if largest or not t]
    if not np.isfinite(values).all():
        legend.append((frame.swatch(palette.PAPER, palette.NEUTRAL[1]), "not known"))
    legend[0] = (legend[0][0], f"{label_of}: {legend[0][1]}")
    foot, height = frame.footer(view, view.y + view.height + _GAP + 16, legend, command)
    return frame.document(view.canvas, height, title, facts, command, [*body, *foot])


def _colour(share: float) -> str:
    """Colour of a number as a share of the largest, from -1 to 1."""
    if not np.isfinite(share):
        return palette.PAPER
    ramp = np.array([list(bytes.fromhex(c[1:])) for c in (_UP if share >= 0 else _DOWN)], dtype=float)
    at = min(abs(share), 1.0) * (len(ramp) - 1)
    k = min(int(at), len(ramp) - 2)
    mixed = ramp[k] + (at - k) * (ramp[k + 1] - ramp[k])
    return "#" + bytes(round(c) for c in mixed.tolist()).hex()
