"""From files to outlines in millimetres, and back."""

from wiggleroom.drawing.read import read_drawing, write_drawing

__all__ = ["read_drawing", "write_drawing"]
