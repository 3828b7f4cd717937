"""A cutting sheet put together: bodies of panels, their joints, what is left over, and how sure that is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.mating.beam_search import BeamState, Effort, Placement, extent, grow
from wiggleroom.mating.closed_search import Closed, closed_placements
from wiggleroom.mating.congruence import congruent
from wiggleroom.mating.contact import MET_TOLERANCE
from wiggleroom.mating.cutting_sheet import CuttingSheet
from wiggleroom.mating.edge_constraints import EdgeConstraints, edge_constraints, without_skipped
from wiggleroom.mating.edge_ends import aligned_ends
from wiggleroom.mating.flanks import SheetPlate, bits, plates_of
from wiggleroom.mating.hints import Hints
from wiggleroom.mating.known import known_starts, with_fixed_plates
from wiggleroom.mating.pair_poses import PairPoseTable
from wiggleroom.mating.refinement import pressed_panel, refined, relief_needed

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class SheetSettings:
    """How hard a sheet is tried, and what counts as a body.

    Parameters
    ----------
    efforts : tuple of Effort
        Beams that are tried one after the other while needed flanks stay open.
    min_met_share : float in (0, 1)
        A panel of which a smaller share of the flanks meets belongs elsewhere, if there is more than one body.
    max_open_share : float in (0, 1)
        No other way is tried where a smaller share of the flanks meets nothing, and none of them could meet any.
    max_relief : float in (0, 0.5)
        Outlines are relieved by at most this share of the thickness; what still overlaps then is taken out again.
    sure_relief : float in (0, 0.5)
        An assembly that needs more than this share is not sure.
    body_distance : float > 0 [mm]
        Free room between two bodies in the file that is written.
    max_scored : int
        No other beam is begun after as many poses were scored for the sheet.
    aligned_share : float in (0, 1)
        Share of the poses of a search that the one of edges that end together may try.
    """

    efforts: tuple[Effort, ...] = (Effort(8, 0.5), Effort(6, 1.0), Effort(20, 0.5))
    min_met_share: float = 0.5
    max_open_share: float = 0.05
    max_relief: float = 0.2
    sure_relief: float = 0.12
    body_distance: float = 20.0
    max_scored: int = 400_000
    aligned_share: float = 0.3


SETTINGS = SheetSettings()


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
    bench = BeamState(_told_apart(plates, constraints.named), constraints)
    whole = PairPoseTable(bench, whole=True)
    tables = PairPoseTable(bench, whole=True, aligned_of=whole), whole, PairPoseTable(bench, whole=False)
    found, doubts = _bodies(bench, tables, hints, stop, progress)
    bodies, unplaced = with_fixed_plates(bench, [_outward(bench, refined(bench, body)) for body in found], constraints)
    notes = [*sheet.notes]
    bodies, relief, pressed = _relieved(bench, bodies, real, thickness)
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
        joints += [FoundJoint((a, b), pairs) for a, b, pairs in bench.met(body)[0]]
        left |= {row: rows for row, rows in bench.open(body).items() if len(rows)}
    if left:
        doubts.append(
            f"{sum(len(rows) for rows in left.values())} flanks meet nothing, of {_listed(names, list(left))}"
        )
    doubts += _not_kept(constraints, bodies)
    loose = _loose(bench, tables[1], bodies, unplaced)
    if loose:
        fits = (
            "no edge of it fits another panel: it lies"
            if len(loose) == 1
            else "no edge of theirs fits another panel: they lie"
        )
        doubts.append(f"not placed: {_listed(names, loose)}; {fits} loose, and a hint ([[plate]]) can say where")
    waiting = [row for row in unplaced if row not in loose]
    if waiting:
        doubts.append(f"not placed: {_listed(names, waiting)}")
    placed = _side_by_side(bench, [_upright(bench, body) for body in bodies])
    return AssembledSheet(
        plates, tuple(real), tuple(placed), tuple(joints), left, tuple(unplaced), tuple(loose), taken, relief,
        tuple(dict.fromkeys(doubts)), tuple(notes), sheet.source,
    )  # fmt: skip


def _loose(bench: BeamState, table: PairPoseTable, bodies: Sequence[Placement], unplaced: Sequence[int]) -> list[int]:
    """Panels of which no row of fingers fits one of another panel that is still open."""
    met = dict.fromkeys(unplaced, 0)
    for body in bodies:
        _, flags = bench.met(body)
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


def _listed(names: Sequence[str], rows: Sequence[int]) -> str:
    shown = ", ".join(names[row] for row in rows[:6])
    return shown + (f" and {len(rows) - 6} more" if len(rows) > 6 else "")


def _bodies(
    bench: BeamState,
    tables: tuple[PairPoseTable, ...],
    hints: Hints,
    stop: Stop | None,
    progress: Callable[[int], None] | None,
) -> tuple[list[Placement], list[str]]:
    """Bodies, largest first as they are found, and what makes them doubtful."""
    names = [plate.name for plate in bench.plates]
    groups = [frozenset(names.index(name) for name in group) for group in hints.groups]
    rest = frozenset(range(len(names))) - frozenset().union(*groups)
    bodies: list[Placement] = []
    doubts: list[str] = []
    for group in [*groups, rest]:
        left = {row for row in group if len(bench.flanks[row])}
        while len(left) > 1:
            body, doubt = _body(bench, frozenset(left), tables, 1.0 / (1 + len(bodies)), stop, progress)
            doubts += doubt
            if len(body.rows) < 2:
                left -= set(body.rows)
                continue
            bodies.append(body)
            left -= set(body.rows)
    return bodies, doubts


def _body(
    bench: BeamState,
    left: frozenset[int],
    tables: tuple[PairPoseTable, ...],
    share: float,
    stop: Stop | None,
    progress: Callable[[int], None] | None,
) -> tuple[Placement, list[str]]:
    """One body of some of the panels, and why it may be wrong; with a share of the work that the first body may take."""
    root = max(left, key=lambda row: (len(bench.flanks[row]), bench.plates[row].polygon.area))
    starts = known_starts(bench, bench.constraints, left, tables[-1]) or [bench.start(root)]
    name = bench.plates[starts[0].rows[0]].name
    best: tuple[int, Placement] | None = None
    doubts: list[str] = []
    aligned = closed_placements(
        bench, starts, left, tables[0], share=SETTINGS.aligned_share * share, max_open_lines=0, stop=stop
    )
    for table in tables[1:]:
        # What has edges that end together is likelier, but it counts as sure only where nothing else fits.
        spare = {"max_open_lines": 0} if aligned.placements else {}
        closed = closed_placements(bench, starts, left, table, share=share, stop=stop, **spare)
        closed = _merged(bench, aligned, closed)
        if not closed.placements:
            continue
        placed = _best(bench, closed.placements)
        if best is None or _met(bench, placed) > best[0]:
            best, doubts = (_met(bench, placed), placed), _rivals(bench, closed, name)
        if _open_share(bench, best[1]) <= SETTINGS.max_open_share:
            return best[1], doubts
    for effort in SETTINGS.efforts:
        if bench.scored > SETTINGS.max_scored or (best is not None and _complete(bench, best[1], left)):
            break
        grown = [grow(bench, start, left, effort, stop=stop, progress=progress)[0] for start in starts]
        for found in grown:
            if len(found.rows) > 2:
                found = _trimmed(bench, found, len(starts[0].rows))
            if best is None or _met(bench, found) > best[0]:
                best = _met(bench, found), found
                doubts = [f"no way was found to put panels round {name} so that every flank meets another"]
    if best is None or len(best[1].rows) < 2:
        return starts[0], []
    return best[1], doubts


def _merged(bench: BeamState, aligned: Closed, closed: Closed) -> Closed:
    """What two searches found; whether there is nothing else, the second one says."""
    if not aligned.placements:
        return closed
    kinds = [plate.kind for plate in bench.plates]
    found = list(aligned.placements)
    for each in closed.placements if closed.open_lines == 0 else []:
        panels = [
            [(kinds[row], turn, move) for row, turn, move in zip(one.rows, one.turns, one.moves, strict=True)]
            for one in (each, *aligned.placements)
        ]
        tolerance = MET_TOLERANCE * bench.tolerance
        if not any(congruent(bench.isometries, panels[0], other, tolerance) for other in panels[1:]):
            found.append(each)
    return Closed(found, 0, closed.exhausted)


def _open_share(bench: BeamState, placed: Placement) -> float:
    """Share of the needed flanks of a placement that meet nothing."""
    needed = sum(int(bench.plates[row].needed.sum()) for row in placed.rows)
    return sum(len(rows) for rows in bench.open(placed).values()) / max(needed, 1)


def _complete(bench: BeamState, placed: Placement, left: frozenset[int]) -> bool:
    """Whether a placement holds all panels, and all their flanks meet others."""
    return len(placed.rows) == len(left) and not any(len(rows) for rows in bench.open(placed).values())


def _best(bench: BeamState, placements: list[Placement]) -> Placement:
    """The placement in which the most flanks meet; of several the one whose edges end together, then the one whose panels press least.

    Of placements that are equal in this, too, the smallest one.
    """
    most = max(_met(bench, each) for each in placements)
    equal = [each for each in placements if _met(bench, each) == most]
    if len(equal) == 1:
        return equal[0]
    together = [aligned_ends(bench, each) for each in equal]
    equal = [each for each, ends in zip(equal, together, strict=True) if ends > max(together) - 0.5]
    if len(equal) == 1:
        return equal[0]
    drawn = [plate.thickness for plate in bench.plates]
    least = SETTINGS.max_relief * min(drawn)
    pressing = [relief_needed(bench, refined(bench, each), drawn, least) for each in equal]
    return equal[min(range(len(equal)), key=lambda k: (round(pressing[k], 2), extent(bench, equal[k])))]


def _rivals(bench: BeamState, closed: Closed, name: str) -> list[str]:
    """Why the best of the placements that were found may be wrong."""
    if closed.open_lines:
        return [f"no way was found to put panels round {name} so that every flank meets another"]
    if len(closed.placements) > 1:
        moved = _moved(bench, *closed.placements[:2])
        which = (
            f": {_listed([plate.name for plate in bench.plates], moved)} can be elsewhere or otherwise" if moved else ""
        )
        return [f"panels fit together in more than one way, round {name}{which}"]
    return [] if closed.exhausted else [f"not every other way to put panels round {name} was tried"]


def _moved(bench: BeamState, one: Placement, other: Placement) -> list[int]:
    """Panels of the one placement where the other has no panel of their kind in their place, or its mirror image has none."""
    flip = np.diag([1.0, 1.0, -1.0])
    found: list[int] | None = None
    for turns, moves in ((other.turns, other.moves), (flip @ other.turns @ flip, other.moves @ flip)):
        taken: set[tuple[float, ...]] = set()
        for row, turn, move in zip(other.rows, turns, moves, strict=True):
            kind = bench.plates[row].kind
            taken.add((kind, *np.round(bench.trace(kind, turn[None], move[None])[0], 1).tolist()))
        moved = []
        for row, turn, move in zip(one.rows, one.turns, one.moves, strict=True):
            kind = bench.plates[row].kind
            if (kind, *np.round(bench.trace(kind, turn[None], move[None])[0], 1).tolist()) not in taken:
                moved.append(row)
        if found is None or len(moved) < len(found):
            found = moved
    return found or []


def _met(bench: BeamState, placed: Placement) -> int:
    """How many pairs of flanks meet."""
    return sum(len(pairs) for *_, pairs in bench.met(placed)[0])


def _trimmed(bench: BeamState, body: Placement, known: int) -> Placement:
    """Body without the panels that hardly meet the others, worst first; the first ones are known and stay."""
    while len(body.rows) > max(2, known):
        _, flags = bench.met(body)
        share = {row: flags[row].mean() for row in body.rows[known:]}
        worst = min(share, key=lambda row: share[row])
        if share[worst] >= SETTINGS.min_met_share:
            return body
        body = without(body, worst)
    return body


def without(body: Placement, row: int) -> Placement:
    """Placement without one of its panels."""
    keep = [k for k, other in enumerate(body.rows) if other != row]
    return Placement(tuple(body.rows[k] for k in keep), body.turns[keep], body.moves[keep], body.met, {})


def _relieved(
    bench: BeamState, bodies: list[Placement], real: list[float], thickness: float
) -> tuple[list[Placement], float, list[int]]:
    """Bodies in which no plates overlap, the relief that takes [mm], and panels that had to be left out."""
    result: list[Placement] = []
    relief = 0.0
    pressed: list[int] = []
    for body in bodies:
        while len(body.rows) > 1:
            needed = relief_needed(bench, body, real, SETTINGS.max_relief * thickness)
            if np.isfinite(needed):
                relief = max(relief, needed)
                break
            row = pressed_panel(bench, body, real, SETTINGS.max_relief * thickness)
            pressed.append(row)
            body = refined(bench, without(body, row))
        if len(body.rows) > 1:
            result.append(body)
        else:
            pressed += body.rows
    return result, relief, pressed


def _outward(bench: BeamState, body: Placement) -> Placement:
    """Body or its mirror image: the one whose panels show their drawn side outward."""
    areas = np.array([bench.plates[row].polygon.area for row in body.rows])
    centre = areas @ body.moves / areas.sum()
    if areas @ np.einsum("ki,ki->k", body.turns[:, :, 2], body.moves - centre) >= 0:
        return body
    flip = np.diag([1.0, 1.0, -1.0])
    return Placement(body.rows, flip @ body.turns @ flip, body.moves @ flip, body.met, {})


def _upright(bench: BeamState, body: Placement) -> Placement:
    """Body standing on the panel called bottom or on the one that suits it."""
    turns, moves = body.turns, body.moves
    areas = np.array([bench.plates[row].polygon.area for row in body.rows])
    calling = ("bottom", "floor", "base", "boden")
    said = [k for k, row in enumerate(body.rows) if bench.plates[row].name.lower().startswith(calling)]
    points = np.vstack(bench.places(Placement(body.rows, turns, moves, 0.0, {})))

    def tilted(i: int) -> tuple[float, int]:
        """Size of the box round everything in the frame of one panel, then how many panels stand askew in it."""
        askew = (np.abs(turns[:, :, 2] @ turns[i]).max(axis=1) < 0.999).sum()
        return round(float(np.prod(np.ptp(points @ turns[i], axis=0) + 1.0)), -1), int(askew)

    k = said[0] if said else min(range(len(body.rows)), key=tilted)
    frame, origin = turns[k], moves[k]
    turns, moves = frame.T @ turns, (moves - origin) @ frame
    if areas @ moves[:, 2] < 0:  # the others stand on it, not below
        half = np.diag([1.0, -1.0, -1.0])
        turns, moves = half @ turns, moves @ half
    return Placement(body.rows, np.round(turns, 12) + 0.0, moves, body.met, {})


def _side_by_side(bench: BeamState, bodies: list[Placement]) -> list[Placement]:
    """Bodies moved apart along x."""
    result: list[Placement] = []
    reach = 0.0
    for body in bodies:
        thick = max(plate.thickness for plate in bench.plates)
        points = np.vstack(bench.places(body))
        shift = np.array([reach - points[:, 0].min() + thick, 0.0, 0.0]) if result else np.zeros(3)
        reach = float((points + shift)[:, 0].max() + thick + SETTINGS.body_distance)
        result.append(Placement(body.rows, body.turns, body.moves + shift, body.met, {}))
    return result
