"""Placements that a person knows: joints given by two edges, and panels given by where they belong."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wiggleroom.errors import InputError
from wiggleroom.mating.congruence import congruent
from wiggleroom.mating.contact import MET_TOLERANCE
from wiggleroom.mating.edge_constraints import EdgeConstraints, JoinedEdges
from wiggleroom.mating.flanks import flank_rows
from wiggleroom.mating.pair_poses import PairPoseTable
from wiggleroom.mating.panel_set import PanelSet, Placement

MAX_STARTS = 16
"""At most this many ways to fold what is joined are tried."""


def known_starts(
    panel_set: PanelSet, constraints: EdgeConstraints, free: frozenset[int], table: PairPoseTable
) -> list[Placement]:
    """Placements of the panels among `free` of which something was said that hangs together; empty where nothing was.

    Every join can be folded in several ways: each of them is one placement, those that are mirror images once.

    Raises
    ------
    InputError
        If two edges of a join do not fit each other, or panels overlap where hints put them.
    """
    said = [pose.panels for pose in constraints.poses] + [join.panels for join in constraints.joins]
    pairs = [panels for panels in said if set(panels) <= free]
    if not pairs:
        return []
    states = [panel_set.start(pairs[0][0])]
    while True:
        placed = set(states[0].rows)
        reached = next((pair for pair in pairs if len(placed & set(pair)) == 1), None)
        if reached is None:
            return states[:MAX_STARTS]
        old, new = reached if reached[0] in placed else reached[::-1]
        grown = [child for state in states for child in _grown(panel_set, constraints, state, old, new, table)]
        if not grown:
            raise InputError(_why_not(panel_set, constraints, old, new, table))
        states = _distinct(panel_set, grown)


def _grown(
    panel_set: PanelSet, constraints: EdgeConstraints, state: Placement, old: int, new: int, table: PairPoseTable
) -> list[Placement]:
    """Placements with one panel more, joined to a placed one as was said."""
    place = state.rows.index(old)
    given = next((pose for pose in constraints.poses if set(pose.panels) == {old, new}), None)
    if given is not None:
        turn, move = given.turn, given.move
        if given.panels[0] == new:
            turn, move = turn.T, -turn.T @ move
        options = [(turn, move)]
    else:
        poses = table.between(old, new)
        options = list(zip(poses.turns, poses.moves, strict=True))
    found = []
    for inner, shift in options:
        turn, move = state.turns[place] @ inner, state.turns[place] @ shift + state.moves[place]
        if panel_set.overlaps(state, new, turn, move):
            continue
        met = panel_set.flanks_met(state, new, turn, move)
        others = EdgeConstraints(constraints.joins, constraints.flush) if given is None else EdgeConstraints()
        if others.allow(state.rows, state.turns, state.moves, new, turn, move, met):
            turns, moves = np.concatenate([state.turns, turn[None]]), np.concatenate([state.moves, move[None]])
            count = sum(own.bit_count() for own, _ in met.values())
            found.append(Placement((*state.rows, new), turns, moves, state.met + count, {}))
    return found


def _distinct(panel_set: PanelSet, states: Sequence[Placement]) -> list[Placement]:
    """Placements of which none is congruent to another or a mirror image of one; the most flanks that meet first."""
    found: list[Placement] = []
    kinds = [plate.kind for plate in panel_set.plates]
    for state in sorted(states, key=lambda each: -each.met):
        panels = [
            [(kinds[row], turn, move) for row, turn, move in zip(each.rows, each.turns, each.moves, strict=True)]
            for each in (state, *found)
        ]
        tolerance = MET_TOLERANCE * panel_set.tolerance
        if not any(congruent(panel_set.told_isometries, panels[0], other, tolerance) for other in panels[1:]):
            found.append(state)
    return found


def _why_not(panel_set: PanelSet, constraints: EdgeConstraints, old: int, new: int, table: PairPoseTable) -> str:
    """One line about a join that cannot hold, or a pose at which panels overlap."""
    names = [plate.name for plate in panel_set.plates]
    if any(set(pose.panels) == {old, new} for pose in constraints.poses):
        row = next(pose.panels[1] for pose in constraints.poses if set(pose.panels) == {old, new})
        return f'panel "{names[row]}" overlaps others where the hint puts it; move it'
    join = constraints.between(old, new)[0]
    if len(table.between(old, new).turns):
        return f"{join.words} fit each other, but not together with what else was said; leave out one of the hints"
    return f"{join.words} do not fit; {_fitting(panel_set, join, table)}"


def _fitting(panel_set: PanelSet, join: JoinedEdges, table: PairPoseTable) -> str:
    """Which edges would fit the first one of a join."""
    names = [plate.name for plate in panel_set.plates]
    row, edge = join.panels[0], join.flanks[0]
    found = []
    for other in range(len(names)):
        poses = table.unjoined(row, other) if other != row else None
        if poses is None:
            continue
        for met, own in poses.met:
            if (met & edge).bit_count() >= max(1, edge.bit_count() // 2):
                plate = panel_set.plates[other]
                x, y = plate.middle[list(flank_rows(own))].mean(axis=0) + plate.centre
                found.append(f"{names[other]}@{x:.4g},{y:.4g}")
    found = list(dict.fromkeys(found))
    if not found:
        return f"nothing fits {join.words.split(' and ')[0]}: name another edge, or the edge by a point of it"
    return f"what fits {join.words.split(' and ')[0]} is {', '.join(found[:4])}"


def with_fixed_plates(
    panel_set: PanelSet, bodies: Sequence[Placement], constraints: EdgeConstraints
) -> tuple[list[Placement], list[int]]:
    """Bodies put together where the pose of a panel of the one is given in the frame of the other, and the rows of panels in no body.

    Raises
    ------
    InputError
        If a panel overlaps others where it is put.
    """
    result = list(bodies)
    for pose in constraints.poses:
        homes = []
        for row in pose.panels:
            if not any(row in body.rows for body in result):
                result.append(panel_set.start(row))
            homes.append(next(body for body in result if row in body.rows))
        base, guest = homes
        if base is guest:
            continue  # both stood from the start of the search
        frame, row = base.rows.index(pose.panels[0]), guest.rows.index(pose.panels[1])
        turn = base.turns[frame] @ pose.turn @ guest.turns[row].T
        move = base.turns[frame] @ pose.move + base.moves[frame] - turn @ guest.moves[row]
        turns, moves = turn @ guest.turns, guest.moves @ turn.T + move
        for k, other in enumerate(guest.rows):
            if panel_set.overlaps(base, other, turns[k], moves[k]):
                message = f'panel "{panel_set.plates[other].name}" overlaps others where the hint puts it; move it'
                raise InputError(message)
        result = [body for body in result if body is not guest and body is not base]
        whole = np.concatenate([base.turns, turns]), np.concatenate([base.moves, moves])
        result.append(Placement((*base.rows, *guest.rows), *whole, base.met + guest.met, {}))
    result.sort(key=lambda body: -len(body.rows))
    placed = {row for body in result for row in body.rows}
    return result, [row for row in range(len(panel_set.plates)) if row not in placed]
