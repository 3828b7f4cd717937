"""Draw the mechanisms: `python examples/23_mechanisms/draw.py`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import shapely
from shapely import Polygon, affinity

HERE = Path(__file__).parent
MODULE = 4.0
"""Pitch circle's diameter over the number of teeth [mm]."""
AXLE = 6.0
"""Radius of the axles and bores [mm]."""
MARGIN = 4.0


def disc(radius: float, x: float = 0.0, y: float = 0.0, corners: int = 96) -> Polygon:
    """Regular polygon for a circle."""
    angle = 2 * np.pi * np.arange(corners) / corners
    return Polygon(np.column_stack([x + radius * np.cos(angle), y + radius * np.sin(angle)]))


def bar(*points: tuple[float, float], width: float) -> Polygon:
    """Straight pieces of this width with round ends."""
    return shapely.buffer(shapely.LineString(points), width / 2, quad_segs=16)


def gear(teeth: int, phase: float = 0.0) -> Polygon:
    """Gear with involute flanks of 20 degrees, a tooth's middle at angle `phase`."""
    pitch = MODULE * teeth / 2
    base, tip, root = pitch * np.cos(np.radians(20)), pitch + MODULE, pitch - 1.25 * MODULE
    start = max(base, root)
    radius = np.linspace(start, tip, 7)
    roll = np.sqrt((radius / base) ** 2 - 1)
    at_pitch = np.sqrt((pitch / base) ** 2 - 1)
    half = np.pi / (2 * teeth) + (at_pitch - np.arctan(at_pitch)) - (roll - np.arctan(roll))
    flank = np.column_stack([np.r_[root, radius], np.r_[half[0], half]])
    tooth = np.concatenate([flank * (1, -1), flank[::-1]])
    every = phase + 2 * np.pi * np.arange(teeth) / teeth
    r, angle = np.tile(tooth[:, 0], teeth), (every[:, None] + tooth[:, 1]).ravel()
    return Polygon(np.column_stack([r * np.cos(angle), r * np.sin(angle)]))


def train(*teeth: int) -> dict[str, Polygon]:
    """Gears in a row, each on an axle, in mesh; the first has a tooth where it meets the second."""
    parts, x, phase = {}, 0.0, 0.0
    for k, count in enumerate(teeth):
        if k:
            x += MODULE * (teeth[k - 1] + count) / 2
            # a tooth of one points where a space of the other does
            share = (phase * teeth[k - 1] / (2 * np.pi)) % 1
            phase = np.pi - (share + 0.5) * 2 * np.pi / count
        wheel = shapely.difference(gear(count, phase), disc(AXLE))
        parts[f"axle{k + 1}"] = disc(AXLE, x)
        parts[f"gear{k + 1}"] = affinity.translate(wheel, x)
    return parts


def keyed() -> dict[str, Polygon]:
    """A gear on an axle with a key that stands in a wider keyway."""
    key = shapely.box(0, -1.5, AXLE + 2, 1.5)
    return {
        "axle": shapely.union(disc(AXLE), key),
        "gear": shapely.difference(gear(17), shapely.union(disc(AXLE), shapely.box(0, -2.0, AXLE + 2.2, 2.0))),
    }


def geneva(slots: int = 6, apart: float = 60.0, pin: float = 3.0) -> dict[str, shapely.Geometry]:
    """A driver, which is a pin and a locking disc, and a wheel with slots, between two steps."""
    half = np.pi / slots
    crank, outer = apart * np.sin(half), apart * np.cos(half)
    lock = crank - 2.2 * pin
    wheel = disc(outer)
    mouth = Polygon([(outer - pin, -pin), (outer - pin, pin), (outer + pin, 1.6 * pin), (outer + pin, -1.6 * pin)])
    slot = shapely.union(bar((apart - crank, 0), (2 * apart, 0), width=2 * pin), mouth)
    for k in range(slots):
        wheel = shapely.difference(wheel, affinity.rotate(slot, (2 * k + 1) * half, (0, 0), use_radians=True))
        rest = disc(lock, apart)
        wheel = shapely.difference(wheel, affinity.rotate(rest, 2 * k * half, (0, 0), use_radians=True))
    relief = affinity.translate(disc(outer + 0.2 * pin), -apart)
    driver = shapely.difference(disc(lock), affinity.rotate(relief, np.pi, (0, 0), use_radians=True))
    driver = shapely.union_all(
        [driver, disc(pin, crank), disc(AXLE + 1.5)]
    )  # the arm that bears the pin runs in another layer
    return {
        "axle1": disc(AXLE),
        "driver": shapely.difference(driver, disc(AXLE)),
        "axle2": disc(AXLE, -apart),
        "wheel": affinity.translate(shapely.difference(wheel, disc(AXLE)), -apart),
    }


