"""Panels of a cutting sheet: closed outlines nested into material, named by the text that stands in them."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import shapely
from shapely.geometry.polygon import orient

from wiggleroom.drawing.css import properties
from wiggleroom.drawing.elements import Shape
from wiggleroom.drawing.outlines import Outlines
from wiggleroom.drawing.pathdata import Subpath
from wiggleroom.drawing.source import load
from wiggleroom.drawing.strokes import trace
from wiggleroom.drawing.svg_page import page_map
from wiggleroom.drawing.svg_walk import Walk, _State
from wiggleroom.drawing.xmltree import Element, parse_xml
from wiggleroom.errors import InputError

FLATTEN = 0.01
"""Chord error of curves on a sheet [mm]."""
_JOIN = 0.05
"""Ends of open lines this near to each other [mm] meet."""
_SPECK = 1.0
"""Outlines that enclose less than this [mm2] are no material and no joint."""
_ENGRAVED = {(0, 255, 0), (0, 153, 0), (0, 255, 255)}
_SCALE_BAR = re.compile(r"[\d.]+ ?mm, *burn: *(?P<burn>[\d.]+) ?mm")


@dataclass(frozen=True, eq=False)
class Outlined:
    """One panel as it is drawn.

    Parameters
    ----------
    name : str
        Unique on its sheet.
    polygon : shapely.Polygon [mm]
        Material on the sheet, y up, holes cut out.
    """

    name: str
    polygon: shapely.Polygon


@dataclass(frozen=True, eq=False)
class CuttingSheet:
    """Everything a sheet says.

    Parameters
    ----------
    panels : tuple of Outlined
    burn : float [mm], optional
        Half of the cut's width, by which outlines were drawn larger, where the sheet says so.
    notes : tuple of str
    source : str
        The file's name.
    """

    panels: tuple[Outlined, ...]
    burn: float | None = None
    notes: tuple[str, ...] = ()
    source: str = ""


@dataclass
class _SheetWalk(Walk):
    """Walk that also keeps the texts and leaves out what is engraved."""

    texts: list[tuple[str, complex]] = field(default_factory=list)
    engraved: int = 0

    def _visit(self, element: Element, outer: _State) -> None:
        if element.tag == "text":
            self._text(element, outer)
        super()._visit(element, outer)

    def _text(self, element: Element, outer: _State) -> None:
        said = " ".join(_texts(element)).strip()
        state = self._inherit(element, outer)
        if said:
            corner = complex(self._length(element, "x", state), self._length(element, "y", state))
            self.texts.append((said, state.matrix.point(corner)))

    def _shape(self, element: Element, name: str, state: _State) -> None:
        own = properties(element.tag, element.attributes, self._rules)
        stroke = element.attributes.get("stroke", "") or own.get("stroke", "")
        numbers = tuple(int(float(x)) for x in re.findall(r"[\d.]+", stroke)) if stroke.startswith("rgb") else ()
        if numbers in _ENGRAVED or stroke.lower() in ("#00ff00", "#0f0", "lime", "#00ffff", "cyan"):
            self.engraved += 1
            return
        super()._shape(element, name, state)


def _texts(element: Element) -> list[str]:
    return [element.text.strip(), *(said for child in element.children for said in _texts(child))]


def read_sheet(source: str | Path, *, unit: str | None = None) -> CuttingSheet:
    """Panels of a cutting sheet.

    Parameters
    ----------
    source : str or Path
        An SVG file or its text, or a DXF or assembly file.
    unit : str, optional
        What one user unit is (mm, cm, m, in, px), whatever the file says.

    Raises
    ------
    InputError
        With one line per finding.

    Examples
    --------
    >>> sheet = read_sheet('<svg width="9mm" viewBox="0 0 9 9"><rect id="a" width="4" height="2"/></svg>')
    >>> [(panel.name, panel.polygon.area) for panel in sheet.panels]
    [('a', 8.0)]
    """
    if isinstance(source, Path) and source.suffix.lower() in (".dxf", ".json"):
        return _from_parts(source, unit)
    text = load(source, opening="<", name="sheet")
    root = parse_xml(text)
    if root.tag != "svg":
        message = f"{text.name}: is not an SVG drawing; its outermost element must be svg"
        raise InputError(message)
    matrix, port, notes = page_map(root, unit, text.name)
    walk = _SheetWalk(text.name, root)
    walk.run(matrix, port)
    if walk.findings:
        raise InputError(walk.findings)
    rings, names, opened = _rings(walk.shapes)
    return _sheet(text.name, rings, names, walk.texts, list(notes), opened=opened, engraved=walk.engraved)


def _from_parts(path: Path, unit: str | None) -> CuttingSheet:
    """Sheet of a file whose reader gives whole parts."""
    from wiggleroom.drawing import read_drawing

    drawing = read_drawing(path, unit=unit)
    rings, names = [], []
    for part in drawing.parts:
        x, y, angle = part.at
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        for region in part.regions:
            for ring in (region.outer, *region.holes):
                rings.append(ring @ turn.T + (x, y))
                names.append(part.name)
    return _sheet(path.name, rings, names, [], list(drawing.notes), opened=0, engraved=0)


def _rings(shapes: list[Shape]) -> tuple[list[np.ndarray], list[str], int]:
    """Closed outlines with the names of their elements, and how many lines stay open."""
    outlines, names = Outlines(), []
    loose: list[np.ndarray] = []
    for shape in shapes:
        named = shape.name or next((group.name for group in reversed(shape.groups) if group.name), "")
        for subpath in shape.subpaths:
            if outlines.add(_closing(subpath), shape.matrix):
                names.append(named)
            else:
                points = np.array([shape.matrix.point(point) for point in trace(subpath, 16)])
                loose.append(points.view(np.float64).reshape(-1, 2))
    rings = outlines.rings(FLATTEN)
    closed, opened = _chained(loose)
    return rings + closed, names + [""] * len(closed), opened


def _closing(subpath: Subpath) -> Subpath:
    """Close a line whose ends nearly meet."""
    ends = [subpath.start, *(segment.end for segment in subpath.segments)]
    if len(ends) > 3 and abs(ends[-1] - subpath.start) < _JOIN:
        return subpath._replace(closed=True)
    return subpath


def _chained(lines: list[np.ndarray]) -> tuple[list[np.ndarray], int]:
    """Closed outlines among lines joined end to end, and how many chains stay open."""
    if not lines:
        return [], 0
    snapped = shapely.set_precision([shapely.LineString(line) for line in lines if len(line) > 1], _JOIN / 2)
    merged = shapely.get_parts(shapely.line_merge(shapely.union_all(snapped)))
    closed = [shapely.get_coordinates(line) for line in merged if line.is_ring]
    return closed, len(merged) - len(closed)


def _sheet(
    file: str,
    rings: list[np.ndarray],
    named: list[str],
    texts: list[tuple[str, complex]],
    notes: list[str],
    *,
    opened: int,
    engraved: int,
) -> CuttingSheet:
    outlines = [(whole_outline(ring), name) for ring, name in zip(rings, named, strict=True) if len(ring) > 3]
    sound = [(polygon, name) for polygon, name in outlines if polygon.area > _SPECK]
    if not sound:
        message = f"{file}: has no closed outline; every panel must be closed"
        raise InputError(message)
    sound.sort(key=lambda row: -row[0].area)
    materials = _nested([polygon for polygon, _ in sound])
    inside = [[said for said, at in texts if material.envelope.intersects(_point(at))] for _, material in materials]
    burn, panels = None, []
    for (row, material), said in zip(materials, inside, strict=True):
        bar = next((match for line in said if (match := _SCALE_BAR.search(line))), None)
        if bar:
            burn = float(bar["burn"])
            notes.append(f"{file}: the scale bar is left out; it says that burn is {burn:g} mm")
        else:
            panels.append((said[0] if said else sound[row][1], material))
    panels.sort(key=lambda row: (row[1].bounds[0], row[1].bounds[1]))
    if opened:
        notes.append(f"{file}: {opened} open lines are left out; close them if they are outlines")
    if engraved:
        notes.append(f"{file}: {engraved} engraved elements are left out (green or cyan)")
    if len(outlines) > len(sound):
        notes.append(f"{file}: {len(outlines) - len(sound)} specks of less than {_SPECK:g} mm2 are left out")
    names = _unique([name for name, _ in panels])
    found = tuple(Outlined(name, material) for name, (_, material) in zip(names, panels, strict=True))
    return CuttingSheet(found, burn, tuple(notes), file)


def _point(at: complex) -> shapely.Point:
    return shapely.Point(at.real, at.imag)


def whole_outline(ring: np.ndarray) -> shapely.Polygon:
    """Polygon that an outline (n, 2) [mm] runs round; tiny loops at its corners do not count.

    Examples
    --------
    >>> whole_outline(np.array([[0, 0], [9, 0], [9.1, 0.1], [9.1, 0], [9, 0.1], [9, 9], [0, 9.0]])).area > 80
    True
    """
    polygon = shapely.Polygon(ring)
    if not polygon.is_valid:
        faces = shapely.get_parts(shapely.polygonize([shapely.union_all(shapely.LinearRing(ring))]))
        largest = max(faces, key=lambda face: face.area, default=shapely.Polygon())
        polygon = largest if largest.area > 0.5 * sum(face.area for face in faces) else shapely.make_valid(polygon)
        pieces = [piece for piece in shapely.get_parts(polygon) if piece.geom_type == "Polygon"]
        polygon = max(pieces, key=lambda piece: piece.area, default=shapely.Polygon())
    return shapely.Polygon(polygon.exterior)


def _nested(polygons: list[shapely.Polygon]) -> list[tuple[int, shapely.Polygon]]:
    """Material by nesting: every outline inside an even number of others is a panel; rows, and holes cut out.

    Parameters
    ----------
    polygons : list of shapely.Polygon [mm]
        Largest first.
    """
    tree = shapely.STRtree(polygons)
    parent: list[int] = []
    depth: list[int] = []
    for i, polygon in enumerate(polygons):
        point = polygon.representative_point()
        around = [j for j in tree.query(point, predicate="within").tolist() if j < i]
        around = [j for j in around if polygons[j].area > polygon.area * 1.001]
        parent.append(max(around, default=-1))
        depth.append(len(around))
    found = []
    for i, polygon in enumerate(polygons):
        if depth[i] % 2 == 0:
            holes = [polygons[j] for j in range(len(polygons)) if parent[j] == i and depth[j] == depth[i] + 1]
            material = polygon.difference(shapely.union_all(holes)) if holes else polygon
            pieces = shapely.get_parts(material)
            found.append((i, orient(max(pieces, key=lambda piece: piece.area))))
    return found


def _unique(names: list[str]) -> list[str]:
    """Every name once: p1, p2, ... where there is none, a number added where there are several."""
    counts = Counter(name for name in names if name)
    seen: Counter[str] = Counter()
    taken: set[str] = set()
    result = []
    for place, name in enumerate(names, 1):
        wanted = name or f"p{place}"
        if counts[name] > 1:
            seen[name] += 1
            wanted = f"{name} {seen[name]}"
        while wanted in taken:
            wanted += "'"
        taken.add(wanted)
        result.append(wanted)
    return result
