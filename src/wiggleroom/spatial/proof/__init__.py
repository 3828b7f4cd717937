"""Proven bounds for one body that moves in space: inner pieces, linear rows in boxes of poses, and a flood from rest."""
