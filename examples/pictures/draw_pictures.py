"""Draw elephant.png and butterfly.png: `python examples/pictures/draw_pictures.py`.

Both are made of circles, polygons and thick lines and enlarged bit by bit until they have exactly the wanted number of
blocks: 1,669 and 532, as many as the two picture assemblies of the paper (Fig. 8b).
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
from PIL import Image, ImageChops, ImageDraw, ImageOps

HERE = Path(__file__).parent
PIXELS = 8  # a block


class Pen:
    """Draws in blocks from the middle of the bottom, y up."""

    def __init__(self, columns: int, rows: int, scale: float) -> None:
        self.size, self.scale = (columns, rows), scale
        self.picture = Image.new("L", (columns * PIXELS, rows * PIXELS), 255)
        self.draw = ImageDraw.Draw(self.picture)

    def _at(self, x: float, y: float) -> tuple[float, float]:
        columns, rows = self.size
        return (columns / 2 + x * self.scale) * PIXELS, (rows - y * self.scale) * PIXELS

    def oval(self, x: float, y: float, rx: float, ry: float, shade: int = 0, turn: float = 0.0) -> None:
        """Ellipse, turned by `turn` degrees."""
        angle, c, s = np.linspace(0, 2 * np.pi, 120), np.cos(np.radians(turn)), np.sin(np.radians(turn))
        u, v = rx * np.cos(angle), ry * np.sin(angle)
        self.shape(np.column_stack([x + c * u - s * v, y + s * u + c * v]), shade)

    def shape(self, points: object, shade: int = 0) -> None:
        """Polygon."""
        self.draw.polygon([self._at(x, y) for x, y in np.asarray(points, dtype=float)], fill=shade)

    def stroke(self, points: object, widths: object, shade: int = 0) -> None:
        """Smooth thick line through points; the width runs through `widths`."""
        p = np.asarray(points, dtype=float)
        t = np.linspace(0, 1, 100)
        own = np.linspace(0, 1, len(p))
        degree = min(3, len(p) - 1)
        x, y = (np.polyval(np.polyfit(own, p[:, k], degree), t) for k in (0, 1))
        for a, b, w in zip(x, y, np.interp(t, np.linspace(0, 1, len(np.atleast_1d(widths))), widths), strict=True):
            self.oval(a, b, w / 2, w / 2, shade)

    def blocks(self) -> int:
        """Dark blocks, as `wiggleroom make image` counts them."""
        columns, rows = self.size
        return int((np.asarray(self.picture.resize((columns, rows), Image.Resampling.BOX)) < 127.5).sum())


def elephant(scale: float) -> Pen:
    """Walking to the right, 62 by 46 blocks; its eye is a hole."""
    pen = Pen(66, 48, scale)
    pen.oval(-7, 26, 20, 13.2)  # body
    pen.shape([(-26, 27), (-25, 0), (-16.5, 0), (-15.5, 14), (-11, 16), (-14, 28)])  # hind leg
    pen.shape([(-16, 16), (-15, 1.5), (-8.5, 1.5), (-8, 17)])
    pen.shape([(-1, 16), (-0.5, 1.5), (5.5, 1.5), (6.5, 17)])  # fore leg behind
    pen.shape([(4, 20), (6.5, 0), (14.5, 0), (14.5, 26)])
    pen.oval(15.5, 32.5, 10, 10.4)  # head
    pen.stroke([(20.5, 33), (25.5, 24), (24.5, 10.5), (29.5, 8)], [11, 6.5, 4.2, 3.2])  # trunk
    pen.stroke([(-25.5, 31), (-29.5, 26), (-30, 17)], [3, 2.2, 2.6])  # tail
    pen.shape([(19.5, 26.5), (25.5, 18.5), (26.5, 19.5), (22, 28)], 255)  # tusk
    ear = np.array([(8.5, 40.0), (3, 40.5), (0.2, 35), (1.2, 27), (6, 21.5), (10.5, 25.5), (12, 32)])
    for a, b in pairwise(ear):
        pen.stroke([a, b], [1.5, 1.5], 255)
    pen.oval(19, 35.5, 1.15, 1.15, 255)  # eye
    return pen


def butterfly(scale: float) -> Pen:
    """Open wings, 37 by 30 blocks, the same on both sides; four spots are holes."""
    pen = Pen(39, 32, scale)
    for side in (-1, 1):
        pen.oval(side * 9.4, 20.2, 9.8, 5.9, turn=side * 38)
        pen.oval(side * 7.0, 8.6, 7.2, 4.9, turn=-side * 40)
        pen.shape([(0, 19), (side * 6, 15.8), (side * 6, 12.2), (0, 9)])
        pen.stroke([(side * 3.4, 14.0), (side * 14, 14.4)], [0.6, 2.2], 255)  # between the wings
        pen.oval(side * 12.0, 22.2, 2.4, 1.6, 255, turn=side * 38)
        pen.oval(side * 8.6, 7.2, 1.6, 1.6, 255)
        pen.stroke([(0, 21), (side * 2.2, 25.0), (side * 5.0, 28.6)], [1.8, 1.5, 1.9])
    pen.oval(0, 14.0, 1.9, 10.4)
    pen.picture = ImageChops.darker(pen.picture, ImageOps.mirror(pen.picture))
    return pen


def fitted(make: Callable[[float], Pen], count: int, near: float) -> Pen:
    """Picture with exactly this many blocks, at the scale nearest `near` that has them."""
    scales = near + np.linspace(-0.05, 0.05, 1001)
    for scale in scales[np.argsort(np.abs(scales - near))]:
        pen = make(float(scale))
        if pen.blocks() == count:
            return pen
    message = f"no scale gives {count} blocks"
    raise ValueError(message)


if __name__ == "__main__":
    for make, count, near in ((elephant, 1669, 0.981), (butterfly, 532, 0.9635)):
        pen = fitted(make, count, near)
        pen.picture.convert("1", dither=Image.Dither.NONE).save(HERE / f"{make.__name__}.png", optimize=True)
