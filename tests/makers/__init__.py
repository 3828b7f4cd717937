"""Drawings in the styles of the programs that makers use, each with what its maker expects to be read."""
