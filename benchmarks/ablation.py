"""What each move of the search earns: `python -m benchmarks.ablation [--first K] [--count N] [--search S]`.

The problems are random assemblies of the families of `benchmarks/attack` (numbers from `--first`) and chains whose true optimum is known.
Each is asked with all moves, and again without each of them. What a move earns is the objective that is lost without it; the rounds and
the processor time say what it costs. With `--search S` so many climbs from other starts follow, as `flex` does.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
from tests.oracle.blocks import JOINTS
from tests.oracle.chain import GAPS

import wiggleroom as wr
from benchmarks.attack.families import MEASURED_FAMILIES, draw
from benchmarks.chains import chain
from wiggleroom import flex_walls, maximise
from wiggleroom.search import global_search, moves
from wiggleroom.search.local_search import Move

MIN_LOSS = 1e-4
"""A smaller share of the objective counts as the same."""
CHAIN_LENGTH = 10


@contextmanager
def without(left_out: Move) -> Iterator[None]:
    """All searches for an answer do without a move."""
    policy = replace(moves.THOROUGH, moves=tuple(m for m in moves.THOROUGH.moves if m is not left_out))
    users = [module for module in (flex_walls, global_search) if hasattr(module, "THOROUGH")]
    for module in users:
        module.THOROUGH = policy
    try:
        yield
    finally:
        for module in users:
            module.THOROUGH = moves.THOROUGH


def problems(first: int, count: int) -> Iterator[tuple[str, wr.Assembly]]:
    """Families of `attack`, each by its name and number, and chains."""
    for number in range(first, first + count):
        family, made = draw(number, MEASURED_FAMILIES)
        if made is None:
            continue
        assembly = read(json.dumps(made))
        if assembly is not None:
            yield f"{family} {number}", assembly
    for joint in JOINTS:
        for gap in GAPS:
            assembly = read(chain(joint, gap, CHAIN_LENGTH, moved=False))
            if assembly is not None:
                yield f"chain of {CHAIN_LENGTH}, {joint}, gap {gap}", assembly


def read(text: str) -> wr.Assembly | None:
    """The assembly of a file's text; None where its parts touch or nothing is asked."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "drawn.json"
        file.write_text(text, encoding="utf-8")
        try:
            assembly = wr.read(file)
            wr.prepare(assembly)
        except wr.InputError:
            return None
    return assembly


def asked(assembly: wr.Assembly, search: int) -> tuple[float, bool, int, float]:
    """Objective (infinite where nothing stops the motion), whether the verdict is optimal, rounds and processor time [s]."""
    began = time.process_time()
    answer = maximise.witness(assembly, search=search)
    value = np.inf if answer.objective is None else answer.objective
    return value, answer.verdict == wr.Verdict.OPTIMAL, answer.rounds, time.process_time() - began


def share(other: float, value: float) -> float:
    """Change of an objective as a share of it; all of it where only one of them is without end."""
    if np.isinf(value) or np.isinf(other):
        return float(np.isinf(other)) - float(np.isinf(value))
    return (other - value) / max(abs(value), 1e-12)


def main() -> None:
    """Print one line a move."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=9000, help="number of the first assembly")
    parser.add_argument("--count", type=int, default=120, help="so many numbers")
    parser.add_argument("--search", type=int, default=0, help="climbs from other starts")
    options = parser.parse_args()
    runs: dict[str, list[tuple[float, bool, int, float]]] = {"": []}
    names = []
    for name, assembly in problems(options.first, options.count):
        names.append(name)
        asked(assembly, options.search)  # what is compiled on first use does not count
        runs[""].append(asked(assembly, options.search))
        for move in moves.THOROUGH.moves:
            with without(move):
                runs.setdefault(move.__name__, []).append(asked(assembly, options.search))
    table(names, runs)


def table(names: list[str], runs: dict[str, list[tuple[float, bool, int, float]]]) -> None:
    """Markdown: what is lost without each move."""
    value, optimal, rounds, seconds = (np.array(column) for column in zip(*runs[""], strict=True))
    print(
        f"{len(names)} problems with all moves: {optimal.sum()} optimal, {rounds.sum()} rounds, {seconds.sum():.1f} s\n"
    )
    print("| without | worse | better | worst loss | where | optimal | rounds | seconds |\n" + "| --- " * 8 + "|")
    for move, found in list(runs.items())[1:]:
        other, sure, turns, spent = (np.array(column) for column in zip(*found, strict=True))
        change = np.array([share(*pair) for pair in zip(other, value, strict=True)])
        worst = int(np.argmin(change))
        print(
            f"| `{move}` | {(change < -MIN_LOSS).sum()} | {(change > MIN_LOSS).sum()} | {-change[worst]:.2%} "
            f"| {names[worst] if change[worst] < -MIN_LOSS else ''} | {sure.sum()} | {turns.sum()} | {spent.sum():.1f} |"
        )


if __name__ == "__main__":
    main()
