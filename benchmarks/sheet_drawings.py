"""Cutting sheets with a known design: plates are placed in space first, joints are cut from where they cross."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from shapely import affinity

Floats = np.ndarray


@dataclass
class Design:
    """Panels by name as polygons [mm], the pairs that are joined, the size of the box round everything, and the burn in the outlines."""

    name: str
    thickness: float
    panels: dict[str, shapely.Polygon]
    joined: set[frozenset[str]]
    size: tuple[float, float, float]
    burn: float = 0.0

    def svg(self, seed: int = 0) -> str:
        """Sheet with its panels side by side, some turned by a quarter or mirrored."""
        rng = np.random.default_rng(seed)
        lines, x, tall = [], 5.0, 0.0
        for name, polygon in self.panels.items():
            turned = affinity.rotate(polygon, 90.0 * int(rng.integers(4)), origin=(0, 0))
            if rng.random() < 0.5:
                turned = affinity.scale(turned, -1.0, 1.0, origin=(0, 0))
            low = turned.bounds
            laid = affinity.translate(turned, x - low[0], 5.0 - low[1])
            rings = (laid.exterior, *laid.interiors)
            data = " ".join("M" + " L".join(f"{a:.3f},{b:.3f}" for a, b in ring.coords[:-1]) + " Z" for ring in rings)
            lines.append(f'<path id="{name}" d="{data}" fill="none" stroke="black"/>')
            x, tall = x + low[2] - low[0] + 6.0, max(tall, low[3] - low[1])
        size = f'width="{x:.3f}mm" height="{tall + 10:.3f}mm" viewBox="0 0 {x:.3f} {tall + 10:.3f}"'
        return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>\n' + "\n".join(lines) + "\n</svg>\n"


def given_away(start: float, stop: float, pitch: float, first: bool) -> list[tuple[float, float]]:
    """Every other interval of an edge: those that the first of two plates gives to the second, or the other way round."""
    count = max(3, int((stop - start) / pitch) // 2 * 2 + 1)
    steps = np.linspace(start, stop, count + 1)
    return [(steps[k], steps[k + 1]) for k in range(1 if first else 0, count, 2)]


def box(
    name: str, x: float, y: float, z: float, t: float, pitch: float, lid: bool = True, bones: float = 0.0
) -> Design:
    """Box of plates with finger joints: floor and lid come first, then front and back, then left and right."""
    high = z - t if lid else z
    flat = _plate(x, y, t, [(side, given_away(t, long - t, pitch, True)) for side, long in _around(x, y)])
    corners = [(0.0, t), (x - t, x)], [(0.0, t), (y - t, y)]
    ends = ("bottom", "top") if lid else ("bottom",)
    front = [(side, given_away(t, x - t, pitch, False) + corners[0]) for side in ends]
    front += [(side, given_away(t, high, pitch, True)) for side in ("left", "right")]
    side = [(end, given_away(t, y - t, pitch, False) + corners[1]) for end in ends]
    side += [(end, given_away(t, high, pitch, False)) for end in ("left", "right")]
    panels = {"bottom": flat, "front": _plate(x, z, t, front), "back": _plate(x, z, t, front)}
    panels |= {"left": _plate(y, z, t, side), "right": _plate(y, z, t, side)}
    if lid:
        panels["top"] = flat
    panels = {key: _with_bones(panel, bones) for key, panel in panels.items()}
    opposite = [{"bottom", "top"}, {"front", "back"}, {"left", "right"}]
    joined = {frozenset({a, b}) for a in panels for b in panels if a < b and {a, b} not in opposite}
    return Design(name, t, panels, joined, (x, y, z))


def _around(wide: float, tall: float) -> list[tuple[str, float]]:
    return [("bottom", wide), ("top", wide), ("left", tall), ("right", tall)]


def _plate(wide: float, tall: float, t: float, gone: list[tuple[str, list[tuple[float, float]]]]) -> shapely.Polygon:
    """Rectangle without the stretches of its edges that belong to other plates."""
    cut = []
    for side, stretches in gone:
        for a, b in stretches:
            if side in ("bottom", "top"):
                y = 0.0 if side == "bottom" else tall - t
                cut.append(shapely.box(a, y, b, y + t))
            else:
                x = 0.0 if side == "left" else wide - t
                cut.append(shapely.box(x, a, x + t, b))
    return shapely.box(0, 0, wide, tall).difference(shapely.union_all(cut))


def _with_bones(polygon: shapely.Polygon, radius: float) -> shapely.Polygon:
    """Reliefs of a round cutter at the inner corners."""
    if not radius:
        return polygon
    points = np.array(polygon.exterior.coords)[:-1]
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    reflex = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] < 0
    if not polygon.exterior.is_ccw:
        reflex = ~reflex & (np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]) > 1e-9)
    reliefs = [shapely.Point(p).buffer(radius) for p in points[reflex]]
    cut = polygon.difference(shapely.union_all(reliefs))
    return max(shapely.get_parts(cut), key=lambda piece: piece.area)


def egg_crate(
    name: str, columns: list[float], rows: list[float], tall: float, t: float, width: float, depth: float
) -> Design:
    """Strips that cross in half laps: those along x at the places `rows`, those along y at `columns`."""
    panels = {}
    for k, _ in enumerate(rows):
        slots = [shapely.box(c - t / 2, tall / 2, c + t / 2, tall) for c in columns]
        panels[f"x{k}"] = shapely.box(0, 0, width, tall).difference(shapely.union_all(slots))
    for k, _ in enumerate(columns):
        slots = [shapely.box(r - t / 2, 0, r + t / 2, tall / 2) for r in rows]
        panels[f"y{k}"] = shapely.box(0, 0, depth, tall).difference(shapely.union_all(slots))
    joined = {frozenset({f"x{i}", f"y{j}"}) for i in range(len(rows)) for j in range(len(columns))}
    return Design(name, t, panels, joined, (width, depth, tall))


def shelf(
    name: str, width: float, depth: float, heights: list[float], t: float, tall: float, slant: float = 0.0
) -> Design:
    """Two sides with rows of holes, boards with tabs; the boards may slope from front to back [degrees]."""
    tabs = [(depth * 0.15, depth * 0.35), (depth * 0.55, depth * 0.85)]
    holes = [
        affinity.rotate(shapely.box(a, h - t / 2, b, h + t / 2), slant, origin=(depth / 2, h))
        for h in heights
        for a, b in tabs
    ]
    side = shapely.box(0, 0, depth, tall).difference(shapely.union_all(holes))
    board = shapely.union_all(
        [
            shapely.box(0, 0, width, depth),
            *(shapely.box(-t, a, 0, b) for a, b in tabs),
            *(shapely.box(width, a, width + t, b) for a, b in tabs),
        ]
    )
    panels = {"side left": side, "side right": side} | {f"board {k}": board for k in range(len(heights))}
    joined = {frozenset({f"side {s}", f"board {k}"}) for s in ("left", "right") for k in range(len(heights))}
    return Design(name, t, panels, joined, (width + 2 * t, depth, tall))


def stool(name: str, width: float, tall: float, t: float) -> Design:
    """Two legs that cross in a half lap, a seat on their four tabs."""
    tabs = [(width * 0.12, width * 0.3), (width * 0.7, width * 0.88)]
    up = [shapely.box(a, tall, b, tall + t) for a, b in tabs]
    leg = shapely.union_all([shapely.box(0, 0, width, tall), *up])
    half = shapely.box(width / 2 - t / 2, tall / 2, width / 2 + t / 2, tall)
    lower = shapely.box(width / 2 - t / 2, 0, width / 2 + t / 2, tall / 2)
    centre = width / 2 + 20
    holes = [shapely.box(20 + a, centre - t / 2, 20 + b, centre + t / 2) for a, b in tabs]
    holes += [shapely.box(centre - t / 2, 20 + a, centre + t / 2, 20 + b) for a, b in tabs]
    seat = shapely.box(0, 0, width + 40, width + 40).difference(shapely.union_all(holes))
    panels = {"seat": seat, "leg a": leg.difference(half), "leg b": leg.difference(lower)}
    joined = {frozenset(pair) for pair in (("seat", "leg a"), ("seat", "leg b"), ("leg a", "leg b"))}
    return Design(name, t, panels, joined, (width + 40, width + 40, tall + t))


def trapezoid(name: str, low: float, high: float, tall: float, depth: float, t: float) -> Design:
    """Two trapezoid ends with rows of holes along all four sides, four boards with tabs."""
    inset = t * 1.5
    end = shapely.Polygon([(0, 0), (low, 0), ((low + high) / 2, tall), ((low - high) / 2, tall)])
    sides = list(zip(end.exterior.coords[:-1], end.exterior.coords[1:], strict=True))
    holes, boards = [], {}
    for k, (a, b) in enumerate(sides):
        a, b = np.array(a), np.array(b)
        long = float(np.hypot(*(b - a)))
        u = (b - a) / long
        n = np.array([-u[1], u[0]])
        begin, end_at = 5 * t + 2 * k, long - 5 * t + k
        tabs = [(begin, begin + (end_at - begin) * 0.3), (end_at - (end_at - begin) * 0.42, end_at)]
        for p, q in tabs:
            holes.append(
                shapely.Polygon(
                    [a + u * s + n * (inset + h) for s, h in ((p, -t / 2), (q, -t / 2), (q, t / 2), (p, t / 2))]
                )
            )
        board = [shapely.box(begin - t, 0, end_at + t, depth)]
        board += [shapely.box(p, -t, q, 0) for p, q in tabs] + [shapely.box(p, depth, q, depth + t) for p, q in tabs]
        boards[f"board {k}"] = shapely.union_all(board)
    plate = end.difference(shapely.union_all(holes))
    panels = {"end a": plate, "end b": plate} | boards
    joined = {frozenset({f"end {e}", f"board {k}"}) for e in "ab" for k in range(4)}
    return Design(name, t, panels, joined, (max(low, high), tall, depth + 2 * t))


def burnt(design: Design, burn: float) -> Design:
    """The same with outlines grown by half the width of the cut, as tabbed-box makers write them."""
    grown = {name: panel.buffer(burn, join_style="mitre") for name, panel in design.panels.items()}
    return Design(f"{design.name} burn {burn:g}", design.thickness, grown, design.joined, design.size, burn)


def bolted(design: Design, nut: float, sides: tuple[str, ...] = ("front", "back")) -> Design:
    """The same with T-shaped slots for bolts and nuts in the middle of some panels' plain fields, and bolt holes: windows, not joints."""
    panels = dict(design.panels)
    for name in sides:
        x0, y0, x1, y1 = panels[name].bounds
        x, y = (x0 + x1) / 2, (y0 + y1) / 2
        tee = shapely.union_all(
            [shapely.box(x - 1.5, y - 8, x + 1.5, y + 4), shapely.box(x - nut, y - 2, x + nut, y + 0.4)]
        )
        hole = shapely.Point(x - 0.3 * (x1 - x0), y).buffer(1.6)
        panels[name] = panels[name].difference(tee).difference(hole)
    return Design(f"{design.name} bolted", design.thickness, panels, design.joined, design.size)


