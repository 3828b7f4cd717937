"""Parts in space where a motion has taken them, as meshes for other programs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.files import write_whole
from wiggleroom.report.solids.solid_colours import moved_surfaces
from wiggleroom.report.solids.spatial_model_file import glb


def write_moved_meshes(assembly: Assembly, motion: NDArray[np.float64], path: Path) -> None:
    """Write the parts as made at a motion (n, 6) [mm, rad]: named in .glb and .obj, one after the other in .stl."""
    if path.suffix.lower() == ".glb":
        write_whole(path, glb(assembly, motion))
        return
    import trimesh

    scene = trimesh.Scene()
    for name, surface in zip(assembly.names, moved_surfaces(assembly, motion), strict=True):
        mesh = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
        scene.add_geometry(mesh, geom_name=name, node_name=name)
    write_whole(path, scene.export(file_type=path.suffix.lower()[1:]))
