"""Slices of the free space of a tee joint and the walls of a cell, as a picture: `python -m benchmarks.slices_picture OUT.svg`.

Minkowski sums are computed here, from the outlines alone; `wr.free_space` tells which piece is connected with rest.
"""

from __future__ import annotations

import argparse
from itertools import pairwise
from pathlib import Path

import numpy as np
import shapely
from shapely import affinity

import wiggleroom as wr
from wiggleroom.files import write_whole
from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.frame import document, header, swatch
from wiggleroom.report.pictures.text import escape, text_width

GAP = 0.03
SHARES = (-0.8, 0.0, 0.8)
"""Turns, as shares of the largest."""
SIDE, BETWEEN, LEFT, TOP = 230.0, 24.0, 150.0, 120.0
ROWS = (("the two blocks", 0.42), ("translations", 0.42), ("enlarged", 3.0 * GAP))
"""What each row shows, and half of its width [mm]."""
FORBIDDEN, ELSEWHERE, SLICE = palette.NEUTRAL[1], palette.IMPORTANCE_COLOURS[1], palette.PULLED[0]


def difference(a: shapely.Polygon, b: shapely.Polygon) -> shapely.Geometry:
    """Translations of b at which it meets a: A + (-B)."""
    turned = affinity.scale(b, -1.0, -1.0, origin=(0.0, 0.0))
    rings = [np.asarray(ring.exterior.coords) for ring in (a, turned)]
    swept = [
        shapely.MultiPoint([p + q for p in one for q in other]).convex_hull
        for one in zip(rings[0][:-1], rings[0][1:], strict=True)
        for other in zip(rings[1][:-1], rings[1][1:], strict=True)
    ]
    return shapely.union_all([*swept, affinity.translate(a, *rings[1][0]), affinity.translate(turned, *rings[0][0])])


def reached(space: wr.FreeSpace, turn: float, forbidden: shapely.Geometry) -> shapely.Geometry:
    """Free translations of the pivot that are connected with rest."""
    near = min(space.slices, key=lambda one: abs(one.angle - turn))
    swing = affinity.rotate(shapely.Point(space.pivot), near.angle, origin=(0.0, 0.0), use_radians=True)
    at = affinity.translate(near.region.centroid, swing.x - space.pivot[0], swing.y - space.pivot[1])
    window = shapely.box(-1.0, -1.0, 1.0, 1.0)
    return next(piece for piece in shapely.get_parts(window.difference(forbidden)) if piece.contains(at))


def path(shape: shapely.Geometry, middle: tuple[float, float], half: float) -> str:
    """Rings of a shape in a panel [px]."""
    scale, found = SIDE / (2 * half), []
    for part in shapely.get_parts(shape):
        for ring in (part.exterior, *part.interiors):
            at = (np.asarray(ring.coords)[:-1] - middle) * (scale, -scale) + SIDE / 2
            found.append("M" + "L".join(f"{x:.1f},{y:.1f}" for x, y in at) + "Z")
    return "".join(found)


def lines(region: shapely.Geometry, half: float) -> str:
    """Lines of the edges of a slice, across the panel."""
    scale, found = SIDE / (2 * half), []
    at = np.asarray(region.simplify(1e-6).exterior.coords) * (scale, -scale) + SIDE / 2
    for p, q in pairwise(at):
        along = (q - p) / np.hypot(*(q - p)) * 2 * SIDE
        found.append("M{:.1f},{:.1f}L{:.1f},{:.1f}".format(*(p - along), *(q + along)))
    return "".join(found)


def filled(shape: shapely.Geometry, middle: tuple[float, float], half: float, fill: str, stroke: str = "none") -> str:
    """A shape as an element."""
    return f'<path d="{path(shape, middle, half)}" fill="{fill}" stroke="{stroke}" fill-rule="evenodd"/>'


