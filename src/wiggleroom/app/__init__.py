"""The live page: a server on this machine alone, and the processes that solve for it."""
