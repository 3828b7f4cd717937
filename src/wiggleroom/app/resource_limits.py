"""Limits of resources: size of an upload, and memory of a solver process."""

from __future__ import annotations

import os

UPLOAD_MB = 20
"""Largest drawing that may be dropped on a page [MB]."""
MEMORY_SHARE = 0.5
"""Share of the machine's memory that a solver process may take."""


def bound_memory() -> None:
    """Let this process have half of the memory at most: then it says so, instead of the machine going down."""
    try:
        import resource

        whole = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
        resource.setrlimit(resource.RLIMIT_DATA, (int(MEMORY_SHARE * whole), resource.RLIM_INFINITY))
    except (ImportError, ValueError, OSError):  # not every system can
        return
