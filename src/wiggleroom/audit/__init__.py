"""The judge of ways: whether parts overlap anywhere between way-points, from outlines and way-points alone."""
