"""Plans: paths of taking apart and putting together, made ready for hands and robots."""
