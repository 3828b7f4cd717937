"""Walk the tree of an SVG: which shapes are drawn, where, in which groups and colours."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeVar

from wiggleroom.drawing.readers.css import (
    GEOMETRY,
    TRANSFORMS,
    Rules,
    declarations,
    parse_rules,
    properties,
    selectors_not_followed,
)
from wiggleroom.drawing.readers.xmltree import Element
from wiggleroom.drawing.strokes.colours import RED, colour_of
from wiggleroom.drawing.strokes.elements import MAX_ELEMENTS, NO_SIZE, Group, Lettering, Stroke
from wiggleroom.drawing.strokes.layers import LABELS, is_hole_layer
from wiggleroom.drawing.strokes.pathdata import Subpath
from wiggleroom.drawing.strokes.shapes import SHAPES, subpaths_of
from wiggleroom.drawing.strokes.strokes import mapped, trace
from wiggleroom.drawing.strokes.transforms import (
    Affine,
    Box,
    fit,
    matrix_problem,
    parse_length,
    parse_origin,
    parse_transform,
    parse_view_box,
)
from wiggleroom.errors import InputError, Stop, go_on

if TYPE_CHECKING:
    from shapely import Geometry

GROUP_ELEMENTS = ("g", "a", "switch")
UNSUPPORTED_ELEMENTS = ("image", "foreignObject")
INVISIBLE_ELEMENTS = (
    "defs", "symbol", "metadata", "style", "title", "desc", "script", "clipPath", "mask", "marker", "pattern", "filter",
    "linearGradient", "radialGradient", "view", "font", "cursor", "animate", "animateTransform", "set", "namedview",
    "font-face", "color-profile", "solidcolor", "hatch", "mesh", "meshgradient", "animateMotion", "animateColor",
)  # fmt: skip
"""Elements that draw nothing where they stand."""
NOT_INHERITED = ("display", "transform", "transform-origin", "clip-path", "mask", *TRANSFORMS, *GEOMETRY)
MAX_NESTING = 200
"""Groups inside each other at most."""

T = TypeVar("T")


@dataclass(frozen=True, eq=False, slots=True)
class Copy:
    """A `use`: its element, what it copies, and by how much it moves that."""

    element: Element
    target: Element
    shift: complex


@dataclass(frozen=True, slots=True)
class _SvgState:
    """What an element inherits."""

    matrix: Affine
    port: Box
    style: dict[str, str] = field(default_factory=dict)
    groups: tuple[Group, ...] = ()
    layer: str = ""
    fixed: bool = False
    copies: tuple[Element, ...] = ()
    copy: Copy | None = None
    clips: tuple[Geometry | None, ...] = ()
    depth: int = 0


@dataclass(frozen=True, eq=False, slots=True)
class Origin:
    """Where a stroke comes from: its element, the map from there to the page, what it inherits, and the outermost copy that it is in."""

    element: Element
    matrix: Affine
    style: dict[str, str]
    copy: Copy | None


@dataclass
class SvgWalk:
    """Shapes, notes and findings of one drawing; `origins` are those of the strokes."""

    file: str
    root: Element
    stop: Stop | None = None
    strokes: list[Stroke] = field(default_factory=list)
    origins: list[Origin] = field(default_factory=list)
    texts: list[Lettering] = field(default_factory=list)
    repeated: list[str] = field(default_factory=list)
    findings: list[str] = field(default_factory=list)
    left_out: Counter[str] = field(default_factory=Counter)
    clipped: int = 0

    def __post_init__(self) -> None:
        elements = list(_everything(self.root))
        self._visited = 0
        sheets = [element.text for element in elements if element.tag == "style"]
        self._rules: Rules = parse_rules(sheets)
        self.not_followed = selectors_not_followed(sheets)
        drawn = (*SHAPES, *GROUP_ELEMENTS, "use", "symbol", "svg")
        named = [element for element in elements if element.tag in drawn and element.attributes.get("id")]
        self._clips = {e.attributes.get("id", ""): e for e in elements if e.tag in ("clipPath", "mask")}
        self._by_id = {element.attributes["id"]: element for element in reversed(named)}
        counts = Counter(element.attributes["id"] for element in named)
        self.repeated = [name for name, count in counts.items() if count > 1]

    def run(self, matrix: Affine, port: Box) -> None:
        """Collect everything below the root, which `matrix` maps to the page."""
        state = self._inherit(self.root, _SvgState(matrix, port))
        if state.style.get("display") != "none":
            self._children(self.root, state)

    def _inherit(self, element: Element, state: _SvgState) -> _SvgState:
        own = properties(element.tag, element.attributes, self._rules)
        matrix = state.matrix
        if "transform" in own:
            transform = self._try(element, parse_transform, own["transform"], Affine())
            port, about = state.port, own.get("transform-origin", "0 0")
            at = self._try(element, lambda text: parse_origin(text, port.width, port.height), about, 0j)
            matrix = matrix.after(Affine(e=at.real, f=at.imag)).after(transform).after(Affine(e=-at.real, f=-at.imag))
        moving = [key for key in TRANSFORMS if own.get(key, "none") not in ("none", "view-box")]
        if moving and ("transform" in own or moving != ["transform-box"]):
            message = f'style property "{moving[0]}" is not followed; say it with transform alone'
            self.findings.append(f"{self.file}: {element.tag} in line {element.line}: {message}")
        style = {key: value for key, value in state.style.items() if key not in NOT_INHERITED}
        style |= {key: value for key, value in own.items() if value != "inherit"}
        # Ids below a <use> belong to the original: they neither name nor fix the copy.
        fixed = state.fixed or (not state.copies and "fixed" in _marks(element))
        return replace(state, matrix=matrix, style=style, fixed=fixed)

    def _children(self, element: Element, state: _SvgState) -> None:
        if state.depth > MAX_NESTING:
            message = f"{self.file}: line {element.line}: groups are nested deeper than {MAX_NESTING}; ungroup them"
            raise InputError(message)
        inner = replace(state, depth=state.depth + 1)
        children = element.children
        if element.tag == "switch":
            children = [child for child in children if _is_taken(child)][:1]
        for child in children:
            self._visit(child, inner)

    def _visit(self, element: Element, outer: _SvgState) -> None:
        go_on(self.stop)
        tag = element.tag
        if tag == "flowRoot":
            self.left_out["text"] += 1
            return
        if tag not in (*SHAPES, *GROUP_ELEMENTS, *UNSUPPORTED_ELEMENTS, "text", "use", "svg"):
            if tag and tag not in INVISIBLE_ELEMENTS:
                self.left_out[f"unknown {tag}"] += 1
            return
        self._visited += 1
        if self._visited > MAX_ELEMENTS:
            message = f"{self.file}: draws more than {MAX_ELEMENTS} elements, copies counted; split the drawing"
            raise InputError(message)
        state = self._inherit(element, outer)
        if state.style.get("display") == "none":
            named = _label(element) or _id(element)
            self.left_out[f'hidden layer "{named}"' if _is_layer(element) else f"hidden {tag}"] += 1
            return
        if tag == "g" and not state.copies and LABELS in _marks(element):
            return
        state = self._clipped(element, state)
        if tag in SHAPES:
            self._shape(element, state)
            return
        if tag == "text":
            self._text(element, state)
            return
        if tag in UNSUPPORTED_ELEMENTS:
            self.left_out[tag] += 1
            return
        glue = not state.copies and any(mark.startswith("glue") for mark in _marks(element))
        name = "" if state.copies else _label(element) or _id(element)
        marks = () if state.copies else tuple(filter(None, (_label(element), _id(element), *_classes(element))))
        state = replace(state, groups=(*state.groups, Group(name, glue, marks)))
        if _is_layer(element) or (len(state.groups) == 1 and not state.copies):
            state = replace(state, layer=name)
        if tag == "use":
            self._use(element, state)
        elif tag == "svg":
            corner = complex(self._length(element, "x", state), self._length(element, "y", state))
            self._children(element, self._inside(element, element, corner, state))
        else:
            self._children(element, state)

    def _shape(self, element: Element, state: _SvgState) -> None:
        if state.style.get("visibility") in ("hidden", "collapse"):
            self.left_out[f"hidden {element.tag}"] += 1
            return
        fill = self._colour("fill", state, "black")
        copied = bool(state.copies)
        paths, problem = self._paths(element, state)
        if paths and any(clip is not None and not any(_meets(clip, path) for path in paths) for clip in state.clips):
            self.left_out[f"clipped {element.tag}"] += 1
            return
        self.clipped += any(clip is None or not all(_covers(clip, path) for path in paths) for clip in state.clips)
        stroke = Stroke(
            tag=element.tag,
            place=f"line {element.line}",
            paths=paths,
            name="" if copied else _id(element),
            label="" if copied else _label(element),
            groups=state.groups,
            layer=state.layer,
            marks=tuple(_classes(element)),
            colour=self._colour("stroke", state, ""),
            fill=fill,
            styled="fill" in state.style or "stroke" in state.style,
            fixed=state.fixed or fill == RED,
            even_odd=state.style.get("fill-rule", "").lower() == "evenodd",
            hole=any(is_hole_layer(mark) for group in state.groups for mark in group.marks),
            whole="data-pieces" in element.attributes,
            pool=(state.layer, *(id(copy) for copy in state.copies)),
        )
        if problem:
            self.findings.append(f"{self.file}: {stroke}: {problem}")
        elif not paths:
            self.left_out[NO_SIZE] += 1
        else:
            self.strokes.append(stroke)
            self.origins.append(Origin(element, state.matrix, state.style, state.copy))

    def _clipped(self, element: Element, state: _SvgState) -> _SvgState:
        """With the region on the page that a clip path of an element leaves; None where it is not known."""
        links = [state.style.get(key, "none") for key in ("clip-path", "mask")]
        for link in links:
            target = self._clips.get(link.removeprefix("url(").strip("\"') ")[1:])
            if link == "none" or (target is None and link.startswith("url(")):
                continue
            region = None
            if target and target.tag == "clipPath" and target.attributes.get("clipPathUnits") != "objectBoundingBox":
                inner = self._inherit(target, replace(state, copies=(*state.copies, element)))
                shapes = [child for child in target.children if child.tag in SHAPES]
                rest = any(child.tag in ("use", "text") for child in target.children)
                region = None if rest else self._region(shapes, inner)
            state = replace(state, clips=(*state.clips, region))
        return state

    def _region(self, shapes: list[Element], state: _SvgState) -> Geometry:
        """What shapes cover together on the page."""
        import shapely

        traces = [trace(path) for shape in shapes for path in self._paths(shape, self._inherit(shape, state))[0]]
        pieces = [shapely.Polygon([(p.real, p.imag) for p in points]) for points in traces if len(points) > 2]
        whole = shapely.union_all(shapely.make_valid(pieces))
        return whole.buffer(1e-6 * whole.length)

    def _paths(self, element: Element, state: _SvgState) -> tuple[tuple[Subpath, ...], str]:
        """Subpaths of a shape on the page, and what is wrong with them."""
        styled = {key: _plain(state.style[key]) for key in GEOMETRY if state.style.get(key, "auto") != "auto"}
        try:
            subpaths = subpaths_of(element.tag, element.attributes | styled, state.port)
        except ValueError as error:
            return (), str(error) or "cannot be read"
        if problem := matrix_problem(state.matrix):
            return (), problem
        return tuple(mapped(path, state.matrix) for path in subpaths), ""

    def _colour(self, key: str, state: _SvgState, otherwise: str) -> str:
        """Colour of the fill or the line, or nothing where it does not show."""
        value = state.style.get(key, otherwise)
        if value.lower() == "currentcolor":
            value = state.style.get("color", "black")
        try:
            hidden = any(float(state.style.get(k, "1").rstrip("%")) == 0 for k in (f"{key}-opacity", "opacity"))
        except ValueError:
            hidden = False
        return "" if hidden else colour_of(value)

    def _text(self, element: Element, state: _SvgState) -> None:
        """Keep a text and a point within its first letters."""
        words = " ".join(" ".join(child.text for child in _everything(element)).split())
        if not words:
            return
        spots = [e.attributes for e in _everything(element) if e.tag in ("text", "tspan") and "x" in e.attributes]
        first = spots[0] if spots else element.attributes
        try:
            x, y = (parse_length(first.get(key, "0").replace(",", " ").split()[0], 0.0) for key in ("x", "y"))
            size = parse_length(state.style.get("font-size", "16px"), 16.0)
        except (ValueError, IndexError):
            x = y = 0.0
            size = 1.0
        below = state.style.get("dominant-baseline", "") in ("hanging", "text-before-edge")
        middle = state.style.get("dominant-baseline", "") in ("middle", "central")
        side = {"middle": 0.0, "end": -0.3}.get(state.style.get("text-anchor", ""), 0.3)
        up = 0.3 if below else 0.0 if middle else -0.3
        self.texts.append(Lettering(words, state.matrix.point(complex(x + side * size, y + up * size))))

    def _use(self, element: Element, state: _SvgState) -> None:
        link = element.attributes.get("href") or element.attributes.get("xlink:href") or ""
        target = self._by_id.get(link[1:]) if link.startswith("#") else None
        if target is None or target in state.copies:
            reason = "holds this use itself" if target else "is no shape or group of this file"
            message = f'use refers to "{link[:60]}", which {reason}; it must refer to the id of a shape or group'
            self.findings.append(f"{self.file}: line {element.line}: {message}")
            return
        shift = Affine(e=self._length(element, "x", state), f=self._length(element, "y", state))
        copy = state.copy or Copy(element, target, complex(shift.e, shift.f))
        state = replace(state, matrix=state.matrix.after(shift), copies=(*state.copies, target), copy=copy)
        if target.tag == "symbol":
            state = self._inside(target, element, 0j, self._inherit(target, state))
            self._children(target, state)
        else:
            if target.tag == "svg":
                size = {key: element.attributes[key] for key in ("width", "height") if key in element.attributes}
                target = replace(target, attributes=target.attributes | size)
            self._visit(target, replace(state, depth=state.depth + 1))

    def _inside(self, element: Element, sized: Element, corner: complex, state: _SvgState) -> _SvgState:
        """Coordinates inside a nested svg or a used symbol; `sized` carries the width and height."""
        width, height = (self._length(sized, key, state, "100%") for key in ("width", "height"))
        port = Box(corner.real, corner.imag, width, height)
        inner, view = Affine(e=port.x, f=port.y), Box(0.0, 0.0, width, height)
        if "viewBox" in element.attributes:
            view = self._try(element, parse_view_box, element.attributes["viewBox"], Box(0.0, 0.0, 1.0, 1.0))
            inner = fit(view, port, element.attributes.get("preserveAspectRatio", ""))
        own = declarations(element.attributes.get("style", ""))
        clips = state.clips
        if own.get("overflow", element.attributes.get("overflow", "hidden")) in ("hidden", "scroll"):
            x, y, right, top = port.x, port.y, port.x + port.width, port.y + port.height
            corners = [state.matrix.point(complex(*at)) for at in ((x, y), (right, y), (right, top), (x, top))]
            clips = (*clips, _slack_polygon(corners))
        return replace(state, matrix=state.matrix.after(inner), port=view, clips=clips)

    def _length(self, element: Element, key: str, state: _SvgState, default: str = "0") -> float:
        whole = state.port.width if key in ("x", "width") else state.port.height
        return self._try(element, lambda text: parse_length(text, whole), element.attributes.get(key, default), 0.0)

    def _try(self, element: Element, parse: Callable[[str], T], text: str, otherwise: T) -> T:
        try:
            return parse(text)
        except ValueError as error:
            self.findings.append(f"{self.file}: {element.tag} in line {element.line}: {error}")
            return otherwise


def _plain(value: str) -> str:
    """Path data or a length of a style as it would stand in an attribute."""
    return value.removeprefix("path(").rstrip(")").strip("\"' ")


def _slack_polygon(corners: list[complex]) -> Geometry:
    """Area inside corners, a hair wider, so that lines on its edge are in it."""
    import shapely

    area = shapely.Polygon([(p.real, p.imag) for p in corners])
    return area.buffer(1e-6 * area.length)


def _covers(region: Geometry, path: Subpath) -> bool:
    import shapely

    return bool(region.covers(shapely.MultiPoint([(p.real, p.imag) for p in trace(path)])))


def _meets(region: Geometry, path: Subpath) -> bool:
    import shapely

    return bool(region.intersects(shapely.LineString([(p.real, p.imag) for p in trace(path)])))


def _is_taken(element: Element) -> bool:
    """Whether a `switch` may draw a child: it asks for no extension, and for no language or English."""
    languages = element.attributes.get("systemLanguage", "en").split(",")
    plain = "requiredExtensions" not in element.attributes and any(s.strip().startswith("en") for s in languages)
    return plain and element.tag in (*SHAPES, *GROUP_ELEMENTS, *UNSUPPORTED_ELEMENTS, "text", "use", "svg")


def _id(element: Element) -> str:
    return element.attributes.get("id", "").strip()


def _label(element: Element) -> str:
    """What a person called an element: its Inkscape label, else its title."""
    label = element.attributes.get("inkscape:label", "").strip()
    title = next((child.text for child in element.children if child.tag == "title"), "")
    return label or " ".join(title.split())


def _classes(element: Element) -> list[str]:
    return element.attributes.get("class", "").split()


def _is_layer(element: Element) -> bool:
    return element.attributes.get("inkscape:groupmode") == "layer" or element.attributes.get("data-name") is not None


def _marks(element: Element) -> set[str]:
    return {element.attributes.get(key, "").strip().lower() for key in ("id", "inkscape:label")}


def _everything(element: Element) -> Iterator[Element]:
    waiting = [element]
    while waiting:
        found = waiting.pop()
        yield found
        waiting.extend(reversed(found.children))
