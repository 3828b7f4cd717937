"""Parameters of putting a cutting sheet together."""

from __future__ import annotations

from dataclasses import dataclass

from wiggleroom.mating.beam_search import Effort


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
        A panel that overlaps others still when outlines are relieved by this share of the thickness is taken out again.
    max_burn : float > 0 [mm]
        Half the width of the widest usual cut: where the burn is not known, at most this much is taken off for it.
    rounding : float > 0 [mm]
        Relief that only the rounding of coordinates asks for.
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
    max_burn: float = 0.15
    rounding: float = 0.0025
    body_distance: float = 20.0
    max_scored: int = 400_000
    aligned_share: float = 0.3


SETTINGS = SheetSettings()
