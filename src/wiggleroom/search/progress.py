"""What a search tells of its progress."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """What a progress callback is told: stage ("pairs", "free spaces", "solve" or "check"), round, iteration and objective [mm]."""

    stage: str
    round: int = 0
    iteration: int = 0
    objective: float = 0.0


def silent(_: Progress) -> None:
    """No-op progress callback."""
