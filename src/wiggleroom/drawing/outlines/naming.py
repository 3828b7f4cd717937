"""Names of parts: labels, titles, blocks, texts that stand in them, ids, groups, numbers."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

if TYPE_CHECKING:
    from wiggleroom.drawing.strokes.elements import Lettering, Stroke

MAX_LABEL_LENGTH = 80
"""Characters of a name; longer texts are notes."""
JOINERS = str.maketrans("", "", "\u200c\u200d")
"""Characters that join or part letters; words of some scripts need them, though nothing is printed for them."""
PLACE = re.compile(r"@\s*([-+.\deE]+)\s*,\s*([-+.\deE]+)\s*")
"""How a part is chosen by a point of it."""
Polygons = Sequence[shapely.Polygon] | NDArray[np.object_]


def is_printable(name: str) -> bool:
    """Whether all of a name is seen where it is printed, and it is more than blanks.

    Examples
    --------
    >>> is_printable("\u0645\u06cc\u200c\u062e\u0648\u0627\u0647\u0645"), is_printable("a\u202eb"), is_printable(" ")
    (True, False, False)
    """
    seen = name.translate(JOINERS)
    return seen.isprintable() and bool(seen.strip())


def texts_inside(polygons: Polygons, texts: Sequence[Lettering]) -> tuple[list[str], int]:
    """The only text that stands in each outline, or nothing, and how many texts name none.

    Examples
    --------
    >>> from wiggleroom.drawing.strokes.elements import Lettering
    >>> texts_inside([shapely.box(0, 0, 9, 9)], [Lettering("lid", 3 + 3j), Lettering("out", 20 + 3j)])
    (['lid'], 1)
    """
    said: dict[int, list[str]] = {}
    tree, area = shapely.STRtree(list(polygons)), shapely.area(np.array(polygons, dtype=object)).tolist()
    for lettering in texts:
        point = shapely.Point(lettering.at.real, lettering.at.imag)
        around = tree.query(point, predicate="intersects").tolist()
        owner = min(around, key=lambda i: area[i], default=None)
        if owner is not None and is_printable(lettering.text) and 0 < len(lettering.text) <= MAX_LABEL_LENGTH:
            said.setdefault(owner, []).append(lettering.text)
    names = [said[i][0] if len(said.get(i, [])) == 1 else "" for i in range(len(polygons))]
    return names, len(texts) - sum(map(bool, names))


def given_names(strokes: Sequence[Stroke], inside: Sequence[str], named: Sequence[bool]) -> list[str]:
    """What each outline is called by its label, the text in it, its id, or a group that holds nothing else.

    Parameters
    ----------
    strokes : sequence of Stroke
        What drew each outline.
    inside : sequence of str
        The only text in it, or nothing.
    named : sequence of bool
        Whether a stroke's own label and id are those of this outline; not for faces cut from it.
    """
    members: Counter[object] = Counter()
    for stroke in {id(stroke): stroke for stroke in strokes}.values():
        members.update(stroke.groups)
    names = []
    for stroke, text, own in zip(strokes, inside, named, strict=True):
        group = next((g.name for g in reversed(stroke.groups) if g.name and members[g] == 1), "")
        names.append((stroke.label if own else "") or text or ((stroke.name or group) if own else ""))
    return names


def unique_names(given: Sequence[str]) -> list[str]:
    """Names that differ: what has none is numbered p1, p2, ..., what has one that is taken gets a number.

    Examples
    --------
    >>> unique_names(["x", "", "x"])
    ['x', 'p2', 'x-2']
    """
    taken = set(given)
    seen: Counter[str] = Counter()
    names = []
    for i, name in enumerate(given):
        wanted = name or f"p{i + 1}"
        seen[wanted] += 1
        if seen[wanted] > 1 or (not name and wanted in taken):
            wanted = next(w for k in range(2, len(given) + 3) if (w := f"{wanted}-{k}") not in taken)
            taken.add(wanted)
        names.append(wanted)
    return names


def aliases_of(names: Sequence[str], said: Sequence[Sequence[str]]) -> list[tuple[str, ...]]:
    """What else parts are called, where that means one part alone.

    Parameters
    ----------
    names : sequence of str
        Of the parts.
    said : sequence of sequences of str
        Everything that the file calls each of them.

    Examples
    --------
    >>> aliases_of(["lid", "box"], [["path7", "lid"], ["g1", "path7", "box"]])
    [(), ('g1',)]
    """
    owners: Counter[str] = Counter(word for words in said for word in set(words))
    return [
        tuple(dict.fromkeys(word for word in words if word and owners[word] == 1 and word not in set(names)))
        for words in said
    ]


def rows_at(points: Sequence[tuple[float, float]], polygons: Polygons) -> list[int | None]:
    """The smallest outline around each point [mm], or None.

    Examples
    --------
    >>> rows_at([(1, 1), (20, 1)], [shapely.box(0, 0, 9, 9), shapely.box(0, 0, 2, 2)])
    [1, None]
    """
    area = shapely.area(np.array(polygons, dtype=object))
    tree = shapely.STRtree(list(polygons))
    found = [tree.query(shapely.Point(point), predicate="intersects").tolist() for point in points]
    return [min(rows, key=lambda i: area[i], default=None) for rows in found]


def asked_for(names: Sequence[str], polygons: Polygons) -> tuple[set[str], set[int | None]]:
    """What an option names: names in small letters, and rows of the smallest outlines around the points among them.

    Examples
    --------
    >>> asked_for(["Lid", "@1,1"], [shapely.box(0, 0, 9, 9), shapely.box(0, 0, 2, 2)])
    ({'lid'}, {1})
    """
    places = [place for name in names if (place := place_of(name))]
    return {name.casefold() for name in names if not place_of(name)}, set(rows_at(places, polygons) if places else ())


def place_of(name: str) -> tuple[float, float] | None:
    """The point that a name such as "@12,30" gives [mm], or None.

    Examples
    --------
    >>> place_of("@12,30"), place_of("lid")
    ((12.0, 30.0), None)
    """
    match = PLACE.fullmatch(name)
    try:
        return (float(match.group(1)), float(match.group(2))) if match else None
    except ValueError:
        return None
