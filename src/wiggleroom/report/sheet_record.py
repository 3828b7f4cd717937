"""A cutting sheet put together, as JSON and as a page on the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wiggleroom.mating.assembled_sheet import AssembledSheet

if TYPE_CHECKING:
    from rich.console import Group

FORMAT = "wiggleroom.assemble/1"


def assemble_record(found: AssembledSheet, *, command: str = "") -> dict[str, Any]:
    """Everything `assemble --json` says; lengths in mm, on the sheet x and y as drawn, y up."""
    names = [plate.name for plate in found.plates]
    return {
        "format": FORMAT,
        "certainty": "sure" if found.sure else "not sure",
        "doubts": list(found.doubts),
        "panels": len(names),
        "placed": sum(len(body.rows) for body in found.bodies),
        "bodies": [[names[row] for row in body.rows] for body in found.bodies],
        "joints": [
            {
                "name": f"J{k}",
                "panels": [names[row] for row in joint.panels],
                "flanks": len(joint.flanks),
                "on_sheet": [_mean(found, row, joint.flanks[:, side]) for side, row in enumerate(joint.panels)],
            }
            for k, joint in enumerate(found.joints, 1)
        ],
        "unmatched": [
            {"panel": names[row], "on_sheet": on_sheet(found, row, flanks).round(4).tolist()}
            for row, flanks in found.open.items()
        ],
        "unplaced": [names[row] for row in found.unplaced],
        "burn": found.burn,
        "relief": found.relief,
        "notes": list(found.notes),
        "command": command,
    }


def on_sheet(found: AssembledSheet, row: int, flanks: np.ndarray) -> np.ndarray:
    """Midpoints (n, 2) [mm] of flanks where the sheet shows them."""
    plate = found.plates[row]
    return plate.middle[flanks] + plate.centre


def _mean(found: AssembledSheet, row: int, flanks: np.ndarray) -> list[float]:
    return [round(float(x), 4) for x in on_sheet(found, row, flanks).mean(axis=0)]


def sheet_headline(found: AssembledSheet) -> str:
    """How much was placed, and how sure that is, in one line."""
    placed = sum(len(body.rows) for body in found.bodies)
    bodies = f" in {len(found.bodies)} bodies" if len(found.bodies) > 1 else ""
    return f"{placed} of {len(found.plates)} panels placed{bodies}, {'sure' if found.sure else 'not sure'}"


def sheet_page(found: AssembledSheet) -> Group:
    """Headline, doubts and a table of joints."""
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    names = [plate.name for plate in found.plates]
    table = Table("joint", "panels", "flanks", box=None)
    for k, joint in enumerate(found.joints, 1):
        table.add_row(f"J{k}", " - ".join(names[row] for row in joint.panels), str(len(joint.flanks)))
    doubts = [Text(f"  because: {doubt}") for doubt in found.doubts]
    return Group(Text(sheet_headline(found), style="bold"), *doubts, table)
