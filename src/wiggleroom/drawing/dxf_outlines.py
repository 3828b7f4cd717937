"""From the strokes of a DXF to shapes: edges joined, copies dropped, holes given to their parts, names found."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from wiggleroom.drawing.dxf_walk import HOLES, DxfWalk, Stroke, edges_by_place
from wiggleroom.drawing.elements import Shape
from wiggleroom.drawing.joining import joined
from wiggleroom.drawing.pathdata import Subpath
from wiggleroom.drawing.strokes import trace
from wiggleroom.drawing.transforms import Affine

MEET = 1e-5
"""Ends nearer to each other than this share of the drawing's size meet, ..."""
MEET_MOST = 0.01
"""... but never ends further apart than this [mm]."""
_ALIKE = 1e-3
"""Areas of traced outlines are compared to this share."""
_STEPS = 128
_LONGEST_NAME = 80


@dataclass(frozen=True, eq=False)
class _Outline:
    """A closed outline with the first of its strokes, and its traced polygon."""

    stroke: Stroke
    path: Subpath
    polygon: shapely.Polygon

    @property
    def hole(self) -> bool:
        """Whether its layer says that it is one."""
        return self.stroke.layer.lower().startswith(HOLES)


def shapes_of(walk: DxfWalk) -> tuple[list[Shape], tuple[str, ...]]:
    """Shapes of a drawing, closed ones first, and notes; what is wrong is added to the findings of `walk`.

    Parameters
    ----------
    walk : DxfWalk
        After its run.
    """
    strokes = walk.strokes
    if not strokes:
        return [], _notes(walk, 0, 0)
    ends = np.array([point for stroke in strokes for point in trace(stroke.path, 4)])
    tolerance = min(MEET * max(np.ptp(ends.real), np.ptp(ends.imag)), MEET_MOST)
    long = [s for s in strokes if _extent(s.path) > tolerance]
    walk.pointlike += len(strokes) - len(long)
    outlines, opened, repeated = _closed(walk, long, tolerance)
    distinct = _distinct(outlines, tolerance)
    repeated += len(outlines) - len(distinct)
    parts = [outline for outline in distinct if not outline.hole]
    tree = shapely.STRtree([outline.polygon for outline in parts])
    paths = [[outline.path] for outline in parts]
    cut: list[list[shapely.Polygon]] = [[] for _ in parts]
    for hole in distinct:
        if hole.hole:
            owner = _around(hole.polygon, parts, tree)
            if owner is None:
                reason = "is a hole by its layer, but lies in no part; it must lie inside an outline of another layer"
                walk.findings.append(f"{walk.file}: {hole.stroke}: {reason}")
            else:
                paths[owner].append(hole.path)
                cut[owner].append(hole.polygon)
    names = _names(walk, parts, tree)
    inside = sum(_fills(outline.polygon, parts, tree, cut) for outline in parts)
    shapes = [_shape(part.stroke, path, name) for part, path, name in zip(parts, paths, names, strict=True)]
    return [*_pieces_joined(parts, shapes), *opened], _notes(walk, repeated, inside)


def _extent(path: Subpath) -> float:
    points = np.array(trace(path, 4))
    return float(max(np.ptp(points.real), np.ptp(points.imag)))


def _closed(walk: DxfWalk, strokes: Sequence[Stroke], tolerance: float) -> tuple[list[_Outline], list[Shape], int]:
    """Closed outlines in drawing order, open chains, and how many edges were drawn twice."""
    order = {id(stroke): i for i, stroke in enumerate(strokes)}
    found = [(order[id(stroke)], stroke, stroke.path) for stroke in strokes if stroke.path.closed]
    opened: list[tuple[int, Shape]] = []
    repeated = 0
    for pool in edges_by_place([stroke for stroke in strokes if not stroke.path.closed]):
        result = joined([stroke.path for stroke in pool], tolerance)
        repeated += result.repeated
        for edges, path in result.loops:
            first = min(edges)
            found.append((order[id(pool[first])], pool[first], path))
        for chain in result.opened:
            opened.append((order[id(pool[chain[0]])], _open_shape([pool[i] for i in chain])))
        for point in result.overlapping[:1]:
            what = f"edges lie on one another at ({point.real:.6g}, {point.imag:.6g}) mm"
            right = "draw every outline as one closed polyline, or its edges one after the other"
            walk.findings.append(f'{walk.file}: layer "{pool[0].layer}": {what}; {right}')
    found.sort(key=lambda row: row[0])
    outlines = [_Outline(stroke, path, _polygon(path)) for _, stroke, path in found]
    return outlines, [shape for _, shape in sorted(opened, key=lambda row: row[0])], repeated


def _polygon(path: Subpath) -> shapely.Polygon:
    points = np.array(trace(path, _STEPS))
    rough = (
        shapely.polygons(shapely.linearrings(np.column_stack([points.real, points.imag]))) if len(points) > 3 else None
    )
    return rough if rough is not None and rough.is_valid else shapely.Polygon()


