"""How near proven bounds come, and what they cost.

`python -m benchmarks.bounds [chains|grids|drawings|quick [NAME ..]|certified [NAME ..]]`
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator

from tests.flexing import row_of
from tests.oracle import blocks, chain

import wiggleroom as wr
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble

DRAWINGS = "examples/drawings"


def chains() -> Iterator[tuple[str, Assembly, float, float | None]]:
    """Ten links of five joint kinds, whose true optimum a dynamic programme knows."""
    for joint in blocks.JOINTS:
        for gap in (0.01, 0.03):
            made = assemble(row_of([blocks.block(joint, gap)] * 10), gap=0.0)
            yield f"chain of 10, {joint}, gap {gap}", made, 0.005, chain.stored(joint, gap, 10)[0]


def grids() -> Iterator[tuple[str, Assembly, float, float | None]]:
    """Tee blocks, the last one pulled up."""
    for nx, ny, within in ((3, 3, 0.002), (6, 5, 0.01)):
        made = wr.patterns.grid(nx, ny, joint="tee", gap=0.01)
        last = wr.Pull(made.names[-1], (0, 1))
        yield f"{nx} x {ny} tee blocks, gap 0.01", assemble(made.drawing, goals=[last]), within, None


def drawings() -> Iterator[tuple[str, Assembly, float, float | None]]:
    """Two of the example drawings, one corner fixed, the opposite one pulled."""
    for name, gap, fixed, pull in (
        ("pyjigsaw_4x5.svg", 1.0, "p1", wr.Pull("p20", (1, 0))),
        ("jointpanel_4x4.svg", 0.2, "p-0", wr.Pull("p-15", (0, 1))),
    ):
        made = wr.read(f"{DRAWINGS}/{name}", gap=gap, fix=[fixed])
        yield f"{name}, gap {gap}", assemble(made.drawing, gap=gap, fix=[fixed], goals=[pull]), 0.02, None


KINDS: dict[str, Callable[[], Iterator[tuple[str, Assembly, float, float | None]]]] = {
    "chains": chains,
    "grids": grids,
    "drawings": drawings,
}


def quick(names: list[str]) -> None:
    """What stands beside answers that nobody asked to prove, and its share of the time; of questions that contain one of the names."""
    print("| question | found | at most | within | milliseconds of the search | of the bound |\n" + "| --- " * 6 + "|")
    made = [(name, assembly) for kind in KINDS.values() for name, assembly, *_ in kind()]
    for n, joint in ((3, "swallowtail"), (6, "tee"), (10, "tee"), (10, "jigsaw")):
        blocks_ = wr.patterns.grid(n, n, joint=joint, gap=0.01)
        goals = [wr.Pull(blocks_.names[-1], (0, 1))]
        made.append((f"{n} x {n} blocks, {joint}, gap 0.01", assemble(blocks_.drawing, goals=goals)))
    puzzle = wr.patterns.jigsaw(5, 4, gap=0.02, seed=1)
    made.append(("jigsaw 5 x 4, gap 0.02", assemble(puzzle.drawing, goals=[wr.Pull(puzzle.names[-1], (1, 0))])))
    for name, assembly in made:
        if names and not any(n in name for n in names):
            continue
        answer = wr.flex(assembly)
        spent = answer.seconds.get("bound", 0.0)
        most, share = (
            ("-", "-")
            if answer.bound is None or answer.bound.within is None
            else (f"{answer.at_most:.6g}", f"{answer.bound.within:.1%}")
        )
        search = 1e3 * (answer.seconds["total"] - spent)
        print(f"| {name} | {answer.objective:.6g} | {most} | {share} | {search:.0f} | {1e3 * spent:.1f} |", flush=True)


def tees(nx: int, ny: int) -> Assembly:
    """Tee blocks, the last one pulled up."""
    made = wr.patterns.grid(nx, ny, joint="tee", gap=0.01)
    return assemble(made.drawing, goals=[wr.Pull(made.names[-1], (0, 1))])


def row(n: int) -> Assembly:
    """A chain of tees, the last one pulled up."""
    made = wr.patterns.chain(n, joint="tee", gap=0.01)
    return assemble(made.drawing, goals=[wr.Pull(made.names[-1], (0, 1))])


def drawn(name: str, gap: float, fixed: str, part: str, direction: tuple[float, float]) -> Assembly:
    """An example drawing, one part fixed, another one pulled."""
    made = wr.read(f"{DRAWINGS}/{name}.svg", gap=gap, fix=[fixed])
    return assemble(made.drawing, gap=gap, fix=[fixed], goals=[wr.Pull(part, direction)])


CERTIFIED: dict[str, tuple[Callable[[], Assembly], float, float]] = {
    "chain-10": (lambda: row(10), 0.001, 600),
    "chain-50": (lambda: row(50), 0.001, 600),
    "chain-200": (lambda: row(200), 0.001, 600),
    "tees-3x3": (lambda: tees(3, 3), 0.002, 600),
    "tees-6x5": (lambda: tees(6, 5), 0.002, 600),
    "tees-10x10": (lambda: tees(10, 10), 0.005, 1800),
    "tees-20x20": (lambda: tees(20, 20), 0.05, 3600),
    "jointpanel_4x4": (lambda: drawn("jointpanel_4x4", 0.2, "p-0", "p-15", (0, 1)), 0.005, 1200),
    "jointpanel_10x10": (lambda: drawn("jointpanel_10x10", 0.2, "p-0", "p-99", (0, 1)), 0.05, 3600),
    "pyjigsaw_4x5": (lambda: drawn("pyjigsaw_4x5", 1.0, "p1", "p20", (1, 0)), 0.006, 1800),
}
"""Question, how near, and the most seconds it may take."""


def certified(names: list[str]) -> None:
    """Proofs with certificates, and what checking these takes; processor seconds of this process."""
    from wiggleroom.verify.checker import verify

    print("| question | found | at most | within | proof, s | file, MB | verify, s | verified |\n" + "| --- " * 8 + "|")
    for name in names or list(CERTIFIED):
        make, within, limit = CERTIFIED[name]
        answer = wr.flex(make())
        began = time.process_time()
        done = wr.prove(answer, within, seconds=limit, certify=True)
        proof = time.process_time() - began
        paper = None if done.bound is None else done.bound.certificate
        if paper is None:
            print(
                f"| {name} | {done.objective} | - | - | {proof:.1f} | - | - | {done.bound and done.bound.why} |",
                flush=True,
            )
            continue
        text = json.dumps(paper)
        began = time.process_time()
        found = verify(json.loads(text))
        spent = time.process_time() - began
        print(
            f"| {name} | {done.objective:.6g} | {paper['at_most']:.6g} | {paper['at_most'] / done.objective - 1:.3%} | {proof:.1f} "
            f"| {len(text) / 1e6:.1f} | {spent:.1f} | {found.why or 'yes'} |",
            flush=True,
        )


def main(words: list[str]) -> None:
    """Print one line for each question."""
    if words[:1] == ["certified"]:
        certified(words[1:])
        return
    if words[:1] == ["quick"]:
        quick(words[1:])
        return
    print(
        "| question | found | at most | within | true optimum | seconds | of this process alone |\n"
        + "| --- " * 7
        + "|"
    )
    for kind in words or list(KINDS):
        for name, assembly, within, truth in KINDS[kind]():
            answer = wr.flex(assembly)
            wall, own = time.perf_counter(), time.process_time()
            done = wr.prove(answer, within, seconds=300)
            wall, own = time.perf_counter() - wall, time.process_time() - own
            share = "-" if done.bound is None or done.bound.within is None else f"{done.bound.within:.2%}"
            most = "-" if done.at_most is None else f"{done.at_most:.6g}"
            true = "-" if truth is None else f"{truth:.6g}"
            print(f"| {name} | {done.objective:.6g} | {most} | {share} | {true} | {wall:.1f} | {own:.1f} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
