"""Outer regions: everything that a pair can reach, and a little more."""
