"""Write parts as they are made into the LightBurn project that they were drawn in: layers, their settings and all else stay as they are."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from typing import NamedTuple

from wiggleroom.drawing.model import Part
from wiggleroom.drawing.readers.lightburn import walked_lightburn
from wiggleroom.drawing.readers.source import Source
from wiggleroom.drawing.readers.xmltree import Element, element_span, spliced
from wiggleroom.drawing.strokes.layers import cut_strokes
from wiggleroom.drawing.strokes.pathdata import Arc, Cubic, Subpath
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.drawing.strokes.strokes import mapped
from wiggleroom.drawing.strokes.transforms import Affine
from wiggleroom.drawing.writers.drawn_rings import Redrawn, redrawn
from wiggleroom.drawing.writers.svg_in_place import cubics
from wiggleroom.errors import InputError

_SHAPE = frozenset(("Type", "W", "H", "Cr", "Rx", "Ry", "N", "VertID", "PrimID"))
"""Attributes that say what a shape looks like."""
_LISTS = ("VertID", "PrimID")
"""Attributes by which shapes share the lists of one of them."""


def lightburn_in_place(
    source: Source, drawn: Sequence[Part], made: Sequence[Part], flatten: float, unit: str | None, options: ReadOptions
) -> str:
    """Text of the same project with the outlines of `made` in place of those of `drawn`.

    Raises
    ------
    InputError
        If a shape that stays shares the lists of one that is drawn anew.
    """
    walk, artwork = walked_lightburn(source, unit)
    origins = {id(stroke): origin for stroke, origin in zip(walk.strokes, walk.origins, strict=True)}
    strokes = cut_strokes(artwork, options)[0].strokes
    changed = redrawn(strokes, drawn, made, flatten)
    if changed is None:
        return source.text
    told = [(*origins[id(s)], new) for s, new in zip(strokes, changed, strict=True) if len(new.kept) < len(s.paths)]
    _check_shared(source.name, walk.root, [element for element, _, _ in told])
    older = source.name.lower().endswith(".lbrn")
    return spliced(
        source.text,
        (
            (*element_span(source.text, element), _shapes(element, matrix.inverse(), new, older))
            for element, matrix, new in sorted(told, key=lambda one: one[0].at)
        ),
    )


def _check_shared(name: str, root: Element, anew: Sequence[Element]) -> None:
    """Raise InputError where a shape that stays has lists of one that goes."""
    gone = {id(element) for element in anew}
    lists = {(key, e.attributes[key]) for e in anew for key in _LISTS if key in e.attributes}
    for shape in _all_shapes(root):
        if id(shape) not in gone and any((key, shape.attributes.get(key)) in lists for key in _LISTS):
            message = f"{name}: line {shape.line}: a shape shares its vertices with an outline; save the project again"
            raise InputError(message)


def _all_shapes(parent: Element) -> Iterator[Element]:
    for element in parent.children:
        if element.tag == "Shape":
            yield element
        yield from _all_shapes(element)


def _shapes(element: Element, inverse: Affine, new: Redrawn, older: bool) -> str:
    """The paths in place of a shape, on its layer and in its place; the first has its name.

    In `older` projects (.lbrn) every vertex and every edge is an element, in others they stand in two lists.
    """
    form = next((child.text for child in element.children if child.tag == "XForm"), "1 0 0 1 0 0")
    said = [(key, value) for key, value in element.attributes.items() if key not in _SHAPE]
    lines: list[_Lines] = []
    for rings in new.rings.values():
        lines.append(_Lines([], []))
        for ring in rings:
            _ring([inverse.point(complex(x, y)) for x, y in ring.tolist()], lines[-1])
    if new.kept:
        lines.append(_Lines([], []))
        for path in new.kept:
            _curve(mapped(path, inverse), lines[-1])
    found = []
    for k, line in enumerate(lines):
        words = "".join(f' {key}="{escape(value)}"' for key, value in said if k == 0 or key != "Name")
        inner = line.elements if older else line.lists
        found.append(f'<Shape Type="Path"{words}><XForm>{form.strip()}</XForm>{inner}</Shape>')
    return "\n".join(found)


class _Lines(NamedTuple):
    """Vertices of a path, each with values by name (its place x and y, and those of its controls, c0x to c1y), and edges."""

    vertices: list[dict[str, str]]
    edges: list[tuple[str, int, int]]

    @property
    def lists(self) -> str:
        """Both as the program has them now."""
        vertices = (
            f"V{v['x']} {v['y']}{''.join(f'{k}{n}' for k, n in v.items() if k[0] == 'c')}" for v in self.vertices
        )
        edges = (f"{kind}{a} {b}" for kind, a, b in self.edges)
        return f"<VertList>{''.join(vertices)}</VertList><PrimList>{''.join(edges)}</PrimList>"

    @property
    def elements(self) -> str:
        """Both as older versions have them."""
        vertices = (
            "<V" + "".join(f' {k if k[0] == "c" else "v" + k}="{n}"' for k, n in v.items()) + "/>"
            for v in self.vertices
        )
        edges = (f'<P T="{kind}" p0="{a}" p1="{b}"/>' for kind, a, b in self.edges)
        return "".join((*vertices, *edges))


NO_CONTROL = {"c0x": "1", "c1x": "1"}
"""What a corner between straight edges says of its controls."""


def _ring(corners: Sequence[complex], lines: _Lines) -> None:
    first, count = len(lines.vertices), len(corners)
    lines.vertices.extend({"x": _number(p.real), "y": _number(p.imag)} | NO_CONTROL for p in corners)
    lines.edges.extend(("L", first + k, first + (k + 1) % count) for k in range(count))


def _curve(path: Subpath, lines: _Lines) -> None:
    """Vertices with the control points of curves; arcs as cubics."""
    corners = [path.start]
    controls: list[dict[str, complex]] = [{}]
    first = len(lines.vertices)
    for segment in path.segments:
        curves = cubics(segment) if isinstance(segment, Arc) else [tuple(segment)] if isinstance(segment, Cubic) else []
        for out, into, at in curves:
            controls[-1]["0"] = out
            controls.append({"1": into})
            corners.append(at)
            lines.edges.append(("B", first + len(corners) - 2, first + len(corners) - 1))
        if not curves:
            controls.append({})
            corners.append(segment.end)
            lines.edges.append(("L", first + len(corners) - 2, first + len(corners) - 1))
    for corner, control in zip(corners, controls, strict=True):
        told = {f"c{end}{axis}": _number(v) for end, p in control.items() for axis, v in (("x", p.real), ("y", p.imag))}
        lines.vertices.append({"x": _number(corner.real), "y": _number(corner.imag)} | told)
    if path.closed and corners[-1] != corners[0]:
        lines.edges.append(("L", first + len(corners) - 1, first))


def _number(value: float) -> str:
    return f"{value + 0.0:.12g}"
