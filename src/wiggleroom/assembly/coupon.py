"""Coupons: a joint at many gaps on one small sheet, to cut, to try by hand, and so to learn what a machine cuts away.

A key of the drawn size is tried in holders that are larger all round by the gap. That is the same fit as both of them
smaller by half of it, with one key for all. A negative gap makes a holder tighter than the key: where a cut takes
material away, the pocket that holds the key snugly is one of those.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from wiggleroom.assembly.assembly import place
from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.findings import examine
from wiggleroom.assembly.joints import joint as joint_of
from wiggleroom.assembly.statements import unknown
from wiggleroom.drawing.model import Drawing, Part, Points, Region
from wiggleroom.drawing.outlines.rings import clean_ring, part_about_centroid
from wiggleroom.drawing.writers.lettering import Label, labels_of, width_of
from wiggleroom.errors import InputError

_WALL, _MARGIN, _HANDLE = 0.14, 0.12, 0.6
"""Material round pockets and labels, space between pieces, height of the key's body, as fractions of the pitch."""
_LETTERS = 0.17
"""Height of labels as a fraction of the pitch; the longest has five letters in one pitch."""
_STRAY = 0.05
"""Mitred corners move further than edges by this share at most, unless the tab has lost its end."""
_MAX_GAPS = 60
"""Gaps on one coupon."""


@dataclass(frozen=True, eq=False)
class Coupon:
    """A sheet to cut.

    Parameters
    ----------
    drawing : Drawing [mm]
        Pieces as they are cut, next to each other.
    labels : tuple of Label
        What is engraved.
    gaps : tuple of float [mm]
        Gap of every holder.
    """

    drawing: Drawing
    labels: tuple[Label, ...]
    gaps: tuple[float, ...]


def gap_steps(start: float, stop: float, step: float) -> tuple[float, ...]:
    """Gaps from `start` to `stop`, both included, `step` apart [mm].

    Raises
    ------
    InputError
        If there are none, or more than a sheet should hold.

    Examples
    --------
    >>> gap_steps(-0.1, 0.1, 0.1)
    (-0.1, 0.0, 0.1)
    """
    if not all(map(math.isfinite, (start, stop, step))) or step <= 0 or stop < start:
        message = (
            f"gaps from {start:g} to {stop:g} in steps of {step:g}: give a start below the stop and a step above 0"
        )
        raise InputError(message)
    count = math.floor((stop - start) / step + 1e-6) + 1
    if count > _MAX_GAPS:
        message = f"gaps from {start:g} to {stop:g} in steps of {step:g} are {count}: take at most {_MAX_GAPS}"
        raise InputError(message)
    return tuple(round(start + i * step, 9) + 0.0 for i in range(count))


