"""Data flows one way: a package imports only from those before it in `ORDER`, and no modules import each other in a circle."""

from __future__ import annotations

import ast
from collections.abc import Container
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1] / "src" / "wiggleroom"
ORDER = [
    "errors",
    "deadline",
    "context",
    "provenance",
    "files",
    "displayable",
    "verdict",
    "compiled",
    "parallel",
    "drawing",
    "assembly",
    "geometry",
    "mating",
    "audit",
    "freespace",
    "program",
    "solve",
    "search",
    "bound",
    "compare",
    "flex_walls",
    "maximise",
    "form_closure",
    "disassembly",
    "sensitivity",
    "planning",
    "live",
    "spatial",
    "questions",
    "schema",
    "report",
    "verify",
    "bench",
    "studies",
    "app",
    "cli",
]


def modules(root: Path) -> dict[str, Path]:
    """All modules of the package, by their full names."""
    found = {".".join(["wiggleroom", *p.relative_to(root).with_suffix("").parts]): p for p in root.rglob("*.py")}
    return {name.removesuffix(".__init__"): path for name, path in found.items()}


def imported(name: str, path: Path, known: Container[str]) -> set[str]:
    """Modules that a module imports anywhere: at its top, for types only, inside functions, relatively, by names made when it runs."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    own = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            above = own[: len(own) - node.level + 1] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            found |= {f"{base}.{alias.name}" if f"{base}.{alias.name}" in known else base for alias in node.names}
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", getattr(node.func, "id", "")) in LOADERS:
            found |= named(node.args[0], tree, known) if node.args else set()
    return {n for n in found if n in known and n != name}


LOADERS = ("import_module", "__import__")


def named(argument: ast.expr, tree: ast.AST, known: Container[str]) -> set[str]:
    """Modules that a computed name may mean: its constant beginning followed by any text of the module that makes one."""
    texts = {n.value for n in ast.walk(tree) if isinstance(n, ast.Constant) and isinstance(n.value, str)}
    pieces = argument.values if isinstance(argument, ast.JoinedStr) else [getattr(argument, "left", argument)]
    first = pieces[0] if pieces else argument
    begin = first.value if isinstance(first, ast.Constant) and isinstance(first.value, str) else ""
    return {name for text in ("", *texts) for name in (begin + text, begin.rstrip(".") + text) if name in known}


def wrong(name: str, imports: set[str]) -> list[str]:
    """Imports of one module that point to the right."""
    own = name.split(".")[1]
    assert own in ORDER, f"{name}: this package has no place in the order"
    allowed = set(ORDER[: ORDER.index(own) + 1])
    packages = {n.split(".")[1] for n in imports if n != "wiggleroom"}
    return [f"{name} imports {package}" for package in sorted(packages & set(ORDER) - allowed)]


KNOWN = modules(ROOT)


@cache
def imports_of(name: str) -> set[str]:
    """Modules of the package that one of them imports."""
    return imported(name, KNOWN[name], KNOWN)


@pytest.mark.parametrize("name", sorted(KNOWN.keys() - {"wiggleroom"}))
def test_a_module_imports_only_from_its_left(name: str) -> None:
    assert wrong(name, imports_of(name)) == []


def test_no_modules_import_each_other_in_a_circle() -> None:
    """Inside packages too; what a package's own file imports from its modules counts as well."""
    graph = {name: imports_of(name) for name in KNOWN if name != "wiggleroom"}
    TopologicalSorter(graph).prepare()  # raises CycleError with the circle


def folders(package: str) -> dict[str, set[str]]:
    """Folders and modules that lie in a package itself, and those of them that each imports from."""
    depth = package.count(".") + 1
    inside = {name for name in KNOWN if name.startswith(f"{package}.")}
    graph: dict[str, set[str]] = {}
    for name in inside:
        own = name.split(".")[depth]
        graph.setdefault(own, set()).update(
            other.split(".")[depth] for other in imports_of(name) & inside if other.split(".")[depth] != own
        )
    return graph


@pytest.mark.parametrize("package", sorted({name.rpartition(".")[0] for name in KNOWN} - {"", "wiggleroom"}))
def test_no_folders_of_a_package_import_each_other_in_a_circle(package: str) -> None:
    TopologicalSorter(folders(package)).prepare()  # raises CycleError with the circle


@pytest.mark.parametrize(
    "line",
    [
        "import wiggleroom.report.results.table",
        "from .. import report",
        "def f():\n    from wiggleroom.report.results.table import table",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from wiggleroom.report.results.table import table",
        "from importlib import import_module\nimport_module(f'wiggleroom.report.{NAME}')\nNAME = 'table'",
        "from importlib import import_module\nNAMES = {'one': 'wiggleroom.report.results.table'}\nimport_module(NAMES['one'])",
        "from importlib import import_module\nNAMES = ('report',)\n[import_module(f'wiggleroom.{n}') for n in NAMES]",
    ],
)
def test_the_walk_sees_every_kind_of_import(tmp_path: Path, line: str) -> None:
    (tmp_path / "solve").mkdir()
    module = tmp_path / "solve" / "bad.py"
    module.write_text(line)
    known = {*KNOWN, "wiggleroom.solve.bad"}
    found = imported("wiggleroom.solve.bad", module, known)
    assert wrong("wiggleroom.solve.bad", found) == ["wiggleroom.solve.bad imports report"]


def test_the_walk_sees_circles(tmp_path: Path) -> None:
    (tmp_path / "solve").mkdir()
    (tmp_path / "solve" / "one.py").write_text("def f():\n    from wiggleroom.solve import two")
    (tmp_path / "solve" / "two.py").write_text(
        "from importlib import import_module\nimport_module('wiggleroom.solve.one')"
    )
    known = modules(tmp_path)
    graph = {name: imported(name, path, known) for name, path in known.items()}
    with pytest.raises(CycleError):
        TopologicalSorter(graph).prepare()


@pytest.mark.parametrize("module", ["wiggleroom", "wiggleroom.cli.app"])
def test_what_starts_first_stays_cheap(module: str) -> None:
    import subprocess
    import sys

    heavy = (
        "{'scipy', 'casadi', 'numba', 'shapely', 'svgelements', 'resvg_py', 'matplotlib', 'ezdxf'} & set(sys.modules)"
    )
    code = f"import sys, {module}; print(sorted({heavy}))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
