"""From SVG to PNG."""

from __future__ import annotations

from importlib.resources import as_file, files

WIDTH = 1600
"""[px]"""


def png(svg: str, *, width: int = WIDTH, own_font_only: bool = False) -> bytes:
    """Render an SVG picture `width` pixels wide.

    Text is set in the font that comes with the package, so that it looks the same on every machine, also on one
    without any font; letters that font does not have come from the system, unless `own_font_only`, which is quicker.
    """
    from resvg_py import svg_to_bytes

    with as_file(files("wiggleroom.report") / "fonts" / "wiggle-sans.ttf") as font:
        return bytes(
            svg_to_bytes(
                svg_string=svg,
                width=width,
                font_files=[str(font)],
                skip_system_fonts=own_font_only,
                style_sheet="svg { font-family: 'Wiggle Sans', sans-serif }",
            )
        )
