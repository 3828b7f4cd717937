"""Searches for the ways in which bodies leave in space: translations, turns in place, and steps on a lattice."""
