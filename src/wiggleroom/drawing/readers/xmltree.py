"""XML text to a tree of plain elements; entities other than short plain texts are refused before anything is expanded."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from xml.parsers import expat

from wiggleroom.drawing.readers.source import Source
from wiggleroom.errors import InputError

_SVG = "http://www.w3.org/2000/svg"
TAG = re.compile(r"<[^>\"']*(?:\"[^\"]*\"[^>\"']*|'[^']*'[^>\"']*)*>")
"""A tag, whatever its attributes hold."""
_COMMENT = re.compile(r"<!--|<!\[CDATA\[")
_INK = re.compile(r"[^\n]")
_ENTITY = re.compile(r"<!ENTITY\s+(?:%\s*)?([^\s>\"']*)", re.IGNORECASE)
_PLAIN_ENTITY = re.compile(r"<!ENTITY\s+[^\s>\"'%]+\s+(?:\"[^\"&%<]{0,80}\"|'[^'&%<]{0,80}')\s*>")
"""A name for a short text without further entities, such as a namespace of Adobe Illustrator: it cannot grow."""


@dataclass(eq=False, slots=True)
class Element:
    """One element: its name without prefix, "" where it is not of SVG, and where its first and its last tag begin in the text."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)
    text: str = ""
    at: int = 0
    end: int = 0


def parse_xml(source: Source) -> Element:
    """Root of the tree.

    Prefixes are taken as written, because many generators leave the namespace declarations out.

    Raises
    ------
    InputError
        If the text is not well-formed, or its DOCTYPE declares entities that are no short plain texts.

    Examples
    --------
    >>> parse_xml(Source("a.svg", "<svg><path id='a'/></svg>")).children[0].attributes
    {'id': 'a'}
    """
    text = _without_comments(source.text)
    entity = next((e for e in _ENTITY.finditer(text) if not _PLAIN_ENTITY.match(text, e.start())), None)
    if entity:
        message = (
            f'{source.name}: the DOCTYPE declares the entity "{entity.group(1)[:40]}"; '
            "only short plain texts are read as entities, save the drawing as plain SVG"
        )
        raise InputError(message)
    builder = _Builder(text)
    try:
        builder.parser.Parse(text, True)
    except expat.ExpatError as error:
        again = "the project" if source.name.lower().endswith(".xmpuzzle") else "the drawing as plain SVG"
        message = (
            f"{source.name}: line {error.lineno}, column {error.offset + 1}: "
            f"is not well-formed XML ({expat.ErrorString(error.code)}); save {again} again"
        )
        raise InputError(message) from None
    return builder.root.children[0]


def spliced(text: str, new: Iterable[tuple[int, int, str]]) -> str:
    """The text with other words from one place to another, each in turn.

    >>> spliced("one two three", [(0, 3, "1"), (8, 13, "3")])
    '1 two 3'
    """
    pieces, end = [], 0
    for begin, after, words in new:
        pieces += [text[end:begin], words]
        end = after
    return "".join([*pieces, text[end:]])


def element_span(text: str, element: Element) -> tuple[int, int]:
    """Where an element begins and ends in the text."""
    tag = TAG.match(text, element.at)
    if tag is not None and tag.group().endswith("/>"):
        return element.at, tag.end()
    return element.at, text.index(">", element.end) + 1


def _without_comments(text: str) -> str:
    """The text with blanks for comments, which many generators write with the two hyphens that XML forbids in them."""
    pieces, end = [], 0
    for begin in _COMMENT.finditer(text):
        if begin.start() < end:
            continue
        close = "-->" if begin.group() == "<!--" else "]]>"
        stop = text.find(close, begin.end())
        if stop < 0:
            break
        pieces.append(text[end : begin.start()])
        end = stop + len(close)
        between = text[begin.start() : end]
        pieces.append(_INK.sub(" ", between) if close == "-->" else between)
    return "".join([*pieces, text[end:]]) if pieces else text


class _Builder:
    def __init__(self, text: str) -> None:
        self._raw = b"" if text.isascii() else text.encode()
        self._known = (0, 0)
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._data
        self.root = Element("", {}, 0)
        self._open = [self.root]
        self._prefixes = {"", "svg"}

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        for key, value in attributes.items():
            if key.startswith("xmlns:") and value == _SVG:
                self._prefixes.add(key[6:])
        prefix, _, local = name.rpartition(":")
        tag = local if prefix in self._prefixes else ""
        element = Element(tag, attributes, self.parser.CurrentLineNumber, at=self._place())
        self._open[-1].children.append(element)
        self._open.append(element)

    def _end(self, _name: str) -> None:
        self._open.pop().end = self._place()

    def _place(self) -> int:
        """Character of the text at which the parser is: it counts bytes."""
        byte = int(self.parser.CurrentByteIndex)
        if not self._raw:
            return byte
        before, characters = self._known
        self._known = byte, characters + len(self._raw[before:byte].decode())
        return self._known[1]

    def _data(self, text: str) -> None:
        self._open[-1].text += text
