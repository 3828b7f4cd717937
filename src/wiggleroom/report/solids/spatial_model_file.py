"""Parts in space as a model for viewers and slicers: binary glTF, with the path to where they are as an animation."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.report.solids.solid_colours import Colour, moved_surfaces, part_colours
from wiggleroom.report.solids.spatial_path import along_path, with_quaternions
from wiggleroom.spatial.bodies.rotations import exponential, logarithm

Floats = NDArray[np.float64]

METRES = 1e-3
"""Metres in a millimetre: glTF counts metres."""
UPRIGHT = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
"""In glTF y is up."""
SECONDS, FRAMES = 4.0, 65
"""Length of the animated path [s], and number of frames in it."""
FLOAT, JSON_CHUNK, BINARY_CHUNK = 5126, 0x4E4F534A, 0x004E4942
"""Numbers of the format."""


def glb(
    assembly: Assembly, motion: Floats, colours: Sequence[Colour] | None = None, waypoints: Floats | None = None
) -> bytes:
    """Parts at a motion (n, 6) as binary glTF, in metres, y up, each with its name and colour.

    Corners are where the parts have moved to; a path (k, n, 6) that leads there from rest is an animation.

    Source: glTF 2.0 specification, Khronos 2021.
    """
    import trimesh

    scene = trimesh.Scene()
    shown = colours or part_colours(assembly)
    for name, surface, colour in zip(assembly.names, moved_surfaces(assembly, motion), shown, strict=True):
        mesh = trimesh.Trimesh(METRES * surface.vertices @ UPRIGHT.T, surface.faces, process=False)
        mesh.visual = trimesh.visual.TextureVisuals(
            material=trimesh.visual.material.PBRMaterial(
                baseColorFactor=[*colour, 255], metallicFactor=0.0, roughnessFactor=0.8
            )
        )
        scene.add_geometry(mesh, node_name=name, geom_name=name)
    found = bytes(scene.export(file_type="glb"))
    return found if waypoints is None or len(waypoints) < 2 else _animated(found, assembly, motion, waypoints)


def _animated(data: bytes, assembly: Assembly, motion: Floats, waypoints: Floats) -> bytes:
    """The model with an animation of its parts from rest to where they are."""
    size = struct.unpack_from("<I", data, 12)[0]
    content: dict[str, Any] = json.loads(data[20 : 20 + size])
    binary = bytearray(data[28 + size :])
    node_of = {node.get("name"): k for k, node in enumerate(content["nodes"])}
    times = np.linspace(0.0, SECONDS, FRAMES)
    motions = along_path(assembly, waypoints, np.linspace(0.0, 1.0, FRAMES))
    clock = _accessor(content, binary, times[:, None], "SCALAR")
    samplers: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []
    for p, name in enumerate(assembly.names):
        if not np.any(motions[:, p] != motions[-1, p]):
            continue
        node = content["nodes"][node_of[name]]
        node.pop("matrix", None)  # the identity, which an animated node may not have
        shift, turn = _from_the_end(assembly.reference[p], motions[:, p], motion[p])
        for values, kind, path in ((shift, "VEC3", "translation"), (turn, "VEC4", "rotation")):
            samplers.append({"input": clock, "output": _accessor(content, binary, values, kind)})
            channels.append({"sampler": len(samplers) - 1, "target": {"node": node_of[name], "path": path}})
    if not channels:
        return data
    content["animations"] = [{"name": "path from rest", "samplers": samplers, "channels": channels}]
    content["buffers"][0]["byteLength"] = len(binary)
    text = json.dumps(content, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    whole = 12 + 8 + len(text) + 8 + len(binary)
    head = struct.pack("<4sII", b"glTF", 2, whole) + struct.pack("<II", len(text), JSON_CHUNK)
    return head + text + struct.pack("<II", len(binary), BINARY_CHUNK) + bytes(binary)


def _from_the_end(reference: Floats, motions: Floats, end: Floats) -> tuple[Floats, Floats]:
    """Translations (k, 3) [m] and quaternions (k, 4) of a part at motions (k, 6), against where it is at its end (6,)."""
    R = exponential(motions[:, 3:]) @ exponential(end[3:]).T
    shift = reference + motions[:, :3] - R @ (reference + end[:3])
    q = with_quaternions(np.concatenate([shift, logarithm(R)], axis=1))[:, 3:]
    return METRES * shift @ UPRIGHT.T, np.concatenate([q[:, :3] @ UPRIGHT.T, q[:, 3:]], axis=1)


def _accessor(content: dict[str, Any], binary: bytearray, values: Floats, kind: str) -> int:
    """Number of a new accessor that holds these rows as floats."""
    binary += b"\0" * (-len(binary) % 4)
    packed = np.ascontiguousarray(values, dtype="<f4")
    content["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": packed.nbytes})
    binary += packed.tobytes()
    entry: dict[str, Any] = {
        "bufferView": len(content["bufferViews"]) - 1, "componentType": FLOAT, "count": len(values), "type": kind,
    }  # fmt: skip
    if kind == "SCALAR":
        entry |= {"min": [float(packed.min())], "max": [float(packed.max())]}
    content["accessors"].append(entry)
    return len(content["accessors"]) - 1
