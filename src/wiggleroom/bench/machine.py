"""The machine on which figures were measured."""

from __future__ import annotations

import os
import platform
from importlib.metadata import version

from wiggleroom.bench.result import Record


def machine() -> Record:
    """Processor kind, cores, system, Python and wiggleroom."""
    return {
        "processor": platform.machine(),
        "cores": os.cpu_count(),
        "system": platform.system(),
        "python": platform.python_version(),
        "wiggleroom": version("wiggleroom"),
    }
