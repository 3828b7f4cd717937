"""The search for large motions in space: starts, rounds of the program, and the check of the path."""
