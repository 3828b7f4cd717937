"""Free spaces of pairs: walls, cells, slices."""
