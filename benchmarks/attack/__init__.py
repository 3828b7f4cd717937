"""Attack from outside: random assemblies of many families, and a judge of what is said about them."""
