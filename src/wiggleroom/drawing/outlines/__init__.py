"""From strokes to the outlines of parts, and their names."""
