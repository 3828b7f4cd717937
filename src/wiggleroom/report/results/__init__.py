"""What was found, in words, as tables and as JSON."""
