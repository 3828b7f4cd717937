"""Judge of motions and paths: polygons by shapely, adaptive subdivision by a Lipschitz bound; it reads the file itself."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

Json = dict[str, Any]
Floats = NDArray[np.float64]

TOLERANCE = 1.5e-9
"""Overlap that counts as none, as a share of the size; the contract says 1e-9, the rest is for rounding."""
MAX_LEVELS = 7
"""Pieces are halved at most so often where parts touch."""
MAX_LOOKS = 30_000
"""Positions of a pair that are looked at on a path, at most."""


@dataclass(frozen=True)
class Overlap:
    """Where two parts overlap on a path: how deep [mm], and at which piece and share of it."""

    parts: tuple[str, str]
    depth: float
    piece: int
    share: float

    def __str__(self) -> str:
        """One line for a report."""
        return (
            f"{self.parts[0]} and {self.parts[1]} overlap {self.depth:.3g} mm deep at {self.piece} + {self.share:.4f}"
        )


class Ground:
    """The parts of an assembly file with gap 0, as drawn."""

    def __init__(self, made: Json) -> None:
        if made.get("gap"):
            message = "the judge reads files whose clearance is drawn"
            raise ValueError(message)
        self.made = made
        self.names = [p["name"] for p in made["parts"]]
        self.fixed = np.array([bool(p.get("fixed")) for p in made["parts"]])
        self.rest = np.array([[*p["at"][:2], np.radians(p["at"][2])] for p in made["parts"]])
        self.rings = [_rings(p) for p in made["parts"]]
        self.radius = np.array([max(np.hypot(*r.T).max() for _, r in rings) for rings in self.rings])
        body = {name: name for name in self.names}
        for group in made.get("glue", []):
            body |= dict.fromkeys(group, group[0])
        ignored = {frozenset(pair) for pair in made.get("ignore", [])}
        apart = [
            (i, j)
            for i, j in combinations(range(len(self.names)), 2)
            if body[self.names[i]] != body[self.names[j]] and frozenset((self.names[i], self.names[j])) not in ignored
        ]
        self.pairs = [(i, j) for i, j in apart if not (self.fixed[i] and self.fixed[j])]
        self.standing = [(i, j) for i, j in apart if self.fixed[i] and self.fixed[j]]
        still = self.at(np.zeros((1, len(self.names), 3)))
        low_x, low_y, high_x, high_y = shapely.total_bounds(np.concatenate(still))
        self.size = float(max(high_x - low_x, high_y - low_y))

    def at(self, motions: Floats, who: Any = None) -> list[NDArray[np.object_]]:
        """Material (k,) of every part, or of some, at motions (k, n, 3)."""
        return [self._placed(p, self.rest[p] + motions[:, p]) for p in (range(len(self.names)) if who is None else who)]

    def _placed(self, p: int, pose: Floats) -> NDArray[np.object_]:
        c, s = np.cos(pose[:, 2])[:, None], np.sin(pose[:, 2])[:, None]
        rings, region = [], []
        for outer, ring in self.rings[p]:
            x, y = ring.T
            points = np.stack([c * x - s * y + pose[:, :1], s * x + c * y + pose[:, 1:2]], axis=2)
            rings.append(shapely.linearrings(points))
            region.append(outer)
        outers = sorted(set(region))
        solids = []
        for outer in outers:
            mine = [r for r, o in zip(rings, region, strict=True) if o == outer]
            holes = np.stack(mine[1:], axis=1) if len(mine) > 1 else None
            solids.append(shapely.polygons(mine[0], holes=holes))
        return solids[0] if len(solids) == 1 else shapely.union_all(np.stack(solids, axis=1), axis=1)

    def depth(self, one: NDArray[np.object_], other: NDArray[np.object_]) -> Floats:
        """How deep two rows of shapes (k,) overlap [mm]: a corner of their common material from either rim, or the disc that fits in it.

        Equal blocks that lie on each other in line have no corner off both rims. A disc of area over perimeter fits into any region.
        """
        out = np.zeros(len(one))
        hit = np.flatnonzero(shapely.intersects(one, other))
        common = shapely.intersection(one[hit], other[hit])
        solid = shapely.area(common) > 0
        for k, shape in zip(hit[solid], common[solid], strict=True):
            spots = shapely.points(shapely.get_coordinates(shape))
            rims = [shapely.boundary(x) for x in (one[k], other[k])]
            width = shapely.area(shape) / shapely.length(shape)
            out[k] = max(width, *(shapely.distance(rim, spots).max() for rim in rims))
        return out

    def overlap(self, motion: Floats) -> Overlap | None:
        """An overlap at one motion (n, 3)."""
        return self.overlap_on(np.stack([motion, motion]))

    def overlap_on(self, waypoints: Floats, levels: int = MAX_LEVELS, without: Collection[str] = ()) -> Overlap | None:
        """The first overlap that is found along straight motion between waypoints (k, n, 3) of all parts but some, or None."""
        for i, j in self.pairs:
            if self.names[i] in without or self.names[j] in without:
                continue
            found = self._pair(i, j, waypoints, levels)
            if found is not None:
                return found
        return None

    def _pair(self, i: int, j: int, waypoints: Floats, levels: int) -> Overlap | None:
        change = np.diff(waypoints, axis=0)
        # no point of j moves faster past i than this, in units of a piece
        speed = np.hypot(*(change[:, j] - change[:, i])[:, :2].T)
        speed += self.radius[i] * np.abs(change[:, i, 2]) + self.radius[j] * np.abs(change[:, j, 2])
        piece = np.arange(len(change))
        middle, half = np.full(len(piece), 0.5), 0.5
        looks = 0
        for level in range(levels + 1):
            motions = waypoints[piece] + middle[:, None, None] * change[piece]
            apart = self.rest[j, :2] + motions[:, j, :2] - self.rest[i, :2] - motions[:, i, :2]
            room = np.hypot(*apart.T) - self.radius[i] - self.radius[j]
            near = room <= speed[piece] * half
            piece, middle, motions = piece[near], middle[near], motions[near]
            if not len(piece):
                return None
            one, other = self.at(motions, (i, j))
            depth = self.depth(one, other)
            if depth.max() > TOLERANCE * self.size:
                k = int(depth.argmax())
                return Overlap((self.names[i], self.names[j]), float(depth[k]), int(piece[k]), float(middle[k]))
            looks += len(piece)
            close = shapely.distance(one, other) <= speed[piece] * half
            piece, middle = piece[close], middle[close]
            half /= 2
            if level == levels or looks + 2 * len(piece) > MAX_LOOKS:
                break
            piece, middle = np.repeat(piece, 2), np.repeat(middle, 2)
            middle[0::2] -= half
            middle[1::2] += half
        ends = waypoints
        one, other = self.at(ends, (i, j))
        depth = self.depth(one, other)
        k = int(depth.argmax())
        if depth[k] > TOLERANCE * self.size:
            return Overlap((self.names[i], self.names[j]), float(depth[k]), k, 0.0)
        return None

    def value(self, motion: Floats) -> float:
        """Sum of the file's goals at a motion (n, 3)."""
        total = 0.0
        for one in self.made["pull"]:
            p = self.names.index(one["part"])
            x, y, angle = motion[p]
            if "turn" in one:
                total += angle * (1 if one["turn"] == "ccw" else -1)
                continue
            direction = np.array(one["direction"]) / np.hypot(*one["direction"])
            arm = np.array(one.get("point", self.rest[p, :2])) - self.rest[p, :2]
            c, s = np.cos(angle) - 1, np.sin(angle)
            total += float(direction @ (x + c * arm[0] - s * arm[1], y + s * arm[0] + c * arm[1]))
        return total

    def slope(self, motion: Floats) -> Floats:
        """Derivative (n, 3) of that sum."""
        out = np.zeros((len(self.names), 3))
        for one in self.made["pull"]:
            p = self.names.index(one["part"])
            if "turn" in one:
                out[p, 2] += 1 if one["turn"] == "ccw" else -1
                continue
            direction = np.array(one["direction"]) / np.hypot(*one["direction"])
            arm = np.array(one.get("point", self.rest[p, :2])) - self.rest[p, :2]
            c, s = np.cos(motion[p, 2]), np.sin(motion[p, 2])
            out[p, :2] += direction
            out[p, 2] += float(direction @ (-s * arm[0] - c * arm[1], c * arm[0] - s * arm[1]))
        return out


def _rings(part: Json) -> list[tuple[int, Floats]]:
    """Number of the region and corners (m, 2) of every ring, outer ones before their holes."""
    regions = part.get("outlines", [part])
    out = []
    for k, region in enumerate(regions):
        out += [(k, np.array(ring, dtype=float)) for ring in (region["outline"], *region.get("holes", []))]
    return out
