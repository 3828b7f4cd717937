"""Does it come apart: who leaves, and how."""
