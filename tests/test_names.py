"""Names: no file and no class is called like another, so that every name can be looked for."""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path

SOURCES = sorted((Path(__file__).parents[1] / "src" / "wiggleroom").rglob("*.py"))


def test_no_two_files_have_one_name() -> None:
    count = Counter(path.stem for path in SOURCES if path.stem != "__init__")
    assert [name for name, times in count.items() if times > 1] == []


def test_no_two_classes_have_one_name() -> None:
    trees = (ast.parse(path.read_text(encoding="utf-8")) for path in SOURCES)
    count = Counter(node.name for tree in trees for node in ast.walk(tree) if isinstance(node, ast.ClassDef))
    assert [name for name, times in count.items() if times > 1] == []
