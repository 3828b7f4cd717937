"""Interlocking pairs that nobody drew by hand, from a seed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from .closed_forms import rectangle
from .geometry import inset_polygon

SHARPEST = np.radians(35)  # corners sharper than this would grow long mitres


@dataclass(frozen=True)
class Pair:
    """Two parts as drawn (they touch all along the joint) and as made (`gap` apart), in assembly position.

    The reference point of A is the origin, that of B is `D`; neither is turned at rest.
    """

    drawn: tuple[shapely.Polygon, shapely.Polygon]
    made: tuple[shapely.Polygon, shapely.Polygon]
    D: np.ndarray
    gap: float

    def local(self) -> tuple[shapely.Polygon, shapely.Polygon, np.ndarray]:
        """A, B about its own reference point, and D: what the collision test takes."""
        return self.made[0], shapely.transform(self.made[1], lambda p: p - self.D), self.D


def tab_pair(seed: int, gap: float = 0.01, holes: bool = False) -> Pair:
    """A block with a random pocket in its right side and a block with the tab that fills it, unit blocks.

    The tab has 4 to 16 corners, undercuts and no symmetry; with `holes` both blocks have a hole of their own.
    """
    rng = np.random.default_rng(seed)
    for _ in range(20000):
        profile = _profile(rng)
        if profile is None:
            continue
        left, right = _blocks(profile)
        if holes:
            left, right = _with_hole(left, rng, -0.28), _with_hole(right, rng, 1.3)
        pair = _pair(left, right, np.array([1.0, 0.0]), gap)
        if pair is not None:
            return pair
    raise ValueError(f"no joint found for seed {seed} and gap {gap}")


def peg_pair(seed: int, gap: float = 0.01, holes: bool = False) -> Pair:
    """A ring part with a random hole and the peg that fills it; with `holes` the peg is a ring itself."""
    rng = np.random.default_rng(seed)
    for _ in range(20000):
        corners = _star(rng, int(rng.integers(4, 13)), 0.12, 0.38, 0, 2 * np.pi, wrap=True)
        if not _sound(corners, closed=True):
            continue
        D = shapely.get_coordinates(shapely.centroid(shapely.Polygon(corners)))[0]
        peg = shapely.Polygon(corners, [rectangle(0.06, 0.08, (0, 0))] if holes else [])
        pair = _pair(shapely.Polygon(rectangle(1, 1), [corners]), peg, D, gap)
        if pair is not None:
            return pair
    raise ValueError(f"no peg found for seed {seed} and gap {gap}")


def _pair(a: shapely.Polygon, b: shapely.Polygon, D: np.ndarray, gap: float) -> Pair | None:
    """Both parts with the gap applied, or None where something vanishes or the clearance is not the gap."""
    if not (a.is_valid and b.is_valid):
        return None
    made = tuple(inset_polygon(p, gap / 2) for p in (a, b))
    if made[0] is None or made[1] is None or abs(shapely.distance(*made) - gap) > 1e-12:
        return None
    return Pair((a, b), (made[0], made[1]), D, gap)


def _blocks(profile: np.ndarray) -> tuple[shapely.Polygon, shapely.Polygon]:
    """Left block with the profile as pocket, right block with it as tab, one unit apart."""
    joint = np.add(profile, [0.5, 0])
    left = [[-0.5, -0.5], [0.5, -0.5], *joint[::-1], [0.5, 0.5], [-0.5, 0.5]]
    right = [[1.5, -0.5], [1.5, 0.5], [0.5, 0.5], *joint, [0.5, -0.5]]
    return shapely.Polygon(left), shapely.Polygon(right)


def _profile(rng: np.random.Generator) -> np.ndarray | None:
    """Tab from (0, high) to (0, low) through x < 0, or None if this try is no sound joint."""
    count = int(rng.integers(4, 17))
    half = rng.uniform(0.04, 0.12)
    ends = np.add([[0, half], [0, -half]], [0, rng.uniform(-0.15, 0.15)])
    if rng.random() < 0.6:
        centre = np.array([-rng.uniform(0.1, 0.22), ends[:, 1].mean() + rng.uniform(-0.06, 0.06)])
        opening = rng.uniform(0.5, 0.9)
        inner = _star(rng, count - 2, 0.07, 0.26, opening, 2 * np.pi - opening) + centre
    else:
        inner = _untangled(rng.uniform([-0.4, -0.32], [-0.05, 0.32], (min(count, 9) - 2, 2)), ends)
    profile = np.vstack([ends[:1], inner, ends[1:]])
    outside = inner[:, 0].max() > -0.03 or np.abs(inner[:, 1]).max() > 0.42 or inner[:, 0].min() < -0.45
    undercut = np.ptp(inner[:, 1]) > 2 * half + 0.04
    return profile if undercut and not outside and _sound(profile, closed=False) else None


def _star(
    rng: np.random.Generator, n: int, least: float, most: float, start: float, stop: float, wrap: bool = False
) -> np.ndarray:
    """Corners seen one after the other from the centre, at random distances."""
    steps = rng.uniform(0.4, 1.0, n + 1 if not wrap else n)
    angles = start + (stop - start) * np.cumsum(steps)[:n] / steps.sum()
    return rng.uniform(least, most, n)[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])


def _untangled(points: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """The same points in an order in which the line from end to end does not cross itself (2-opt)."""
    order = points
    for _ in range(60):
        line = np.vstack([ends[:1], order, ends[1:]])
        pieces = shapely.linestrings(np.stack([line[:-1], line[1:]], axis=1))
        crossing = [
            (i, j) for i in range(len(pieces)) for j in range(i + 2, len(pieces)) if pieces[i].crosses(pieces[j])
        ]
        if not crossing:
            break
        i, j = crossing[0]
        line[i + 1 : j + 1] = line[i + 1 : j + 1][::-1].copy()
        order = line[1:-1]
    return order


def _sound(corners: np.ndarray, closed: bool) -> bool:
    """No crossing, no corner too sharp, no edge too short."""
    line = np.vstack([corners, corners[:1]]) if closed else np.vstack([[0, 0.5], corners, [0, -0.5]])
    if not shapely.LineString(line).is_simple:
        return False
    if closed:
        line = np.vstack([line, corners[1:2]])
    edges = np.diff(line, axis=0)
    long = np.hypot(*edges.T)
    if long.min() < 0.03:
        return False
    cosine = -np.sum(edges[1:] * edges[:-1], axis=1) / (long[1:] * long[:-1])
    return bool(np.all((cosine < np.cos(SHARPEST)) & (cosine > -np.cos(np.radians(8)))))


def _with_hole(block: shapely.Polygon, rng: np.random.Generator, x: float) -> shapely.Polygon:
    """The block with a small quadrilateral hole near x, away from the joint."""
    hole = rectangle(0.2, 0.4, (x, rng.uniform(-0.2, 0.2))) + rng.uniform(-0.03, 0.03, (4, 2))
    return shapely.Polygon(block.exterior.coords, [hole])
