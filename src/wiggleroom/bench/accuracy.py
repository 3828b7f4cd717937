"""Table 1: how many random motions of one joint each model judges rightly, and how much of the free space it loses.

Samples are spread evenly over a box in (x, y, turn), and what is right depends on the box. Over the box of the free space, of the second
block's reference point, it is asked how much a model loses of all motions. Over the box of a hull itself, of the point that the hull turns
about, between its angles nc and pc, as in the paper's Table 1, it is asked only what it says where it was made. Truth is exact
collision of the outlines and, for the free ones, the exact slice next in angle: pieces cut off from rest are not free.

Two polygons overlap where a pair of their edges crosses properly, or where one holds a corner of the other.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly import patterns
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.bench.published import ACCURACY
from wiggleroom.bench.result import Bench, Column, Record, ResultTable
from wiggleroom.compare.monte_carlo import depths, reached
from wiggleroom.compiled.jit_options import njit
from wiggleroom.drawing.model import Drawing, Part, Region
from wiggleroom.errors import InputError, Stop
from wiggleroom.freespace.free_space import FreeSpace, free_space
from wiggleroom.freespace.models.pair_models import HalfPlane, Hull
from wiggleroom.freespace.models.polyhedron import Polyhedron
from wiggleroom.geometry.bodies import bodies
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import rotated

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

SAMPLES = 1_000_000
"""Random motions of one pair."""
SEED = 0
"""Of the random motions, so that all runs judge the same ones."""
WALLS = "walls"
HULLS = {"hull, reference": Hull("reference"), "hull, joint": Hull("joint")}
HALF_PLANES = {"half-planes": HalfPlane(iterated=False)}

OWN = "own_"
"""Begins the names of figures over the box of the hull itself."""

COLUMNS = (
    Column("pair", "pair"),
    Column("method", "method"),
    Column("rows", "rows", 0, wide=True),
    Column("accuracy_percent", "right %", 2),
    Column("invalid_invalid_percent", "both not free %", 2, wide=True),
    Column("invalid_valid_percent", "unsafe %", 2),
    Column("valid_invalid_percent", "lost %", 2),
    Column("valid_valid_percent", "both free %", 2, wide=True),
    Column("lost_of_free_percent", "lost of free %", 2),
    Column("from_deg", "from deg", 2),
    Column("to_deg", "to deg", 2),
)

GAP = 0.01
"""Of all pairs [mm]; blocks have side 1."""
PAIR = ("b1", "b2")
"""Names of the two blocks."""

CENTRE, INNER, OUTER, ARC = (0.0, -0.55), 0.44, 0.62, 40.0
"""Arc: its centre from the middle of the side, its radii, and how far it goes [deg]."""
CHORDS = 10
"""Of the arc."""


def accuracy(
    samples: int = SAMPLES,
    *,
    stop: Stop | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Bench:
    """Judge random motions of each pair by each model and by exact collision.

    Parameters
    ----------
    samples : int
        Of each pair.
    stop, progress : optional
        Asked between pairs; told how many pairs are done, and how many there are.

    Raises
    ------
    InputError
        If there are no samples.

    Source: Mind the Gap, Table 1.
    """
    if samples < 1:
        finding = f"samples {samples}: there must be at least 1"
        raise InputError(finding)
    found: list[Record] = []
    for done, name in enumerate(PAIRS):
        if stop is not None and stop.is_set():
            break
        if progress is not None:
            progress(done, len(PAIRS))
        found += of_pair(name, PAIRS[name](), samples)
    cut = sum(r["method"] == WALLS for r in found) < len(PAIRS)
    notes = (
        f"{samples:,} samples a pair, gap {GAP:g}, blocks of side 1. Right, unsafe and lost are shares of all "
        "samples, lost of free of the free ones. Unsafe: accepted though parts overlap; lost: refused though "
        "free.",
        "Hulls of three slices, B turned about its reference point or about the joint: the paper does not say "
        "which. Half-planes: those of one linear program, at rest.",
        "Box of the free space: for the arc and the open wedge, which leave it, the one that the "
        "hulls span, grown by the gap in x and y. Box of the hull: of the point that it turns about, in joint coordinates, "
        "from nc to pc. From, to: turns of b2 that the model knows; of half-planes how far it turns in place.",
        "† Published in Mind the Gap, Table 1, for four joints of its own whose sizes it does not give; "
        "PuzzleFlex as measured there.",
    )
    command = "wiggleroom bench accuracy" + ("" if samples == SAMPLES else f" --samples {samples}")
    title = "One joint: random motions judged by each model and by exact collision"
    own = tuple(
        {"pair": r["pair"], "method": r["method"], "rows": r["rows"], "published": False}
        | {key.removeprefix(OWN): value for key, value in r.items() if key.startswith(OWN)}
        for r in found
        if r["method"] in HULLS
    )
    sheets = (
        ResultTable("Over the box of the free space: how much of all motions is lost", COLUMNS, tuple(found)),
        ResultTable(
            "Over the box of the hull itself, as published: what it says where it was made",
            COLUMNS[:-2],
            (*own, *ACCURACY),
        ),
    )
    return Bench("accuracy", title, (*found, *ACCURACY), sheets, notes, command, cut)


def of_pair(name: str, assembly: Assembly, samples: int) -> list[Record]:
    """Figures of all models for one pair."""
    hulls = {key: _polyhedron(assembly, model) for key, model in HULLS.items()}
    planes = {key: _polyhedron(assembly, model) for key, model in HALF_PLANES.items()}
    walls = free_space(assembly, *PAIR)
    if walls.closed:
        box = _span([s.region for s in walls.slices], walls.angles)
    else:
        box = _hull_box(list(hulls.values()))
        needed = _farthest(walls, box)
        if needed > walls.reach:
            walls = free_space(assembly, *PAIR, reach=needed)
    models: dict[str, FreeSpace | Polyhedron] = {WALLS: walls, **hulls, **planes}
    found = _judged(models, walls, assembly, np.random.default_rng(SEED).uniform(*box, (samples, 3)))
    for key, hull in hulls.items():
        low, high = _span([s.region for s in hull.slices], hull.angles)
        about = np.random.default_rng(SEED).uniform(low, high, (samples, 3))
        about[:, :2] += hull.pivot - rotated(np.broadcast_to(hull.pivot, (samples, 2)), about[:, 2])
        needed = float(np.abs(about[:, :2]).max() + np.hypot(*walls.pivot) * np.abs(about[:, 2]).max())
        around = walls if walls.closed or needed <= walls.reach else free_space(assembly, *PAIR, reach=needed)
        own = _judged({key: hull}, around, assembly, about)[key]
        found[key] |= {OWN + figure: value for figure, value in own.items()}
    return [
        {"pair": name, "method": key, "published": False, "rows": model.rows}
        | found[key]
        | {"from_deg": float(np.degrees(model.angles[0])), "to_deg": float(np.degrees(model.angles[1]))}
        for key, model in models.items()
    ]


def _judged(
    models: Mapping[str, FreeSpace | Polyhedron], walls: FreeSpace, assembly: Assembly, relative: Floats
) -> dict[str, Record]:
    """Figures of models for relative motions (k, 3) of the reference point."""
    free = truth(walls, assembly, relative)
    return {key: confusion(free, _accepted(model, walls, assembly, relative, free)) for key, model in models.items()}


def truth(walls: FreeSpace, assembly: Assembly, relative: Floats) -> Bools:
    """Which relative motions (k, 3) are free of overlap and connected to rest."""
    them = bodies(assembly)
    at = assembly.rest[1]
    a, b = (shapely.transform(g, lambda p: p - at[:2]) for g in placed(them))
    free = ~overlapping(a, b, relative)
    free[free] = reached(walls, relative[free], float(them.radius[1]))
    return free


def confusion(free: Bools, accepted: tuple[Bools, Bools]) -> Record:
    """Shares [%] of samples by truth and by what a model says; `accepted` are those it accepts, and those of them that overlap."""
    said, unsafe = accepted
    n = len(free)
    both, lost, wrong = int((free & said).sum()), int((free & ~said).sum()), int(unsafe.sum())
    return {
        "samples": n,
        "unsafe_samples": wrong,
        "accuracy_percent": 100 * (n - lost - wrong) / n,
        "invalid_invalid_percent": 100 * (n - both - lost - wrong) / n,
        "invalid_valid_percent": 100 * wrong / n,
        "valid_invalid_percent": 100 * lost / n,
        "valid_valid_percent": 100 * both / n,
        "lost_of_free_percent": 100 * lost / max(1, both + lost),
    }


def _accepted(
    model: FreeSpace | Polyhedron, walls: FreeSpace, assembly: Assembly, relative: Floats, free: Bools
) -> tuple[Bools, Bools]:
    """What a model accepts, and what of that is no motion without overlap; contact within rounding is no overlap."""
    said = model.contains(relative)
    unsafe = said & ~free
    doubtful = np.flatnonzero(unsafe)
    deep = depths(walls, assembly, bodies(assembly), relative[doubtful]) > OVERLAP_TOLERANCE * assembly.size
    cut_off = ~reached(walls, relative[doubtful], float(bodies(assembly).radius[1]))
    unsafe[doubtful] = deep | cut_off
    return said & (free | unsafe), unsafe


def _polyhedron(assembly: Assembly, model: Hull | HalfPlane) -> Polyhedron:
    found = free_space(assembly, *PAIR, model=model)
    assert isinstance(found, Polyhedron)  # walls alone give another kind
    return found


def _hull_box(hulls: list[Polyhedron]) -> tuple[Floats, Floats]:
    """Box of relative motions that the hulls span, grown by the gap in x and y."""
    boxes = []
    for hull in hulls:
        swing = [rotated(-hull.pivot, np.array([s.angle]))[0] + hull.pivot for s in hull.slices]
        about = [shapely.transform(s.region, lambda p, d=d: p + d) for s, d in zip(hull.slices, swing, strict=True)]
        boxes.append(_span(about, hull.angles))
    low, high = np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)
    grow = np.array([GAP, GAP, 0.0])
    return low - grow, high + grow


def _span(regions: list[shapely.Geometry], angles: tuple[float, float]) -> tuple[Floats, Floats]:
    """Low and high corner (3,) [mm, mm, rad] of slices."""
    boxes = shapely.bounds(regions)
    return np.array([*boxes[:, :2].min(0), angles[0]]), np.array([*boxes[:, 2:].max(0), angles[1]])


def _farthest(walls: FreeSpace, box: tuple[Floats, Floats]) -> float:
    """Largest motion of the pivot in x or y [mm] within a box of relative motions."""
    corners = np.array(np.meshgrid(*zip(*box, strict=True))).reshape(3, -1).T
    return float(np.abs(corners[:, :2]).max() + np.hypot(*walls.pivot) * np.abs(corners[:, 2]).max())


def arc() -> Assembly:
    """Two blocks joined by a tongue that is part of a ring: one comes out by turning about a point beside the joint."""
    centre = np.array(CENTRE)
    angle = np.radians(np.linspace(0.0, ARC, CHORDS + 1))
    direction = np.column_stack([-np.sin(angle), np.cos(angle)])
    outer, inner = centre + OUTER * direction, centre + INNER * direction[::-1]
    line = np.vstack([(0.0, 0.5), outer, inner, (0.0, -0.5)])  # down the side, material on the right
    block = Region(np.vstack([np.add(line, (-0.5, 0.0)), np.add(line[::-1], (0.5, 0.0))]))
    parts = tuple(Part(name, (block,), (float(k), 0.0, 0.0), fixed=k == 0) for k, name in enumerate(PAIR))
    return assemble(Drawing(parts), gap=GAP)


def wedge() -> Assembly:
    """Two blocks that nothing keeps from leaving each other."""
    return patterns.chain(2, "swallowtail", GAP, neck=0.4, end=0.2)


PAIRS: dict[str, Callable[[], Assembly]] = {
    "tee": lambda: patterns.chain(2, "tee", GAP),
    "swallowtail": lambda: patterns.chain(2, "swallowtail", GAP),
    "dovetail": lambda: patterns.chain(2, "dovetail", GAP),
    "arc": arc,
    "round": lambda: patterns.chain(2, "revolute", GAP),
    "open wedge": wedge,
}
"""Registry: what makes each pair; its blocks are "b1", fixed, and "b2"."""


def overlapping(a: shapely.Geometry, b: shapely.Geometry, relative: Floats) -> NDArray[np.bool_]:
    """Whether the interiors meet (k,) when b turns about the origin and moves; contact within rounding may go either way.

    Parameters
    ----------
    a, b : shapely polygons [mm]
        Both in the axes of a's frame at rest, the point that b turns about at the origin.
    relative : (k, 3) float64 [mm, mm, rad]

    Examples
    --------
    >>> import numpy as np
    >>> plate, peg = shapely.box(-3, -3, 3, 3) - shapely.box(-1, -1, 1, 1), shapely.box(-0.9, -0.9, 0.9, 0.9)
    >>> overlapping(plate, peg, np.array([[0.09, 0.0, 0.0], [0.11, 0.0, 0.0], [0.0, 0.0, 0.2]]))
    array([False,  True,  True])
    """
    return _any(_edges(a), _edges(b), np.ascontiguousarray(relative, dtype=float))


def _edges(geometry: shapely.Geometry) -> Floats:
    """Edges (n, 4) of all rings: x0, y0, x1, y1."""
    rings = [r for part in shapely.get_parts(geometry) for r in (part.exterior, *part.interiors)]
    corners = [shapely.get_coordinates(r) for r in rings]
    return np.vstack([np.hstack([c[:-1], c[1:]]) for c in corners])


@njit(cache=True, nogil=True)
def _inside(x: float, y: float, edges: Floats) -> bool:
    """Even-odd rule."""
    odd = False
    for k in range(len(edges)):
        x0, y0, x1, y1 = edges[k]
        if (y0 > y) != (y1 > y) and x < x0 + (y - y0) * (x1 - x0) / (y1 - y0):
            odd = not odd
    return odd


@njit(cache=True, nogil=True)
def _cross(a: Floats, b: Floats, low: Floats, high: Floats) -> bool:
    """Whether an edge of `a` properly crosses one of `b`; `low`, `high` (n, 2) are the boxes of the edges of `a`."""
    for j in range(len(b)):
        bx0, by0, bx1, by1 = b[j]
        low_x, high_x = min(bx0, bx1), max(bx0, bx1)
        low_y, high_y = min(by0, by1), max(by0, by1)
        bx, by = bx1 - bx0, by1 - by0
        for i in range(len(a)):
            if high[i, 0] < low_x or low[i, 0] > high_x or high[i, 1] < low_y or low[i, 1] > high_y:
                continue
            ax0, ay0, ax1, ay1 = a[i]
            s0 = bx * (ay0 - by0) - by * (ax0 - bx0)
            s1 = bx * (ay1 - by0) - by * (ax1 - bx0)
            if not (s0 > 0 > s1 or s0 < 0 < s1):
                continue
            ax, ay = ax1 - ax0, ay1 - ay0
            t0 = ax * (by0 - ay0) - ay * (bx0 - ax0)
            t1 = ax * (by1 - ay0) - ay * (bx1 - ax0)
            if t0 > 0 > t1 or t0 < 0 < t1:
                return True
    return False


@njit(cache=True, nogil=True)
def _any(a: Floats, b: Floats, samples: Floats) -> NDArray[np.bool_]:
    """Whether the polygons meet, for every sample (k, 3)."""
    out = np.zeros(len(samples), dtype=np.bool_)
    low = np.column_stack((np.minimum(a[:, 0], a[:, 2]), np.minimum(a[:, 1], a[:, 3])))
    high = np.column_stack((np.maximum(a[:, 0], a[:, 2]), np.maximum(a[:, 1], a[:, 3])))
    placed = np.empty_like(b)
    for k in range(len(samples)):
        x, y, phi = samples[k]
        c, s = np.cos(phi), np.sin(phi)
        for j in range(len(b)):
            for i in (0, 2):
                placed[j, i] = c * b[j, i] - s * b[j, i + 1] + x
                placed[j, i + 1] = s * b[j, i] + c * b[j, i + 1] + y
        out[k] = _cross(a, placed, low, high)
        if not out[k]:
            out[k] = _inside(placed[0, 0], placed[0, 1], a) or _inside(a[0, 0], a[0, 1], placed)
    return out
