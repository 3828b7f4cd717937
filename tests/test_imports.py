"""Data flows one way: a package imports only from packages to its left, errors and files stand left of all."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1] / "src" / "wiggleroom"
ORDER = [
    "errors",
    "files",
    "verdict",
    "drawing",
    "assembly",
    "geometry",
    "freespace",
    "program",
    "solve",
    "search",
    "bound",
    "compare",
    "maximise",
    "tight",
    "separate",
    "sensitivity",
    "live",
    "schema",
    "report",
    "verify",
    "bench",
    "app",
    "cli",
]


def imported(tree: ast.AST, package: str) -> set[str]:
    """Packages of wiggleroom that a module imports anywhere, also inside functions and by relative imports."""
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                above = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*above, base]).rstrip(".")
            names |= {f"{base}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", getattr(node.func, "id", "")) in (
            "import_module",
            "__import__",
        ):
            names |= {a.value for a in node.args[:1] if isinstance(a, ast.Constant) and isinstance(a.value, str)}
    return {name.split(".")[1] for name in names if name.startswith("wiggleroom.")}


def wrong(path: Path, root: Path = ROOT) -> list[str]:
    """Imports of one module that point to the right."""
    inside = path.relative_to(root)
    own = inside.parts[0].removesuffix(".py")
    package = ".".join(["wiggleroom", *inside.parts[:-1]])
    found = imported(ast.parse(path.read_text(encoding="utf-8")), package)
    assert own in ORDER, f"{inside}: this package has no place in the order"
    allowed = set(ORDER[: ORDER.index(own) + 1])
    return [f"{inside} imports {name}" for name in sorted(found & set(ORDER) - allowed)]


MODULES = sorted(
    p for p in ROOT.rglob("*.py") if p.parent != ROOT or p.stem in ("errors", "files", "verdict", "maximise")
)


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(ROOT)))
def test_a_module_imports_only_from_its_left(path: Path) -> None:
    assert wrong(path) == []


def test_every_package_has_a_place() -> None:
    assert {p.name for p in ROOT.iterdir() if (p / "__init__.py").exists()} <= set(ORDER)


@pytest.mark.parametrize(
    "line",
    [
        "import wiggleroom.report.table",
        "from wiggleroom.report import table",
        "from wiggleroom import report",
        "from ..report import table",
        "from .. import report",
        "def f():\n    from wiggleroom.report.table import table",
        "import importlib\nimportlib.import_module('wiggleroom.report')",
    ],
)
def test_the_walk_sees_every_kind_of_import(tmp_path: Path, line: str) -> None:
    module = tmp_path / "solve" / "bad.py"
    module.parent.mkdir()
    module.write_text(line)
    assert wrong(module, tmp_path) == ["solve/bad.py imports report"]


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
