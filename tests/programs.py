"""Programs for tests of the mathematics and of the solvers: first rounds of small assemblies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from wiggleroom.assembly import patterns
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing, Goal, Part, Pull, Region
from wiggleroom.program.nonlinear_program import Program, build_program
from wiggleroom.program.objectives import objective
from wiggleroom.search.prepare import prepare_as_drawn


def first_program(assembly: Assembly, goals: Sequence[Goal] = ()) -> Program:
    """The program of the first round: one cell a pair, grown at rest."""
    ready = prepare_as_drawn(assembly)
    return build_program(
        ready.bodies, ready.cells, objective(assembly, ready.bodies, goals or assembly.goals), length=ready.clearance
    )


def with_roles(assembly: Assembly, fixed: Sequence[str] = (), glue: tuple[tuple[str, ...], ...] = ()) -> Assembly:
    """The same parts with other fixed ones and with glue."""
    parts = tuple(replace(p, fixed=p.name in fixed) for p in assembly.drawing.parts)
    return assemble(replace(assembly.drawing, parts=parts, glue=glue))


def squares(n: int, gap: float = 0.02) -> Assembly:
    """Plain squares in a row, nothing interlocked, the last one pulled away from the first, which is fixed."""
    region = Region(np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]))
    parts = tuple(Part(f"s{k + 1}", (region,), (float(k), 0.0, 0.0), fixed=k == 0) for k in range(n))
    return assemble(Drawing(parts, gap=gap, goals=(Pull(f"s{n}", (1.0, 0.0)),)))


ASSEMBLIES: dict[str, Callable[[], Assembly]] = {
    "tees": lambda: patterns.grid(3, 3),
    "tees, middle fixed, two glued": lambda: with_roles(patterns.grid(3, 3), ("b2-2",), (("b1-1", "b2-1"),)),
    "tees, fixed by glue": lambda: with_roles(
        patterns.grid(3, 2, gap=0.03), ("b2-1",), (("b2-1", "b2-2"), ("b3-1", "b3-2"))
    ),
    "revolute chain": lambda: patterns.chain(4, "revolute", 0.02),
    "revolute chain, middle fixed": lambda: with_roles(patterns.chain(5, "revolute", 0.02), ("b3",)),
    "jigsaw": lambda: patterns.jigsaw(2, 3, seed=3),
    "jigsaw, middle fixed, glued": lambda: with_roles(patterns.jigsaw(3, 2, seed=5), ("b2-1",), (("b1-1", "b1-2"),)),
}
