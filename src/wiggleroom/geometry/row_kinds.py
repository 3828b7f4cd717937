"""Kinds of the rows h >= 0 that keep two bodies apart; their equations: `wiggleroom.program.contact_functions`."""

A_EDGE, B_EDGE = 0, 1
"""A corner of B in front of an edge of A, and a corner of A in front of an edge of B."""
LOW_TURN, HIGH_TURN = 2, 3
"""The relative angle is no less, and no more, than where its interval ends."""
FACE = 4
"""A flat face of a convex region of relative poses."""
