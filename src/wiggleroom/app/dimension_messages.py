"""What was found as the page reads it, of drawings and of assemblies in space alike; what belongs to space is loaded for space alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.statements import unknown
from wiggleroom.errors import InputError
from wiggleroom.report.page.page_messages import rings_message
from wiggleroom.report.page.path_frames import path_frames
from wiggleroom.schema.replies import DragReply, FlexReply, ShapeReply, Solids
from wiggleroom.schema.reply_base import Outline

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly

Floats = NDArray[np.float64]


class Outlines(NamedTuple):
    """What parts look like, and the name under which the page keeps it."""

    name: str
    shapes: list[Outline] | Solids


def frames_of(assembly: Assembly, points: Floats) -> Floats:
    """Frames along a path of motions (m, n, 3) or (m, n, 6)."""
    if assembly.dimension == 2:
        return path_frames(assembly, points)
    from wiggleroom.report.page.spatial_messages import spatial_frames

    return spatial_frames(assembly, points)


def as_frames(motions: Floats) -> Floats:
    """Frames of motions (k, n, 3) or (k, n, 6)."""
    if motions.shape[2] == 3:
        return motions
    from wiggleroom.report.solids.spatial_path import with_quaternions

    return with_quaternions(motions)


def still_frame(motion: Floats) -> Floats:
    """The frame of one motion (n, 3) or (n, 6)."""
    return as_frames(motion[None])


def motion_of(pose: Mapping[str, tuple[float, ...]], names: Sequence[str], in_space: bool) -> Floats:
    """Motions (n, 3) [mm, rad] of all parts, in space (n, 6), from those that a request says of the parts that do not rest.

    Raises
    ------
    InputError
        If it names a part that is not there, or has another count of numbers.
    """
    columns, index = 7 if in_space else 3, {name: k for k, name in enumerate(names)}
    wrong = [f"pose: {unknown(name, dict.fromkeys(names))}" for name in pose if name not in index]
    wrong += [
        f'pose: "{name}" has {len(m)} numbers; {columns} are wanted' for name, m in pose.items() if len(m) != columns
    ]
    if wrong:
        raise InputError(wrong)
    motion = np.zeros((len(names), 6 if in_space else 3))
    for name, told in pose.items():
        motion[index[name]] = rotation_vectors(np.array(told)) if in_space else told
    return motion


def rotation_vectors(frame: Floats) -> Floats:
    """Motion (6,) [mm, rad] of a frame (7,) with a quaternion x, y, z, w."""
    axis, w = (frame[3:6], frame[6]) if frame[6] >= 0 else (-frame[3:6], -frame[6])
    sine = float(np.linalg.norm(axis))
    angle = 2 * np.arctan2(sine, w)
    return np.concatenate([frame[:3], axis * (angle / sine if sine > 0 else 2.0)])


def shapes_of(assembly: Assembly) -> list[Outline] | Solids:
    """What the parts look like."""
    if assembly.dimension == 2:
        return rings_message(assembly.parts)
    from wiggleroom.report.page.spatial_messages import solids_message

    return solids_message(assembly)


def tell_outlines(content: FlexReply | DragReply | ShapeReply, outlines: Outlines | None) -> None:
    """Put into a reply what the parts look like, where the page lacks it."""
    if outlines is None:
        return
    content.shown = outlines.name
    if isinstance(outlines.shapes, Solids):
        content.solids = outlines.shapes
    else:
        content.rings = outlines.shapes
