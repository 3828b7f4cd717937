"""A cutting sheet put together: bodies of panels, their joints, what is left over, and how sure that is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.errors import InputError
from wiggleroom.mating.body_frame import outward, side_by_side, upright, without_panel
from wiggleroom.mating.body_search import bodies_of, panel_names
from wiggleroom.mating.cutting_sheet import CuttingSheet, check_burn
from wiggleroom.mating.edge_constraints import EdgeConstraints, edge_constraints, without_skipped
from wiggleroom.mating.fit import Misfit, fitted, misfits
from wiggleroom.mating.flanks import SheetPlate, bits, flank_lengths
from wiggleroom.mating.given_placements import with_fixed_plates
from wiggleroom.mating.hints import Hints
from wiggleroom.mating.joint_angles import plates_of
from wiggleroom.mating.pair_poses import PairPoseTable
from wiggleroom.mating.panel_outline import inset
from wiggleroom.mating.panel_set import PanelSet, Placement
from wiggleroom.mating.refinement import least_squares_placement, pressed_panel
from wiggleroom.mating.sheet_settings import SETTINGS

Floats = NDArray[np.float64]

MAX_GUESSES = 4
"""At most so many thicknesses are tried where no panel fits another one."""


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
    misfits : tuple of Misfit
        What is too large for slots as cut.
    doubts : tuple of str
        Why it is not sure where panels belong.
    relieved : tuple of str
        That plates fit only since outlines were relieved as asked, one line for every cause.
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
    misfits: tuple[Misfit, ...]
    doubts: tuple[str, ...]
    relieved: tuple[str, ...]
    notes: tuple[str, ...]
    source: str

    @property
    def sure(self) -> bool:
        """Whether every needed flank meets another, no other assembly does as well, and plates fit as cut."""
        return not self.reasons

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why it is not sure, one line each."""
        return (*self.doubts, *self.relieved)

    @property
    def as_cut(self) -> AssembledSheet:
        """The same with outlines as cut, whether or not they were relieved: plates may then press on each other."""
        notes = self.notes[:-1] if self.relieved else self.notes  # the last one says that they were
        return replace(self, relief=0.0, relieved=(), notes=notes)


