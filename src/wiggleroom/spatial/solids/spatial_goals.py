"""What is asked of a spatial assembly, in the words of files and of Python."""

from __future__ import annotations

from collections.abc import Sequence

from wiggleroom.drawing.model import Goal, Pull, Turn
from wiggleroom.errors import InputError
from wiggleroom.spatial.solids.spatial_model import SpatialGoal, SpatialPull, SpatialTurn, Weight

AnyGoal = Goal | SpatialGoal


def spatial_goals(goals: AnyGoal | Sequence[AnyGoal] | None) -> tuple[SpatialGoal, ...] | None:
    """Goals with three numbers each; `Pull` and `Turn` of the plane may carry them.

    Raises
    ------
    InputError
        If a goal belongs to the plane.

    Examples
    --------
    >>> spatial_goals(Pull("lid", (0, 0, 1)))  # doctest: +ELLIPSIS
    (SpatialPull(part='lid', direction=(0.0, 0.0, 1.0), ...
    """
    if goals is None:
        return None
    return tuple(_spatial(g) for g in (goals if isinstance(goals, Sequence) else (goals,)))


def _spatial(goal: AnyGoal) -> SpatialGoal:
    if isinstance(goal, SpatialPull | SpatialTurn | Weight):
        return goal
    if isinstance(goal, Pull):
        point = None if goal.point is None else _three(goal.point, f'pull of "{goal.part}": point')
        return SpatialPull(goal.part, _three(goal.direction, f'pull of "{goal.part}": direction'), point, goal.weight)
    if isinstance(goal, Turn):
        return SpatialTurn(goal.part, _three(goal.sense, f'turn of "{goal.part}"'), goal.weight)
    message = f"{type(goal).__name__} is a question about drawings; in space ask with Pull or Turn"
    raise InputError(message)


def _three(values: object, what: str) -> tuple[float, float, float]:
    if isinstance(values, str) or not isinstance(values, Sequence) or len(values) != 3:
        message = f"{what} is {values}; in space it must be three numbers"
        raise InputError(message)
    x, y, z = (float(v) for v in values)
    return x, y, z