def comb(joint: str, gaps: Sequence[float], pitch: float = 20.0, **sizes: float) -> Coupon:
    """Bar with a pocket for every gap, and a key with the tab of a joint family.

    Parameters
    ----------
    joint : str
        Family, see `wiggleroom.assembly.joints.JOINTS`.
    gaps : sequence of float [mm]
        Of the pockets, from left to right; negative ones are tighter than the key.
    pitch : float [mm]
        Width of a pocket's place; sizes of the joint are fractions of it.
    **sizes : float

    Raises
    ------
    InputError
        If there is no such joint or size, or a pocket cannot be made so.

    Examples
    --------
    >>> coupon = comb("tee", [0.0, 0.2])
    >>> [part.name for part in coupon.drawing.parts], [label.text for label in coupon.labels]
    (['comb', 'key'], ['tee', 'gap mm', '0.0', '0.2', 'key'])
    """
    if not (math.isfinite(pitch) and pitch > 0):
        message = f"pitch is {pitch:g}: it must be more than 0"
        raise InputError(message)
    line = joint_of(joint, **sizes).profile() * pitch
    key = np.vstack([line, [(pitch / 2, _HANDLE * pitch), (-pitch / 2, _HANDLE * pitch)]])
    rim, deepest = -max(0.0, *gaps), float(line[:, 1].min()) - max(0.0, *gaps)
    letters, floor = _LETTERS * pitch, deepest - _WALL * pitch
    bottom = floor - letters - _WALL * pitch
    left, right = -1.75 * pitch, (len(gaps) - 0.5) * pitch
    bar = shapely.box(left, bottom, right, rim)
    for i, gap in enumerate(gaps):
        pocket = _grown(key, gap, joint)
        if abs(pocket.bounds[1] - float(line[:, 1].min()) + gap) > max(_STRAY * abs(gap), 1e-9 * pitch):
            message = (
                f'joint "{joint}": nothing is left of a pocket at gap {gap:g}: take gaps nearer to 0 or a larger pitch'
            )
            raise InputError(message)
        bar = shapely.difference(bar, shapely.affinity.translate(pocket, i * pitch))
    whole = bar.geom_type == "Polygon" and not bar.interiors and bar.bounds == (left, bottom, right, rim)
    if not whole:
        message = f'joint "{joint}": the pockets cut the comb to pieces: take smaller gaps or a larger pitch'
        raise InputError(message)
    lift = rim - float(line[:, 1].min()) + _MARGIN * pitch
    parts = (
        part_about_centroid("comb", [_region(bar)]),
        part_about_centroid("key", [Region(clean_ring(key + np.array([0.0, lift])))]),
    )
    height = floor - letters / 2
    words = [(joint, left + 0.625 * pitch, (rim + floor) / 2)]
    words += [("gap mm", words[0][1], height)]
    words += [(text, i * pitch, height) for i, text in enumerate(texts(gaps))]
    words += [("key", 0.0, lift + _HANDLE * pitch / 2)]
    labels = tuple(
        Label(text, (float(x), float(y)), min(letters, letters * pitch / width_of(text, letters)))
        for text, x, y in words
    )
    return Coupon(Drawing(parts), labels, tuple(gaps))


def row(drawing: Drawing, holder: str, key: str, gaps: Sequence[float]) -> Coupon:
    """Two neighbours of a drawing, cut down to their joint: the holder once for every gap, the key once.

    Parameters
    ----------
    drawing : Drawing [mm]
        Its own gap is not applied; offsets are. Play that is drawn counts besides the gap.
    holder, key : str
        Names of the parts.
    gaps : sequence of float [mm]

    Raises
    ------
    InputError
        If there are no such parts, or the holder cannot be made at a gap.
    """
    names = [part.name for part in drawing.parts]
    wrong = [unknown(name, names) for name in dict.fromkeys((holder, key)) if name not in names]
    if not wrong and holder == key:
        wrong = [f'"{holder}" is named twice: a joint lies between two parts']
    if wrong:
        raise InputError([f"{drawing.source}: {line}" if drawing.source else line for line in wrong])
    plain = Drawing(tuple(part for part in drawing.parts if part.name in (holder, key)), glue=((holder, key),))
    made = {part.name: part for part in assemble(plain).parts}
    shapes = {name: _material(made[name]) for name in (holder, key)}
    window = _joint_window(shapes[holder], shapes[key])
    near = {name: _cropped(shapes[name], window) for name in shapes}
    pieces = [(text, _offset(near[holder], gap, text)) for text, gap in zip(texts(gaps), gaps, strict=True)]
    parts = _laid_out([*pieces, (key if key not in dict(pieces) else f"{key} (key)", near[key])])
    return Coupon(Drawing(parts), _row_labels(parts), tuple(gaps))


