"""From files to outlines in millimetres, and back."""

from wiggleroom.drawing.read import read_drawing, write_drawing, write_in_place
from wiggleroom.drawing.readers.bitmap import read_bitmap

__all__ = ["read_bitmap", "read_drawing", "write_drawing", "write_in_place"]
