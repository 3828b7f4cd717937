"""What gaps do to the motion: derivatives, sweeps, random gaps, tightening."""
