"""Read a LightBurn project (.lbrn2, .lbrn): shapes [mm], y points up."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from wiggleroom.drawing.limits import LARGEST
from wiggleroom.drawing.readers.source import Source, load
from wiggleroom.drawing.readers.xmltree import Element, parse_xml
from wiggleroom.drawing.strokes.elements import MAX_ELEMENTS, NO_SIZE, Artwork, Group, Lettering, Stroke
from wiggleroom.drawing.strokes.layers import is_hole_layer
from wiggleroom.drawing.strokes.pathdata import MAX_COORDINATE, NUMBER, Arc, Cubic, Line, Segment, Subpath
from wiggleroom.drawing.strokes.shapes import subpaths_of
from wiggleroom.drawing.strokes.strokes import largest_coordinate, mapped
from wiggleroom.drawing.strokes.transforms import Affine, Box
from wiggleroom.drawing.units import millimetres
from wiggleroom.errors import InputError, Stop, go_on

LAYER_COLOURS = (
    "#000000", "#0000ff", "#ff0000", "#00e000", "#d0d000", "#ff8000", "#00e0e0", "#ff00ff", "#b4b4b4", "#0000a0",
    "#a00000", "#00a000", "#a0a000", "#c08000", "#00a0ff", "#a000a0", "#808080", "#7d87b9", "#bb7784", "#4a6fe3",
    "#d33f6a", "#8cd78c", "#f0b98d", "#f6c4e1", "#fa9ed4", "#500a78", "#b45a00", "#004754", "#86fa88", "#ffdb66",
)  # fmt: skip
"""Colours of the layers 00 to 29 in the program's palette."""
TOOL_LAYERS = (30, 31)
"""Layers T1 and T2, which are never cut."""
_VERTEX = re.compile(rf"V({NUMBER})\s+({NUMBER})((?:c[01][xy]{NUMBER})*)")
_CONTROL = re.compile(rf"c([01])([xy])({NUMBER})")
_PRIMITIVE = re.compile(r"([LB])\s*(\d+)\s+(\d+)")
MAX_NESTING = 100
"""Groups inside each other at most."""


def lightburn_artwork(path: str | Path, unit: str | None = None, stop: Stop | None = None) -> Artwork:
    """Strokes and texts of a LightBurn project.

    Parameters
    ----------
    path : str or Path
    unit : str, optional
        What one unit is, in place of the millimetre.
    stop : optional
        Asked before every shape.

    Raises
    ------
    InputError
        If the file is no LightBurn project.
    """
    return walked_lightburn(load(path, opening="<", name="drawing"), unit, stop)[1]


def walked_lightburn(
    source: Source, unit: str | None = None, stop: Stop | None = None
) -> tuple[LightburnWalk, Artwork]:
    """The same with where in the text every stroke comes from; see `lightburn_artwork`."""
    root = parse_xml(source)
    if root.tag != "LightBurnProject":
        message = f"{source.name}: is not a LightBurn project; its outermost element must be LightBurnProject"
        raise InputError(message)
    try:
        scale = millimetres(unit) if unit is not None else 1.0
    except InputError as error:
        message = f"{source.name}: {error}"
        raise InputError(message) from None
    walk = LightburnWalk(source.name, root, stop)
    # What was drawn on a machine whose origin is at the right or in the back is mirrored on the screen.
    mirror = [-1.0 if root.attributes.get(key, "").lower() == "true" else 1.0 for key in ("MirrorX", "MirrorY")]
    walk.shapes(root, Affine(scale * mirror[0], 0.0, 0.0, scale * mirror[1]), (), 0)
    artwork = Artwork(
        file=source.name,
        strokes=tuple(walk.strokes),
        texts=tuple(walk.texts),
        findings=tuple(walk.findings),
        left_out=tuple(walk.left_out.items()),
    )
    return walk, artwork


