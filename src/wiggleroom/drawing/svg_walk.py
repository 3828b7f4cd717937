"""Walk the tree of an SVG: which shapes are drawn, where, in which groups and colours."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import TypeVar

from wiggleroom.drawing.css import Rules, is_red, parse_rules, properties
from wiggleroom.drawing.elements import MOST, Group, Shape
from wiggleroom.drawing.shapes import SHAPES, subpaths_of
from wiggleroom.drawing.transforms import Affine, Box, fit, parse_length, parse_transform, parse_view_box
from wiggleroom.drawing.xmltree import Element
from wiggleroom.errors import InputError

_GROUPS = ("g", "a", "switch")
_LEFT_OUT = ("text", "image", "foreignObject")
LABELS = "labels"
"""A group with this id or label holds names for people to read, and no parts."""
_DEEPEST = 200

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class _State:
    """What an element inherits."""

    matrix: Affine
    port: Box
    style: dict[str, str] = field(default_factory=dict)
    groups: tuple[Group, ...] = ()
    fixed: bool = False
    copies: tuple[Element, ...] = ()
    depth: int = 0


@dataclass
class Walk:
    """Shapes, notes and findings of one drawing."""

    file: str
    root: Element
    shapes: list[Shape] = field(default_factory=list)
    findings: list[str] = field(default_factory=list)
    left_out: Counter[str] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        elements = list(_everything(self.root))
        self._visited = 0
        self._rules: Rules = parse_rules(element.text for element in elements if element.tag == "style")
        drawn = (*SHAPES, *_GROUPS, "use", "symbol", "svg")
        named = [element for element in elements if element.tag in drawn and element.attributes.get("id")]
        self._by_id = {element.attributes["id"]: element for element in reversed(named)}
        for name, count in Counter(element.attributes["id"] for element in named).items():
            if count > 1:
                self.findings.append(f'{self.file}: id "{name}" is used {count} times; every id must be used once only')

    def run(self, matrix: Affine, port: Box) -> None:
        """Collect everything below the root, which `matrix` maps to the page."""
        state = self._inherit(self.root, _State(matrix, port))
        if state.style.get("display") != "none":
            self._children(self.root, state)

    def _inherit(self, element: Element, state: _State) -> _State:
        own = properties(element.tag, element.attributes, self._rules)
        matrix = state.matrix
        if "transform" in own:
            matrix = matrix.after(self._try(element, parse_transform, own["transform"], Affine()))
        style = {key: value for key, value in state.style.items() if key != "display"}
        style |= {key: value for key, value in own.items() if value != "inherit"}
        # Ids below a <use> belong to the original: they neither name nor fix the copy.
        fixed = state.fixed or (not state.copies and "fixed" in _marks(element))
        return replace(state, matrix=matrix, style=style, fixed=fixed)

    def _children(self, element: Element, state: _State) -> None:
        if state.depth > _DEEPEST:
            message = f"{self.file}: line {element.line}: groups are nested deeper than {_DEEPEST}; ungroup them"
            raise InputError(message)
        for child in element.children:
            self._visit(child, replace(state, depth=state.depth + 1))

    def _visit(self, element: Element, outer: _State) -> None:
        tag = element.tag
        if tag not in (*SHAPES, *_GROUPS, *_LEFT_OUT, "use", "svg"):
            return
        self._visited += 1
        if self._visited > MOST:
            message = f"{self.file}: draws more than {MOST} elements, copies counted; split the drawing"
            raise InputError(message)
        state = self._inherit(element, outer)
        name = "" if state.copies else _name(element)
        if state.style.get("display") == "none":
            return
        if tag == "g" and not state.copies and LABELS in _marks(element):
            return
        if tag in SHAPES:
            self._shape(element, name, state)
            return
        if tag in _LEFT_OUT:
            self.left_out[tag] += 1
            return
        glue = not state.copies and any(mark.startswith("glue") for mark in _marks(element))
        state = replace(state, groups=(*state.groups, Group(name, glue)))
        if tag == "use":
            self._use(element, state)
        elif tag == "svg":
            corner = complex(self._length(element, "x", state), self._length(element, "y", state))
            self._children(element, self._inside(element, element, corner, state))
        else:
            self._children(element, state)

    def _shape(self, element: Element, name: str, state: _State) -> None:
        if state.style.get("visibility") in ("hidden", "collapse"):
            return
        fill = state.style.get("fill", "")
        if fill.lower() == "currentcolor":
            fill = state.style.get("color", "")
        shape = Shape(
            tag=element.tag,
            place=f"line {element.line}",
            name=name,
            groups=state.groups,
            fixed=state.fixed or is_red(fill),
            even_odd=state.style.get("fill-rule", "").lower() == "evenodd",
            matrix=state.matrix,
            subpaths=[],
        )
        try:
            subpaths = subpaths_of(element.tag, element.attributes, state.port)
        except ValueError as error:
            self.findings.append(f"{self.file}: {shape}: {error}")
        else:
            self.shapes.append(replace(shape, subpaths=subpaths))

    def _use(self, element: Element, state: _State) -> None:
        link = element.attributes.get("href") or element.attributes.get("xlink:href") or ""
        target = self._by_id.get(link[1:]) if link.startswith("#") else None
        if target is None or target in state.copies:
            reason = "holds this use itself" if target else "is no shape or group of this file"
            message = f'use refers to "{link[:60]}", which {reason}; it must refer to the id of a shape or group'
            self.findings.append(f"{self.file}: line {element.line}: {message}")
            return
        shift = Affine(e=self._length(element, "x", state), f=self._length(element, "y", state))
        state = replace(state, matrix=state.matrix.after(shift), copies=(*state.copies, target))
        if target.tag == "symbol":
            state = self._inside(target, element, 0j, self._inherit(target, state))
            self._children(target, state)
        else:
            self._visit(target, replace(state, depth=state.depth + 1))

    def _inside(self, element: Element, sized: Element, corner: complex, state: _State) -> _State:
        """Coordinates inside a nested svg or a used symbol; `sized` carries the width and height."""
        width, height = (self._length(sized, key, state, "100%") for key in ("width", "height"))
        port = Box(corner.real, corner.imag, width, height)
        inner, view = Affine(e=port.x, f=port.y), Box(0.0, 0.0, width, height)
        if "viewBox" in element.attributes:
            view = self._try(element, parse_view_box, element.attributes["viewBox"], Box(0.0, 0.0, 1.0, 1.0))
            inner = fit(view, port, element.attributes.get("preserveAspectRatio", ""))
        return replace(state, matrix=state.matrix.after(inner), port=view)

    def _length(self, element: Element, key: str, state: _State, default: str = "0") -> float:
        whole = state.port.width if key in ("x", "width") else state.port.height
        return self._try(element, lambda text: parse_length(text, whole), element.attributes.get(key, default), 0.0)

    def _try(self, element: Element, parse: Callable[[str], T], text: str, otherwise: T) -> T:
        try:
            return parse(text)
        except ValueError as error:
            self.findings.append(f"{self.file}: {element.tag} in line {element.line}: {error}")
            return otherwise


def _name(element: Element) -> str:
    return element.attributes.get("id", "").strip() or element.attributes.get("inkscape:label", "").strip()


def _marks(element: Element) -> set[str]:
    return {element.attributes.get(key, "").strip().lower() for key in ("id", "inkscape:label")}


def _everything(element: Element) -> Iterator[Element]:
    waiting = [element]
    while waiting:
        found = waiting.pop()
        yield found
        waiting.extend(reversed(found.children))
