"""The pair models side by side: `python -m benchmarks.models`.

Chains of ten blocks against the true optimum of tests/oracle/chain_values.json, and one joint against sampled collision.
"""

from __future__ import annotations

import numpy as np
import shapely
from rich.console import Console
from rich.table import Table
from tests.audit import reachable
from tests.oracle.blocks import block, outline
from tests.oracle.chain import stored
from tests.oracle.collision import overlaps

import wiggleroom as wr
from wiggleroom.assembly.build import assemble
from wiggleroom.freespace.models.pair_models import PairModel, Walls

MODELS: dict[str, PairModel] = {
    "walls": Walls(),
    "hull, about the reference point": wr.Hull(),
    "hull, about the joint": wr.Hull("joint"),
    "hull, about the joint, 8 rounds": wr.Hull("joint", rounds=8),
    "hull of 41 slices": wr.Hull(slices=41),
    "half-planes, one linear program": wr.HalfPlane(iterated=False),
    "half-planes, step by step": wr.HalfPlane(),
}
SAMPLES = 100_000


def chain(joint: str, gap: float, n: int) -> wr.Assembly:
    """Blocks in a row, the first fixed, the last pulled sideways."""
    region = wr.Region(outline(joint))
    parts = tuple(wr.Part(f"b{k + 1}", (region,), (float(k), 0.0, 0.0), fixed=k == 0) for k in range(n))
    return assemble(wr.Drawing(parts, gap=gap, goals=(wr.Pull(f"b{n}", (0.0, 1.0)),)))


def shares(console: Console) -> None:
    """Share of the true optimum on chains."""
    cases = [(joint, gap) for joint in ("tee", "swallowtail", "hook") for gap in (0.01, 0.02)]
    table = Table(
        "model", *(f"{joint} {gap}" for joint, gap in cases), title="share of the true optimum, 10 blocks [%]"
    )
    for name, model in MODELS.items():
        cells = []
        for joint, gap in cases:
            answer = wr.flex(chain(joint, gap, 10), model=model)
            said = "" if answer.collision_free else " *"
            cells.append(f"{100 * (answer.objective or 0.0) / stored(joint, gap, 10)[0]:.2f}{said}")
        table.add_row(name, *cells)
    console.print(table, "* parts overlap")


def accuracy(console: Console, joint: str) -> None:
    """One joint against samples in the box round all slices."""
    pair, body, D = chain(joint, 0.01, 2), block(joint, 0.01), np.array([1.0, 0.0])
    walls = wr.free_space(pair, "b1", "b2")
    boxes = shapely.bounds([s.region for s in walls.slices])
    low, high = (*boxes[:, :2].min(0), walls.angles[0]), (*boxes[:, 2:].max(0), walls.angles[1])
    samples = np.random.default_rng(0).uniform(low, high, (SAMPLES, 3))
    free = ~overlaps(body, body, samples, D) & reachable(walls, samples)
    table = Table(
        "model", "rows", "accuracy %", "unsafe %", "lost % of free", "turns to [deg]", title=f"{joint}, gap 0.01"
    )
    for name, model in MODELS.items():
        if "rounds" in name or "step" in name:
            continue
        space = wr.free_space(pair, "b1", "b2", model=model)
        found = space.contains(samples)
        right, unsafe, lost = (found == free).mean(), (found & ~free).mean(), (free & ~found).sum() / free.sum()
        figures = (f"{100 * x:.2f}" for x in (right, unsafe, lost))
        table.add_row(name, str(space.rows), *figures, f"{np.degrees(space.angles[1]):.2f}")
    console.print(table)


def main() -> None:
    """Print the tables."""
    console = Console(width=130)
    for joint in ("tee", "swallowtail"):
        accuracy(console, joint)
    shares(console)


if __name__ == "__main__":
    main()
