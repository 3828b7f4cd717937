"""A cutting sheet put together, as JSON and as a page on the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wiggleroom.mating.assembled_sheet import AssembledSheet
from wiggleroom.schema.listing_schema import AssembleResult, MisfitEntry, SheetJointEntry, UnmatchedEntry

if TYPE_CHECKING:
    from rich.console import Group


def assemble_record(found: AssembledSheet, *, command: str = "") -> AssembleResult:
    """Everything `assemble --json` says; lengths in mm, on the sheet x and y as drawn, y up."""
    names = [plate.name for plate in found.plates]
    joints = []
    for k, joint in enumerate(found.joints, 1):
        a, b = joint.panels
        places = (_mean(found, a, joint.flanks[:, 0]), _mean(found, b, joint.flanks[:, 1]))
        joints.append(
            SheetJointEntry(name=f"J{k}", panels=(names[a], names[b]), flanks=len(joint.flanks), on_sheet=places)
        )
    return AssembleResult(
        certainty="sure" if found.sure else "not sure",
        doubts=list(found.reasons),
        panels=len(names),
        placed=sum(len(body.rows) for body in found.bodies),
        bodies=[[names[row] for row in body.rows] for body in found.bodies],
        joints=joints,
        unmatched=[
            UnmatchedEntry(panel=names[row], on_sheet=[sheet_point(point) for point in on_sheet(found, row, flanks)])
            for row, flanks in found.open.items()
        ],
        unplaced=[names[row] for row in found.unplaced],
        loose=[names[row] for row in found.loose],
        burn=found.burn,
        relief=found.relief,
        misfits=[
            MisfitEntry(
                kind=each.kind,
                panel=names[each.panels[0]],
                slots_of=names[each.panels[1]],
                size=each.size,
                room=each.room,
                excess=round(each.excess, 4),
                places=each.places,
            )
            for each in found.misfits
        ],
        notes=list(found.notes),
        command=command,
    )


def on_sheet(found: AssembledSheet, row: int, flanks: np.ndarray) -> np.ndarray:
    """Midpoints (n, 2) [mm] of flanks where the sheet shows them."""
    plate = found.plates[row]
    return plate.middle[flanks] + plate.centre


def sheet_point(point: np.ndarray) -> tuple[float, float]:
    """A place on the sheet [mm], rounded as results are."""
    return round(float(point[0]), 4), round(float(point[1]), 4)


def _mean(found: AssembledSheet, row: int, flanks: np.ndarray) -> tuple[float, float]:
    return sheet_point(on_sheet(found, row, flanks).mean(axis=0))


def sheet_headline(found: AssembledSheet) -> str:
    """How much was placed, and how sure that is, in one line."""
    placed = sum(len(body.rows) for body in found.bodies)
    bodies = f" in {len(found.bodies)} bodies" if len(found.bodies) > 1 else ""
    return f"{placed} of {len(found.plates)} panels placed{bodies}, {'sure' if found.sure else 'not sure'}"


def sheet_page(found: AssembledSheet) -> Group:
    """Headline, doubts and a table of joints."""
    from rich.console import Group
    from rich.table import Column, Table
    from rich.text import Text

    names = [plate.name for plate in found.plates]
    table = Table(
        Column("joint", no_wrap=True), Column("panels", overflow="fold"), Column("flanks", no_wrap=True), box=None
    )
    for k, joint in enumerate(found.joints, 1):
        table.add_row(f"J{k}", " - ".join(names[row] for row in joint.panels), str(len(joint.flanks)))
    doubts = [Text(f"  because: {doubt}") for doubt in found.reasons]
    return Group(Text(sheet_headline(found), style="bold"), *doubts, table)
