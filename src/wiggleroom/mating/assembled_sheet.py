"""A cutting sheet put together: bodies of panels, their joints, what is left over, and how sure that is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.mating.body_frame import outward, side_by_side, upright, without_panel
from wiggleroom.mating.body_search import bodies_of, panel_names
from wiggleroom.mating.cutting_sheet import CuttingSheet
from wiggleroom.mating.edge_constraints import EdgeConstraints, edge_constraints, without_skipped
from wiggleroom.mating.flanks import SheetPlate, bits
from wiggleroom.mating.given_placements import with_fixed_plates
from wiggleroom.mating.hints import Hints
from wiggleroom.mating.joint_angles import plates_of
from wiggleroom.mating.pair_poses import PairPoseTable
from wiggleroom.mating.panel_set import PanelSet, Placement
from wiggleroom.mating.refinement import least_squares_placement, pressed_panel, relief_needed
from wiggleroom.mating.sheet_settings import SETTINGS

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FoundJoint:
    """Two panels that hold each other.

    Parameters
    ----------
    panels : (int, int)
        Rows of the panels.
    flanks : (n, 2) int
        Rows of the flanks that meet, of the one and the other.
    """

    panels: tuple[int, int]
    flanks: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class AssembledSheet:
    """What became of a sheet.

    Parameters
    ----------
    plates : tuple of Plate
        All panels, outlines as cut and relieved.
    thickness : tuple of float [mm]
        Real thickness of every panel.
    bodies : tuple of Placement
        Panels placed in space, body beside body.
    joints : tuple of FoundJoint
    open : dict of int to (n,) int
        By row of a placed panel, needed flanks that meet nothing.
    unplaced : tuple of int
    loose : tuple of int
        Those of them of which no edge fits a free edge of another panel: lids that lie on top, plates that slide in.
    burn, relief : float [mm]
        Taken off every outline: as the cut does, and so that nothing presses at rest.
    doubts : tuple of str
        Why the assembly is not sure; empty where it is.
    notes : tuple of str
    source : str
        The sheet's file name.
    """

    plates: tuple[SheetPlate, ...]
    thickness: tuple[float, ...]
    bodies: tuple[Placement, ...]
    joints: tuple[FoundJoint, ...]
    open: dict[int, NDArray[np.int64]]
    unplaced: tuple[int, ...]
    loose: tuple[int, ...]
    burn: float
    relief: float
    doubts: tuple[str, ...]
    notes: tuple[str, ...]
    source: str

    @property
    def sure(self) -> bool:
        """Whether every needed flank meets another and no other assembly does as well."""
        return not self.doubts


def assemble_sheet(
    sheet: CuttingSheet,
    thickness: float,
    *,
    burn: float | None = None,
    hints: Hints | None = None,
    stop: Stop | None = None,
    progress: Callable[[int], None] | None = None,
) -> AssembledSheet:
    """Panels of a cutting sheet put together in space by the joints that their outlines show.

    Parameters
    ----------
    sheet : CuttingSheet
    thickness : float [mm]
        For which slots and fingers are drawn.
    burn : float [mm], optional
        By how much outlines were drawn larger; by default what the sheet says, else 0.
    hints : Hints, optional

    Raises
    ------
    InputError
        If a hint names a panel that is not there.

    Notes
    -----
    The mirror image of an assembly of flat plates has the same plates, each turned over, and fits as well. Of the two
    the one is chosen in which the sides drawn face outward.
    """
    hints = hints or Hints()
    sheet = without_skipped(sheet, hints)
    taken = burn if burn is not None else hints.burn if hints.burn is not None else sheet.burn or 0.0
    names = [panel.name for panel in sheet.panels]
    real = [hints.thicknesses.get(name, thickness) for name in names]
    # A panel a little thinner than its slots is a real sheet; one far off has slots of its own.
    drawn = [size if abs(size - thickness) > 0.15 * thickness else thickness for size in real]
    plates = plates_of(names, [panel.polygon for panel in sheet.panels], drawn, taken)
    constraints = edge_constraints(sheet, plates, hints)
    panel_set = PanelSet(_told_apart(plates, constraints.named), constraints)
    whole = PairPoseTable(panel_set, whole=True)
    tables = PairPoseTable(panel_set, whole=True, aligned_of=whole), whole, PairPoseTable(panel_set, whole=False)
    found, doubts = bodies_of(panel_set, tables, hints, stop, progress)
    bodies, unplaced = with_fixed_plates(
        panel_set, [outward(panel_set, least_squares_placement(panel_set, body)) for body in found], constraints
    )
    notes = [*sheet.notes]
    bodies, relief, pressed = _relieved(panel_set, bodies, real, thickness)
    unplaced = sorted({*unplaced, *pressed})
    doubts += [f'panel "{names[row]}" overlaps others where its flanks meet, and is left out' for row in pressed]
    if relief > 1e-3:
        notes.append(
            f"{sheet.source}: outlines pressed on each other at rest and are moved inward by {relief:.3g} mm more"
        )
    if relief > SETTINGS.sure_relief * thickness:
        doubts.append(f"panels press on each other by up to {2 * relief:.2g} mm")
    joints: list[FoundJoint] = []
    left: dict[int, NDArray[np.int64]] = {}
    for body in bodies:
        joints += [FoundJoint((a, b), pairs) for a, b, pairs in panel_set.met(body)[0]]
        left |= {row: rows for row, rows in panel_set.open(body).items() if len(rows)}
    if left:
        doubts.append(
            f"{sum(len(rows) for rows in left.values())} flanks meet nothing, of {panel_names(names, list(left))}"
        )
    doubts += _not_kept(constraints, bodies)
    loose = _loose(panel_set, tables[1], bodies, unplaced)
    if loose:
        fits = (
            "no edge of it fits one that is still open: it lies"
            if len(loose) == 1
            else "no edge of theirs fits one that is still open: they lie"
        )
        doubts.append(f"not placed: {panel_names(names, loose)}; {fits} loose, and a hint ([[plate]]) can say where")
        if len(loose) == len(names):
            doubts.insert(0, f"no panel fits another one: is the material {thickness:g} mm thick?")
    waiting = [row for row in unplaced if row not in loose]
    if waiting:
        doubts.append(f"not placed: {panel_names(names, waiting)}")
    placed = side_by_side(panel_set, [upright(panel_set, body) for body in bodies])
    return AssembledSheet(
        plates, tuple(real), tuple(placed), tuple(joints), left, tuple(unplaced), tuple(loose), taken, relief,
        tuple(dict.fromkeys(doubts)), tuple(notes), sheet.source,
    )  # fmt: skip


def _loose(
    panel_set: PanelSet, table: PairPoseTable, bodies: Sequence[Placement], unplaced: Sequence[int]
) -> list[int]:
    """Panels of which no row of fingers fits one of another panel that is still open."""
    met = dict.fromkeys(unplaced, 0)
    for body in bodies:
        _, flags = panel_set.met(body)
        met |= {row: bits(rows[None])[0] if len(rows) else 0 for row, rows in flags.items()}
    found = []
    for row in unplaced:
        near = (other for other in met if other != row)
        if not any(own & ~met[o] == own for o in near for own, _ in table.between(o, row).met):
            found.append(row)
    return found


def _told_apart(plates: Sequence[SheetPlate], named: frozenset[int]) -> tuple[SheetPlate, ...]:
    """Plates of which those named in hints have kinds of their own."""
    return tuple(replace(plate, kind=len(plates) + row) if row in named else plate for row, plate in enumerate(plates))


def _not_kept(constraints: EdgeConstraints, bodies: Sequence[Placement]) -> list[str]:
    """What was said of edges of panels that are not in one body."""
    return [
        f"{words}: said to belong together, but not all of these panels are placed in one body"
        for panels, words in constraints.pairs
        if not any(set(panels) <= set(body.rows) for body in bodies)
    ]


def _relieved(
    panel_set: PanelSet, bodies: list[Placement], real: list[float], thickness: float
) -> tuple[list[Placement], float, list[int]]:
    """Bodies in which no plates overlap, the relief that takes [mm], and panels that had to be left out."""
    result: list[Placement] = []
    relief = 0.0
    pressed: list[int] = []
    for body in bodies:
        while len(body.rows) > 1:
            needed = relief_needed(panel_set, body, real, SETTINGS.max_relief * thickness)
            if np.isfinite(needed):
                relief = max(relief, needed)
                break
            row = pressed_panel(panel_set, body, real, SETTINGS.max_relief * thickness)
            pressed.append(row)
            body = least_squares_placement(panel_set, without_panel(body, row))
        if len(body.rows) > 1:
            result.append(body)
        else:
            pressed += body.rows
    return result, relief, pressed
