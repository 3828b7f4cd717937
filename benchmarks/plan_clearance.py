"""Clearances of plans beside a long random search: `python -m benchmarks.plan_clearance [TRIALS]` prints a line for each puzzle.

The search knows outlines and the two ends of a step alone, and measures by general polygon geometry at dense samples. It begins with the
step's own way and with straight and bent ones between its ends, and keeps whatever random change of waypoints widens the
narrowest place. No path has more room than there is where it begins: that ends the search early.
"""

from __future__ import annotations

import sys
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

import wiggleroom as wr
from benchmarks import plan_families as families
from wiggleroom.assembly.assembly import Assembly, place
from wiggleroom.planning.plan import Plan
from wiggleroom.planning.steps import Step

Floats = NDArray[np.float64]

TRIALS = 1500
POINTS, SAMPLES = 8, 6
"""Waypoints besides the first, and poses looked at on every piece."""
TOLD = 0.1
"""Plans say clearances up to this share of the drawing's size."""
BENT = 3
"""So many bent paths are begun with."""


class Room:
    """Distances of what moves in a step from all else, measured on the outlines."""

    def __init__(self, assembly: Assembly, step: Step) -> None:
        shapes = [shapely.union_all([shapely.Polygon(r.outer, r.holes) for r in p.regions]) for p in assembly.parts]
        self.rest = assembly.rest
        self.moving = [assembly.names.index(n) for n in step.parts]
        self.shapes = [shapes[k] for k in self.moving]
        self.as_one = step.as_one
        still = [k for k in np.flatnonzero(step.there) if k not in self.moving]
        self.others = shapely.union_all([_at(shapes[k], self.rest[k] + step.path[0, k]) for k in still])
        shapely.prepare(self.others)
        self.size = assembly.size
        self.radius = np.array([shapely.hausdorff_distance(s, shapely.Point(0, 0)) for s in self.shapes])

    def here(self, pose: Floats) -> float:
        """Least distance at some poses (m, 3) of what moves [mm]; nothing where it overlaps."""
        placed = [_at(s, p) for s, p in zip(self.shapes, pose, strict=True)]
        least = min((shapely.distance(p, self.others) for p in placed), default=np.inf)
        if not self.as_one:
            least = min([least, *(shapely.distance(p, q) for k, p in enumerate(placed) for q in placed[:k])])
        return float(least)

    def least(self, path: Floats) -> tuple[float, int]:
        """Least distance at samples of a path (k, m, 3), and the piece where it is."""
        worst, piece = np.inf, 0
        for k in range(len(path) - 1):
            for t in np.linspace(0, 1, SAMPLES + 1)[int(k > 0) :]:
                apart = self.here(path[k] + t * (path[k + 1] - path[k]))
                if apart < worst:
                    worst, piece = apart, k
        return worst, piece


def _at(shape: shapely.Geometry, pose: Floats) -> shapely.Geometry:
    return shapely.transform(shape, lambda p: place(p, pose))


def widest(assembly: Assembly, step: Step, trials: int, seed: int = 0) -> float:
    """Largest least distance of any path between the ends of a step that the search finds [mm]."""
    room, random = Room(assembly, step), np.random.default_rng(seed)
    own = (room.rest + step.path)[:, room.moving]
    limit = min(room.here(own[0]), TOLD * room.size)
    if not step.leaves:
        limit = min(limit, room.here(own[-1]))
    best = room.least(own)[0]
    begins = [_resampled(own)]
    straight = own[[0, -1]]
    for _ in range(BENT):
        bent = _resampled(straight)
        bent[1:-1, :, :2] += random.normal(0, 0.05 * room.size, 2)
        begins.append(bent)
    for begin in begins:
        path, (least, piece) = begin, room.least(begin)
        for _ in range(trials // len(begins)):
            if best > 0.99 * limit:
                return min(best, TOLD * room.size)
            trial = path.copy()
            k = piece + int(random.integers(2)) if random.random() < 0.5 else int(random.integers(1, len(path)))
            k = min(max(k, 1), len(path) - 2)
            scale = 0.1 * room.size * 10 ** random.uniform(-3, 0)
            change = random.normal(0, scale, (1 if room.as_one else len(room.moving), 3))
            change = np.repeat(change, len(room.moving), 0) if room.as_one else change
            change[:, 2] = 0.0 if room.as_one and len(room.moving) > 1 else change[:, 2] / room.radius.max()
            trial[k] += change
            found = room.least(trial)
            if found[0] >= least:
                path, (least, piece) = trial, found
        best = max(best, least)
    return min(best, TOLD * room.size)


def _resampled(path: Floats) -> Floats:
    """The path with about the wanted number of waypoints; those it has are kept."""
    out = [path[:1]]
    each = max(1, POINTS // (len(path) - 1))
    for one, other in pairwise(path):
        out.append(one + (other - one) * (np.arange(1, each + 1) / each)[:, None, None])
    return np.concatenate(out)


def row(name: str, found: Plan, trials: int = TRIALS) -> float:
    """Print the steps' least clearance beside the best that was found; the least ratio."""
    ratio, where = np.inf, 0
    for k, step in enumerate(found.steps):
        best = widest(found.assembly, step, trials, seed=k)
        share = step.clearance / best if best > 0 else np.inf
        if share < ratio:
            ratio, where = share, k
    print(
        f"{name:22} {len(found.steps):3} steps  least share of the best found {ratio:.2f}, in step {where + 1}",
        flush=True,
    )
    return ratio


def main(trials: int) -> None:
    """All puzzles."""
    for count in (3, 4, 5, 6):
        row(f"pinwheel {count}", wr.plan(families.pinwheel(count)), trials)
    for count in (3, 5):
        row(f"pinwheel {count}, tilted", wr.plan(families.pinwheel(count, tilt=0.2)), trials)
    for name in ("rotation", "sequential", "simultaneous"):
        row(name, wr.plan(wr.read(f"examples/17_does_it_come_apart/{name}.json")), trials)
    row("lock 3", wr.plan(families.tumbler_lock(3), ("bolt",)), trials)
    row("latches 3", wr.plan(families.latches(3), ("bolt",)), trials)
    row("turning room", wr.plan(families.turning_room(), ("bar",)), trials)
    for seed in (1008, 1010):
        row(f"tray {seed}", wr.plan(families.tray(*families.random_tray(seed))), trials)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else TRIALS)
