"""Write parts as they are made into the SVG that they were drawn in: page, layers, colours and all else stay as they are."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from wiggleroom.drawing.model import Part, Points
from wiggleroom.drawing.readers.source import Source
from wiggleroom.drawing.readers.svg import walked_svg
from wiggleroom.drawing.readers.svg_walk import Origin
from wiggleroom.drawing.readers.xmltree import TAG, element_span, spliced
from wiggleroom.drawing.strokes.elements import Stroke
from wiggleroom.drawing.strokes.layers import cut_strokes
from wiggleroom.drawing.strokes.pathdata import Arc, Cubic, Subpath
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.drawing.strokes.strokes import mapped
from wiggleroom.drawing.strokes.transforms import Affine
from wiggleroom.drawing.writers.drawn_rings import Redrawn, redrawn
from wiggleroom.drawing.writers.unlinked_copies import unlinked
from wiggleroom.errors import InputError

_ATTRIBUTE = re.compile(r"\s+([^\s=<>\"'/]+)\s*=\s*(\"[^\"]*\"|'[^']*')")
_ENCODING = re.compile(r"(^\s*<\?xml[^>]*encoding\s*=\s*[\"'])[A-Za-z0-9._-]+")
_SHAPE = frozenset(
    ("d", "points", "x", "y", "width", "height", "rx", "ry", "cx", "cy", "r", "x1", "y1", "x2", "y2", "pathLength")
)
"""Attributes that say what a shape looks like; those of Inkscape by which it would draw the shape anew do so too."""
_OWN = ("id", "inkscape:label", "data-pieces")
"""Attributes that only one of several paths in the place of one may have."""
_PAINT = ("fill", "stroke", "stroke-width")
_Look = tuple[Sequence[Subpath], dict[str, str]]
"""Paths of a stroke [mm], and what it inherits."""


def svg_in_place(
    source: Source, drawn: Sequence[Part], made: Sequence[Part], flatten: float, unit: str | None, options: ReadOptions
) -> str:
    """Text of the same file with the outlines of `made` in place of those of `drawn`; copies (`use`) of outlines become shapes.

    Raises
    ------
    InputError
        If a copy of an outline looks otherwise without its link to the original.
    """
    strokes, origins = _strokes(source, unit, options)
    changed = redrawn(strokes, drawn, made, flatten)
    if changed is None:
        return source.text
    while copies := [
        origin.copy
        for origin, stroke, new in zip(origins, strokes, changed, strict=True)
        if origin.copy is not None and len(new.kept) < len(stroke.paths)
    ]:
        looked = [(stroke.paths, origin.style) for stroke, origin in zip(strokes, origins, strict=True)]
        source = unlinked(source, copies)
        strokes, origins = _strokes(source, unit, options)
        if not _alike(looked, [(stroke.paths, origin.style) for stroke, origin in zip(strokes, origins, strict=True)]):
            first = min(copies, key=lambda copy: copy.element.at)
            message = f"{source.name}: line {first.element.line}: a copy (use) of an outline depends on its link; unlink it first"
            raise InputError(message)
        changed = redrawn(strokes, drawn, made, flatten) or changed
    told = [(o, new) for s, o, new in zip(strokes, origins, changed, strict=True) if len(new.kept) < len(s.paths)]
    words = []
    for origin, new in sorted(told, key=lambda one: one[0].element.at):
        begin, after = element_span(source.text, origin.element)
        words.append((begin, after, _element(source.text[begin:after], origin, new)))
    return _ENCODING.sub(r"\1UTF-8", spliced(source.text, words), count=1)


def _strokes(source: Source, unit: str | None, options: ReadOptions) -> tuple[Sequence[Stroke], list[Origin]]:
    """What is cut, and where in the text each stroke comes from."""
    walk, artwork = walked_svg(source, unit)
    origins = {id(stroke): origin for stroke, origin in zip(walk.strokes, walk.origins, strict=True)}
    strokes = cut_strokes(artwork, options)[0].strokes
    return strokes, [origins[id(stroke)] for stroke in strokes]


def _alike(before: Sequence[_Look], after: Sequence[_Look]) -> bool:
    """Whether strokes lie at the same places and look the same; their curves are compared at their ends."""
    if [style for _, style in before] != [style for _, style in after]:
        return False
    one, two = (np.array([p for paths, _ in looks for path in paths for p in _ends(path)]) for looks in (before, after))
    return one.shape == two.shape and np.allclose(one, two, rtol=1e-9, atol=1e-9)


def _ends(path: Subpath) -> list[complex]:
    return [path.start, *(segment.end for segment in path.segments)]


def _element(text: str, origin: Origin, new: Redrawn) -> str:
    """The paths in place of an element, with what else it says."""
    tag = TAG.match(text)
    assert tag is not None
    inner = "" if tag.group().endswith("/>") else text[tag.end() : text.rindex("</")]
    name = tag.group()[1:].split(None, 1)[0].rstrip("/>")
    prefix = name.rpartition(":")[0]
    path = f"{prefix}:path" if prefix else "path"
    said = _ATTRIBUTE.findall(tag.group())
    kept = [
        (k, v)
        for k, v in said
        if k not in _SHAPE and not k.startswith(("sodipodi:", "inkscape:path-effect", "inkscape:original"))
    ]
    if name != path:  # rules about its kind no longer find it
        style = dict(kept).get("style", '""')[1:-1].rstrip("; ")
        paint = [f"{key}:{origin.style[key]}" for key in _PAINT if key in origin.style and f"{key}:" not in style]
        if paint:
            words = "; ".join([*([style] if style else []), *paint]).replace('"', "'")
            kept = [(k, v) for k, v in kept if k != "style"] + [("style", f'"{words}"')]
    inverse = origin.matrix.inverse()
    digits = max(0, min(15, 9 + math.floor(math.log10(_scale(origin.matrix)))))
    data = ["".join(_ring(ring, inverse, digits) for ring in rings) for rings in new.rings.values()]
    rest = "".join(_curve(mapped(one, inverse), digits) for one in new.kept)
    if rest:
        data.append(rest)
    found = []
    for k, shape in enumerate(data):
        words = "".join(f" {key}={value}" for key, value in kept if k == 0 or key not in _OWN)
        body = f">{inner}</{path}>" if inner.strip() and k == 0 else "/>"
        found.append(f'<{path}{words} d="{shape}"{body}')
    return "\n".join(found)


def _scale(matrix: Affine) -> float:
    """Millimetres of a unit."""
    return math.sqrt(abs(matrix.a * matrix.d - matrix.b * matrix.c))


def _ring(ring: Points, inverse: Affine, digits: int) -> str:
    corners = (inverse.point(complex(x, y)) for x, y in ring.tolist())
    return "M" + "L".join(_point(p, digits) for p in corners) + "z"


def _curve(path: Subpath, digits: int) -> str:
    """Path data of a stroke; arcs as cubics of a quarter turn at most."""
    words = [f"M{_point(path.start, digits)}"]
    for segment in path.segments:
        if isinstance(segment, Cubic):
            words.append("C" + " ".join(_point(p, digits) for p in segment))
        elif isinstance(segment, Arc):
            words += ["C" + " ".join(_point(p, digits) for p in three) for three in cubics(segment)]
        else:
            words.append(f"L{_point(segment.end, digits)}")
    return "".join(words) + ("z" if path.closed else "")


def cubics(arc: Arc) -> list[tuple[complex, complex, complex]]:
    """Control points and ends of cubics along an arc, off by less than 0.03 % of its radius."""
    count = max(1, math.ceil(abs(arc.sweep) / (math.pi / 2) - 1e-9))
    step = arc.sweep / count
    angles = [arc.start + k * step for k in range(count + 1)]
    at = [arc.centre + arc.u * math.cos(angle) + arc.v * math.sin(angle) for angle in angles]
    reach = 4 / 3 * math.tan(step / 4)
    along = [reach * (arc.v * math.cos(angle) - arc.u * math.sin(angle)) for angle in angles]
    if arc.flipped:
        at, along = at[::-1], [-vector for vector in reversed(along)]
    return [(at[k] + along[k], at[k + 1] - along[k + 1], at[k + 1]) for k in range(count)]


def _point(at: complex, digits: int) -> str:
    """Two numbers without trailing zeros, and no minus before a zero."""
    words = [f"{round(value, digits) + 0.0:.{digits}f}" for value in (at.real, at.imag)]
    return " ".join(word.rstrip("0").rstrip(".") if digits else word for word in words)
