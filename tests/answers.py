"""Answers made by hand, for tests of what is shown and written."""

from __future__ import annotations

import numpy as np

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Drawing, Goal, Part, Pull, Region
from wiggleroom.search.answer import Answer, Contact
from wiggleroom.verdict import Verdict


def block(size: float = 1.0, hole: float = 0.0) -> Region:
    """A square about the origin, with a square hole where asked."""
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
    return Region(corners * size, (corners[::-1] * hole,) if hole else ())


def answer(
    parts: list[Part],
    motion: list[tuple[float, float, float]],
    goals: tuple[Goal, ...],
    objective: float | None,
    contacts: tuple[Contact, ...] = (),
    verdict: Verdict = Verdict.OPTIMAL,
    leaves: tuple[str, ...] = (),
    command: str = "wiggleroom flex it.json",
) -> Answer:
    """An answer as the engine gives it."""
    moved = np.array(motion, dtype=float)
    return Answer(
        assembly=Assembly(tuple(parts), Drawing(tuple(parts), gap=0.1, goals=goals)),
        goals=goals,
        verdict=verdict,
        objective=objective,
        motion=moved,
        waypoints=np.stack([np.zeros_like(moved), moved]),
        contacts=contacts,
        path="checked",
        collision_free=True,
        deepest_overlap=0.0,
        model="walls",
        solver="interior-point",
        rounds=2,
        iterations=41,
        seconds={"read": 0.01, "freespace": 0.2, "solve": 0.1, "total": 0.31},
        leaves=leaves,
        command=command,
    )


def row(n: int = 5, scale: float = 1.0, shift: float = 0.0, lift: float = 0.3) -> Answer:
    """`n` blocks in a row, the first fixed, the last lifted most."""
    parts = [Part(f"b{k + 1}", (block(0.9 * scale),), (shift + k * scale, shift, 0.0), fixed=k == 0) for k in range(n)]
    motion = [(0.0, lift * scale * k / max(n - 1, 1), 0.01 * k) for k in range(n)]
    touch = Contact(("b1", "b2"), (shift + 0.5 * scale, shift), (0.0, 1.0), 0.7)
    return answer(parts, motion, (Pull(f"b{n}", (0.0, 1.0)),), lift * scale, (touch,))


def grid(n: int) -> Answer:
    """`n` by `n` blocks, no two of one shape, all moved a little; many contacts."""
    parts, contacts = [], []
    for k in range(n * n):
        x, y = float(k % n), float(k // n)
        parts.append(Part(f"b{k + 1}", (block(0.9 - 1e-4 * k / n),), (x, y, 0.0), fixed=k == 0))
        if k:
            contacts.append(Contact((f"b{k}", f"b{k + 1}"), (x - 0.5, y), (1.0, 0.0), 1.0 / k))
    motion = [(0.02 * k / n, 0.01 * k / n, 0.0) for k in range(n * n)]
    return answer(parts, motion, (Pull(f"b{n * n}", (1.0, 0.0)),), 0.02 * n, tuple(contacts))
