"""Colours of lines and fills, however a file spells them."""

from __future__ import annotations

import re
from colorsys import hls_to_rgb

RED = "#ff0000"
"""A part filled with this stands."""
NAMES = {
    "black": "#000000", "white": "#ffffff", "red": RED, "lime": "#00ff00", "green": "#008000", "blue": "#0000ff",
    "yellow": "#ffff00", "cyan": "#00ffff", "aqua": "#00ffff", "magenta": "#ff00ff", "fuchsia": "#ff00ff",
    "gray": "#808080", "grey": "#808080", "silver": "#c0c0c0", "maroon": "#800000", "navy": "#000080",
    "olive": "#808000", "purple": "#800080", "teal": "#008080", "orange": "#ffa500", "brown": "#a52a2a",
    "pink": "#ffc0cb", "lightgray": "#d3d3d3", "lightgrey": "#d3d3d3", "darkgray": "#a9a9a9", "gold": "#ffd700",
}  # fmt: skip
_HEX = re.compile(r"#([0-9a-f]{3,4}|[0-9a-f]{6}|[0-9a-f]{8})")
_CALL = re.compile(r"(rgb|hsl)a?\(([^)]*)\)")


def colour_of(text: str) -> str:
    """A colour as `#rrggbb`; nothing where none is drawn, the words themselves where they are not known.

    Examples
    --------
    >>> [colour_of(text) for text in ("Red", "#F00", "rgb(100%, 0%, 0%)", "hsl(0 100% 50%)", "#ff00ff00", "none")]
    ['#ff0000', '#ff0000', '#ff0000', '#ff0000', '', '']
    """
    flat = text.strip().lower()
    if flat in ("", "none", "transparent"):
        return ""
    if flat in NAMES:
        return NAMES[flat]
    if _HEX.fullmatch(flat):
        digits = flat[1:] if len(flat) > 5 else "".join(2 * digit for digit in flat[1:])
        return "" if digits[6:] == "00" else f"#{digits[:6]}"
    call = _CALL.fullmatch(flat)
    if call:
        return _called(call.group(1), re.findall(r"([-+.\de]+)(%|deg)?", call.group(2))) or flat
    return flat


def name_of(colour: str) -> str:
    """How people call a colour: its name where it has a common one.

    Examples
    --------
    >>> name_of("#0000ff"), name_of("#123456")
    ('blue', '#123456')
    """
    return next((name for name, value in NAMES.items() if value == colour), colour)


def is_light(colour: str) -> bool:
    """Whether a colour is white or nearly so, as paper is.

    Examples
    --------
    >>> is_light("#ffffff"), is_light("#ffff00")
    (True, False)
    """
    return bool(_HEX.fullmatch(colour)) and min(int(colour[k : k + 2], 16) for k in (1, 3, 5)) >= 0xE0


def is_grey(colour: str) -> bool:
    """Whether a colour is a grey, neither black nor white.

    Examples
    --------
    >>> is_grey("#aaaaaa"), is_grey("#000000"), is_grey("#aa0000")
    (True, False, False)
    """
    if not _HEX.fullmatch(colour):
        return False
    levels = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
    return max(levels) - min(levels) <= 0x18 and 0x40 <= max(levels) < 0xFF


def _called(kind: str, numbers: list[tuple[str, str]]) -> str:
    """Colour of rgb() or hsl(), or nothing where the numbers make none."""
    try:
        values = [float(number) for number, _ in numbers[:4]]
        if len(values) < 3 or (len(values) == 4 and values[3] == 0):
            return ""
        if kind == "hsl":
            rgb = hls_to_rgb(values[0] / 360, values[2] / 100, values[1] / 100)
            values = [255 * value for value in rgb]
        else:
            values = [2.55 * v if unit == "%" else v for v, (_, unit) in zip(values, numbers, strict=False)]
        return "#" + "".join(f"{min(255, max(0, round(value))):02x}" for value in values[:3])
    except (ValueError, OverflowError):
        return ""