def svg(parts: Mapping[str, shapely.Geometry]) -> str:
    """Drawing in mm; axles stand."""
    x0, y0, x1, y1 = shapely.total_bounds(list(parts.values())) + np.array([-MARGIN, -MARGIN, MARGIN, MARGIN])
    size = f'width="{x1 - x0:.3f}mm" height="{y1 - y0:.3f}mm" viewBox="0 0 {x1 - x0:.3f} {y1 - y0:.3f}"'
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" {size} fill="#e7eaef" fill-rule="evenodd">']
    for name, shape in parts.items():
        pieces = shapely.get_parts(shape)
        rings = [np.array(ring.coords[:-1]) for piece in pieces for ring in (piece.exterior, *piece.interiors)]
        path = " ".join("M" + " ".join(f"{x - x0:.4f},{y1 - y:.4f}" for x, y in ring) + " Z" for ring in rings)
        red = ' fill="red"' if name.startswith("axle") else ""
        lines.append(f'  <path id="{name}"{red} d="{path}"/>')
    return "\n".join([*lines, "</svg>"]) + "\n"


def linkage() -> dict[str, object]:
    """A crank, a rod and a rocker on pins, each in a layer of its own; two pins stand."""
    hole, pin, width = 3.0, 3.0, 14.0
    a, d, b = (0.0, 0.0), (80.0, 0.0), (0.0, 30.0)
    reach, rod, rocker = np.hypot(80.0, 30.0), 75.0, 55.0  # crank 30, ground 80: 30 + 80 < 75 + 55
    along = (rod**2 - rocker**2 + reach**2) / (2 * reach)
    across = np.sqrt(rod**2 - along**2)
    forward = (np.array(d) - b) / reach
    c = tuple(b + along * forward + across * np.array([-forward[1], forward[0]]))
    spots = {"a": a, "b": b, "c": c, "d": d}

    def link(one: str, other: str) -> Polygon:
        holes = [disc(hole, *spots[spot], corners=48) for spot in (one, other)]
        return shapely.difference(bar(spots[one], spots[other], width=width), shapely.union_all(holes))

    links = {"crank": ("a", "b"), "rod": ("b", "c"), "rocker": ("c", "d")}
    shapes = {name: link(*ends) for name, ends in links.items()}
    shapes |= {f"pin_{spot}": disc(pin, *at, corners=48) for spot, at in spots.items()}
    parts = []
    for name, shape in shapes.items():
        rings = [np.round(np.array(ring.coords[:-1]), 4).tolist() for ring in (shape.exterior, *shape.interiors)]
        standing = {"fixed": True} if name in ("pin_a", "pin_d") else {}
        parts.append({"name": name, "outline": rings[0], "holes": rings[1:], **standing})
    passes = [[one, other] for one in links for other in links if one < other]
    passes += [[name, f"pin_{spot}"] for name, ends in links.items() for spot in spots if spot not in ends]
    return {"format": "wiggleroom/1", "unit": "mm", "parts": parts, "ignore": passes}


if __name__ == "__main__":
    drawings = {
        "gears_12_16": train(12, 16),
        "gears_17_23": train(17, 23),
        "train": train(14, 19, 15),
        "keyed": keyed(),
        "geneva": geneva(),
    }
    for name, shapes in drawings.items():
        (HERE / f"{name}.svg").write_text(svg(shapes))
    rows = ",\n  ".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in linkage().items())
    (HERE / "linkage.json").write_text(f"{{\n  {rows}\n}}\n")
