"""The search for the largest motion, its path and its answer."""
