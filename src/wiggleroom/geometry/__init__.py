"""Rigid bodies in the plane: poses, neighbours, overlap."""
