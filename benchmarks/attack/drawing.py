"""Assembly files drawn from shapely polygons, with the clearance already in them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import shapely
from shapely import Polygon, affinity

Json = dict[str, Any]
Random = np.random.Generator


def box(x0: float, y0: float, x1: float, y1: float) -> Polygon:
    """Rectangle."""
    return shapely.box(x0, y0, x1, y1)


def disc(radius: float, count: int = 24, at: Sequence[float] = (0.0, 0.0), phase: float = 0.0) -> Polygon:
    """Regular polygon round a circle's centre."""
    turn = 2 * np.pi * np.arange(count) / count + phase
    return Polygon(np.column_stack([at[0] + radius * np.cos(turn), at[1] + radius * np.sin(turn)]))


def polar(radii: Sequence[float], phase: float = 0.0) -> Polygon:
    """Polygon with corners evenly round the origin."""
    turn = 2 * np.pi * np.arange(len(radii)) / len(radii) + phase
    r = np.asarray(radii)
    return Polygon(np.column_stack([r * np.cos(turn), r * np.sin(turn)]))


def wider(shape: Polygon, by: float) -> Polygon:
    """Outline moved outward, or inward, with mitred corners."""
    return shapely.buffer(shape, by, join_style="mitre", mitre_limit=4.0)


def band(points: Sequence[Sequence[float]], width: float) -> Polygon:
    """Channel along a line."""
    return shapely.buffer(shapely.LineString(points), width / 2, cap_style="square", join_style="mitre")


def moved(shape: Polygon, x: float = 0.0, y: float = 0.0, turn: float = 0.0, about: Any = (0.0, 0.0)) -> Polygon:
    """The shape turned [rad] about a point, then moved."""
    return affinity.translate(affinity.rotate(shape, turn, origin=about, use_radians=True), x, y)


def union(*shapes: Polygon) -> Polygon:
    """All material of some shapes."""
    return shapely.union_all(shapes)


def cut(shape: Polygon, *others: Polygon) -> Polygon:
    """What is left of a shape without others."""
    return shapely.difference(shape, shapely.union_all(others))


def pieces(shape: Polygon) -> list[Polygon]:
    """The connected pieces of some material, without crumbs."""
    found = [p for p in shapely.get_parts(shape) if p.geom_type == "Polygon"]
    return [p for p in found if p.area > 1e-3 * shape.area]


def part(name: str, shape: Polygon, *, fixed: bool = False) -> Json:
    """A part whose reference point is its centroid."""
    regions = []
    at = np.array(shape.centroid.coords[0])
    for piece in shapely.get_parts(shapely.orient_polygons(shape)):
        rings = [(np.array(r.coords[:-1]) - at).tolist() for r in (piece.exterior, *piece.interiors)]
        regions.append({"outline": rings[0], "holes": rings[1:]})
    body: Json = regions[0] if len(regions) == 1 else {"outlines": regions}
    return {"name": name, **body, "at": [*at.tolist(), 0.0], **({"fixed": True} if fixed else {})}


def pull(name: str, direction: Sequence[float], point: Sequence[float] | None = None) -> Json:
    """A pull, of the reference point unless another is named."""
    return {"part": name, "direction": [float(x) for x in direction], **({"point": [*point]} if point else {})}


def turn(name: str, sense: str) -> Json:
    """A turn."""
    return {"part": name, "turn": sense}


def anywhere(rng: Random) -> tuple[float, float]:
    """A direction; often along an axis."""
    angle = rng.integers(4) * np.pi / 2 if rng.random() < 0.4 else rng.uniform(0, 2 * np.pi)
    return float(np.cos(angle)), float(np.sin(angle))


def goal(rng: Random, names: Sequence[str]) -> Json:
    """A pull anywhere or a turn of one of some parts."""
    name = names[int(rng.integers(len(names)))]
    return turn(name, str(rng.choice(["cw", "ccw"]))) if rng.random() < 0.25 else pull(name, anywhere(rng))


def assembly(parts: Iterable[Json], asked: Iterable[Json], **more: Any) -> Json:
    """An assembly file with its goals."""
    return {"format": "wiggleroom/1", "unit": "mm", "parts": list(parts), "pull": list(asked), **more}


def turned(made: Json, angle: float) -> Json:
    """The same assembly, turned by an angle [rad] about the origin."""
    c, s = np.cos(angle), np.sin(angle)

    def spun(v: Sequence[float]) -> list[float]:
        return [float(c * v[0] - s * v[1]), float(s * v[0] + c * v[1])]

    parts = [p | {"at": [*spun(p["at"][:2]), p["at"][2] + float(np.degrees(angle))]} for p in made["parts"]]
    asked = []
    for one in made["pull"]:
        new = {k: spun(v) if k in ("direction", "point") else v for k, v in one.items()}
        asked.append(new)
    return made | {"parts": parts, "pull": asked}


def lie_apart(made: Json, least: float) -> bool:
    """True where no two parts are nearer to each other than `least` [mm], apart from pairs that are ignored or glued.

    Two that are fixed may touch, but not overlap.
    """
    from benchmarks.attack.oracle import TOLERANCE, Ground

    ground = Ground(made)
    shapes = ground.at(np.zeros((1, len(ground.names), 3)))
    deepest = max((float(ground.depth(shapes[i], shapes[j])[0]) for i, j in ground.standing), default=0.0)
    near = any(shapely.distance(shapes[i][0], shapes[j][0]) <= least for i, j in ground.pairs)
    return not near and deepest <= TOLERANCE * ground.size
