"""Which bodies can meet."""
