"""The sparse nonlinear program."""
