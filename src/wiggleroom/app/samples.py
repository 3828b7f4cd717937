"""Drawings to begin with, made when they are wanted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from wiggleroom.app.sheet_sample import sheet
from wiggleroom.app.spatial_samples import SPATIAL_SAMPLES
from wiggleroom.assembly import patterns
from wiggleroom.assembly.assembly import Assembly, rings_at
from wiggleroom.drawing.model import Pull
from wiggleroom.drawing.writers.assembly_writer import write_assembly
from wiggleroom.errors import InputError
from wiggleroom.schema.replies import SampleEntry
from wiggleroom.schema.reply_base import Outline

PICTURE_SIDE = 100.0
"""Width or height of small pictures [SVG units]."""


@dataclass(frozen=True)
class SampleDrawing:
    """An assembly to begin with, one of its kind for its picture, and whether its last part is pulled to the right."""

    words: str
    make: Callable[[], Assembly]
    picture: Callable[[], Assembly]
    pulled: bool = True


SAMPLES = {
    "jigsaw": SampleDrawing(
        "Pieces with knobs, a fine cut between them",
        lambda: patterns.jigsaw(5, 4, gap=0.3, pitch=40),
        lambda: patterns.jigsaw(5, 4, gap=1.5, pitch=40),
    ),
    "chain": SampleDrawing(
        "Blocks in a row: how far does the last one go?",
        lambda: patterns.chain(6, "tee", gap=0.4, pitch=20),
        lambda: patterns.chain(6, "tee", gap=0.8, pitch=20),
    ),
    "swallowtails": SampleDrawing(
        "A frame of swallowtail joints",
        lambda: patterns.frame(5, 4, "swallowtail", gap=0.3, pitch=20),
        lambda: patterns.frame(5, 4, "swallowtail", gap=0.8, pitch=20),
    ),
    "panel": SampleDrawing(
        "Blocks that hold each other on all sides",
        lambda: patterns.grid(10, 10, "tee", gap=0.2, pitch=20),
        lambda: patterns.grid(10, 10, "tee", gap=0.8, pitch=20),
    ),
    "large": SampleDrawing(
        "As many as in a floor",
        lambda: patterns.grid(27, 25, "tee", gap=0.2, pitch=20),
        lambda: patterns.grid(12, 10, "tee", gap=1.2, pitch=20),
    ),
    "sheet": SampleDrawing("A cutting sheet, 3 mm thick: which box is it?", sheet, sheet, pulled=False),
}


def sample_file(name: str) -> bytes:
    """Assembly file of a sample.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    if name in SPATIAL_SAMPLES:
        return SPATIAL_SAMPLES[name].text().encode()
    if name not in SAMPLES:
        message = f'there is no sample "{name}": choose {", ".join([*SAMPLES, *SPATIAL_SAMPLES])}'
        raise InputError(message)
    sample = SAMPLES[name]
    made = sample.make()
    goals = (Pull(made.names[-1], (1.0, 0.0)),) if sample.pulled else ()
    return write_assembly(replace(made.drawing, goals=goals)).encode()


@lru_cache
def sample_entries() -> tuple[SampleEntry, ...]:
    """What the page is told about the samples."""
    found = []
    for name, sample in SAMPLES.items():
        rings = [rings_at(part) for part in sample.picture().parts]
        found.append(SampleEntry(name, sample.words, len(sample.make().parts), _small(rings), sample.pulled))
    for name, one in SPATIAL_SAMPLES.items():
        found.append(SampleEntry(name, one.words, len(one.boxes), _small(one.outlines()), pulled=True))
    return tuple(found)


def _small(rings: Sequence[Sequence[NDArray[np.float64]]]) -> list[Outline]:
    """Outlines of parts, drawn as small pictures are."""
    corners = np.vstack([ring for one in rings for ring in one])
    low = corners.min(axis=0)
    scale = PICTURE_SIDE / float(np.ptp(corners, axis=0).max())
    return [[((ring - low) * scale).round(1).tolist() for ring in one] for one in rings]
