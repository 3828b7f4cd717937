"""What a film shows: a still background, and tracks that move over it; the look is that of the pictures."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Goal, Pull, Turn, W, part_of
from wiggleroom.report.films.film_timing import TimedPath, checked_waypoints, ease_in_out
from wiggleroom.report.pictures import frame, layout, palette
from wiggleroom.report.pictures.arrows import PULL_LENGTH, carry, pull_arrow, turn_arrow, turn_radius
from wiggleroom.report.pictures.layout import View
from wiggleroom.report.pictures.names import common_font_size, name_position, text_at
from wiggleroom.report.pictures.part_paths import (
    PartPath,
    PartPaths,
    colour_attributes,
    line_width,
    middle,
    rest_outlines,
    role,
    spot,
    use,
)
from wiggleroom.report.pictures.text import escape
from wiggleroom.report.results.answer_words import number, short

Floats = NDArray[np.float64]

MAX_WHOLE_SHARE = 1.0
"""A motion no further than this, as a share of the drawing's size, is shown as a whole."""
FRAME_SHARE = 0.55
"""Of one that goes further the frame shows this share on each side of the parts at rest; the rest fades."""
DURATION = (2.0, 4.5)
"""Shortest and longest film [s]."""
MAX_PLACES = 150_000
"""Places of parts in all frames together."""
MIN_OPACITY = 0.02
"""Parts that are fainter are not drawn."""


@dataclass(frozen=True, eq=False)
class Track:
    """One thing that moves.

    Parameters
    ----------
    svg : str
        Drawn about 0, 0.
    place : (m, 3) float64 [px, px, deg]
        Where it lies in every frame.
    opacity : (m,) float64
    """

    svg: str
    place: Floats
    opacity: Floats

    @property
    def still(self) -> bool:
        """Whether nothing about it changes that could be seen."""
        return bool(np.ptp(self.place, axis=0).max() < 5e-3 and np.ptp(self.opacity) == 0)

    def drawn(self, k: int) -> str:
        """SVG of frame k."""
        x, y, turn = self.place[k].tolist()
        shown = f' opacity="{self.opacity[k]:.3f}"' if self.opacity[k] < 1 else ""
        turned = f" rotate({turn:.3f})" if abs(turn) > 5e-4 else ""
        return f'<g transform="translate({x:.2f} {y:.2f}){turned}"{shown}>{self.svg}</g>'


@dataclass(frozen=True, eq=False)
class Scene:
    """A film before it is written.

    Parameters
    ----------
    width, height : float [px]
    background, defs : str
        SVG that stays.
    stage : (x, y, width, height) [px]
        Where things move; nothing is drawn outside it.
    tracks : tuple of Track
        Bottom first.
    seconds : float
        How long the path takes, from rest to its end.
    title, words, command : str
    """

    width: float
    height: float
    background: str
    defs: str
    stage: tuple[float, float, float, float]
    tracks: tuple[Track, ...]
    seconds: float
    title: str
    words: str
    command: str

    @property
    def frames(self) -> int:
        """Frames from rest to the end."""
        return len(self.tracks[0].place)

    @property
    def head(self) -> str:
        """Opening tag of an SVG document with its metadata, paper and background."""
        size = f'width="{self.width:.0f}" height="{self.height:.0f}" viewBox="0 0 {self.width:.0f} {self.height:.0f}"'
        made = f"<metadata>{escape(self.command)}</metadata>" if self.command else ""
        x, y, wide, high = self.stage
        clip = f'<clipPath id="stage"><rect x="{x:.2f}" y="{y:.2f}" width="{wide:.2f}" height="{high:.2f}"/></clipPath>'
        return (
            '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
            f'{size} font-family="{palette.FONT}" role="img"><title>{escape(self.title)}</title>'
            f"<desc>{escape(self.words)}</desc>{made}<defs>{clip}{self.defs}</defs>"
            f'<rect width="{self.width:.0f}" height="{self.height:.0f}" fill="{palette.PAPER}"/>{self.background}'
        )

    def drawn(self, k: int) -> str:
        """Whole SVG of frame k."""
        return f'{self.head}<g clip-path="url(#stage)">{"".join(t.drawn(k) for t in self.tracks)}</g></svg>'


@dataclass(frozen=True)
class Caption:
    """What a film says and marks.

    Parameters
    ----------
    title : str
    facts : tuple of str
        Lines under it.
    command : str
        What made it.
    goals : tuple
        What is drawn as pulled or turned.
    pulled : str
        What the legend calls these parts.
    """

    title: str = ""
    facts: tuple[str, ...] = ()
    command: str = ""
    goals: tuple[Goal, ...] = ()
    pulled: str = "pulled"


