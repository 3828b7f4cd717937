"""The list of parts, to the letter of the format `wiggleroom.parts/1`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

from wiggleroom.assembly.inventory import InventoryRow
from wiggleroom.schema.listing_schema import PartListing, PartsResult


def parts_result(
    rows: Sequence[InventoryRow],
    notes: Sequence[str],
    findings: Sequence[str],
    command: str = "",
    *,
    size: tuple[float, float],
) -> PartsResult:
    """Everything `parts --json` says; lengths in mm."""
    return PartsResult(
        parts=[PartListing(**asdict(row)) for row in rows],
        size=size,
        notes=list(notes),
        findings=list(findings),
        command=command,
    )
