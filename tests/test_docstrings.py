"""Docstrings: what they list as parameters and fields is there under that name, so that none speaks of what was renamed."""

from __future__ import annotations

import ast
import re
from pathlib import Path

SOURCES = sorted((Path(__file__).parents[1] / "src" / "wiggleroom").rglob("*.py"))


def listed(docstring: str) -> list[str]:
    """Names in the section of parameters: "a, b : type" lists two; lines that are indented say more about them."""
    section = docstring.split("Parameters\n----------\n")[1]
    section = re.split(r"\n(?:\w+\n---|Source: )", section)[0]
    lines = [line.partition(" : ")[0] for line in section.splitlines() if line and not line[0].isspace()]
    return [name.strip(" *") for line in lines for name in line.split(",")]


def there(node: ast.FunctionDef | ast.ClassDef) -> set[str]:
    """Arguments of a function; fields of a class and arguments of what makes one."""
    if isinstance(node, ast.FunctionDef):
        every = node.args
        more = [one for one in (every.vararg, every.kwarg) if one is not None]
        return {one.arg for one in (*every.posonlyargs, *every.args, *every.kwonlyargs, *more)}
    fields = {n.target.id for n in node.body if isinstance(n, ast.AnnAssign) and isinstance(n.target, ast.Name)}
    makers = [n for n in node.body if isinstance(n, ast.FunctionDef) and n.name == "__init__"]
    return fields.union(*(there(one) for one in makers))


def test_parameters_in_docstrings_exist() -> None:
    lost = []
    for path in SOURCES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                said = ast.get_docstring(node) or ""
                if "Parameters\n----------\n" in said and (known := there(node)):
                    lost += [f"{path.name}:{node.lineno} {name}" for name in listed(said) if name not in known]
    assert lost == []
