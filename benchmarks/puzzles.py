"""Random boards cut into pieces, shuffled, put together in the plane and judged: `python -m benchmarks.puzzles [COUNT]`.

The judge knows where each piece was before it was shuffled, and nothing of how pieces are matched.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.spatial import Voronoi
from shapely import affinity

from wiggleroom.mating.cutting_sheet import CuttingSheet, Outlined
from wiggleroom.mating.planar_assembly import assemble_plane
from wiggleroom.mating.planar_search import moved

Floats = NDArray[np.float64]

SIZE = 100.0
"""Of the board [mm]."""
CUTS = ("wave", "zigzag", "dovetail")
RIGHT = 0.01
"""Share of the board by which a piece may miss its place."""


def cut(a: Floats, b: Floats, kind: str, rng: np.random.Generator) -> Floats:
    """Corners of one cut from a to b (2,)."""
    along, normal = b - a, np.array([a[1] - b[1], b[0] - a[0]])
    if kind == "wave":
        x = np.linspace(0.0, 1.0, 40)
        y = sum(0.085 * rng.normal() / k * np.sin(np.pi * k * x) for k in range(1, 5))
    elif kind == "zigzag":
        x = np.array([0.0, 0.2, 0.35, 0.5, 0.65, 0.8, 1.0])
        y = np.concatenate([[0.0], rng.uniform(-0.16, 0.16, 5), [0.0]])
    else:
        middle, half, tall = rng.uniform(0.35, 0.65), rng.uniform(0.08, 0.14), rng.uniform(0.12, 0.22)
        x = np.array([0.0, middle - half, middle - 1.5 * half, middle + 1.4 * half, middle + half, 1.0])
        y = np.array([0.0, 0.0, tall, tall, 0.0, 0.0]) * rng.choice([-1, 1])
    return a + x[:, None] * along + np.asarray(y)[:, None] * normal


def board(kind: str, count: int, rng: np.random.Generator) -> list[shapely.Polygon]:
    """Pieces of a square board, cut along the borders of Voronoi cells."""
    seeds: list[Floats] = []
    for point in rng.uniform(0, SIZE, (400, 2)):
        if len(seeds) < count and all(np.hypot(*(point - seed)) > 0.7 * SIZE / np.sqrt(count) for seed in seeds):
            seeds.append(point)
    inner = np.array(seeds)
    mirrored = [inner * (-1, 1), inner * (1, -1), (2 * SIZE, 0) + inner * (-1, 1), (0, 2 * SIZE) + inner * (1, -1)]
    cells = Voronoi(np.concatenate([inner, *mirrored]))
    lines = []
    for (p, q), ends in zip(cells.ridge_points, cells.ridge_vertices, strict=True):
        if min(p, q) < len(inner) and min(ends) >= 0:
            a, b = cells.vertices[ends]
            lines.append(shapely.LineString(cut(a, b, kind, rng) if max(p, q) < len(inner) else [a, b]))
    pieces = shapely.get_parts(shapely.polygonize([shapely.union_all(shapely.set_precision(lines, 1e-7))]))
    return [piece for piece in pieces if piece.area > 20.0]


def shuffled(pieces: list[shapely.Polygon], rng: np.random.Generator) -> CuttingSheet:
    """The pieces turned, in a row."""
    panels, x = [], 0.0
    for k, piece in enumerate(pieces):
        turned = affinity.rotate(piece, rng.uniform(-180, 180))
        left, bottom, right, _ = turned.bounds
        panels.append(Outlined(f"p{k}", affinity.translate(turned, x - left, -bottom)))
        x += right - left + 3.0
    return CuttingSheet(tuple(panels), source="puzzle")


def main() -> None:
    """Print one line for each board, and how many were right, and sure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=4, help="boards of every kind")
    right = sure = wrong_and_sure = total = 0
    for seed in range(parser.parse_args().count):
        for kind in CUTS:
            for pieces, clearance, frame in ((8, 0.0, False), (14, 0.15, True)):
                rng = np.random.default_rng([seed, pieces])
                whole = board(kind, pieces, rng)
                if frame:
                    inside = shapely.union_all(whole)
                    whole.append(inside.convex_hull.buffer(15, join_style="mitre").difference(inside))
                truth = [piece.buffer(-clearance / 2, join_style="mitre") for piece in whole]
                sheet = shuffled(truth, rng)
                begun = time.process_time()
                found = assemble_plane(sheet)
                seconds = time.process_time() - begun
                got = {
                    row: moved(affinity.translate(sheet.panels[row].polygon, *-found.centres[row]), pose)
                    for body in found.bodies
                    for row, pose in body.items()
                }
                good = len(found.bodies) == 1 and not found.unplaced and miss(got, truth) < RIGHT * SIZE
                total, right, sure = total + 1, right + good, sure + found.sure
                wrong_and_sure += found.sure and not good
                print(
                    f"{kind:9} {len(truth):3} pieces  clearance {clearance:4}  {'right' if good else 'wrong':6}"
                    f"{'sure' if found.sure else 'not sure':9} {seconds:6.1f} s"
                )
    print(f"{right} of {total} right, {sure} sure, {wrong_and_sure} sure and wrong")


def miss(got: dict[int, shapely.Polygon], truth: list[shapely.Polygon]) -> float:
    """Largest distance [mm] of a centroid from where it was, after the best rigid motion of all."""
    a = np.array([complex(p.centroid.x, p.centroid.y) for p in got.values()])
    b = np.array([complex(truth[k].centroid.x, truth[k].centroid.y) for k in got])
    a, b = a - a.mean(), b - b.mean()
    spin = np.vdot(a, b)
    return float(abs(spin / abs(spin) * a - b).max())


if __name__ == "__main__":
    main()
