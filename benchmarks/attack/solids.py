"""Assembly files in space drawn from slabs, polygons between two heights, and convex hulls, with the clearance already in them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import shapely
import trimesh
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation
from shapely import Polygon

Slab = tuple[Polygon, float, float]
Random = np.random.Generator


@dataclass(frozen=True)
class Block:
    """A part: slabs whose union it is, or the corners of a convex body, in its own frame, and where that lies."""

    name: str
    slabs: tuple[Slab, ...] = ()
    corners: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    R: np.ndarray = field(default_factory=lambda: np.eye(3))
    at: Sequence[float] = (0.0, 0.0, 0.0)
    fixed: bool = False

    def pieces(self) -> list[np.ndarray]:
        """Corners of convex pieces whose union it is, where it lies."""
        if len(self.corners):
            return [self.corners @ self.R.T + self.at]
        found = []
        for polygon, low, high in self.slabs:
            for triangle in shapely.get_parts(shapely.constrained_delaunay_triangles(polygon)):
                if triangle.area > 1e-12:
                    flat = np.array(triangle.exterior.coords)[:3]
                    ends = [np.column_stack([flat, np.full(3, z)]) for z in (low, high)]
                    found.append(np.vstack(ends) @ self.R.T + self.at)
        return found

    def mesh(self) -> trimesh.Trimesh:
        """Closed surface where it lies."""
        if len(self.corners):
            whole = trimesh.convex.convex_hull(self.corners)
        else:
            several = [
                trimesh.creation.extrude_polygon(p, high - low, engine="manifold").apply_translation((0, 0, low))
                for p, low, high in self.slabs
            ]
            whole = several[0] if len(several) == 1 else trimesh.boolean.union(several, engine="manifold")
        return trimesh.Trimesh(np.asarray(whole.vertices) @ self.R.T + self.at, whole.faces, process=False)


@dataclass(frozen=True)
class Solids:
    """Parts, what is asked about them, and whether they come apart, where that is known."""

    parts: tuple[Block, ...]
    asked: dict[str, Any]
    meshes: bool
    comes_apart: bool | None

    def write(self, folder: Path) -> Path:
        """Write the assembly file, and meshes as STL beside it."""
        parts = [self._part(p, folder) for p in self.parts]
        made = {"format": "wiggleroom/2", "unit": "mm", "gap": 0, "parts": parts, "pull": [self.asked]}
        file = folder / "assembly.json"
        file.write_text(json.dumps(made, indent=1), encoding="utf-8")
        return file

    def _part(self, block: Block, folder: Path) -> dict[str, Any]:
        own: dict[str, Any] = {"name": block.name, **({"fixed": True} if block.fixed else {})}
        turn = Rotation.from_matrix(block.R).as_euler("xyz", degrees=True).tolist()
        boxes = bool(block.slabs) and all(_is_box(polygon) for polygon, _, _ in block.slabs)
        if not self.meshes and len(block.slabs) == 1:
            polygon, low, high = block.slabs[0]
            rings = [np.array(r.coords)[:-1].tolist() for r in (polygon.exterior, *polygon.interiors)]
            at = (np.asarray(block.at) + block.R @ [0, 0, low]).tolist()
            return own | {"outline": rings[0], "holes": rings[1:], "thickness": high - low, "at": at, "rotate": turn}
        if not self.meshes and boxes:
            listed = [[*p.bounds[:2], low, *p.bounds[2:], high] for p, low, high in block.slabs]
            return own | {"boxes": listed, "at": list(map(float, block.at)), "rotate": turn}
        block.mesh().export(folder / f"{block.name}.stl")
        return own | {"mesh": f"{block.name}.stl"}


def _is_box(polygon: Polygon) -> bool:
    return not polygon.interiors and abs(polygon.area - polygon.envelope.area) < 1e-9 * polygon.area


def turned(parts: Sequence[Block], R: np.ndarray) -> tuple[Block, ...]:
    """The same parts, all turned about the origin."""
    return tuple(Block(p.name, p.slabs, p.corners, R @ p.R, (R @ np.asarray(p.at)).tolist(), p.fixed) for p in parts)


def ngon(count: int, radius: float, phase: float = 0.0) -> Polygon:
    """Regular polygon, turned by a share of the angle between two corners."""
    turn = 2 * np.pi * (np.arange(count) + phase) / count
    return Polygon(radius * np.column_stack([np.cos(turn), np.sin(turn)]))


def cut(shape: Polygon, *others: Polygon) -> Polygon:
    """The largest piece of what is left of a shape."""
    return max(shapely.get_parts(shapely.difference(shape, shapely.union_all(others))), key=lambda piece: piece.area)


def joined(*shapes: Polygon) -> Polygon:
    """Shapes that touch, as one."""
    return max(shapely.get_parts(shapely.union_all(shapes)), key=lambda piece: piece.area)


def hull(points: np.ndarray) -> np.ndarray:
    """Corners of the convex hull."""
    return points[ConvexHull(points).vertices]
