"""Cells: regions of relative pose that walls keep free of overlap."""
