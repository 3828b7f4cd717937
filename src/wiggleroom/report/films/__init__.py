"""Films of paths."""
