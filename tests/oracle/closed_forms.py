"""Small assemblies whose largest motion has an exact formula, each with a motion that reaches it.

Every builder returns a `Case`. Lengths are free; reasons for the formulas stand beside them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from .geometry import turn


@dataclass(frozen=True)
class Pull:
    """weight x direction . displacement of the material point `point` (assembly coordinates at rest)."""

    part: int
    direction: tuple[float, float]
    point: tuple[float, float]
    weight: float = 1.0


@dataclass(frozen=True)
class Case:
    """An assembly, its objective, the exact largest value and a motion that reaches it.

    `parts` lie where they rest, `at` (n, 2) are their reference points, `turns` holds (part, weight) with counter-
    clockwise turns in radians. `value` is infinite and `witness` (n, 3) None where nothing stops the motion.
    """

    name: str
    parts: tuple[shapely.Polygon, ...]
    at: np.ndarray
    value: float
    witness: np.ndarray | None
    fixed: tuple[int, ...] = (0,)
    pulls: tuple[Pull, ...] = ()
    turns: tuple[tuple[int, float], ...] = ()

    def objective(self, motion: np.ndarray) -> np.ndarray:
        """Objective of motions (..., n, 3) about the reference points."""
        total = np.zeros(motion.shape[:-2])
        for p in self.pulls:
            x, y, theta = np.moveaxis(motion[..., p.part, :], -1, 0)
            arm, (ux, uy) = np.subtract(p.point, self.at[p.part]), unit(p.direction)
            c, s = np.cos(theta), np.sin(theta)
            dx, dy = x + (c - 1) * arm[0] - s * arm[1], y + s * arm[0] + (c - 1) * arm[1]
            total += p.weight * (ux * dx + uy * dy)
        for part, weight in self.turns:
            total += weight * motion[..., part, 2]
        return total


def unit(direction: Sequence[float]) -> np.ndarray:
    """Direction of length one."""
    return np.asarray(direction, dtype=float) / np.linalg.norm(direction)


def rectangle(width: float, height: float, centre: Sequence[float] = (0, 0)) -> np.ndarray:
    """Corners, counter-clockwise."""
    return np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [width / 2, height / 2] + centre


def regular(n: int, radius: float, angle: float = 0.0) -> np.ndarray:
    """Corners of a regular polygon of this circumradius, the first one at `angle`."""
    t = angle + 2 * np.pi * np.arange(n) / n
    return radius * np.column_stack([np.cos(t), np.sin(t)])


def frame(*holes: np.ndarray, wall: float = 1.0) -> shapely.Polygon:
    """Rectangular part with these holes and at least `wall` of material round them."""
    points = np.concatenate(holes)
    (x0, y0), (x1, y1) = points.min(axis=0) - wall, points.max(axis=0) + wall
    return shapely.Polygon([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], list(holes))


def _case(
    name: str,
    parts: Sequence[shapely.Polygon],
    at: Sequence[Sequence[float]] | np.ndarray,
    value: float,
    last: object,
    **rest: object,
) -> Case:
    """Case whose first part is fixed; `last` are the motions of the others."""
    witness = None if last is None else np.vstack([np.zeros(3), np.reshape(np.asarray(last, dtype=float), (-1, 3))])
    return Case(name, tuple(parts), np.asarray(at, dtype=float), float(value), witness, **rest)  # type: ignore[arg-type]


# -- a peg in a hole ------------------------------------------------------------------------------------------------


def square_turn_limit(s: float, c: float) -> float:
    """Largest turn of a square of side s in a square hole of side s + 2c: s (cos + sin) = s + 2c."""
    return 0.5 * np.arcsin((1 + 2 * c / s) ** 2 - 1)


def _square(s: float, c: float) -> list[shapely.Polygon]:
    return [frame(rectangle(s + 2 * c, s + 2 * c), wall=s), shapely.Polygon(rectangle(s, s))]


def square_shift(s: float = 1.0, c: float = 0.05, direction: tuple[float, float] = (1, 0)) -> Case:
    """Unturned, the centre is free in a square of half-side c; any turn makes the peg wider and higher."""
    u = unit(direction)
    pulls = (Pull(1, direction, (0, 0)),)
    return _case("square shift", _square(s, c), [[0, 0]] * 2, c * np.abs(u).sum(), [*np.sign(u) * c, 0], pulls=pulls)


def square_turn(s: float = 1.0, c: float = 0.05) -> Case:
    """See `square_turn_limit`."""
    phi = square_turn_limit(s, c)
    return _case("square turn", _square(s, c), [[0, 0]] * 2, phi, [0, 0, phi], turns=((1, 1.0),))


def square_turn_and_pull(s: float = 1.0, c: float = 0.05, weight: float = 1.0) -> Case:
    """x + weight phi, x <= c - s/2 (cos + sin - 1): convex in phi, so the best is at one of the two ends."""
    phi = square_turn_limit(s, c)
    best = [c, 0, 0] if c >= weight * phi else [0, 0, phi]
    pulls, turns = (Pull(1, (1, 0), (0, 0)),), ((1, weight),)
    return _case(
        "square turn and pull", _square(s, c), [[0, 0]] * 2, max(c, weight * phi), best, pulls=pulls, turns=turns
    )


def rectangle_turn_limit(a: float, b: float, cx: float, cy: float) -> float:
    """First turn at which a x b no longer fits into (a + 2cx) x (b + 2cy) in width or in height.

    Width a cos + b sin = a + 2cx and height a sin + b cos = b + 2cy, each of the form r cos(phi - phi0).
    """
    r = np.hypot(a, b)
    ends = [np.arctan2(q, p) - np.arccos((p + 2 * c) / r) for p, q, c in ((a, b, cx), (b, a, cy)) if p + 2 * c < r]
    return min(ends, default=np.inf)


def _rectangle(a: float, b: float, cx: float, cy: float) -> list[shapely.Polygon]:
    return [frame(rectangle(a + 2 * cx, b + 2 * cy), wall=b), shapely.Polygon(rectangle(a, b))]


def rectangle_turn(a: float = 3.0, b: float = 1.0, cx: float = 0.05, cy: float = 0.05) -> Case:
    """See `rectangle_turn_limit`; a peg in a slot where cx is large."""
    phi = rectangle_turn_limit(a, b, cx, cy)
    return _case("rectangle turn", _rectangle(a, b, cx, cy), [[0, 0]] * 2, phi, [0, 0, phi], turns=((1, 1.0),))


def slot_shift(a: float = 1.0, b: float = 0.5, cx: float = 2.0, cy: float = 0.02) -> Case:
    """A peg in a slot pulled along it."""
    pulls = (Pull(1, (1, 0), (0, 0)),)
    return _case("slot shift", _rectangle(a, b, cx, cy), [[0, 0]] * 2, cx, [cx, 0, 0], pulls=pulls)


def bar_end(a: float = 3.0, b: float = 0.5, cx: float = 0.1, cy: float = 0.05) -> Case:
    """A bar in a slot pulled upward at the middle of its right end.

    ty <= cy + b/2 - (a sin + b cos)/2 and the end adds a/2 sin: cy + b/2 (1 - cos), growing up to the largest turn.
    """
    phi = rectangle_turn_limit(a, b, cx, cy)
    ty = cy + b / 2 - (a * np.sin(phi) + b * np.cos(phi)) / 2
    value = cy + b / 2 * (1 - np.cos(phi))
    pulls = (Pull(1, (0, 1), (a / 2, 0)),)
    return _case("bar end", _rectangle(a, b, cx, cy), [[0, 0]] * 2, value, [0, ty, phi], pulls=pulls)


def polygon_turn(n: int = 6, radius: float = 1.0, c: float = 0.02) -> Case:
    """Regular n-gon in a regular hole whose sides are c further out: radius cos(pi/n - phi) = apothem + c.

    The hole is convex and both are n-fold symmetric, so the mean of a free position over its n turned copies,
    the centre, is free too.
    """
    reach = radius * np.cos(np.pi / n) + c
    phi = np.pi / n - np.arccos(reach / radius)
    parts = [frame(regular(n, reach / np.cos(np.pi / n)), wall=radius), shapely.Polygon(regular(n, radius))]
    return _case(f"{n}-gon turn", parts, [[0, 0]] * 2, phi, [0, 0, phi], turns=((1, 1.0),))


def disc_in_square(n: int = 24, radius: float = 1.0, c: float = 0.05, direction: tuple[float, float] = (1, 0)) -> Case:
    """Regular n-gon (n a multiple of 4, corners on the axes) in a square hole of half-side radius + c.

    It spins freely; turned by pi/n it is narrowest, radius cos(pi/n), in x and y at once.
    """
    if n % 4:
        raise ValueError("n must be a multiple of 4")
    u = unit(direction)
    slack = radius + c - radius * np.cos(np.pi / n)
    parts = [frame(rectangle(2 * (radius + c), 2 * (radius + c)), wall=radius), shapely.Polygon(regular(n, radius))]
    best = [*np.sign(u) * slack, np.pi / n]
    pulls = (Pull(1, direction, (0, 0)),)
    return _case(f"{n}-gon in a square", parts, [[0, 0]] * 2, slack * np.abs(u).sum(), best, pulls=pulls)


def tangential_shift(
    normals: Sequence[float] = (0.3, 2.2, 4.4),
    radius: float = 1.0,
    c: float = 0.03,
    direction: Sequence[float] = (1, 0.4),
) -> Case:
    """Polygon whose sides (normals at these angles) all touch a circle, in a hole with sides c further out.

    The circle stays inside, so a side's support is never below `radius` at any turn: no turn helps, and the centre
    moves in the same polygon scaled to the inner radius c.
    """
    angles = np.sort(np.asarray(normals, dtype=float))
    following = np.roll(angles, -1)
    half = np.mod(following - angles, 2 * np.pi) / 2
    if np.any(half >= np.pi / 2 - 1e-3):
        raise ValueError("the normals leave the polygon open")
    middle = angles + half
    corners = np.column_stack([np.cos(middle), np.sin(middle)]) / np.cos(half)[:, None]
    u = unit(direction)
    best = c * corners[np.argmax(corners @ u)]
    parts = [frame(corners * (radius + c), wall=radius), shapely.Polygon(corners * radius)]
    pulls = (Pull(1, tuple(u), (0, 0)),)
    return _case(f"tangential {len(angles)}-gon", parts, [[0, 0]] * 2, best @ u, [*best, 0], pulls=pulls)


def plus_turn(arm: float = 2.0, width: float = 0.8, c: float = 0.03) -> Case:
    """Plus sign (arms from the centre `arm` long, `width` wide) in a hole c larger all round.

    The ends of one bar must stay in their slots: arm sin + width/2 cos <= width/2 + c for the sum over both ends,
    which the centre meets; the slots' inner corners and the ends of the slots leave more room.
    """
    outer, inner = (_plus(arm + c, width / 2 + c), _plus(arm, width / 2))
    phi = np.arcsin((width / 2 + c) / np.hypot(arm, width / 2)) - np.arctan2(width / 2, arm)
    inner_corner = (width / 2 + c) * (np.cos(phi) - np.sin(phi)) >= width / 2
    if not inner_corner or arm * np.cos(phi) + width / 2 * np.sin(phi) > arm + c:
        raise ValueError("another contact comes first")
    parts = [frame(outer, wall=arm), shapely.Polygon(inner)]
    return _case("plus turn", parts, [[0, 0]] * 2, phi, [0, 0, phi], turns=((1, 1.0),))


def _plus(arm: float, half: float) -> np.ndarray:
    quarter = np.array([[arm, -half], [arm, half], [half, half]])
    return np.concatenate([quarter @ turn(k * np.pi / 2).T for k in range(4)])


# -- a lever --------------------------------------------------------------------------------------------------------


def pin_lever(s: float = 1.0, c: float = 0.04, length: float = 6.0, height: float = 2.0) -> Case:
    """Bar with a square hole (side s + 2c) on a fixed square pin (side s), pulled upward `length` from the pin.

    With m = c - s/2 (cos + sin - 1) the pin's room in the hole, the point rises by m (cos + sin) + length sin, which
    grows up to the largest turn where m = 0.
    """
    phi = square_turn_limit(s, c)
    hole = rectangle(s + 2 * c, s + 2 * c)
    bar = shapely.Polygon(rectangle(length + height, height, (length / 2, 0)), [hole])
    pulls = (Pull(1, (0, 1), (length, 0)),)
    parts = [shapely.Polygon(rectangle(s, s)), bar]
    value = length * np.sin(phi)
    return _case("lever on a pin", parts, [[0, 0], [length / 2, 0]], value, _about_origin(length / 2, phi), pulls=pulls)


def _about_origin(x: float, phi: float) -> list[float]:
    """Motion of the reference point (x, 0) when its part turns about the origin."""
    return [x * (np.cos(phi) - 1), x * np.sin(phi), phi]


# -- several parts --------------------------------------------------------------------------------------------------


def nested_turn(s: float = 1.0, c1: float = 0.03, wall: float = 0.4, c2: float = 0.06) -> Case:
    """Square peg in a square ring in a square frame: the turns add up."""
    phi1, phi2 = square_turn_limit(s, c1), square_turn_limit(s + 2 * c1 + 2 * wall, c2)
    best = [[0, 0, phi2], [0, 0, phi1 + phi2]]
    return _case("nested turn", _nested(s, c1, wall, c2), [[0, 0]] * 3, phi1 + phi2, best, turns=((2, 1.0),))


def nested_shift(
    s: float = 1.0, c1: float = 0.03, wall: float = 0.4, c2: float = 0.06, direction: tuple[float, float] = (1, 2)
) -> Case:
    """The same pulled: the shifts add up, as a turned ring loses more than it gains while c1 is below its half-side."""
    u = unit(direction)
    best = [[*np.sign(u) * c2, 0], [*np.sign(u) * (c1 + c2), 0]]
    pulls = (Pull(2, direction, (0, 0)),)
    value = (c1 + c2) * np.abs(u).sum()
    return _case("nested shift", _nested(s, c1, wall, c2), [[0, 0]] * 3, value, best, pulls=pulls)


def _nested(s: float, c1: float, wall: float, c2: float) -> list[shapely.Polygon]:
    hole = s + 2 * c1
    outer = hole + 2 * wall
    ring = shapely.Polygon(rectangle(outer, outer), [rectangle(hole, hole)])
    return [frame(rectangle(outer + 2 * c2, outer + 2 * c2), wall=s), ring, shapely.Polygon(rectangle(s, s))]


def row_in_channel(
    gaps: Sequence[float] = (0.2, 0.1, 0.3), width: float = 1.0, height: float = 1.0, c: float = 0.01, pulled: int = -1
) -> Case:
    """Blocks in a row in a closed channel, block `pulled` drawn to the left, pushing those before it.

    `gaps` lie before, between and behind the blocks, so there are len(gaps) - 1 of them. Tilting costs height/2 per
    radian at the wall and wins at most about 3c per radian at each contact, hence the limit on c.
    """
    n = len(gaps) - 1
    if c > height / (12 * n):
        raise ValueError("the channel is too loose")
    k = pulled % n
    starts = np.cumsum(gaps[:-1]) + width * np.arange(n)
    length = sum(gaps) + n * width
    centres = np.column_stack([starts + width / 2, np.zeros(n)])
    channel = frame(rectangle(length, height + 2 * c, (length / 2, 0)), wall=width)
    blocks = [shapely.Polygon(rectangle(width, height, m)) for m in centres]
    shift = np.where(np.arange(n) <= k, np.cumsum(gaps[:-1]), 0)
    best = np.column_stack([-shift, np.zeros(n), np.zeros(n)])
    pulls = (Pull(k + 1, (-1, 0), tuple(centres[k])),)
    return _case(f"row of {n}", [channel, *blocks], [[0, 0], *centres], shift[k], best, pulls=pulls)


def two_pegs(s: float = 1.0, c: tuple[float, float] = (0.03, 0.07), weights: tuple[float, float] = (1, 2)) -> Case:
    """Two square pegs in two holes of one plate, pulled different ways: a sum of independent pulls."""
    centres = np.array([[0, 0], [2 * s, 0]])
    directions = np.array([[0.6, 0.8], [-1.0, 0.0]])
    holes = [rectangle(s + 2 * g, s + 2 * g, m) for g, m in zip(c, centres, strict=True)]
    parts = [frame(*holes, wall=s), *(shapely.Polygon(rectangle(s, s, m)) for m in centres)]
    best = [[*np.sign(u) * g, 0] for u, g in zip(directions, c, strict=True)]
    value = sum(w * g * np.abs(u).sum() for u, g, w in zip(directions, c, weights, strict=True))
    pulls = tuple(Pull(i + 1, tuple(directions[i]), tuple(centres[i]), weights[i]) for i in range(2))
    return _case("two pegs", parts, [[0, 0], *centres], value, best, pulls=pulls)


# -- nothing in the way ---------------------------------------------------------------------------------------------


def block_on_floor(s: float = 1.0, gap: float = 0.01) -> Case:
    """A block above a floor pulled away from it: unbounded."""
    parts = [shapely.Polygon(rectangle(4 * s, s, (0, -s / 2))), shapely.Polygon(rectangle(s, s, (0, gap + s / 2)))]
    pulls = (Pull(1, (0.3, 1), (0, gap + s / 2)),)
    return _case("block on a floor", parts, [[0, 0], [0, gap + s / 2]], np.inf, None, pulls=pulls)


def spinning_disc(n: int = 24, radius: float = 1.0, c: float = 0.05) -> Case:
    """A disc in a hole that never stops its turn: unbounded."""
    still = disc_in_square(n, radius, c)
    return _case("spinning disc", still.parts, still.at, np.inf, None, turns=((1, 1.0),))


def bounded() -> list[Case]:
    """All cases with a finite value, several sizes and directions each."""
    return [
        *(square_shift(s, c, u) for s, c, u in ((1, 0.05, (1, 0)), (1, 0.05, (3, 4)), (20, 0.1, (-1, 5)))),
        *(square_turn(s, c) for s, c in ((1, 0.05), (10, 0.01), (1, 0.2))),
        *(square_turn_and_pull(1, 0.05, w) for w in (0.2, 1.0)),
        *(rectangle_turn(*a) for a in ((3, 1, 0.05, 0.05), (1, 3, 0.05, 0.1), (1, 0.5, 2, 0.02), (5, 1, 0.01, 0.5))),
        slot_shift(),
        *(bar_end(*a) for a in ((3, 0.5, 0.1, 0.05), (3, 0.5, 0.01, 0.3))),
        *(polygon_turn(n, 1.0, c) for n, c in ((3, 0.05), (5, 0.02), (6, 0.02), (12, 0.005))),
        *(disc_in_square(24, 1.0, 0.05, u) for u in ((1, 0), (1, -2))),
        tangential_shift(),
        tangential_shift((0.1, 1.0, 2.6, 3.9, 5.0), 2.0, 0.1, (-1, 0.2)),
        plus_turn(),
        pin_lever(),
        nested_turn(),
        *(nested_shift(direction=u) for u in ((1, 2), (-1, 0))),
        row_in_channel(),
        row_in_channel((0.2, 0.1, 0.3, 0.05)),
        row_in_channel((0.2, 0.1, 0.3, 0.05), pulled=1),
        two_pegs(),
    ]


def unbounded() -> list[Case]:
    """All cases that nothing stops."""
    return [block_on_floor(), spinning_disc()]
