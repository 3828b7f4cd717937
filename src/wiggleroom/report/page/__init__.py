"""What the page reads, live and in one file."""
