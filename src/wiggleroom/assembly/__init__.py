"""Parts as they are made: gaps and offsets, joint families and patterns, and what is wrong with a drawing."""
