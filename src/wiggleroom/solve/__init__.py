"""Solvers of the program, by name."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from wiggleroom.errors import InputError

SOLVERS = {"interior-point": "wiggleroom.solve.interior_point", "ipopt": "wiggleroom.solve.ipopt"}
"""Registry: name and the module whose `solve` it is; imported when used."""


def solver_named(name: str) -> Callable:
    """The `solve` function of a solver.

    Raises
    ------
    InputError
        If there is no solver of that name.
    """
    if name not in SOLVERS:
        finding = f'solver "{name}" is not known; solvers are {", ".join(SOLVERS)}'
        raise InputError(finding)
    return import_module(SOLVERS[name]).solve
