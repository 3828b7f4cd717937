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
    return spliced(
        source.text,
        (
            (*element_span(source.text, element), _shapes(element, matrix.inverse(), new))
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


def _shapes(element: Element, inverse: Affine, new: Redrawn) -> str:
    """The paths in place of a shape, on its layer and in its place; the first has its name."""
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
    for k, (vertices, edges) in enumerate(lines):
        words = "".join(f' {key}="{escape(value)}"' for key, value in said if k == 0 or key != "Name")
        lists = f"<VertList>{''.join(vertices)}</VertList><PrimList>{''.join(edges)}</PrimList>"
        found.append(f'<Shape Type="Path"{words}><XForm>{form.strip()}</XForm>{lists}</Shape>')
    return "\n".join(found)


class _Lines(NamedTuple):
    """Vertices and edges of a path, as the program has them."""

    vertices: list[str]
    edges: list[str]


def _ring(corners: Sequence[complex], lines: _Lines) -> None:
    first, count = len(lines.vertices), len(corners)
    lines.vertices.extend(f"V{_number(p.real)} {_number(p.imag)}c0x1c1x1" for p in corners)
    lines.edges.extend(f"L{first + k} {first + (k + 1) % count}" for k in range(count))


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
            lines.edges.append(f"B{first + len(corners) - 2} {first + len(corners) - 1}")
        if not curves:
            controls.append({})
            corners.append(segment.end)
            lines.edges.append(f"L{first + len(corners) - 2} {first + len(corners) - 1}")
    for corner, control in zip(corners, controls, strict=True):
        told = [f"c{end}x{_number(p.real)}c{end}y{_number(p.imag)}" for end, p in control.items()]
        lines.vertices.append(f"V{_number(corner.real)} {_number(corner.imag)}{''.join(told)}")
    if path.closed and corners[-1] != corners[0]:
        lines.edges.append(f"L{first + len(corners) - 1} {first}")


def _number(value: float) -> str:
    return f"{value + 0.0:.12g}"
