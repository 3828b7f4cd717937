"""Colours and sizes of the pictures, in one place; chosen to stay apart for colour-blind eyes and on white print."""

from __future__ import annotations

PAPER = "#ffffff"
INK = "#1f2933"
SUBDUED = "#66727f"
REST = "#aeb6bf"
GRID = "#e3e7eb"

NEUTRAL = ("#e4e9ef", "#7c8894")
PULLED = ("#8fc1ea", "#1f5f99")
FIXED = ("#e58a80", "#a02c22")
ROLE_COLOURS = {"neutral": NEUTRAL, "pulled": PULLED, "fixed": FIXED}
"""Fill and outline of the parts, in the order they are drawn."""

IMPORTANCE_COLOURS = ("#f3f1ec", "#fbe3b8", "#f8bd76", "#ee8a5b", "#d9606a", "#b0508c")
"""Fill of a part, from no importance of its gap to the largest."""
CHOSEN = "#b9a0da"
ASIDE = "#cfe3f4"
"""Parts that move aside and do not leave."""

MOTION = "#0b3c6f"
FORCE = "#c96a00"

FONT = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif"
TITLE_SIZE = 24.0
TEXT_SIZE = 14.0
SMALL_SIZE = 11.0
"""Sizes of the text [px]."""

MARGIN = 40.0
"""Round everything [px]."""
HEAD_SPACING = 30.0
"""Between the text and the drawing [px]."""
WIDEST, TALLEST = 1120.0, 1000.0
"""A drawing is scaled to fit into this [px]."""
NARROWEST = 720.0
"""Least width of the text [px]."""