def drawn(command: str) -> str:
    """The picture as SVG."""
    pair = wr.patterns.chain(2, joint="tee", gap=GAP)
    space = wr.free_space(pair, "b1", "b2")
    made = [shapely.Polygon(part.regions[0].outer) for part in pair.parts]
    placed = [affinity.translate(shape, *rest[:2]) for shape, rest in zip(made, pair.rest, strict=True)]
    pivot = pair.rest[1][:2] + space.pivot
    body = [
        f'<clipPath id="panel"><rect width="{SIDE}" height="{SIDE}"/></clipPath>',
        *(
            f'<text x="{LEFT - 16}" y="{TOP + row * (SIDE + BETWEEN) + SIDE / 2}" text-anchor="end" font-size="14" '
            f'fill="{palette.INK}">{escape(word)}</text>'
            for row, (word, _) in enumerate(ROWS)
        ),
    ]
    for column, share in enumerate(SHARES):
        turn = share * space.angles[1]
        b = affinity.rotate(placed[1], turn, origin=tuple(pivot), use_radians=True)
        forbidden = difference(placed[0], b)
        piece = reached(space, turn, forbidden)
        left = LEFT + column * (SIDE + BETWEEN)
        body.append(
            f'<text x="{left}" y="{TOP - 12}" font-size="14" fill="{palette.INK}">turn {np.degrees(turn):.1f}°</text>'
        )
        for row, (_, half) in enumerate(ROWS):
            inside = []
            if row == 0:
                middle = tuple(pivot)
                inside += [
                    filled(placed[0], middle, half, *palette.NEUTRAL),
                    filled(affinity.translate(b, piece.centroid.x, piece.centroid.y), middle, half, *palette.PULLED),
                ]
            else:
                inside += [
                    f'<rect width="{SIDE}" height="{SIDE}" fill="{ELSEWHERE}"/>',
                    filled(forbidden, (0.0, 0.0), half, FORBIDDEN),
                    filled(piece, (0.0, 0.0), half, SLICE),
                ]
                if row == 2:
                    inside.append(f'<path d="{lines(piece, half)}" stroke="{palette.FORCE}" stroke-width="1"/>')
                inside.append(f'<circle cx="{SIDE / 2}" cy="{SIDE / 2}" r="3" fill="{palette.INK}"/>')
            body.append(
                f'<g transform="translate({left} {TOP + row * (SIDE + BETWEEN)})"><g clip-path="url(#panel)">{"".join(inside)}</g>'
                f'<rect width="{SIDE}" height="{SIDE}" fill="none" stroke="{palette.REST}"/></g>'
            )
    end, place = TOP + len(ROWS) * (SIDE + BETWEEN), LEFT
    for colour, word in (
        (FORBIDDEN, "the blocks overlap"),
        (SLICE, "slice: free, connected with rest"),
        (ELSEWHERE, "free, not reached"),
        (palette.FORCE, "lines of walls"),
    ):
        body.append(
            f'<g transform="translate({place} {end})">{swatch(colour, palette.NEUTRAL[1])}'
            f'<text x="24" y="10" font-size="14" fill="{palette.SUBDUED}">{word}</text></g>'
        )
        place += 44 + text_width(word, 14.0)
    width = LEFT + len(SHARES) * (SIDE + BETWEEN) + palette.MARGIN - BETWEEN
    title, said = (
        "Slices of the free space of a tee joint",
        f"gap {GAP:g} mm, blocks of side 1; the dot is no translation",
    )
    head, _ = header(title, [said], width)
    foot = f'<text x="{palette.MARGIN}" y="{end + 50}" font-size="11" fill="{palette.SUBDUED}">{escape(command)}</text>'
    return document(width, end + 70, title, [said], command, [*head, *body, foot])


def main() -> None:
    """Write the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    out = parser.parse_args().out
    write_whole(out, drawn(f"python -m benchmarks.slices_picture {out}").encode())


if __name__ == "__main__":
    main()
