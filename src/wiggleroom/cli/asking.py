"""What `--pull`, `--turn` and `--fix` say."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Sequence

from wiggleroom.drawing.directions import HOW, coordinates, vector
from wiggleroom.drawing.model import Goal, JointGap, Pull, Turn, Weight

_WHERE = {2: "+y@12,1", 3: "+z@12,1,3"}


def goals(
    pulls: Iterable[str], turns: Iterable[str], weight: str | None = None, dimension: int = 2
) -> tuple[list[Goal], list[str]]:
    """Goals from the texts of `--pull`, `--turn` and `--weight`, and one line for each that cannot be read.

    A name may hold colons: the last one ends it.

    >>> goals(["a:b:+y@1,2"], ["c:ccw"])[0]
    [Pull(part='a:b', direction=(0.0, 1.0), point=(1.0, 2.0), weight=1.0), Turn(part='c', sense='ccw', weight=1.0)]
    >>> goals([], ["lid:+z"], dimension=3)[0]
    [Turn(part='lid', sense=(0.0, 0.0, 1.0), weight=1.0)]
    """
    found: list[Goal] = []
    wrong: list[str] = []
    for text in pulls:
        name, _, value = text.rpartition(":")
        along, at, place = value.partition("@")  # the part may be a point itself: @12,30:+y
        direction, point = vector(along, dimension), coordinates(place, dimension)
        if not name or direction is None:
            wrong.append(f"--pull {text}: write NAME:{HOW[dimension].format('NAME:')}")
        elif at and point is None:
            wrong.append(f"--pull {text}: after @ write the pulled point in mm, as NAME:{_WHERE[dimension]}")
        else:
            found.append(Pull(name, direction, point))
    for text in turns:
        name, _, value = text.rpartition(":")
        sense = vector(value, 3) if dimension == 3 else value if value in ("ccw", "cw") else None
        if not name or sense is None:
            how = "ccw or NAME:cw" if dimension == 2 else HOW[3].format("NAME:")
            wrong.append(f"--turn {text}: write NAME:{how}")
        else:
            found.append(Turn(name, sense))
    if weight is not None:
        down = vector(weight, dimension)
        if down is None:
            wrong.append(f"--weight {weight}: write {HOW[dimension].format('')}")
        else:
            found.append(Weight(down))
    return found, wrong


def split_words(texts: Iterable[str]) -> list[str]:
    """Words from lists such as "A,B"; a point "@12,30" is one word, and so is a colour such as "rgb(1,2,3)".

    >>> split_words(["a,@12,30,b", "rgb(255,0,0)"])
    ['a', '@12,30', 'b', 'rgb(255,0,0)']
    """
    found = [word for text in texts for word in re.findall(r"@[^,]*,[^,]*|(?:\([^)]*\)|[^,])+", text)]
    return [word.strip() for word in found if word.strip()]


def joint_gaps(
    texts: Iterable[str], known: set[str], resolve: Callable[[str], str]
) -> tuple[list[JointGap], list[str]]:
    """Gaps of single joints from texts such as "A,B:0.3", and one line for each that cannot be read.

    >>> joint_gaps(["a,b:0.3"], {"a", "b"}, str)
    ([JointGap(parts=('a', 'b'), gap=0.3)], [])
    """
    found: list[JointGap] = []
    wrong: list[str] = []
    for text in texts:
        pair, _, size = text.rpartition(":")
        parts = names([pair], known)
        try:
            gap = float(size)
        except ValueError:
            gap = math.nan
        if len(parts) != 2 or not (math.isfinite(gap) and gap >= 0):
            wrong.append(f"--gap-of {text}: write two parts and their gap in mm, as A,B:0.3")
        else:
            found.append(JointGap((resolve(parts[0]), resolve(parts[1])), gap))
    return found, wrong


def group_findings(
    glue: Sequence[str], glued: Sequence[Sequence[str]], ignore: Sequence[str], ignored: Sequence[Sequence[str]]
) -> list[str]:
    """One line for each text of `--glue` or `--ignore` that does not name enough parts.

    >>> group_findings(["a"], [("a",)], ["a,b"], [("a", "b")])
    ['--glue a: name at least two parts, as A,B']
    """
    few = [f"--glue {t}: name at least two parts, as A,B" for t, g in zip(glue, glued, strict=True) if len(set(g)) < 2]
    return few + [
        f"--ignore {t}: name two parts, as A,B"
        for t, g in zip(ignore, ignored, strict=True)
        if len(g) != 2 or len(set(g)) != 2
    ]


def names(texts: Iterable[str], known: set[str]) -> list[str]:
    """Names from lists such as "A,B"; a name that itself holds a comma is recognised among the `known` ones.

    >>> names(["a,b,c", "d"], {"a", "b,c", "d"})
    ['a', 'b,c', 'd']
    """
    found: list[str] = []
    for text in texts:
        pieces = text.split(",")
        while pieces:
            if pieces[0].strip().startswith("@") and len(pieces) > 1:
                found.append(",".join(pieces[:2]).strip())
                pieces = pieces[2:]
                continue
            longest = max((k for k in range(1, len(pieces) + 1) if ",".join(pieces[:k]) in known), default=1)
            found.append(",".join(pieces[:longest]))
            pieces = pieces[longest:]
    return [name for name in found if name]
