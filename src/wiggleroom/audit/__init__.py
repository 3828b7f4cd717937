"""Whether paths are free of overlap, also between waypoints, judged from outlines and waypoints alone."""