def _row_labels(parts: Sequence[Part]) -> tuple[Label, ...]:
    """Names of holders, all in the same place of each, and of the key, which comes last."""
    model = parts[len(parts) // 2 - 1]
    (first,), last = labels_of([model]), labels_of(parts[-1:])
    away = np.array(first.at) - model.at[:2]
    height = min(label.height for label in labels_of(parts[:-1]))
    centres = [np.array(part.at[:2]) + away for part in parts[:-1]]
    holders = [Label(part.name, (float(at[0]), float(at[1])), height) for part, at in zip(parts, centres, strict=False)]
    return (*holders, *last)


def texts(gaps: Sequence[float]) -> list[str]:
    """Gaps as they are engraved, with as many decimals as the finest needs.

    Examples
    --------
    >>> texts([-0.05, 0.0, 0.1])
    ['-0.05', '0.00', '0.10']
    """
    decimals = max(len(f"{gap:.4f}".rstrip("0").partition(".")[2]) for gap in gaps)
    return [f"{gap:.{max(decimals, 1)}f}" for gap in gaps]


def _grown(outline: Points, amount: float, name: str) -> shapely.Polygon:
    """Outline moved outward by `amount` [mm] with mitred corners."""
    return _material(_made(Part(name, (Region(clean_ring(outline)),), offset=amount)))


def _offset(shape: shapely.Polygon, gap: float, name: str) -> shapely.Polygon:
    """Holder at one gap: all of its material moved inward by it."""
    return _material(_made(Part(name, (_region(shape),), offset=-gap)))


def _made(part: Part) -> Part:
    """Give the part with its offset applied."""
    made, findings = examine(Drawing((part,)))
    if findings:
        raise InputError([f"coupon: {line}" for line in findings])
    return made[0]


def _material(part: Part) -> shapely.Polygon:
    pieces = [
        shapely.Polygon(place(region.outer, part.at), [place(hole, part.at) for hole in region.holes])
        for region in part.regions
    ]
    return max(pieces, key=lambda piece: piece.area) if len(pieces) == 1 else shapely.union_all(pieces)


def _region(shape: shapely.Polygon) -> Region:
    holes = tuple(clean_ring(shapely.get_coordinates(ring), clockwise=True) for ring in shape.interiors)
    return Region(clean_ring(shapely.get_coordinates(shape.exterior)), holes)


def _joint_window(holder: shapely.Geometry, key: shapely.Geometry) -> shapely.Polygon:
    """Box round the place where two parts face each other, with some material about it."""
    size = max(holder.length, key.length)
    reach = shapely.distance(holder, key) + 1e-3 * size
    facing = shapely.union(
        shapely.intersection(holder.boundary, shapely.buffer(key, reach)),
        shapely.intersection(key.boundary, shapely.buffer(holder, reach)),
    )
    low_x, low_y, high_x, high_y = facing.bounds
    short, long = sorted((high_x - low_x, high_y - low_y))
    margin = max(0.5 * short, 0.15 * long)
    return shapely.box(low_x - margin, low_y - margin, high_x + margin, high_y + margin)


def _cropped(shape: shapely.Geometry, window: shapely.Polygon) -> shapely.Polygon:
    """Largest piece of a part inside the window."""
    pieces = [piece for piece in shapely.get_parts(shapely.intersection(shape, window)) if piece.area > 0]
    return max(pieces, key=lambda piece: piece.area)


def _laid_out(pieces: Sequence[tuple[str, shapely.Polygon]]) -> tuple[Part, ...]:
    """Pieces in rows from the top, on a sheet about as high as it is wide."""
    boxes = np.array([piece.bounds for _, piece in pieces])
    width, height = (boxes[:, 2:] - boxes[:, :2]).max(axis=0)
    width, height = np.array([width, height]) + _MARGIN * max(width, height)
    columns = max(1, min(len(pieces), math.ceil(math.sqrt(len(pieces) * height / width))))
    parts = []
    for i, (name, piece) in enumerate(pieces):
        middle = (boxes[i, :2] + boxes[i, 2:]) / 2
        centre = np.array([i % columns + 0.5, math.ceil(len(pieces) / columns) - i // columns - 0.5]) * (width, height)
        moved = shapely.affinity.translate(piece, *(centre - middle))
        parts.append(part_about_centroid(name, [_region(moved)]))
    return tuple(parts)