def lapped_on_base(name: str, x: float, y: float, high: float, t: float, over: float) -> Design:
    """Four walls that cross in half laps `over` from their ends and stand with tabs in holes of a base."""
    holes, walls = [], {}
    for axis, (long, other) in enumerate(((x, y), (y, x))):
        tabs = [(long * 0.22, long * 0.34), (long * 0.58, long * 0.76)]
        slots = [over, long - over - t]
        low, top = (high / 2, high) if axis == 0 else (0.0, high / 2)
        wall = shapely.union_all([shapely.box(0, 0, long, high), *(shapely.box(a, -t, b, 0) for a, b in tabs)])
        wall = wall.difference(shapely.union_all([shapely.box(s, low, s + t, top) for s in slots]))
        for k, at in enumerate((over, other - over - t)):
            walls["xy"[axis] + str(k)] = wall
            for a, b in tabs:
                box_of = (a, at, b, at + t) if axis == 0 else (at, a, at + t, b)
                holes.append(shapely.box(*box_of))
    base = shapely.box(0, 0, x, y).difference(shapely.union_all(holes))
    joined = {frozenset({f"x{i}", f"y{j}"}) for i in range(2) for j in range(2)}
    joined |= {frozenset({"base", wall}) for wall in walls}
    return Design(name, t, {"base": base} | walls, joined, (x, y, high + t))


