"""The little of CSS that decides about parts: fill, stroke, visibility; simple selectors only."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

_COMMENT = re.compile(r"/\*.*?\*/|<!--|-->", re.DOTALL)
_SIMPLE = re.compile(r"^(\*|[\w-]+)?((?:[.#][\w-]+)*)$")
Rules = list[tuple[tuple[int, int], str, str, dict[str, str]]]
"""(weight and order), element name or "", rest of the selector, declarations."""


def declarations(text: str) -> dict[str, str]:
    """Properties of a `style` attribute or of a rule's body, as written.

    Examples
    --------
    >>> declarations("fill: red; stroke:none !important")
    {'fill': 'red', 'stroke': 'none !important'}
    """
    pairs = (item.split(":", 1) for item in _COMMENT.sub("", text).split(";") if ":" in item)
    return {key.strip().lower(): value.strip() for key, value in pairs}


def parse_rules(sheets: Iterable[str]) -> Rules:
    """Rules of style sheets, weakest first; selectors with combinators or pseudo-classes are skipped.

    Examples
    --------
    >>> parse_rules([".a, path { fill: red }"])
    [((1, 1), 'path', '', {'fill': 'red'}), ((100, 0), '', '.a', {'fill': 'red'})]
    """
    rules: Rules = []
    for sheet in sheets:
        for rule in _COMMENT.sub("", sheet).split("}"):
            selectors, _, body = rule.partition("{")
            for selector in selectors.split(","):
                match = _SIMPLE.match(selector.strip())
                if match and selector.strip():
                    tag, rest = (match.group(1) or "").replace("*", ""), match.group(2)
                    weight = 10_000 * rest.count("#") + 100 * rest.count(".") + bool(tag)
                    rules.append(((weight, len(rules)), tag, rest, declarations(body)))
    return sorted(rules, key=lambda rule: rule[0])


def selectors_not_followed(sheets: Iterable[str]) -> list[str]:
    """Selectors with combinators or attributes, and at-rules, that say something about parts: their rules are skipped.

    Examples
    --------
    >>> selectors_not_followed(["g > .a, .b { stroke: red } a:hover { fill: red } @media print { .c { fill: red } }"])
    ['g > .a', '@media print']
    """
    found: list[str] = []
    for sheet in sheets:
        for rule in _COMMENT.sub("", sheet).split("}"):
            selectors, _, body = rule.partition("{")
            known = declarations(body.rpartition("{")[2]).keys() & {*_PRESENTATION, *GEOMETRY}
            names = [selector.strip() for selector in selectors.split(",")]
            found += [name for name in names if known and ":" not in name and name and not _SIMPLE.match(name)]
    return found


def properties(tag: str, attributes: Mapping[str, str], rules: Rules) -> dict[str, str]:
    """Properties set on one element: attributes, overruled by style sheets, overruled by its own style, all by what is important.

    Examples
    --------
    >>> properties("path", {"style": "fill: red"}, parse_rules(["path { fill: blue !important }"]))
    {'fill': 'blue'}
    """
    found = {key: attributes[key].strip() for key in _PRESENTATION if key in attributes}
    marks = {"." + name for name in attributes.get("class", "").split()} | {"#" + attributes.get("id", "")}
    for _, wanted, rest, values in rules:
        if wanted in ("", tag) and marks.issuperset(re.findall(r"[.#][\w-]+", rest)):
            _overrule(found, values)
    _overrule(found, declarations(attributes.get("style", "")))
    return {key: value.partition("!")[0].rstrip() for key, value in found.items()}


def _overrule(found: dict[str, str], values: Mapping[str, str]) -> None:
    found.update({key: value for key, value in values.items() if "!" in value or "!" not in found.get(key, "")})


GEOMETRY = ("x", "y", "width", "height", "rx", "ry", "cx", "cy", "r", "d")
"""Attributes of shapes that a style may set."""
TRANSFORMS = ("translate", "rotate", "scale", "offset-path", "transform-box")
"""Properties that move shapes and are not followed."""
_PRESENTATION = (
    "fill", "fill-rule", "fill-opacity", "stroke", "stroke-opacity", "opacity", "display", "visibility", "color",
    "font-size", "text-anchor", "dominant-baseline", "transform", "transform-origin", "clip-path", "mask",
)  # fmt: skip
