"""What plans ask of an assembly, in the plane and in space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol, Self

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.disassembly_sequence import Disassembly
from wiggleroom.planning.gravity import FallingBodies, Gravity
from wiggleroom.planning.steps import Step


class PlanGeometry(Protocol):
    """An assembly in which something stands and no parts touch."""

    assembly: Assembly

    @property
    def clearance(self) -> float:
        """Typical clearance between neighbours [mm]."""

    def made(self, gap: float | None = None, inward: Mapping[str, float] | None = None) -> Self | None:
        """The assembly with another gap, or with boundaries of parts moved inward [mm]; None where parts touch or cannot be made."""

    def taken_apart(self, targets: tuple[str, ...], weight: Gravity | None, context: Context) -> Disassembly:
        """Its parts taken away one after the other until all targets have left, or as long as any leave; which first may hang on weight."""

    def fitted(self, steps: Sequence[Step], context: Context = UNLIMITED) -> tuple[Step, ...]:
        """Steps that do the same with more room, where paths can be fitted; not all of them need be free."""

    def collision(self, step: Step) -> tuple[str, str] | None:
        """Two parts that are in each other's way in a step; None where it is free."""

    def measured(self, step: Step) -> Step:
        """The step with its clearance, room for errors, axis and held parts."""

    def falling(self) -> FallingBodies:
        """Its bodies, as gravity asks for them."""