class LightburnWalk:
    """Shapes of a project, with what is wrong with them; `origins` are the element of each stroke and the map from it to the page."""

    def __init__(self, file: str, root: Element, stop: Stop | None) -> None:
        self.file = file
        self.root = root
        self.stop = stop
        self.strokes: list[Stroke] = []
        self.origins: list[tuple[Element, Affine]] = []
        self.texts: list[Lettering] = []
        self.findings: list[str] = []
        self.left_out: Counter[str] = Counter()
        self._vertices: dict[str, Element] = {}
        self._primitives: dict[str, Element] = {}
        self._layers: dict[int, Group] = {}
        self._engraved: dict[int, str] = {}
        for setting in root.children:
            if setting.tag in ("CutSetting", "CutSetting_Img"):
                self._setting(setting)

    def _setting(self, setting: Element) -> None:
        """One layer: its number, its name, and whether it cuts."""
        values = {child.tag: child.attributes.get("Value", "") for child in setting.children}
        try:
            index = int(values.get("index", ""))
        except ValueError:
            return
        kind = setting.attributes.get("type", setting.attributes.get("Type", "Cut"))
        name = values.get("name", "").strip() or _layer_name(index)
        self._layers[index] = Group(name, name.lower().startswith("glue"), (name, _layer_name(index)))
        if setting.tag == "CutSetting_Img" or kind in ("Scan", "Image", "Offset Fill"):
            self._engraved[index] = "filled layer"
        elif values.get("doOutput", "1") == "0":
            self._engraved[index] = "layer without output"
        elif kind == "Tool":
            self._engraved[index] = "tool layer"

    def shapes(self, parent: Element, matrix: Affine, groups: tuple[Group, ...], depth: int) -> None:
        """Collect all shapes below an element, which `matrix` maps to the page."""
        if depth > MAX_NESTING:
            message = f"{self.file}: line {parent.line}: groups are nested deeper than {MAX_NESTING}; ungroup them"
            raise InputError(message)
        for element in parent.children:
            if element.tag != "Shape":
                continue
            go_on(self.stop)
            if len(self.strokes) > MAX_ELEMENTS:
                message = f"{self.file}: draws more than {MAX_ELEMENTS} elements; split the drawing"
                raise InputError(message)
            try:
                self._shape(element, matrix, groups, depth)
            except (ValueError, IndexError, ArithmeticError) as error:
                kind = element.attributes.get("Type", "shape")
                reason = str(error) if isinstance(error, ValueError) else "cannot be read"
                self.findings.append(f"{self.file}: {kind} in line {element.line}: {reason}")

    def _shape(self, element: Element, matrix: Affine, groups: tuple[Group, ...], depth: int) -> None:
        kind = element.attributes.get("Type", "")
        own = next((child for child in element.children if child.tag == "XForm"), None)
        if own is not None:
            matrix = matrix.after(_matrix(own.text))
        name = element.attributes.get("Name", "").strip()
        if kind == "Group":
            group = Group(name, name.lower().startswith("glue"), (name,) if name else ())
            for child in element.children:
                if child.tag == "Children":
                    self.shapes(child, matrix, (*groups, group), depth + 1)
        elif kind == "Text":
            text = " ".join(element.attributes.get("Str", "").split())
            if text:
                self.texts.append(Lettering(text, matrix.point(0j)))
        elif kind in ("Path", "Rect", "Ellipse", "Polygon"):
            self._stroke(element, kind, name, matrix, groups)
        else:
            self.left_out[kind or "nameless"] += 1

    def _stroke(self, element: Element, kind: str, name: str, matrix: Affine, groups: tuple[Group, ...]) -> None:
        index = int(element.attributes.get("CutIndex", "0"))
        layer = self._layers.setdefault(index, Group(_layer_name(index), False, (_layer_name(index),)))
        if index in TOOL_LAYERS or index in self._engraved:
            what = self._engraved.get(index, "tool layer")
            self.left_out[f'{kind} (on {what} "{layer.name}")'] += 1
            return
        paths = tuple(mapped(path, matrix) for path in self._paths(element, kind))
        if not paths:
            self.left_out[NO_SIZE] += 1
            return
        if any(not largest_coordinate(path) <= LARGEST for path in paths):
            message = f"has coordinates beyond {LARGEST:g} mm; move or scale it"
            raise ValueError(message)
        self.origins.append((element, matrix))
        self.strokes.append(
            Stroke(
                tag=kind,
                place=f"line {element.line}",
                paths=paths,
                label=name,
                groups=(Group("", layer.glue, layer.marks), *groups),
                layer=layer.name,
                colour=LAYER_COLOURS[index] if 0 <= index < len(LAYER_COLOURS) else "#000000",
                fixed="fixed" in {layer.name.lower(), name.lower(), *(group.name.lower() for group in groups)},
                even_odd=True,
                hole=is_hole_layer(layer.name),
                pool=(index,),
            )
        )

    def _paths(self, element: Element, kind: str) -> list[Subpath]:
        if kind == "Rect":
            width, height = (_number(element, key) for key in ("W", "H"))
            round_ = str(_number(element, "Cr", "0"))
            sizes = {"x": str(-width / 2), "y": str(-height / 2), "width": str(width), "height": str(height)}
            return subpaths_of("rect", sizes | {"rx": round_, "ry": round_}, Box(0.0, 0.0, 1.0, 1.0))
        if kind == "Ellipse":
            rx, ry = _number(element, "Rx"), _number(element, "Ry")
            if min(rx, ry) == 0:
                return []
            return [Subpath(complex(rx), [Arc(0j, complex(rx), 1j * ry, 0.0, 2 * math.pi, False, complex(rx))], True)]
        if kind == "Polygon":
            n, rx, ry = int(_number(element, "N")), _number(element, "Rx"), _number(element, "Ry")
            if not 3 <= n <= 10_000:
                raise ValueError("a polygon has at least 3 sides")
            corners = [complex(rx * math.cos(a), ry * math.sin(a)) for a in (2 * math.pi * k / n for k in range(n))]
            return [Subpath(corners[0], [Line(corner) for corner in corners[1:]], True)]
        return self._path(element)

    def _path(self, element: Element) -> list[Subpath]:
        """Subpaths of vertices and primitives; a path may refer to those of an earlier one by number."""
        vertices = self._referred(element, "VertList", "VertID", self._vertices)
        primitives = self._referred(element, "PrimList", "PrimID", self._primitives)
        corners, controls = _vertices(vertices, element)
        if not corners:
            return []
        text = primitives.text.strip() if primitives is not None else ""
        if text in ("LineClosed", "LineOpen"):
            return [Subpath(corners[0], [Line(corner) for corner in corners[1:]], text == "LineClosed")]
        edges = [(kind, int(a), int(b)) for kind, a, b in _PRIMITIVE.findall(text)]
        edges += [
            (e.attributes.get("T", "L")[:1], int(e.attributes.get("p0", "0")), int(e.attributes.get("p1", "0")))
            for e in element.children
            if e.tag == "P"
        ]
        if any(max(a, b) >= len(corners) for _, a, b in edges):
            raise ValueError("names a vertex that is not there; save the project again")
        return _chained(edges, corners, controls)

    @staticmethod
    def _referred(element: Element, tag: str, key: str, known: dict[str, Element]) -> Element | None:
        """List of its own, or that of an earlier path with the same number."""
        own = next((child for child in element.children if child.tag == tag), None)
        number = element.attributes.get(key)
        if number is None:
            return own
        if own is not None and own.text.strip():
            known[number] = own
        return known.get(number, own)