def divided(name: str, x: float, y: float, high: float, t: float, at: tuple[float, float]) -> Design:
    """Open box of finger joints with two dividers that cross in a half lap and stand with tabs in holes of the walls."""
    design = box(name, x, y, high, t, 3 * t, lid=False)
    tabs = [(high * 0.3, high * 0.45), (high * 0.6, high * 0.8)]
    holes = {"front": at[0], "back": at[0], "left": at[1], "right": at[1]}
    for wall, place in holes.items():
        cut = shapely.union_all([shapely.box(place - t / 2, a, place + t / 2, b) for a, b in tabs])
        design.panels[wall] = design.panels[wall].difference(cut)
    for key, long, cross, half in (("along", y, at[1], "up"), ("across", x, at[0], "down")):
        sheet = shapely.box(t, t, long - t, high - 2)
        sheet = shapely.union_all([sheet, *(shapely.box(c, a, c + t, b) for c in (0.0, long - t) for a, b in tabs)])
        middle = (t + high - 2) / 2
        low, top = (middle, high) if half == "up" else (0.0, middle)
        design.panels[key] = sheet.difference(shapely.box(cross - t / 2, low, cross + t / 2, top))
    design.joined |= {frozenset(pair) for pair in (("along", "front"), ("along", "back"), ("across", "left"))}
    design.joined |= {frozenset(pair) for pair in (("across", "right"), ("along", "across"))}
    return design


