"""How much of the machine a solver process may take."""

from __future__ import annotations

import os

UPLOAD_MB = 20
"""A drawing that is dropped on a page may have so many MB."""
MEMORY_SHARE = 0.5
"""Of the machine's memory, at most."""


def bound_memory() -> None:
    """Let this process have half of the memory at most: then it says so, instead of the machine going down."""
    try:
        import resource

        whole = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
        resource.setrlimit(resource.RLIMIT_DATA, (int(MEMORY_SHARE * whole), resource.RLIM_INFINITY))
    except (ImportError, ValueError, OSError):  # not every system can
        return
