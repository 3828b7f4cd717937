"""Proven upper bounds on the largest motion."""
