"""Solids as drawn and as made: files, gaps, convex pieces."""
