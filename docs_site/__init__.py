"""What makes the documentation a site."""
