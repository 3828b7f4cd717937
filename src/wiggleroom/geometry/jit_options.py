"""How functions are compiled.

What was compiled is kept beside the package. Of what a function calls in other modules only the outermost one's file is looked at to see
whether it is still right: after a change to what `grow` builds on, change the time of grow.py as well (touch).
"""

from __future__ import annotations

OPTIONS = {"cache": True, "nogil": True, "error_model": "numpy"}
"""For functions that make arrays."""
NO_ALLOCATION = {**OPTIONS, "no_cfunc_wrapper": True, "_nrt": False}
"""For functions that only fill the arrays they are given: without the counting of references they compile much quicker."""
COMPILED_CALLERS_ONLY = {**NO_ALLOCATION, "no_cpython_wrapper": True}
"""For functions that moreover only compiled code calls."""
INLINED = {**COMPILED_CALLERS_ONLY, "inline": "always"}
"""For long functions with one caller: compiled as part of it, not twice."""
