"""Pair models by name: what stands for the free space of two parts."""

from __future__ import annotations

from dataclasses import dataclass

from wiggleroom.errors import InputError

TURNING_POINTS = ("reference", "joint")


@dataclass(frozen=True)
class Walls:
    """Exact contacts: cells that never overlap, rebuilt where they end before the parts do."""

    name = "walls"


@dataclass(frozen=True)
class Hull:
    """The paper's model: convex hull of the free slices at the angles nc, 0 and pc.

    Source: Mind the Gap, sections 4.1 to 4.3.

    Parameters
    ----------
    about : str
        The point about which B turns in place until it touches: its "reference" point or one in the "joint". The paper leaves it open.
    slices : int
        3, as in the paper, or more: then evenly spaced over all angles that B can reach, shifting as it turns.
    rounds : int
        Number of times the hulls are computed; from the second time on round the last motion (the paper's outlook).
    """

    about: str = "reference"
    slices: int = 3
    rounds: int = 1
    name = "hull"

    def __post_init__(self) -> None:
        """Check that the numbers make sense."""
        wrong = (
            [] if self.about in TURNING_POINTS else [f'hull about "{self.about}": it is {" or ".join(TURNING_POINTS)}']
        )
        if self.slices < 3:
            wrong.append(f"hull of {self.slices} slices: 3 or more make a hull")
        if self.rounds < 1:
            wrong.append(f"hull in {self.rounds} rounds: 1 or more")
        if wrong:
            raise InputError(wrong)


@dataclass(frozen=True)
class HalfPlane:
    """PuzzleFlex: distances of corners from lines of edges, linearised; linear programs instead of a nonlinear one.

    Source: Lensgraf and others, "PuzzleFlex: kinematic motion of chains with loose joints" (ICRA 2020), as far as it is public.

    Parameters
    ----------
    iterated : bool
        True: small steps, linearised and corrected after each, until nothing is gained. False: one linear program at rest, which
        overestimates motions with turns.
    """

    iterated: bool = True
    name = "halfplane"


PairModel = Walls | Hull | HalfPlane

MODELS: dict[str, type[Walls] | type[Hull] | type[HalfPlane]] = {"walls": Walls, "hull": Hull, "halfplane": HalfPlane}
"""Registry: name and settings of each pair model."""


def model_named(model: str | PairModel) -> PairModel:
    """Settings of a model; a name means its usual ones.

    Raises
    ------
    InputError
        If there is no model of that name.

    Examples
    --------
    >>> model_named("hull")
    Hull(about='reference', slices=3, rounds=1)
    """
    if isinstance(model, Walls | Hull | HalfPlane):
        return model
    if model not in MODELS:
        finding = f'there is no model "{model}": choose {", ".join(MODELS)}'
        raise InputError(finding)
    return MODELS[model]()
