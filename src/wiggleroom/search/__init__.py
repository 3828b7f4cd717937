"""Largest motion: the search, its path and its answer."""
