"""Rigid motions in space: rotations, poses, and parts that move as one body."""
