"""Beyond one machine, simulated: how the factorisation of a grid of n x n bodies splits into domains, `python -m benchmarks.domains`.

The elimination tree of the real nested dissection is cut at a depth: each subtree below is a domain, which one machine holds whole;
what lies above is shared, each front of it on one machine. Counted are operations and memory of the largest domain, the operations of the
largest shared front at each depth, which follow each other, and what the domains send each other in one factorisation and in one
solution. Times follow from the speed of cores and network, which are assumed. Grids that are too large for this machine follow from
the growth of the last two that are not.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np

from wiggleroom.program.nested_dissection import dissect

BLOCK = 3
NUMBER = 8  # bytes
NETWORK, LATENCY = 1.25e9, 50e-6
"""Bytes a second and seconds a message of ten-gigabit Ethernet."""
ITERATIONS, FACTORISATIONS, SOLUTIONS = 100, 1.3, 4
"""Of a question, and of each iteration, as counted on 128 x 128 tees."""
WORK_PER_BODY = 11e-6
"""Seconds of one core an iteration for rows, retraction and vectors of a body, as measured on 64 x 64 tees."""
CORES, CORE_SPEED = 32, 10e9
"""Of each machine; operations a second of a core in dense fronts."""


@dataclass(frozen=True)
class Split:
    """Work and traffic of a factorisation that is cut into domains: the largest domain, the shared fronts, bytes of all domains."""

    domains: int
    domain_operations: float
    shared_operations: float
    domain_memory: float
    sent_matrix: float
    sent_vector: float


def neighbours(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Neighbours of the bodies of a grid, across corners too, in compressed rows."""
    at = np.arange(n * n).reshape(n, n)
    pairs = [(at[:, :-1], at[:, 1:]), (at[:-1], at[1:]), (at[:-1, :-1], at[1:, 1:]), (at[:-1, 1:], at[1:, :-1])]
    one = np.concatenate([a.ravel() for a, b in pairs] + [b.ravel() for a, b in pairs])
    other = np.concatenate([b.ravel() for a, b in pairs] + [a.ravel() for a, b in pairs])
    order = np.argsort(one, kind="stable")
    return np.concatenate([[0], np.cumsum(np.bincount(one, minlength=n * n))]), other[order]


def split(n: int, depths: range) -> list[Split]:
    """The tree of a grid, cut at several depths."""
    x, y = np.meshgrid(np.arange(float(n)), np.arange(float(n)))
    tree = dissect(np.column_stack([x.ravel(), y.ravel()]), *neighbours(n))
    wide, high = (BLOCK * np.diff(count).astype(float) for count in (tree.first, tree.border_start))
    operations = wide**3 / 3 + wide**2 * high + wide * high**2
    memory = NUMBER * (wide * (wide + high))
    out = []
    for depth in depths:
        roots = np.flatnonzero(tree.depth == depth)
        top = tree.depth < depth
        # nodes stand after all below them, so the cumulative sums of a domain end at its root
        last = np.concatenate([[-1], roots])
        total = np.concatenate([[0.0], np.cumsum(np.where(top, 0.0, operations))])
        held = np.concatenate([[0.0], np.cumsum(np.where(top, 0.0, memory))])
        out.append(
            Split(
                domains=len(roots),
                domain_operations=float(np.diff(total[last + 1]).max()),
                shared_operations=float(sum(operations[tree.depth == d].max() for d in range(depth))),
                domain_memory=float(np.diff(held[last + 1]).max()),
                sent_matrix=float(NUMBER * (high[roots] ** 2 / 2).sum()),
                sent_vector=float(2 * NUMBER * high[roots].sum()),
            )
        )
    return out


def main() -> None:
    """Print one line a cut."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--largest", type=int, default=1000, help="side of the largest grid whose tree is made")
    asked = parser.parse_args()
    print(
        "| bodies | machines | domain Gflop | shared Gflop | domain GB | sent MB a factorisation | s an iteration | h a question |"
    )
    print("| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    half, whole = (split(n, range(2, 9, 2)) for n in (asked.largest // 2, asked.largest))
    for doublings in (0, 10_000 / asked.largest):
        bodies = asked.largest**2 * max(doublings, 1) ** 2
        for small, large in zip(half, whole, strict=True):
            grown = {
                name: value * max(doublings, 1) ** np.log2(value / getattr(small, name))
                for name, value in vars(large).items()
                if name != "domains"
            }
            machine = CORES * CORE_SPEED
            seconds = FACTORISATIONS * (
                (grown["domain_operations"] + grown["shared_operations"]) / machine
                + grown["sent_matrix"] / large.domains / NETWORK
            )
            seconds += WORK_PER_BODY * bodies / large.domains / CORES
            seconds += SOLUTIONS * (
                grown["sent_vector"] / large.domains / NETWORK + 2 * np.log2(large.domains) * LATENCY
            )
            print(
                f"| {bodies:.0e} | {large.domains} | {grown['domain_operations'] / 1e9:.0f} | {grown['shared_operations'] / 1e9:.0f} | "
                f"{grown['domain_memory'] / 1e9:.1f} | {grown['sent_matrix'] / 1e6:.0f} | {seconds:.2g} | "
                f"{ITERATIONS * seconds / 3600:.2g} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
