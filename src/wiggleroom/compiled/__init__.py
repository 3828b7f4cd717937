"""How numerical kernels are compiled, and where their machine code is kept."""

import sys
from importlib.util import LazyLoader, find_spec, module_from_spec

import numpy


def _defer(*names: str) -> None:
    """Have modules of numpy imported when they are first used.

    scipy copies every name of numpy as soon as any package of it is imported, which takes in numpy's tests and its compiler of Fortran:
    half of the time that `scipy.sparse` takes.
    """
    for name in names:
        full = f"numpy.{name}"
        spec = None if full in sys.modules else find_spec(full)
        if spec is None or spec.loader is None:
            continue
        spec.loader = LazyLoader(spec.loader)
        sys.modules[full] = module = module_from_spec(spec)
        spec.loader.exec_module(module)
        setattr(numpy, name, module)


_defer("f2py", "testing")
