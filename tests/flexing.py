"""Assemblies for tests of flex: closed forms, chains, and some that nobody drew by hand."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import shapely

import wiggleroom as wr
from tests.audit import as_assembly, part
from tests.oracle import blocks, closed_forms, random_joints
from tests.oracle.geometry import turn
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing, Goal, Part, Pull, Region, Turn, W

FAMILIES = ("tee", "swallowtail", "dovetail", "revolute", "finger", "jigsaw")


def part_at(name: str, shape: shapely.Polygon, at: Iterable[float] = (0.0, 0.0, 0.0), fixed: bool = False) -> Part:
    """Part whose material `shape` is given where it lies; its frame rests at `at`."""
    x, y, angle = at
    c, s = np.cos(angle), np.sin(angle)
    local = shapely.transform(shape, lambda p: (p - (x, y)) @ np.array([[c, -s], [s, c]]))
    return part(name, local, (float(x), float(y), float(angle)), fixed)


def case_assembly(case: closed_forms.Case) -> Assembly:
    """A closed form as an assembly, its objective as goals, gap 0."""
    parts = [part_at(f"p{k}", shape, (*case.at[k], 0.0), fixed=k in case.fixed) for k, shape in enumerate(case.parts)]
    goals: list[Goal] = [Pull(f"p{p.part}", p.direction, p.point, p.weight) for p in case.pulls]
    goals += [Turn(f"p{k}", "ccw", weight) for k, weight in case.turns]
    return assemble(Drawing(tuple(parts), goals=tuple(goals)), gap=0.0)


def row_of(regions: list[shapely.Polygon], pitch: float = 1.0) -> Drawing:
    """Blocks about their centres in a row, the first fixed, the last pulled up; as drawn, gap 0."""
    parts = [
        part_at(f"b{k + 1}", _moved(r, (k * pitch, 0.0)), (k * pitch, 0.0, 0.0), k == 0) for k, r in enumerate(regions)
    ]
    return Drawing(tuple(parts), goals=(Pull(parts[-1].name, (0.0, 1.0)),))


def _moved(shape: shapely.Polygon, by: tuple[float, float]) -> shapely.Polygon:
    return shapely.transform(shape, lambda p: p + by)


def polygon_part(name: str, corners: Iterable[Iterable[float]], fixed: bool = False) -> Part:
    """Part of these corners [mm], its frame resting at the middle of their box."""
    shape = shapely.Polygon(corners)
    x0, y0, x1, y1 = shape.bounds
    return part_at(name, shape, ((x0 + x1) / 2, (y0 + y1) / 2, 0.0), fixed)


def box(name: str, x0: float, y0: float, x1: float, y1: float, fixed: bool = False) -> Part:
    """Rectangular part."""
    return polygon_part(name, [(x0, y0), (x1, y0), (x1, y1), (x0, y1)], fixed)


# -- the same drawing otherwise -------------------------------------------------------------------------------------


def _points(change: np.ndarray, flip: bool, parts: Iterable[Part]) -> tuple[Part, ...]:
    """Parts whose own corners are multiplied by a matrix, their order turned round where it mirrors."""
    order = -1 if flip else 1
    return tuple(
        replace(
            p,
            regions=tuple(
                Region((r.outer @ change)[::order], tuple((h @ change)[::order] for h in r.holes)) for r in p.regions
            ),
        )
        for p in parts
    )


def _goals(drawing: Drawing, change: np.ndarray, sense: int, length: float) -> tuple[Goal, ...]:
    """Goals of a drawing whose points are multiplied by a matrix and whose turns change their sense; turns count `length`."""
    out: list[Goal] = []
    for goal in drawing.goals:
        if isinstance(goal, Pull):
            point = None if goal.point is None else _pair(goal.point @ change)
            out.append(replace(goal, direction=_pair(np.asarray(goal.direction) @ change / length), point=point))
        elif isinstance(goal, Turn):
            other = {"ccw": "cw", "cw": "ccw"}[goal.sense]
            out.append(replace(goal, sense=goal.sense if sense > 0 else other, weight=goal.weight * length))
        else:
            x, y = _pair(np.asarray(goal.w[:2]) @ change / length)
            out.append(replace(goal, w=(x, y, goal.w[2] * sense * length)))
    return tuple(out)


def _pair(point: np.ndarray) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def mirrored(drawing: Drawing) -> Drawing:
    """The drawing in a mirror, x turned round."""
    change = np.diag([-1.0, 1.0])
    parts = tuple(replace(p, at=(-p.at[0], p.at[1], -p.at[2])) for p in _points(change, True, drawing.parts))
    return replace(drawing, parts=parts, goals=_goals(drawing, change, -1, 1.0))


def scaled(drawing: Drawing, f: float) -> Drawing:
    """The drawing `f` times as large; the objective of its motions is `f` times as large too."""
    change = np.diag([f, f])
    parts = tuple(replace(p, at=(p.at[0] * f, p.at[1] * f, p.at[2])) for p in _points(change, False, drawing.parts))
    return replace(drawing, parts=parts, gap=drawing.gap * f, goals=_goals(drawing, change, 1, f))


def shuffled(drawing: Drawing, seed: int = 0) -> Drawing:
    """The same parts in another order."""
    order = np.random.default_rng(seed).permutation(len(drawing.parts))
    return replace(drawing, parts=tuple(drawing.parts[k] for k in order))


def displaced(drawing: Drawing, angle: float, by: tuple[float, float], seed: int = 3) -> Drawing:
    """Everything turned about the origin, then moved, and every outline stored in a turned frame of its own."""
    rng, R = np.random.default_rng(seed), turn(angle)
    parts = []
    for p in drawing.parts:
        own = float(rng.uniform(-np.pi, np.pi))
        (stored,) = _points(turn(angle + p.at[2] - own).T, False, [p])
        parts.append(replace(stored, at=(*_pair(R @ p.at[:2] + by), own)))
    goals: list[Goal] = []
    for goal in drawing.goals:
        assert isinstance(goal, Pull)
        point = None if goal.point is None else _pair(R @ goal.point + by)
        goals.append(replace(goal, direction=_pair(R @ goal.direction), point=point))
    return replace(drawing, parts=tuple(parts), goals=tuple(goals))


def about(drawing: Drawing, point: tuple[float, float]) -> Drawing:
    """The same parts at the same places, every one with its reference point at `point`; pulls keep their points."""
    parts = []
    for p in drawing.parts:
        shape = _points(turn(p.at[2]).T, False, [p])[0].regions
        by = np.subtract(p.at[:2], point)
        regions = tuple(Region(r.outer + by, tuple(h + by for h in r.holes)) for r in shape)
        parts.append(replace(p, regions=regions, at=(*_pair(np.asarray(point)), 0.0)))
    place = {p.name: (p.at[0], p.at[1]) for p in drawing.parts}
    goals = tuple(replace(g, point=g.point or place[g.part]) if isinstance(g, Pull) else g for g in drawing.goals)
    return replace(drawing, parts=tuple(parts), goals=goals)


# -- by lot ---------------------------------------------------------------------------------------------------------


def random_chain(seed: int, n: int, gap: float) -> Assembly:
    """Blocks in a row with one random joint."""
    rng = np.random.default_rng(seed)
    for _ in range(20000):
        profile = random_joints._profile(rng)
        if profile is None:
            continue
        shape = shapely.Polygon(blocks.with_profile(profile))
        if shape.is_valid:
            try:
                return assemble(row_of([shape] * n), gap=gap)
            except wr.InputError:
                continue
    raise ValueError(f"no joint found for seed {seed}")


def random_assembly(seed: int) -> Assembly:
    """A small chain, jigsaw, grid or peg in a hole, gap from 0.002 to 0.05 of the pitch."""
    rng = np.random.default_rng(seed)
    gap = float(np.exp(rng.uniform(np.log(0.002), np.log(0.05))))
    nx, ny, n = (int(k) for k in (*rng.integers(2, 4, 2), rng.integers(2, 7)))
    family = str(rng.choice(FAMILIES))
    makers = (
        lambda g: random_chain(seed, min(n, 5), g),
        lambda g: wr.patterns.jigsaw(nx, ny, gap=g, seed=seed),
        lambda g: wr.patterns.grid(nx, ny, joint=family, gap=g),
        lambda g: wr.patterns.chain(n, joint=family, gap=g),
        lambda g: as_assembly(random_joints.peg_pair(seed, g, holes=bool(seed % 2))),
    )
    for _ in range(20):
        try:
            return makers[seed % len(makers)](gap)
        except (wr.InputError, ValueError):
            gap *= 0.7
    raise ValueError(f"no assembly for seed {seed}")


def random_puzzle(seed: int) -> Assembly:
    """Thirty parts: a jigsaw, or a grid of one family."""
    rng = np.random.default_rng(seed)
    gap = float(rng.uniform(0.004, 0.04))
    if seed % 2:
        return wr.patterns.jigsaw(6, 5, gap=gap, seed=seed)
    return wr.patterns.grid(6, 5, joint=("tee", "swallowtail", "revolute", "jigsaw")[seed // 2 % 4], gap=gap)


def random_goals(assembly: Assembly, seed: int, most: int = 3) -> tuple[Goal, ...]:
    """Up to `most` pulls at any points, turns and Ws with random weights."""
    rng = np.random.default_rng([seed, 1])
    free = [p for p in assembly.parts if not p.fixed]
    out: list[Goal] = []
    for _ in range(int(rng.integers(1, most + 1))):
        p = free[int(rng.integers(len(free)))]
        weight, u, arm = float(rng.uniform(0.2, 2)), rng.standard_normal(3), rng.uniform(-1, 1, 2)
        kinds: tuple[Goal, ...] = (
            Pull(p.name, _pair(u), None, weight),
            Pull(p.name, _pair(u), _pair(np.asarray(p.at[:2]) + arm), weight),
            Turn(p.name, "ccw" if u[0] > 0 else "cw", weight),
            W(p.name, (float(u[0]), float(u[1]), float(u[2])), weight),
        )
        out.append(kinds[int(rng.integers(4))])
    return tuple(out)


def slot(**more: object) -> Drawing:
    """A block between two fixed walls, floor and ceiling: 0.3 mm free to the right, 0.2 mm to the left."""
    parts = (
        box("left", -2.0, 0.0, -1.0, 4.0, fixed=True),
        box("right", 5.5, 0.0, 6.5, 4.0, fixed=True),
        box("block", -0.8, 0.1, 5.2, 3.9),
        box("floor", -0.8, -1.0, 5.3, -0.1, fixed=True),
        box("ceiling", -0.8, 4.1, 5.3, 5.0, fixed=True),
    )
    return Drawing(parts, goals=(Pull("block", (1.0, 0.0)),), **more)
