"""Whether paths are free of overlap, also between way-points, judged from outlines and way-points alone."""
