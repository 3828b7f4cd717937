"""Which panels of a cutting sheet make one body: closed assemblies first, then beams, and what makes the result doubtful."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wiggleroom.context import Context
from wiggleroom.mating.beam_search import beam_search, extent
from wiggleroom.mating.body_frame import without_panel
from wiggleroom.mating.closed_search import Closed, closed_placements
from wiggleroom.mating.congruence import congruent
from wiggleroom.mating.contact import MET_TOLERANCE
from wiggleroom.mating.edge_ends import aligned_ends
from wiggleroom.mating.given_placements import known_starts
from wiggleroom.mating.hints import Hints
from wiggleroom.mating.pair_poses import PairPoseTable
from wiggleroom.mating.panel_set import PanelSet, Placement
from wiggleroom.mating.refinement import least_squares_placement, relief_needed
from wiggleroom.mating.sheet_settings import SETTINGS


def bodies_of(
    panel_set: PanelSet, tables: tuple[PairPoseTable, ...], hints: Hints, context: Context
) -> tuple[list[Placement], list[str]]:
    """Bodies, largest first as they are found, and what makes them doubtful."""
    names = [plate.name for plate in panel_set.plates]
    groups = [frozenset(names.index(name) for name in group) for group in hints.groups]
    rest = frozenset(range(len(names))) - frozenset().union(*groups)
    bodies: list[Placement] = []
    doubts: list[str] = []
    for group in [*groups, rest]:
        left = {row for row in group if len(panel_set.flanks[row])}
        while len(left) > 1:
            body, doubt = _body(panel_set, frozenset(left), tables, 1.0 / (1 + len(bodies)), context)
            doubts += doubt
            if len(body.rows) < 2:
                left -= set(body.rows)
                continue
            bodies.append(body)
            left -= set(body.rows)
    return bodies, doubts


def _body(
    panel_set: PanelSet, left: frozenset[int], tables: tuple[PairPoseTable, ...], share: float, context: Context
) -> tuple[Placement, list[str]]:
    """One body of some of the panels, and why it may be wrong; with a share of the work that the first body may take."""
    root = max(left, key=lambda row: (len(panel_set.flanks[row]), panel_set.plates[row].polygon.area))
    starts = known_starts(panel_set, panel_set.constraints, left, tables[-1]) or [panel_set.start(root)]
    name = panel_set.plates[starts[0].rows[0]].name
    best: tuple[int, Placement] | None = None
    doubts: list[str] = []
    aligned = closed_placements(
        panel_set, starts, left, tables[0], share=SETTINGS.aligned_share * share, max_open_lines=0, context=context
    )
    for table in tables[1:]:
        # What has edges that end together is likelier, but it counts as sure only where nothing else fits.
        spare = {"max_open_lines": 0} if aligned.placements else {}
        closed = closed_placements(panel_set, starts, left, table, share=share, **spare, context=context)
        closed = _merged(panel_set, aligned, closed)
        if not closed.placements:
            continue
        placed = _best(panel_set, closed.placements)
        if best is None or _met(panel_set, placed) > best[0]:
            best, doubts = (_met(panel_set, placed), placed), _rivals(panel_set, closed, name)
        if _open_share(panel_set, best[1]) <= SETTINGS.max_open_share:
            return best[1], doubts
    for effort in SETTINGS.efforts:
        if panel_set.scored > SETTINGS.max_scored or (best is not None and _complete(panel_set, best[1], left)):
            break
        grown = [beam_search(panel_set, start, left, effort, context=context)[0] for start in starts]
        for found in grown:
            if len(found.rows) > 2:
                found = _trimmed(panel_set, found, len(starts[0].rows))
            if best is None or _met(panel_set, found) > best[0]:
                best = _met(panel_set, found), found
                doubts = [f"no way was found to put panels round {name} so that every flank meets another"]
    if best is None or len(best[1].rows) < 2:
        return starts[0], []
    return best[1], doubts


def _merged(panel_set: PanelSet, aligned: Closed, closed: Closed) -> Closed:
    """What two searches found; whether there is nothing else, the second one says."""
    if not aligned.placements:
        return closed
    kinds = [plate.kind for plate in panel_set.plates]
    found = list(aligned.placements)
    for each in closed.placements if closed.open_lines == 0 else []:
        panels = [
            [(kinds[row], turn, move) for row, turn, move in zip(one.rows, one.turns, one.moves, strict=True)]
            for one in (each, *aligned.placements)
        ]
        tolerance = MET_TOLERANCE * panel_set.tolerance
        if not any(congruent(panel_set.isometries, panels[0], other, tolerance) for other in panels[1:]):
            found.append(each)
    return Closed(found, 0, closed.exhausted)


def _open_share(panel_set: PanelSet, placed: Placement) -> float:
    """Share of the needed flanks of a placement that meet nothing."""
    needed = sum(int(panel_set.plates[row].needed.sum()) for row in placed.rows)
    return sum(len(rows) for rows in panel_set.open(placed).values()) / max(needed, 1)


def _complete(panel_set: PanelSet, placed: Placement, left: frozenset[int]) -> bool:
    """Whether a placement holds all panels, and all their flanks meet others."""
    return len(placed.rows) == len(left) and not any(len(rows) for rows in panel_set.open(placed).values())


def _best(panel_set: PanelSet, placements: list[Placement]) -> Placement:
    """The placement in which the most flanks meet; of several the one whose edges end together, then the one whose panels press least.

    Of placements that are equal in this, too, the smallest one.
    """
    most = max(_met(panel_set, each) for each in placements)
    equal = [each for each in placements if _met(panel_set, each) == most]
    if len(equal) == 1:
        return equal[0]
    together = [aligned_ends(panel_set, each) for each in equal]
    equal = [each for each, ends in zip(equal, together, strict=True) if ends > max(together) - 0.5]
    if len(equal) == 1:
        return equal[0]
    drawn = [plate.thickness for plate in panel_set.plates]
    least = SETTINGS.max_relief * min(drawn)
    pressing = [relief_needed(panel_set, least_squares_placement(panel_set, each), drawn, 0.0, least) for each in equal]
    return equal[min(range(len(equal)), key=lambda k: (round(pressing[k], 2), extent(panel_set, equal[k])))]


def _rivals(panel_set: PanelSet, closed: Closed, name: str) -> list[str]:
    """Why the best of the placements that were found may be wrong."""
    if closed.open_lines:
        return [f"no way was found to put panels round {name} so that every flank meets another"]
    if len(closed.placements) > 1:
        moved = _moved(panel_set, *closed.placements[:2])
        which = (
            f": {panel_names([plate.name for plate in panel_set.plates], moved)} can be elsewhere or otherwise"
            if moved
            else ""
        )
        return [f"panels fit together in more than one way, round {name}{which}"]
    return [] if closed.exhausted else [f"not every other way to put panels round {name} was tried"]


def _moved(panel_set: PanelSet, one: Placement, other: Placement) -> list[int]:
    """Panels of the one placement where the other has no panel of their kind in their place, or its mirror image has none."""
    flip = np.diag([1.0, 1.0, -1.0])
    found: list[int] | None = None
    for turns, moves in ((other.turns, other.moves), (flip @ other.turns @ flip, other.moves @ flip)):
        taken: set[tuple[float, ...]] = set()
        for row, turn, move in zip(other.rows, turns, moves, strict=True):
            kind = panel_set.plates[row].kind
            taken.add((kind, *np.round(panel_set.trace(kind, turn[None], move[None])[0], 1).tolist()))
        moved = []
        for row, turn, move in zip(one.rows, one.turns, one.moves, strict=True):
            kind = panel_set.plates[row].kind
            if (kind, *np.round(panel_set.trace(kind, turn[None], move[None])[0], 1).tolist()) not in taken:
                moved.append(row)
        if found is None or len(moved) < len(found):
            found = moved
    return found or []


def _met(panel_set: PanelSet, placed: Placement) -> int:
    """How many pairs of flanks meet."""
    return sum(len(pairs) for *_, pairs in panel_set.met(placed)[0])


def _trimmed(panel_set: PanelSet, body: Placement, known: int) -> Placement:
    """Body without the panels that hardly meet the others, worst first; the first ones are known and stay."""
    while len(body.rows) > max(2, known):
        _, flags = panel_set.met(body)
        share = {row: flags[row].mean() for row in body.rows[known:]}
        worst = min(share, key=lambda row: share[row])
        if share[worst] >= SETTINGS.min_met_share:
            return body
        body = without_panel(body, worst)
    return body


def panel_names(names: Sequence[str], rows: Sequence[int]) -> str:
    """Names of some panels, the first few of them."""
    shown = ", ".join(names[row] for row in rows[:6])
    return shown + (f" and {len(rows) - 6} more" if len(rows) > 6 else "")
