"""Where models differ on the open wedge, as a picture: `python -m benchmarks.wedge_picture OUT.svg`.

Slices of the free space at three turns of the second block: what is truly free, what each model accepts of it, and what it loses.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import shapely

from wiggleroom.bench.accuracy import (
    GAP,
    HALF_PLANES,
    HULLS,
    PAIR,
    PAIRS,
    WALLS,
    _accepted,
    _farthest,
    _hull_box,
    _polyhedron,
    truth,
)
from wiggleroom.files import write_whole
from wiggleroom.freespace.free_space import free_space
from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.frame import document, header, swatch
from wiggleroom.report.pictures.text import escape
from wiggleroom.report.pictures.text import text_width as width_of

ACROSS, CELLS, BETWEEN, LEFT, TOP = 200.0, 160, 20.0, 130.0, 110.0
FREE, LOST, UNSAFE = palette.PULLED[0], palette.IMPORTANCE_COLOURS[2], palette.FIXED[1]
SHARES = (0.0, 0.5, 0.9)
"""Turns, as shares of the largest that the hull about the joint knows."""


def region(picked: np.ndarray, side: tuple[float, float]) -> str:
    """Path round the cells (rows, columns) that are picked, in pixels."""
    boxes = []
    for k, row in enumerate(picked):
        ends = np.flatnonzero(np.diff(np.concatenate([[0], row.astype(int), [0]])))
        boxes += [shapely.box(i * side[0], k * side[1], j * side[0], (k + 1) * side[1]) for i, j in ends.reshape(-1, 2)]
    rings = [r for part in shapely.get_parts(shapely.union_all(boxes)) for r in (part.exterior, *part.interiors)]
    return "".join("M" + "L".join(f"{x:.1f},{y:.1f}" for x, y in r.coords[:-1]) + "Z" for r in rings)


def drawn(command: str) -> str:
    """The picture as SVG."""
    assembly = PAIRS["open wedge"]()
    hulls = {key: _polyhedron(assembly, model) for key, model in HULLS.items()}
    planes = {key: _polyhedron(assembly, model) for key, model in HALF_PLANES.items()}
    low, high = _hull_box(list(hulls.values()))
    walls = free_space(assembly, *PAIR)
    walls = free_space(assembly, *PAIR, reach=_farthest(walls, (low, high)))
    models = {WALLS: walls, **hulls, **planes}
    up = (high[1] - low[1]) / (high[0] - low[0]) * ACROSS
    rows = int(CELLS * up / ACROSS)
    side = ACROSS / CELLS, up / rows
    x = low[0] + (np.arange(CELLS) + 0.5) * (high[0] - low[0]) / CELLS
    y = high[1] - (np.arange(rows) + 0.5) * (high[1] - low[1]) / rows
    body: list[str] = []
    for row, share in enumerate(SHARES):
        turn = share * hulls["hull, joint"].angles[1]
        relative = np.stack([*np.meshgrid(x, y), np.full((rows, CELLS), turn)], axis=-1).reshape(-1, 3)
        free = truth(walls, assembly, relative)
        at = TOP + row * (up + BETWEEN)
        body.append(
            f'<text x="{LEFT - 14}" y="{at + up / 2}" text-anchor="end" font-size="14" fill="{palette.INK}">{np.degrees(turn):.2f}°</text>'
        )
        for column, (name, model) in enumerate(models.items()):
            said, unsafe = _accepted(model, walls, assembly, relative, free)
            left = LEFT + column * (ACROSS + BETWEEN)
            if row == 0:
                body.append(
                    f'<text x="{left}" y="{TOP - 12}" font-size="14" fill="{palette.INK}">{escape(name)}</text>'
                )
            body.append(
                f'<g transform="translate({left} {at:.1f})"><rect width="{ACROSS}" height="{up:.1f}" fill="{palette.GRID}"/>'
            )
            for picked, colour in ((free & said, FREE), (free & ~said, LOST), (unsafe, UNSAFE)):
                if picked.any():
                    body.append(f'<path d="{region(picked.reshape(rows, CELLS), side)}" fill="{colour}"/>')
            rest = (-low[0] / (high[0] - low[0]) * ACROSS, high[1] / (high[1] - low[1]) * up)
            body.append(f'<circle cx="{rest[0]:.1f}" cy="{rest[1]:.1f}" r="3" fill="{palette.INK}"/></g>')
    width = LEFT + len(models) * (ACROSS + BETWEEN) + palette.MARGIN - BETWEEN
    end = TOP + len(SHARES) * (up + BETWEEN) + 14
    place = LEFT
    for colour, word in (
        (FREE, "free and accepted"),
        (LOST, "free but lost"),
        (UNSAFE, "accepted but not free"),
        (palette.GRID, "not free"),
    ):
        body.append(
            f'<g transform="translate({place} {end})">{swatch(colour, palette.NEUTRAL[1])}'
            f'<text x="24" y="10" font-size="14" fill="{palette.SUBDUED}">{word}</text></g>'
        )
        place += 50 + width_of(word, 14.0)
    title = "Open wedge: what each model knows of the free space"
    size = (
        f"{high[0] - low[0]:.2g} x {high[1] - low[1]:.2g} mm of shifts, gap {GAP:g} mm, at three turns; the dot is rest"
    )
    lines, _ = header(title, [size], width)
    foot = f'<text x="{palette.MARGIN}" y="{end + 50}" font-size="11" fill="{palette.SUBDUED}">{escape(command)}</text>'
    return document(width, end + 70, title, [size], command, [*lines, *body, foot])


def main() -> None:
    """Write the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    out = parser.parse_args().out
    write_whole(out, drawn(f"python -m benchmarks.wedge_picture {out}").encode())


if __name__ == "__main__":
    main()