def other_styles() -> list[Design]:
    """Sheets in the style of other programs, on which nothing was tried out before they were measured."""
    return [
        burnt(box("tabbed", 110, 80, 55, 3, 12), 0.08),
        burnt(box("tabbed tall", 60, 60, 140, 4, 10), 0.12),
        burnt(box("tabbed open", 130, 70, 50, 6, 15, lid=False), 0.1),
        bolted(box("bolts", 120, 90, 60, 3, 14), 2.75),
        bolted(box("bolts open", 140, 100, 70, 5, 18, lid=False), 4.0, ("left", "front")),
        lapped_on_base("laps", 120, 90, 50, 3, 8),
        lapped_on_base("laps thick", 200, 140, 60, 6, 14),
        lapped_on_base("laps tall", 90, 70, 110, 4, 6),
        divided("divided", 120, 80, 50, 3, (45.0, 30.0)),
        divided("divided thick", 200, 150, 80, 5, (70.0, 90.0)),
        divided("divided low", 160, 110, 40, 4, (60.0, 40.0)),
    ]


def designs() -> list[Design]:
    """All sheets of the benchmark."""
    return [
        box("box 80 60 40", 80, 60, 40, 3, 9),
        box("box thick", 150, 110, 90, 6, 16),
        box("box thin", 70, 50, 45, 1.5, 6),
        box("cube", 70, 70, 70, 3, 9),
        box("open box", 90, 60, 45, 3, 9, lid=False),
        box("open box thick", 200, 150, 80, 5, 17, lid=False),
        box("dog-bone box", 160, 120, 90, 6, 22, bones=1.2),
        box("dog-bone tray", 180, 130, 70, 6, 20, lid=False, bones=1.5),
        egg_crate("egg crate 2 x 3", [30, 75, 110], [25, 60], 40, 3, 150, 90),
        egg_crate("egg crate 4 x 4", [20, 50, 80, 120], [15, 45, 70, 105], 50, 3, 150, 130),
        egg_crate("egg crate even", [30, 60, 90], [30, 60, 90], 30, 4, 120, 120),
        egg_crate("cross", [50], [40], 60, 5, 110, 90),
        shelf("shelf 2", 120, 80, [40, 110], 4, 150),
        shelf("shelf 4", 200, 90, [20, 80, 150, 230], 5, 260),
        shelf("shelf slanted", 150, 80, [40, 100], 4, 150, slant=12),
        shelf("shelf slanted 3", 180, 100, [50, 120, 190], 3, 240, slant=-20),
        stool("stool", 120, 90, 6),
        stool("stool small", 60, 50, 3),
        trapezoid("trapezoid", 120, 70, 80, 60, 3),
        trapezoid("trapezoid wide", 100, 180, 90, 110, 4),
    ]
