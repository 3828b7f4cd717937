"""Whether parts overlap at a pose or on a path; shares nothing with the program."""
