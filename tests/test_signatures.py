"""Functions inside the package take few things: what ends the work, who hears of it and where it runs is one object."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import wiggleroom as wr

ROOT = Path(__file__).parents[1] / "src" / "wiggleroom"
MOST = 7
KERNELS = {"jit", "njit", "cfunc", "vectorize", "guvectorize"}
LIVE = ("others_back", "drag", "flex", "settle", "wiggle")
PUBLIC = set(wr.__all__)
"""Names that are asked from outside, and what of them is asked of one dimension: these take their arguments one by one."""
PROTOCOLS = {
    ("solve/interior_point.py", "solve"),  # SOLVERS
    ("solve/ipopt.py", "solve"),
    ("spatial/planes/separating_plane_ipopt.py", "solve_with_ipopt"),
    ("bench/accuracy.py", "accuracy"),  # the tables of `bench`
    ("bench/chains.py", "chains"),
    ("bench/interlock_table.py", "interlock_table"),
    ("bench/speed.py", "speed"),
    *(("live/live_session.py", name) for name in LIVE),  # the public Live, in the plane and in space
    *(("spatial/spatial_live.py", name) for name in LIVE),
}


def parameters(function: ast.FunctionDef | ast.AsyncFunctionDef) -> list[str]:
    """Names of the parameters of a function, besides the object that it belongs to."""
    its = function.args
    return [a.arg for a in (*its.posonlyargs, *its.args, *its.kwonlyargs) if a.arg not in ("self", "cls")]


def decorators(function: ast.FunctionDef | ast.AsyncFunctionDef) -> set[str]:
    """Last names of the decorators."""
    called = [d.func if isinstance(d, ast.Call) else d for d in function.decorator_list]
    return {getattr(d, "attr", getattr(d, "id", "")) for d in called}


@cache
def internal() -> tuple[tuple[str, str, tuple[str, ...]], ...]:
    """File, name and parameters of all functions but kernels, commands and what is public."""
    return tuple(_internal())


def _internal() -> Iterator[tuple[str, str, tuple[str, ...]]]:
    for path in sorted(ROOT.rglob("*.py")):
        name = path.relative_to(ROOT).as_posix()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) or decorators(node) & KERNELS:
                continue
            command = name.startswith("cli/") and not node.name.startswith("_")
            if not command and node.name not in PUBLIC and (name, node.name) not in PROTOCOLS:
                yield name, node.name, tuple(parameters(node))


def test_no_function_takes_many_things() -> None:
    assert {(path, name) for path, name, taken in internal() if len(taken) > MOST} == set()


def test_what_ends_the_work_and_who_hears_of_it_come_together() -> None:
    together = (
        {"stop", "progress"},
        {"stop", "tell"},
        {"stop", "workers"},
        {"stop", "cluster"},
        {"deadline", "progress"},
    )
    assert [(path, name) for path, name, taken in internal() if any(some <= set(taken) for some in together)] == []


def test_what_is_taken_one_by_one_is_there() -> None:
    """An exception whose function is gone or has become short is no exception."""
    found = {
        (path.relative_to(ROOT).as_posix(), node.name)
        for path in ROOT.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    }
    asked = {name for name in PROTOCOLS if not name[0].endswith("spatial_live.py")}
    assert asked <= found
