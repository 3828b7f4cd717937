"""How far loose interlocking flat parts can move."""
