"""From files to outlines in millimetres, and back."""

from wiggleroom.drawing.bitmap import read_bitmap
from wiggleroom.drawing.read import read_drawing, write_drawing

__all__ = ["read_bitmap", "read_drawing", "write_drawing"]
