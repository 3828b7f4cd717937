"""Joint families: the line between two square blocks, tab on one, pocket on the other.

Sizes are fractions of the pitch. A profile is the bottom side of a block of pitch 1, from corner to corner, material
above it and the tab pointing down; the pocket above the tab of the next block is the same line. Edge counts are given
for a chain block (two joints, plain top and bottom) and for a grid block (four joints).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from difflib import get_close_matches
from typing import Protocol

import numpy as np
import shapely

from wiggleroom.drawing.model import Points
from wiggleroom.errors import InputError


class Joint(Protocol):
    """A joint family; its fields are sizes."""

    def profile(self) -> Points:
        """Corners (n, 2) of the line from (-0.5, 0) to (0.5, 0), tab towards -y."""


@dataclass(frozen=True)
class Tee:
    """A T: 20 edges a chain block, 36 a grid block, as in the paper."""

    stem: float = 0.15
    stem_depth: float = 0.08
    head: float = 0.30
    head_depth: float = 0.10

    def profile(self) -> Points:
        """Corners of the line."""
        s, h, top, bottom = self.stem / 2, self.head / 2, -self.stem_depth, -self.stem_depth - self.head_depth
        return _mirrored([(-s, 0.0), (-s, top), (-h, top), (-h, bottom)])


@dataclass(frozen=True)
class Swallowtail:
    """A trapezoid wider at its end: 12 edges a chain block, 20 a grid block.

    With `blunt` above 0 its four corners are cut off by that length along both edges: 20 and 36 edges. (The paper
    counts 35, which four equal sides cannot have.)
    """

    neck: float = 0.20
    end: float = 0.40
    depth: float = 0.25
    blunt: float = 0.0

    def profile(self) -> Points:
        """Corners of the line."""
        neck, end = (-self.neck / 2, 0.0), (-self.end / 2, -self.depth)
        line = _mirrored([neck, end])
        return _blunted(line, self.blunt) if self.blunt > 0 else line


@dataclass(frozen=True)
class Dovetail:
    """A flat trapezoid with a blunt point in the middle of its end.

    14 edges a chain block, as in the paper, 24 a grid block. The flanks slope by 1 in 2; the point leads the tail into
    its pocket.
    """

    neck: float = 0.26
    end: float = 0.40
    depth: float = 0.14
    point: float = 0.03

    def profile(self) -> Points:
        """Corners of the line."""
        left = [(-self.neck / 2, 0.0), (-self.end / 2, -self.depth)]
        return _mirrored(left, tip=(0.0, -self.depth - self.point))


@dataclass(frozen=True)
class Revolute:
    """A round bulb on a short neck, a polygon in a polygon: 74 edges a chain block, as in the paper; 144 a grid block.

    The bulb's arc has `segments` equal edges, the neck two straight ones. `depth` is that of the bulb's centre.
    """

    neck: float = 0.14
    radius: float = 0.13
    depth: float = 0.18
    segments: int = 32

    def profile(self) -> Points:
        """Corners of the line."""
        half = np.arcsin(self.neck / 2 / self.radius)
        bulb = _arc((0.0, -self.depth), self.radius, np.pi / 2 + half, 5 * np.pi / 2 - half, self.segments)
        return np.array([(-0.5, 0.0), (-self.neck / 2, 0.0), *bulb, (self.neck / 2, 0.0), (0.5, 0.0)])


@dataclass(frozen=True)
class Finger:
    """Straight fingers as wide as the spaces between them: 28 edges a chain block, 52 a grid block.

    They hold sideways only.
    """

    fingers: int = 3
    depth: float = 0.08

    def profile(self) -> Points:
        """Corners of the line."""
        x = np.linspace(-0.5, 0.5, 2 * self.fingers + 2)
        y = np.where(np.arange(len(x) - 1) % 2 == 1, -self.depth, 0.0)
        return np.column_stack([x.repeat(2)[1:-1], y.repeat(2)])


@dataclass(frozen=True)
class Jigsaw:
    """The knob of a jigsaw puzzle, a bulb whose neck runs smoothly into the side.

    54 edges a chain block, 104 a grid block. `depth` is that of the bulb's centre, `fillet` the radius at the neck,
    `shift` the place of the knob along the side. The bulb has `segments` edges, either side of the neck a quarter.
    """

    radius: float = 0.11
    depth: float = 0.14
    fillet: float = 0.05
    shift: float = 0.0
    segments: int = 16

    def profile(self) -> Points:
        """Corners of the line."""
        reach = self.radius + self.fillet
        rise = self.depth - self.fillet
        foot = np.sqrt(reach**2 - rise**2)
        turn = np.arctan2(-rise, foot)
        left = _arc((-foot, -self.fillet), self.fillet, np.pi / 2, turn, max(1, self.segments // 4))
        bulb = _arc((0.0, -self.depth), self.radius, np.pi + turn, 2 * np.pi - turn, self.segments)
        knob = np.vstack([left[:-1], bulb, left[-2::-1] * (-1, 1)])
        knob[:, 0] += self.shift
        return np.vstack([(-0.5, 0.0), knob, (0.5, 0.0)])


JOINTS: dict[str, Callable[..., Joint]] = {
    "tee": Tee,
    "t": Tee,
    "swallowtail": Swallowtail,
    "dovetail": Dovetail,
    "revolute": Revolute,
    "finger": Finger,
    "jigsaw": Jigsaw,
}


def joint(name: str, **sizes: float) -> Joint:
    """Joint of a family, by name.

    Raises
    ------
    InputError
        If there is no such family or size, or the sizes do not fit each other.

    Examples
    --------
    >>> joint("t", stem=0.2)
    Tee(stem=0.2, stem_depth=0.08, head=0.3, head_depth=0.1)
    """
    if name not in JOINTS:
        near = get_close_matches(name, JOINTS, n=1) or JOINTS
        message = f'there is no joint "{name}": choose {" or ".join(near)}'
        raise InputError(message)
    known = {f.name: f.type for f in fields(JOINTS[name])}  # type: ignore[arg-type]
    wrong = [f'joint "{name}" has no size "{s}": it has {", ".join(known)}' for s in sizes if s not in known]
    counts = {s: v for s, v in sizes.items() if known.get(s) == "int"}
    wrong += [
        f'joint "{name}": {s} is {v:g}: it must be a whole number above 0'
        for s, v in counts.items()
        if not 1 <= v < 1e6 or v != int(v)
    ]
    if wrong:
        raise InputError(wrong)
    made = JOINTS[name](**{**sizes, **{s: int(v) for s, v in counts.items()}})
    with np.errstate(invalid="ignore"):
        line = made.profile()
    if not (np.abs(line[:, 0]) <= 0.5).all() or not shapely.is_simple(shapely.linestrings(line)):
        message = f'joint "{name}": its line crosses itself or leaves its side: choose sizes that fit each other'
        raise InputError(message)
    return made


def _mirrored(left: Sequence[tuple[float, float]], tip: tuple[float, float] | None = None) -> Points:
    """Line that begins with `left` and is the same from both ends, with one corner in the middle or none."""
    right = [(-x, y) for x, y in reversed(left)]
    return np.array([(-0.5, 0.0), *left, *([tip] if tip else []), *right, (0.5, 0.0)])


def _blunted(line: Points, cut: float) -> Points:
    """Line with every corner but its ends cut off by `cut` along both edges."""
    back, ahead = line[:-2] - line[1:-1], line[2:] - line[1:-1]
    ends = [line[1:-1] + d * (cut / np.hypot(*d.T))[:, None] for d in (back, ahead)]
    return np.vstack([line[:1], np.stack(ends, axis=1).reshape(-1, 2), line[-1:]])


def _arc(centre: tuple[float, float], radius: float, start: float, stop: float, segments: int) -> Points:
    """Corners of an arc from one angle to another [rad], both ends included."""
    angle = np.linspace(start, stop, int(segments) + 1)
    return np.column_stack([np.cos(angle), np.sin(angle)]) * radius + centre
