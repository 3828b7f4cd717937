"""The tests, and the independent truth they are held against."""
