"""Subdivision of one pair's motions into boxes that are certainly free, certainly forbidden, or mixed."""
