"""Placements that a person knows: joints given by two edges, and panels given by where they belong."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wiggleroom.errors import InputError
from wiggleroom.mating.beam_search import BeamState, Placement
from wiggleroom.mating.candidates import line_fits
from wiggleroom.mating.flanks import FlankLine, SheetPlate
from wiggleroom.mating.hints import Hints, Join

_AXES = {"left": (0, -1), "right": (0, 1), "bottom": (1, -1), "top": (1, 1)}


def joined_start(bench: BeamState, hints: Hints, free: frozenset[int]) -> Placement | None:
    """Panels placed by the joins among `free` that hang together, or None where there is none.

    Raises
    ------
    InputError
        If two edges of a join do not fit each other.
    """
    names = [plate.name for plate in bench.plates]
    waiting = [join for join in hints.joins if {names.index(name) for name in join.panels} <= free]
    if not waiting:
        return None
    state = bench.start(names.index(waiting[0].panels[0]))
    while True:
        placed = {names[row] for row in state.rows}
        join = next((j for j in waiting if len(placed & set(j.panels)) == 1), None)
        if join is None:
            return state
        if join.panels[0] not in placed:
            join = Join(join.panels[::-1], join.sides[::-1])
        state = _joined(bench, state, join, names)


def _joined(bench: BeamState, state: Placement, join: Join, names: Sequence[str]) -> Placement:
    """One panel more, laid on the other's edge where most flanks meet."""
    a, b = (names.index(name) for name in join.panels)
    one, other = bench.plates[a], bench.plates[b]
    place = state.rows.index(a)
    options = []
    for line in _lines(one, join.sides[0]):
        for partner in _lines(other, join.sides[1]):
            for fit in line_fits(line, partner, one.thickness, other.thickness):
                turn = state.turns[place] @ fit.turn
                move = state.turns[place] @ fit.move + state.moves[place]
                if not bench.overlaps(state, b, turn, move):
                    options.append((fit.votes, turn, move))
    if not options:
        message = f"{join.panels[0]}:{join.sides[0]} and {join.panels[1]}:{join.sides[1]} do not fit; name edges whose fingers do"
        raise InputError(message)
    votes, turn, move = max(options, key=lambda option: option[0])
    turns, moves = np.concatenate([state.turns, turn[None]]), np.concatenate([state.moves, move[None]])
    return Placement((*state.rows, b), turns, moves, state.met + votes, {})


def _lines(plate: SheetPlate, side: str) -> list[FlankLine]:
    """Lines of flanks along one side of a panel's box."""
    axis, sign = _AXES[side]
    bounds = plate.polygon.bounds
    edge = bounds[axis + 2] if sign > 0 else bounds[axis]
    lines = []
    for line in plate.lines:
        point = line.offset * line.across
        if abs(line.along[axis]) < 0.1 and abs(point[axis] - edge) < 2.0 * plate.thickness:
            lines.append(line)
    return lines


def with_fixed_plates(bench: BeamState, bodies: Sequence[Placement], hints: Hints) -> tuple[list[Placement], list[int]]:
    """Bodies with the panels added whose place is given, and the rows of panels in no body.

    Raises
    ------
    InputError
        If the panel in whose frame a place is given is not placed itself.
    """
    names = [plate.name for plate in bench.plates]
    result = list(bodies)
    for plate in hints.plates:
        frame, row = names.index(plate.frame), names.index(plate.panel)
        home = next((k for k, body in enumerate(result) if frame in body.rows), None)
        if home is None:
            result.append(bench.start(frame))
            home = len(result) - 1
        body = result[home]
        place = body.rows.index(frame)
        right, up = (np.array(way) / np.linalg.norm(way) for way in (plate.right, plate.up))
        turn = body.turns[place] @ np.column_stack([right, up, np.cross(right, up)])
        move = body.turns[place] @ np.array(plate.centre) + body.moves[place]
        if bench.overlaps(body, row, turn, move):
            message = f'panel "{plate.panel}" overlaps others where the hint puts it; move it'
            raise InputError(message)
        turns, moves = np.concatenate([body.turns, turn[None]]), np.concatenate([body.moves, move[None]])
        result[home] = Placement((*body.rows, row), turns, moves, body.met, {})
    placed = {row for body in result for row in body.rows}
    return result, [row for row in range(len(names)) if row not in placed]
