"""The free space of one pair: words, JSON, pictures, and a solid for the page."""
