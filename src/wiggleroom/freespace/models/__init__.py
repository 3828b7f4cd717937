"""Models of one pair to compare with: the paper's hull and half-planes."""
