"""Plans for hands and robots: in which order, and along which paths, parts are taken apart and put together."""