def _open_shape(chain: Sequence[Stroke]) -> Shape:
    """Shape of a chain that does not close; says how far its ends are from each other where it has two."""
    ends = Counter(point for stroke in chain for point in (stroke.path.start, stroke.path.segments[-1].end))
    loose = np.array(list(ends))
    corner = loose[0]
    shape = _shape(chain[0], [stroke.path for stroke in chain], "")
    if len(chain) > 1:
        shape = replace(shape, tag=f"{len(chain)} edges")
    return replace(shape, place=f"{shape.place} near ({corner.real:.6g}, {corner.imag:.6g}) mm")


def _shape(stroke: Stroke, paths: list[Subpath], name: str) -> Shape:
    return Shape(
        tag=stroke.tag,
        place=f'layer "{stroke.layer}" ({stroke.handle})',
        name=name,
        groups=stroke.groups,
        fixed=any(group.name.lower() == "fixed" for group in stroke.groups),
        even_odd=True,
        matrix=Affine(),
        subpaths=paths,
    )


def _distinct(outlines: Sequence[_Outline], tolerance: float) -> list[_Outline]:
    """Without outlines that were drawn before."""
    boxes = np.array([outline.polygon.bounds for outline in outlines if not outline.polygon.is_empty])
    rows = [i for i, outline in enumerate(outlines) if not outline.polygon.is_empty]
    copies: set[int] = set()
    if len(rows) > 1:
        corners = shapely.points(boxes[:, 0] + boxes[:, 2], boxes[:, 1] + boxes[:, 3])
        first, second = shapely.STRtree(corners).query(corners, predicate="dwithin", distance=4 * tolerance)
        for i, j in zip(first.tolist(), second.tolist(), strict=True):
            if i < j and rows[i] not in copies and np.abs(boxes[i] - boxes[j]).max() <= 2 * tolerance:
                a, b = outlines[rows[i]], outlines[rows[j]]
                near = shapely.hausdorff_distance(a.polygon.exterior, b.polygon.exterior) <= 2 * tolerance
                if a.hole == b.hole and near:
                    copies.add(rows[j])
    return [outline for i, outline in enumerate(outlines) if i not in copies]


def _around(inner: shapely.Polygon, parts: Sequence[_Outline], tree: shapely.STRtree) -> int | None:
    """Smallest outline that holds another one, or None."""
    if inner.is_empty:
        return None
    holding = [
        i
        for i in tree.query(inner).tolist()
        if parts[i].polygon.area > inner.area * (1 + _ALIKE)
        and inner.difference(parts[i].polygon).area <= _ALIKE * inner.area
    ]
    return min(holding, key=lambda i: parts[i].polygon.area, default=None)


def _fills(
    inner: shapely.Polygon, parts: Sequence[_Outline], tree: shapely.STRtree, cut: Sequence[Sequence[shapely.Polygon]]
) -> bool:
    """Whether an outline lies in another one that has no hole there."""
    owner = _around(inner, parts, tree)
    return owner is not None and not any(hole.intersection(inner).area > inner.area / 2 for hole in cut[owner])


def _names(walk: DxfWalk, parts: Sequence[_Outline], tree: shapely.STRtree) -> list[str]:
    """Name of every outline: what the file says of it, else the only text that stands in it."""
    said: dict[int, list[str]] = {}
    for text, at in walk.texts:
        point = shapely.Point(at.real, at.imag)
        owner = min(
            (i for i in tree.query(point, predicate="intersects").tolist()),
            key=lambda i: parts[i].polygon.area,
            default=None,
        )
        readable = text.isprintable() and 0 < len(text) <= _LONGEST_NAME
        if owner is not None and readable and parts[owner].stroke.piece is None:
            said.setdefault(owner, []).append(text)
        else:
            walk.left_out["text"] += 1
    names = []
    for i, part in enumerate(parts):
        texts = said.get(i, [])
        if len(texts) > 1:
            walk.left_out["text"] += len(texts)
        own = part.stroke.piece[0] if part.stroke.piece else ""
        names.append(own or (texts[0] if len(texts) == 1 else ""))
    return names


def _pieces_joined(parts: Sequence[_Outline], shapes: Sequence[Shape]) -> list[Shape]:
    """Outlines that the file says are pieces of one part become one shape; copies of such a part stay apart."""
    seen: Counter[tuple[str, int, int]] = Counter()
    first: dict[tuple[str, int, int], int] = {}
    result: list[Shape] = []
    for part, shape in zip(parts, shapes, strict=True):
        piece = part.stroke.piece
        if piece is None or piece[2] < 2:
            result.append(shape)
            continue
        seen[piece] += 1
        key = (piece[0], piece[2], seen[piece])
        if key in first:
            result[first[key]].subpaths.extend(shape.subpaths)
        else:
            first[key] = len(result)
            result.append(shape)
    return result


def _notes(walk: DxfWalk, repeated: int, inside: int) -> tuple[str, ...]:
    said = []
    if walk.hidden:
        said.append(f"layers that are off or frozen are left out: {', '.join(sorted(walk.hidden))}")
    if walk.pointlike:
        said.append(f"{walk.pointlike} elements of no length are left out")
    if repeated:
        said.append(f"{repeated} lines or outlines are drawn twice; the copies are left out")
    if inside:
        one = "1 outline inside another is a part" if inside == 1 else f"{inside} outlines inside others are parts"
        said.append(f'{one} in a hole of the same form; draw plain holes on a layer "holes"')
    return tuple(f"{walk.file}: {line}" for line in said)
