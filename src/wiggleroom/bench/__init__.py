"""The paper's tables beside its peers: what each method gets right, what it misses and what it costs, in one run."""
