"""Drawings to begin with, made when they are wanted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from wiggleroom.assembly import patterns
from wiggleroom.assembly.assembly import Assembly, rings_at
from wiggleroom.drawing.assembly_writer import write_assembly
from wiggleroom.drawing.model import Pull
from wiggleroom.errors import InputError
from wiggleroom.schema.replies import SampleEntry

PICTURE_SIDE = 100.0
"""Small pictures are so many units wide or high."""


@dataclass(frozen=True)
class Sample:
    """An assembly to begin with, and a smaller one of its kind for its picture."""

    words: str
    make: Callable[[], Assembly]
    picture: Callable[[], Assembly]


SAMPLES = {
    "jigsaw": Sample(
        "Pieces with knobs, a fine cut between them",
        lambda: patterns.jigsaw(5, 4, gap=0.3, pitch=40),
        lambda: patterns.jigsaw(5, 4, gap=1.5, pitch=40),
    ),
    "chain": Sample(
        "Blocks in a row: how far does the last one go?",
        lambda: patterns.chain(6, "tee", gap=0.4, pitch=20),
        lambda: patterns.chain(4, "tee", gap=0.8, pitch=20),
    ),
    "swallowtails": Sample(
        "A frame of swallowtail joints",
        lambda: patterns.frame(5, 4, "swallowtail", gap=0.3, pitch=20),
        lambda: patterns.frame(5, 4, "swallowtail", gap=0.8, pitch=20),
    ),
    "panel": Sample(
        "Blocks that hold each other on all sides",
        lambda: patterns.grid(10, 10, "tee", gap=0.2, pitch=20),
        lambda: patterns.grid(6, 5, "tee", gap=0.8, pitch=20),
    ),
    "large": Sample(
        "As many as in a floor",
        lambda: patterns.grid(27, 25, "tee", gap=0.2, pitch=20),
        lambda: patterns.grid(12, 10, "tee", gap=1.2, pitch=20),
    ),
}


def sample_file(name: str) -> bytes:
    """Assembly file of a sample: its last part is pulled to the right.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    if name not in SAMPLES:
        message = f'there is no sample "{name}": choose {", ".join(SAMPLES)}'
        raise InputError(message)
    made = SAMPLES[name].make()
    return write_assembly(replace(made.drawing, goals=(Pull(made.names[-1], (1.0, 0.0)),))).encode()


@lru_cache
def sample_entries() -> tuple[SampleEntry, ...]:
    """What the page is told about the samples."""
    found = []
    for name, sample in SAMPLES.items():
        rings = [rings_at(part) for part in sample.picture().parts]
        corners = np.vstack([ring for one in rings for ring in one])
        low = corners.min(axis=0)
        scale = PICTURE_SIDE / float(np.ptp(corners, axis=0).max())
        outlines = [[((ring - low) * scale).round(1).tolist() for ring in one] for one in rings]
        found.append(SampleEntry(name, sample.words, len(sample.make().parts), outlines))
    return tuple(found)