def _vertices(listed: Element | None, element: Element) -> tuple[list[complex], list[dict[str, complex]]]:
    """Corners, and of each the control points of the curves that leave (0) and reach (1) it."""
    corners: list[complex] = []
    controls: list[dict[str, complex]] = []
    found = _VERTEX.findall(listed.text) if listed is not None else []
    rows = [(x, y, {(end, axis): value for end, axis, value in _CONTROL.findall(more)}) for x, y, more in found]
    for child in element.children:
        if child.tag == "V":
            at = child.attributes
            more = {(k[1], k[2]): v for k, v in at.items() if re.fullmatch("c[01][xy]", k)}
            rows.append((at.get("vx", "0"), at.get("vy", "0"), more))
    for x, y, more in rows:
        corners.append(_checked(complex(float(x), float(y))))
        controls.append(
            {
                end: _checked(complex(float(more[end, "x"]), float(more[end, "y"])))
                for end in "01"
                if (end, "x") in more and (end, "y") in more
            }
        )
    return corners, controls


def _chained(
    edges: Sequence[tuple[str, int, int]], corners: Sequence[complex], controls: Sequence[dict[str, complex]]
) -> list[Subpath]:
    """Subpaths of edges that follow each other."""
    found: list[Subpath] = []
    segments: list[Segment] = []
    first = last = -1
    for kind, a, b in edges:
        if a != last:
            if segments:
                found.append(Subpath(corners[first], segments, last == first))
            segments, first = [], a
        out, into = controls[a].get("0", corners[a]), controls[b].get("1", corners[b])
        segments.append(Cubic(out, into, corners[b]) if kind == "B" else Line(corners[b]))
        last = b
    if segments:
        found.append(Subpath(corners[first], segments, last == first))
    return found


def _matrix(text: str) -> Affine:
    values = [float(number) for number in text.split()]
    if len(values) != 6 or not all(abs(value) <= MAX_COORDINATE for value in values):
        raise ValueError("its place (XForm) cannot be read; it takes six numbers")
    return Affine(*values)


def _number(element: Element, key: str, otherwise: str = "") -> float:
    text = element.attributes.get(key, otherwise)
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 <= value <= MAX_COORDINATE:
        message = f'{key} is "{text[:20]}"; it must be a number of 0 or more'
        raise ValueError(message)
    return value


def _checked(point: complex) -> complex:
    if not (abs(point.real) <= MAX_COORDINATE and abs(point.imag) <= MAX_COORDINATE):
        raise ValueError("has a vertex that is no number")
    return point


def _layer_name(index: int) -> str:
    return f"T{index - 29}" if index in TOOL_LAYERS else f"C{index:02d}"
