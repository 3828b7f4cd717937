"""Cutting sheets put together: flanks that fit each other tell where every panel belongs."""
