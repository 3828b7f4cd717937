"""Extension modules of scipy without the packages that they lie in, which take thirty times as long to import."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from pathlib import Path
from threading import RLock
from typing import Any

import scipy

BLAS, LAPACK = "scipy.linalg.cython_blas", "scipy.linalg.cython_lapack"
_QHULL = "scipy.spatial._qhull"
_ONE_AT_A_TIME = RLock()


@contextmanager
def without_packages(*names: str) -> Iterator[list[Any]]:
    """Extension modules, each of which may import those before it; within the block they can be imported by name.

    Afterwards their packages import them as ever, and get the same ones.
    """
    added: list[str] = []
    with _ONE_AT_A_TIME:
        try:
            for name in names:
                if name not in sys.modules:
                    added.append(name)
                    _load(name)
            yield [sys.modules[name] for name in names]
        finally:
            for name in added:
                sys.modules.pop(name, None)


def _load(name: str) -> None:
    folder = Path(scipy.__file__).parent.joinpath(*name.split(".")[1:-1])
    spec = PathFinder.find_spec(name, [str(folder)])
    if spec is None or spec.loader is None:
        raise ModuleNotFoundError(name)
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.modules[name] = module


@cache
def qhull() -> Any:
    """Convex hulls: `ConvexHull` and `QhullError` of `scipy.spatial`."""
    with without_packages(BLAS, LAPACK, _QHULL) as modules:
        return modules[-1]
