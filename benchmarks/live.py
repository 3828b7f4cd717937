"""How long a drag and a move of the gap slider take to the true answer, in the process that solves.

``python -m benchmarks.live`` prints a table; ``--names jigsaw,panel`` measures some, ``--moves 40`` fewer moves.

A drag goes in steps of a moving pointer from the grip of a random part to a random place up to 30 gaps away; a jump goes
there at once. A slide changes the gap a little, as a slider does, a leap to anywhere between half and one and a half of
it. Every motion is compared with exact geometry that shares nothing with the solver; its overlap would be printed.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import shapely

import wiggleroom as wr
from wiggleroom.assembly.assembly import place

DRAWINGS = Path(__file__).parents[1] / "examples" / "drawings"
STEPS = 8
"""Moves of the pointer in one drag."""
FAR = 30.0
"""Furthest target, in gaps."""
SLIDE = 0.03
"""Largest change of the gap in one move of the slider, as a share of it."""

ASSEMBLIES: dict[str, Callable[[], wr.Assembly]] = {
    "tee 10 x 10, gap 0.01": lambda: wr.patterns.grid(10, 10, joint="tee", gap=0.01),
    "panel 10 x 10, gap 0.2": lambda: wr.read(DRAWINGS / "jointpanel_10x10.svg", gap=0.2, fix=["p-1"]),
    "jigsaw 10 x 10, gap 1": lambda: wr.read(DRAWINGS / "pyjigsaw_10x10.svg", gap=1.0, fix=["p1"]),
    "tee 27 x 25, gap 0.01": lambda: wr.patterns.grid(27, 25, joint="tee", gap=0.01),
}


def moves(
    assembly: wr.Assembly, random: np.random.Generator, steps: int
) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """Part, grip and target of one drag after another, each in some steps."""
    free = [k for k, part in enumerate(assembly.parts) if not part.fixed]
    while True:
        k = int(random.choice(free))
        grip, angle = assembly.rest[k, :2], random.uniform(0, 2 * np.pi)
        away = random.uniform(0, FAR * assembly.gap) * np.array([np.cos(angle), np.sin(angle)])
        for step in range(1, steps + 1):
            yield assembly.names[k], grip, grip + step / steps * away


def _clock() -> np.ndarray:
    """Wall clock and processor time."""
    return np.array([time.perf_counter(), time.process_time()])


def drags(
    live: wr.Live, count: int, steps: int, random: np.random.Generator
) -> tuple[list[np.ndarray], list[wr.LiveResult]]:
    """Seconds of every move, and its shot."""
    seconds, shots = [], []
    for (part, grip, target), _ in zip(moves(live.assembly, random, steps), range(count), strict=False):
        began = _clock()
        shots.append(live.drag(part, tuple(grip), tuple(target), seconds=60.0))
        seconds.append(_clock() - began)
    return seconds, shots


def slides(
    live: wr.Live, count: int, share: float | None, random: np.random.Generator
) -> tuple[list[np.ndarray], list[wr.LiveResult]]:
    """Seconds of every move of the slider, and its shot; with a share small moves, else anywhere."""
    middle, last = live.assembly.gap, live.assembly.names[-1]
    goal, gap = wr.Pull(last, (1.0, 0.0)), middle
    seconds, shots = [], []
    for _ in range(count):
        gap = middle * random.uniform(0.5, 1.5) if share is None else gap * (1 + random.uniform(-share, share))
        began = _clock()
        live.design(gap=float(gap))
        shots.append(live.flex(goal, seconds=60.0))
        seconds.append(_clock() - began)
        _overlap(live.assembly, shots[-1].motion)
    live.design(gap=middle)
    return seconds, shots


def _overlap(assembly: wr.Assembly, motion: np.ndarray) -> None:
    """Complain where parts overlap."""
    made = []
    for part, by in zip(assembly.parts, motion, strict=True):
        at = tuple(np.asarray(part.at) + by)
        made.append(
            shapely.union_all(
                [shapely.Polygon(place(r.outer, at), [place(h, at) for h in r.holes]) for r in part.regions]
            )
        )
    a, b = shapely.STRtree(made).query(made, predicate="intersects")
    shared = shapely.area(shapely.intersection(np.array(made)[a[a < b]], np.array(made)[b[a < b]]))
    if shared.max(initial=0.0) > 1e-9 * assembly.size**2:
        print(f"  overlap of {shared.max():.3g} mm2")


def _line(name: str, seconds: list[np.ndarray], shots: list[wr.LiveResult]) -> None:
    middle, most, worst = 1e3 * np.percentile([s[0] for s in seconds], [50, 95, 100])
    spent = 1e3 * np.percentile([s[1] for s in seconds], 95)
    settled = sum(shot.settled for shot in shots)
    print(
        f"  {name:8s} {middle:7.0f} {most:7.0f} {worst:7.0f} {spent:10.0f}        {settled} of {len(shots)} settled",
        flush=True,
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--names", default="", help="some assemblies by the beginning of their names, separated by commas"
    )
    parser.add_argument("--moves", type=int, default=100)
    options = parser.parse_args()
    print("            median  95 %   worst  95 % of processor time [ms]")
    for name, make in ASSEMBLIES.items():
        if options.names and not name.startswith(tuple(options.names.split(","))):
            continue
        assembly = make()
        live, random = wr.Live(assembly), np.random.default_rng(1)
        began = time.perf_counter()
        live.design()
        print(f"{name}: {len(assembly.parts)} parts, prepared in {time.perf_counter() - began:.2f} s")
        drags(live, 3, 1, random)  # compiled code is loaded
        live.rest()
        for what, steps in (("drag", STEPS), ("jump", 1)):
            seconds, shots = drags(live, options.moves, steps, random)
            for shot in shots:
                _overlap(assembly, shot.motion)
            _line(what, seconds, shots)
        live.flex(wr.Pull(assembly.names[-1], (1.0, 0.0)), seconds=60.0)
        for what, share in (("slide", SLIDE), ("leap", None)):
            _line(what, *slides(live, options.moves, share, random))


if __name__ == "__main__":
    main()
