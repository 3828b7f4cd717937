"""Copies (`use`) in the text of an SVG, replaced by what they copy."""

from __future__ import annotations

import re
from collections.abc import Iterable

from wiggleroom.drawing.readers.source import Source
from wiggleroom.drawing.readers.svg_walk import Copy
from wiggleroom.drawing.readers.xmltree import TAG, element_span, spliced

_LINK = re.compile(r"\s(?:xlink:)?href\s*=\s*(?:\"[^\"]*\"|'[^']*')")
_PLACE = re.compile(r"\s(?:x|y|width|height)\s*=\s*(?:\"[^\"]*\"|'[^']*')")
_SIZE = re.compile(r"\s(?:width|height)\s*=\s*(?:\"[^\"]*\"|'[^']*')")
_NAME = re.compile(r"\s(?:id|inkscape:label)\s*=\s*(?:\"[^\"]*\"|'[^']*')")


def unlinked(source: Source, copies: Iterable[Copy]) -> Source:
    """The same drawing with groups in place of some copies; what is in them has no names, which belong to the original.

    Parameters
    ----------
    source : Source
    copies : iterable of Copy
        None of them within another one.
    """
    by_place = {copy.element.at: copy for copy in copies}
    words = (
        (*element_span(source.text, by_place[at].element), _group(source.text, by_place[at])) for at in sorted(by_place)
    )
    return Source(source.name, spliced(source.text, words))


def _group(text: str, copy: Copy) -> str:
    """A group with what a copy says, moved to its place, and what it copies within."""
    head, prefix = _head(text, copy.element.at)
    x, y = copy.shift.real, copy.shift.imag
    said = _PLACE.sub("", _LINK.sub("", head))
    group = f"{prefix}g"
    return f'<{group}{said}><{group} transform="translate({x:.17g} {y:.17g})">{_copied(text, copy)}</{group}></{group}>'


def _copied(text: str, copy: Copy) -> str:
    """What is copied; a symbol becomes a drawing within the drawing, of the size that the copy has."""
    begin, after = element_span(text, copy.target)
    words = text[begin:after]
    if copy.target.tag in ("symbol", "svg"):
        head, prefix = _head(words, 0)
        size = _SIZE.findall(_head(text, copy.element.at)[0])
        own = [
            one
            for one in _SIZE.findall(head)
            if one.split("=")[0].strip() not in {s.split("=")[0].strip() for s in size}
        ]
        tag = TAG.match(words)
        assert tag is not None
        inner = "" if tag.group().endswith("/>") else words[tag.end() : words.rindex("</")]
        said = (_PLACE if copy.target.tag == "symbol" else _SIZE).sub("", head)
        words = f"<{prefix}svg{said}{''.join((*own, *size))}>{inner}</{prefix}svg>"
    return TAG.sub(lambda tag: _NAME.sub("", tag.group()), words)


def _head(text: str, at: int) -> tuple[str, str]:
    """Attributes in a tag, as they are written, and the prefix of its name."""
    tag = TAG.match(text, at)
    assert tag is not None
    name, space, said = tag.group()[1:-1].rstrip("/").partition(next((c for c in tag.group() if c.isspace()), " "))
    prefix, colon, _ = name.rpartition(":")
    return space + said.rstrip() if said.strip() else "", prefix + colon
