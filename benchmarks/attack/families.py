"""All families of random assemblies, and the drawing of one by its number."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchmarks.attack import families_fitted as fitted
from benchmarks.attack import families_framed as framed
from benchmarks.attack import families_loaded as loaded
from benchmarks.attack import families_mechanisms as mechanisms
from benchmarks.attack import families_puzzles as puzzles
from benchmarks.attack import families_rotary as rotary
from benchmarks.attack.drawing import Json, Random, lie_apart, turned

Family = Callable[[Random], Json]

FAMILIES: tuple[Family, ...] = (
    fitted.c_rings,
    fitted.wedges,
    fitted.bayonets,
    fitted.mazes,
    fitted.sliding_blocks,
    fitted.locks,
    mechanisms.cams,
    mechanisms.latches,
    fitted.packed_polygons,
    mechanisms.gears,
    fitted.random_chains,
    fitted.grids,
    fitted.star_holes,
    fitted.dovetail_sliders,
    mechanisms.notched_rings,
    mechanisms.four_bars,
    fitted.t_slots,
    mechanisms.ratchets,
    fitted.curved_dovetails,
    fitted.half_laps,
    mechanisms.zips,
    mechanisms.geneva_drives,
    mechanisms.scissors,
    mechanisms.hinges,
    fitted.nested_keys,
    mechanisms.keyed_gears,
    mechanisms.linkages,
    mechanisms.discs_off_centre,
    fitted.loose_polygons,
    fitted.glued_packings,
    fitted.rods_in_rooms,
    fitted.rings_in_rings,
    puzzles.combination_dials,
    puzzles.tongued_tiles,
    puzzles.nested_hooks,
    puzzles.telescopes,
    puzzles.tangrams,
    puzzles.pegs_in_slots,
    rotary.stepped_bayonets,
    rotary.keys_in_curved_slots,
    rotary.ball_joints,
    loaded.bolted_plates,
    loaded.beams_on_posts,
    loaded.scotch_yokes,
    loaded.oldham_couplings,
    loaded.wedge_stacks,
    loaded.marbles_in_channels,
    loaded.combs,
    loaded.spirals,
    loaded.linked_hooks,
    loaded.arches,
    framed.closed_rings,
    framed.doors_with_bolts,
    framed.toggles,
    framed.keyhole_plates,
    framed.claw_couplings,
    framed.whippletrees,
    framed.carousels,
    framed.drawers,
    framed.split_sleeves,
)
MEASURED_FAMILIES = FAMILIES[:41]
"""Those that the figures of `ablation` and `invariance` in benchmarks/results/measurements.md are about."""
LEAST = 2e-3
"""Parts lie apart by at least so much [mm]: what touches is another question."""
TRIES = 40


def draw(number: int, families: tuple[Family, ...] = FAMILIES) -> tuple[str, Json | None]:
    """Family and assembly of a number; None where no drawing without touching parts was found."""
    family = families[number % len(families)]
    for attempt in range(TRIES):
        rng = np.random.default_rng([number, attempt])
        made = family(rng)
        if rng.random() < 0.4:
            made = turned(made, float(rng.uniform(0, 2 * np.pi)))
        movable = any(not p.get("fixed") for p in made["parts"])
        if movable and lie_apart(made, LEAST):
            return family.__name__, made
    return family.__name__, None
