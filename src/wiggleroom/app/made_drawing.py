"""Drawings that are made on the page: blocks with joints, their sizes set there."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from wiggleroom.assembly import patterns
from wiggleroom.assembly.joints import JOINTS, joint
from wiggleroom.drawing.model import Pull
from wiggleroom.drawing.writers.assembly_writer import write_assembly
from wiggleroom.schema.replies import JointSize
from wiggleroom.schema.requests import Made

GAP_SHARE = 0.015
"""Gap at first, as a share of the side of a block."""


def made_file(made: Made) -> bytes:
    """Assembly file of what is to be made; its last block is pulled to the right.

    Raises
    ------
    InputError
        If there is no such joint or size, or the sizes do not fit each other.
    """
    family: dict[str, Any] = {}
    if made.pattern != "jigsaw":
        joint(made.joint, **made.sizes)
        family = {"joint": made.joint, **made.sizes}
    counts = (made.nx,) if made.pattern == "chain" else (made.nx, made.ny)
    assembly = getattr(patterns, made.pattern)(*counts, gap=GAP_SHARE * made.pitch, pitch=made.pitch, **family)
    return write_assembly(replace(assembly.drawing, goals=(Pull(assembly.names[-1], (1.0, 0.0)),))).encode()


def joint_families() -> dict[str, list[JointSize]]:
    """Families of joints with their sizes; one that has two names comes once."""
    families = {family: name for name, family in reversed(JOINTS.items())}
    return {
        name: [JointSize(f.name, float(f.default), f.type == "int") for f in fields(family)]  # type: ignore[arg-type]
        for family, name in reversed(families.items())
    }