def assemble_sheet(
    sheet: CuttingSheet,
    thickness: float,
    *,
    burn: float | None = None,
    relieve: float = 0.0,
    hints: Hints | None = None,
    context: Context = UNLIMITED,
) -> AssembledSheet:
    """Panels of a cutting sheet put together in space by the joints that their outlines show.

    Parameters
    ----------
    sheet : CuttingSheet
    thickness : float [mm]
        For which slots and fingers are drawn.
    burn : float [mm], optional
        By how much outlines were drawn larger; by default what the hints or the sheet say. Where nothing is known of it, it is
        what plates of this thickness need in order to fit, at most `SheetSettings.max_burn`.
    relieve : float [mm]
        Outlines may be moved inward by up to this so that plates fit.
    hints : Hints, optional

    Raises
    ------
    InputError
        If a hint names a panel that is not there, the burn uses one up, or all flanks meet but plates do not fit as cut:
        one line for every cause.

    Notes
    -----
    The mirror image of an assembly of flat plates has the same plates, each turned over, and fits as well. Of the two
    the one is chosen in which the sides drawn face outward.
    """
    hints = hints or Hints()
    sheet = without_skipped(sheet, hints)
    said = next((size for size in (burn, hints.burn, sheet.burn) if size is not None), None)
    taken = said or 0.0
    check_burn(sheet, taken)
    names = [panel.name for panel in sheet.panels]
    real = [hints.thicknesses.get(name, thickness) for name in names]
    # A panel a little thinner than its slots is a real sheet; one far off has slots of its own.
    drawn = [size if abs(size - thickness) > 0.15 * thickness else thickness for size in real]
    plates = plates_of(names, [panel.polygon for panel in sheet.panels], drawn, taken)
    constraints = edge_constraints(sheet, plates, hints)
    panel_set = PanelSet(_told_apart(plates, constraints.named), constraints)
    whole = PairPoseTable(panel_set, whole=True)
    tables = PairPoseTable(panel_set, whole=True, aligned_of=whole), whole, PairPoseTable(panel_set, whole=False)
    found, doubts = bodies_of(panel_set, tables, hints, context)
    bodies, unplaced = with_fixed_plates(
        panel_set, [outward(panel_set, least_squares_placement(panel_set, body)) for body in found], constraints
    )
    notes = [*sheet.notes]
    tied = [pose.panels for pose in constraints.poses]
    most = SETTINGS.max_relief * thickness
    cut, pressed = 0.0, list[int]()
    if said is None:
        bodies, cut, pressed = _fitted(panel_set, bodies, drawn, (0.0, most), tied)
        cut = min(cut, SETTINGS.max_burn)
        if cut > SETTINGS.rounding:
            notes.append(
                f"{sheet.source}: by how much outlines are drawn larger is not known; plates fit once {cut:.3g} mm is taken"
                f" off every outline, as a cut {2 * cut:.3g} mm wide does: --burn {cut:.3g} says it, --burn 0 that it is not so"
            )
    before = {row: move for body in bodies for row, move in zip(body.rows, body.moves, strict=True)}
    bodies, relief, more = _fitted(panel_set, bodies, real, (cut, most), tied)
    pressed += more
    shift = max(
        (float(np.abs(m - before[r]).max()) for body in bodies for r, m in zip(body.rows, body.moves, strict=True)),
        default=0.0,
    )
    if shift > 0.01 and not pressed:
        notes.append(
            f"{sheet.source}: panels stand up to {shift:.2g} mm beside where they are drawn for, which frees them"
        )
    unplaced = sorted({*unplaced, *pressed})
    doubts += [f'panel "{names[row]}" overlaps others where its flanks meet, and is left out' for row in pressed]
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
            doubts.insert(0, f"no panel fits another one: {_thickness_shown(sheet, thickness, taken)}")
    waiting = [row for row in unplaced if row not in loose]
    if waiting:
        doubts.append(f"not placed: {panel_names(names, waiting)}")
    tight: list[Misfit] = []
    relieved: list[str] = []
    if 1e-3 < relief - cut <= SETTINGS.rounding:
        notes.append(
            f"{sheet.source}: its numbers are rounded; outlines are moved inward by {relief - cut:.2g} mm, and fit"
        )
    if relief - cut > SETTINGS.rounding:
        tight = [each for body in bodies for each in misfits(panel_set, body, real, cut, 2 * SETTINGS.rounding)]
        causes = misfit_lines(tight, names) or [
            f"no place was found where panels do not press on each other unless outlines move inward by {relief - cut:.2g} mm"
        ]
        asked = relief - cut <= relieve + SETTINGS.rounding
        if tight and not left and not unplaced and not asked:
            advice = f"it cannot be put together as cut: --relieve {relief - cut:.3g} would move every outline inward by that"
            raise InputError([f"{sheet.source}: {cause}; {advice}" for cause in causes])
        moved = f"outlines are moved inward by {relief - cut:.3g} mm more, and fit"
        if not asked:
            doubts += causes
        else:
            relieved = [f"{cause}; {moved} since --relieve allows it" for cause in causes]
        notes.append(f"{sheet.source}: {moved}")
    placed = side_by_side(panel_set, [upright(panel_set, body) for body in bodies])
    return AssembledSheet(
        plates, tuple(real), tuple(placed), tuple(joints), left, tuple(unplaced), tuple(loose), taken, relief,
        tuple(tight), tuple(dict.fromkeys(doubts)), tuple(relieved), tuple(notes), sheet.source,
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


def _thickness_shown(sheet: CuttingSheet, thickness: float, burn: float) -> str:
    """For which thickness joints look drawn, as a question to the person who said another one."""
    polygons = [panel.polygon for panel in sheet.panels]
    names = [panel.name for panel in sheet.panels]
    best, most = 0.0, 0
    for size in flank_lengths([inset(polygon, burn) for polygon in polygons])[:MAX_GUESSES]:
        panel_set = PanelSet(plates_of(names, polygons, [size] * len(names), burn))
        table = PairPoseTable(panel_set, whole=True)
        count = sum(any(len(table.between(a, b).turns) for b in range(len(names)) if b != a) for a in range(len(names)))
        if count > most or (count == most and size < best):
            best, most = size, count
    if not most:
        return f"is the material {thickness:g} mm thick?"
    return f"at {thickness:g} mm no flanks meet; the flanks are {best:g} mm apart: --thickness {best:g}?"


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


def _fitted(
    panel_set: PanelSet,
    bodies: Sequence[Placement],
    thickness: list[float],
    limits: tuple[float, float],
    tied: Sequence[tuple[int, int]],
) -> tuple[list[Placement], float, list[int]]:
    """Bodies in which no plates overlap, the relief that takes [mm] within its limits, and panels that had to be left out."""
    result: list[Placement] = []
    least, most = limits
    relief = least
    pressed: list[int] = []
    for body in bodies:
        while len(body.rows) > 1:
            free, needed = fitted(panel_set, body, thickness, least, most, tied)
            if np.isfinite(needed):
                body, relief = free, max(relief, needed)
                break
            row = pressed_panel(panel_set, body, thickness, most)
            pressed.append(row)
            body = least_squares_placement(panel_set, without_panel(body, row))
        if len(body.rows) > 1:
            result.append(body)
        else:
            pressed += body.rows
    return result, relief, pressed


_COUNTS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")


def misfit_lines(found: Sequence[Misfit], names: Sequence[str]) -> list[str]:
    """One line for every cause: what is too large, for which slots, and by how much.

    Parameters
    ----------
    found : sequence of Misfit
    names : sequence of str
        Of all panels.
    """
    causes: dict[tuple[str, float, float], list[Misfit]] = {}
    for each in found:
        size = each.size if each.kind == "thickness" else 0.0
        causes.setdefault((each.kind, round(size, 2), round(each.excess, 2)), []).append(each)
    lines = []
    for (kind, _, excess), same in causes.items():
        count = sum(each.places for each in same)
        word = _COUNTS[count] if count < len(_COUNTS) else str(count)
        large, slots = (list(dict.fromkeys(each.panels[k] for each in same)) for k in (0, 1))
        which = f"panel{'s' * (len(large) > 1)} {_quoted(names, large)} {'are' if len(large) > 1 else 'is'}"
        sizes = f"{same[0].size:.4g} mm thick, in {same[0].room:.4g} mm as cut"
        if kind == "width":
            which = f"fingers of {_quoted(names, large)} are"
            sizes = f"{same[0].size:.4g} mm wide, in {same[0].room:.4g} mm as cut"
        thick = "thick" if kind == "thickness" else "wide"
        slot = "slot" if kind == "thickness" else "gap"
        lines.append(
            f"{which} {excess:g} mm too {thick} for {word} {slot}{'s' * (count > 1)} of {_quoted(names, slots)}: {sizes}"
        )
    return lines


def _quoted(names: Sequence[str], rows: Sequence[int]) -> str:
    shown = ", ".join(f'"{names[row]}"' for row in rows[:4])
    return shown + (f" and {len(rows) - 4} more" if len(rows) > 4 else "")