def scene(
    assembly: Assembly,
    points: Floats,
    caption: Caption,
    *,
    rate: float,
    magnify: float | None = None,
    least_seconds: float = 0.0,
) -> Scene:
    """Scene of a path.

    Parameters
    ----------
    points : (k, n, 3) float64 [mm, mm, rad]
        Motions along the path.
    caption : Caption
    rate : float [1/s]
        Frames a second; fewer where there are very many parts.
    magnify : float, optional
        Factor by which the motion is enlarged; by default as in pictures, but a motion that is large is not made small:
        what leaves the frame fades.
    least_seconds : float
        Least time that it lasts.
    """
    points = checked_waypoints(assembly, points)
    factor = magnify or max(1.0, layout.magnification(assembly, points[-1]))
    timed = TimedPath(assembly, points * factor)
    pan = (
        math.inf
        if np.abs(factor * points[:, :, :2]).max() <= MAX_WHOLE_SHARE * assembly.size
        else FRAME_SHARE * assembly.size
    )
    shown = _seen_length(assembly, timed, pan)
    seconds = max(float(np.clip(DURATION[0] + 1.2 * shown / assembly.size, *DURATION)), least_seconds)
    count = max(min(round(seconds * rate), MAX_PLACES // len(assembly.parts)), 8) + 1
    poses = assembly.rest + timed.at(shown * ease_in_out(count))
    said = [*caption.facts] + ([f"motion x {number(factor)}"] if factor != 1 else [])
    box = _box(assembly, poses, pan)
    canvas = layout.view(box, 0.0).canvas
    top, below = frame.header(caption.title, said, canvas - 2 * palette.MARGIN)
    view = layout.view(box, below + palette.HEAD_SPACING)
    defs, tracks, still = _tracks(view, assembly, poses, caption.goals, pan)
    legend = [(frame.swatch("none", palette.REST), "at rest")]
    if any(p.fixed for p in assembly.parts):
        legend.insert(0, (frame.swatch(*palette.FIXED), "fixed"))
    if caption.goals:
        legend.insert(1, (frame.swatch(*palette.PULLED), caption.pulled))
    foot, height = frame.footer(view, view.y + view.height + palette.HEAD_SPACING + 16, legend, caption.command)
    stage = (view.x - 12, view.y - 12, view.width + 24, view.height + 24)
    words = "; ".join(said)
    # video needs even sizes
    height = 2.0 * math.ceil(height / 2)
    canvas = 2.0 * math.ceil(view.canvas / 2)
    background = "".join([*top, *foot, still])
    return Scene(canvas, height, background, defs, stage, tracks, seconds, caption.title, words, caption.command)


def _home(assembly: Assembly) -> Floats:
    """Box (4,) round the parts at rest [mm]."""
    return layout.bounding_box(layout.boxes(assembly, assembly.rest))


def _opacity(assembly: Assembly, poses: Floats, pan: float) -> Floats:
    """How clearly each part is seen (m, n): less the further it is from where the parts lay."""
    if math.isinf(pan):
        return np.ones(poses.shape[:2])
    home = _home(assembly)
    middles = np.array([middle(p) for p in assembly.parts])
    c, s = np.cos(poses[:, :, 2]), np.sin(poses[:, :, 2])
    x = poses[:, :, 0] + c * middles[:, 0] - s * middles[:, 1]
    y = poses[:, :, 1] + s * middles[:, 0] + c * middles[:, 1]
    out = np.hypot(
        np.maximum(np.maximum(home[0] - x, x - home[2]), 0), np.maximum(np.maximum(home[1] - y, y - home[3]), 0)
    )
    return np.clip(1.0 - (out - 0.15 * pan) / (0.7 * pan), 0.0, 1.0)


def _seen_length(assembly: Assembly, timed: TimedPath, pan: float) -> float:
    """Length of the path after which nothing that can be seen moves any more [mm]."""
    if timed.length <= pan:
        return timed.length
    lengths = np.linspace(0.0, timed.length, 400)
    poses = assembly.rest + timed.at(lengths)
    clear = _opacity(assembly, poses, pan) > MIN_OPACITY
    step = np.abs(np.diff(poses, axis=0)).max(axis=2) > 1e-4 * timed.length / 400
    moving = (step & clear[1:]).any(axis=1)
    return float(lengths[min(np.flatnonzero(moving)[-1] + 2, 399)]) if moving.any() else timed.length


def _box(assembly: Assembly, poses: Floats, pan: float) -> Floats:
    """Box (4,) [mm] of all that is seen, not too far from where the parts lay."""
    home = _home(assembly)
    looks = poses[np.linspace(0, len(poses) - 1, min(len(poses), max(3, 4000 // len(assembly.parts)))).astype(int)]
    whole = layout.bounding_box(np.vstack([home[None], *[layout.boxes(assembly, p) for p in looks]]))
    return np.concatenate([np.maximum(whole[:2], home[:2] - pan), np.minimum(whole[2:], home[2:] + pan)])


def _tracks(
    view: View, assembly: Assembly, poses: Floats, goals: tuple[Goal, ...], pan: float
) -> tuple[str, tuple[Track, ...], str]:
    """Shapes, what moves (neutral parts first, then pulled and fixed ones, names, arrows), and the outlines at rest."""
    shapes, rest = PartPaths(view.scale), assembly.rest
    far = np.abs(poses - rest)[:, :, :2].max() > pan
    opacity = _opacity(assembly, poses, pan if far else math.inf)
    pulled = {part_of(g) for g in goals}
    of, places = [shapes.of(p) for p in assembly.parts], _places(view, assembly, poses)
    rooms = np.array([np.ptp(shapely.get_coordinates(s.polygon), axis=0).max() for s in of])
    room = float(np.median(rooms))
    line = line_width(room)
    layers: dict[str, list[Track]] = {"neutral": [], "pulled": [], "fixed": []}
    for k, (part, shape) in enumerate(zip(assembly.parts, of, strict=True)):
        kind = role(part, pulled)
        style = f'{colour_attributes(palette.ROLE_COLOURS[kind], line)} fill-rule="evenodd"'
        body = (
            f'<use xlink:href="#{shape.key}" {style} stroke-linejoin="round"><title>{escape(part.name)}</title></use>'
        )
        layers[kind].append(Track(body, places[:, k], opacity[:, k]))
    arrows, taken = [], []
    for goal in goals:
        if isinstance(goal, Pull | Turn | W) and goal.part in assembly.names:
            k = assembly.names.index(goal.part)
            arrows.append(_goal(view, goal, rest[k], poses[:, k], opacity[:, k], float(rooms[k])))
            x, y, _ = arrows[-1].place[0]
            taken.append(_taken(goal, x, y, float(rooms[k])))
    names = _names(assembly, of, places, opacity, room, shapely.STRtree(taken))
    tracks = [*layers["neutral"], *layers["pulled"], *layers["fixed"], *names, *arrows]
    still = "".join(use(s, spot(view, p, tuple(r))) for s, p, r in zip(of, assembly.parts, rest.tolist(), strict=True))
    return shapes.definitions, tuple(tracks), rest_outlines(still, line)


def _places(view: View, assembly: Assembly, poses: Floats) -> Floats:
    """Middle of every part in pixels, and its angle in degrees as SVG counts it: (m, n, 3)."""
    arm = np.array([middle(p) for p in assembly.parts])
    c, s = np.cos(poses[:, :, 2]), np.sin(poses[:, :, 2])
    x = poses[:, :, 0] + c * arm[:, 0] - s * arm[:, 1]
    y = poses[:, :, 1] + s * arm[:, 0] + c * arm[:, 1]
    return np.dstack([view.pixels(np.dstack([x, y])), -np.degrees(poses[:, :, 2])])


def _taken(goal: Pull | Turn | W, x: float, y: float, room: float) -> shapely.Geometry:
    """Where the arrow of a goal is at first, and no name may be."""
    if isinstance(goal, Pull):
        along = PULL_LENGTH * np.array(goal.direction) / math.hypot(*goal.direction) * (1, -1)
        return shapely.buffer(shapely.LineString([(x, y), (x + along[0], y + along[1])]), 6.0)
    return shapely.buffer(shapely.Point(x, y), turn_radius(room) + 6.0)


def _names(
    assembly: Assembly, of: list[PartPath], places: Floats, opacity: Floats, room: float, marks: shapely.STRtree
) -> list[Track]:
    """Names that go with their parts and stay upright."""
    called = [short(p.name) for p in assembly.parts]
    size, found = common_font_size(list(zip(called, of, strict=True)), room), []
    for k, (name, shape) in enumerate(zip(called, of, strict=True)):
        at = name_position(name, shape, tuple(places[0, k].tolist()), size, marks)
        if at is None:
            continue
        x, y = at[0] - places[0, k, :2]
        turn = np.radians(places[:, k, 2] - places[0, k, 2])
        c, s = np.cos(turn), np.sin(turn)
        place = np.column_stack([places[:, k, 0] + c * x - s * y, places[:, k, 1] + s * x + c * y, np.zeros(len(turn))])
        text = f'<g fill="{palette.INK}" text-anchor="middle">{text_at(name, np.zeros(2), at[1])}</g>'
        found.append(Track(text, place, opacity[:, k]))
    return found


def _goal(view: View, goal: Pull | Turn | W, rest: Floats, poses: Floats, opacity: Floats, room: float) -> Track:
    """Arrow of one goal, which goes with the pulled point."""
    point = np.array(goal.point) if isinstance(goal, Pull) and goal.point is not None else rest[:2]
    track = np.array([[*view.pixels(carry(point, rest, pose)), 0.0] for pose in poses])
    match goal:
        case Pull():
            svg = pull_arrow(goal.direction)
        case Turn():
            svg = turn_arrow(1.0 if goal.sense == "ccw" else -1.0, room)
        case W(w=(x, y, turn)):
            svg = pull_arrow((x, y)) if math.hypot(x, y) else turn_arrow(math.copysign(1.0, turn), room)
    return Track(svg, track, opacity)
