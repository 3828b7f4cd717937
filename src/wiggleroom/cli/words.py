"""What a command line's words mean before its options are read, and what was meant by words that are not known."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from itertools import zip_longest

DRAWINGS = (".svg", ".dxf", ".lbrn2", ".lbrn")


def with_json_alone(argv: Sequence[str]) -> list[str]:
    """Words of the command line with "-" after each --json that names no file, which then goes to stdout.

    A drawing after --json is the FILE that is read.

    Examples
    --------
    >>> with_json_alone(["flex", "a.svg", "--json", "--gap", "1"])
    ['flex', 'a.svg', '--json', '-', '--gap', '1']
    >>> with_json_alone(["flex", "--json", "a.svg"]), with_json_alone(["flex", "a.svg", "--json", "b.json"])
    (['flex', '--json', '-', 'a.svg'], ['flex', 'a.svg', '--json', 'b.json'])
    """
    found: list[str] = []
    for word, after in zip_longest(argv, argv[1:]):
        found.append(word)
        if word == "--json" and (after is None or _is_no_output(after)):
            found.append("-")
    return found


def _is_no_output(word: str) -> bool:
    from wiggleroom.drawing.dimension import PUZZLES  # loads the readers

    return (word.startswith("-") and word != "-") or os.path.splitext(word)[1].lower() in (*DRAWINGS, *PUZZLES)


def meant(word: str, known: Iterable[str]) -> str:
    """Say which known words come near, or nothing.

    >>> meant("flx", ["flex", "check"])
    'Did you mean flex?'
    """
    near = get_close_matches(word, list(known), n=1, cutoff=0.6)
    return f"Did you mean {near[0]}?" if near else ""
