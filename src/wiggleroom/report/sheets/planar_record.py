"""A sheet put together in the plane, as JSON and as a page on the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wiggleroom.mating.planar_assembly import PlanarAssembly
from wiggleroom.report.sheets.sheet_record import sheet_point
from wiggleroom.schema.listing_schema import AssembleResult, SheetJointEntry, UnmatchedEntry

if TYPE_CHECKING:
    from rich.console import Group


def planar_record(found: PlanarAssembly, *, command: str = "") -> AssembleResult:
    """Everything `assemble --json` says in the plane; lengths in mm, on the sheet x and y as drawn, y up."""
    names = found.names
    joints = [
        SheetJointEntry(
            name=f"J{k}",
            panels=(names[joint.parts[0]], names[joint.parts[1]]),
            length=round(joint.length, 4),
            on_sheet=(sheet_point(joint.on_sheet[0]), sheet_point(joint.on_sheet[1])),
        )
        for k, joint in enumerate(found.joints, 1)
    ]
    return AssembleResult(
        certainty="sure" if found.sure else "not sure",
        doubts=list(found.doubts),
        panels=len(names),
        placed=sum(len(body) for body in found.bodies),
        bodies=[[names[row] for row in body] for body in found.bodies],
        joints=joints,
        unmatched=[
            UnmatchedEntry(panel=names[row], on_sheet=[sheet_point(point) for point in points])
            for row, points in found.open.items()
        ],
        unplaced=[names[row] for row in found.unplaced],
        loose=[],
        burn=found.burn,
        relief=found.relief,
        misfits=[],
        notes=list(found.notes),
        command=command,
    )


def planar_headline(found: PlanarAssembly) -> str:
    """How much was placed, and how sure that is, in one line."""
    placed = sum(len(body) for body in found.bodies)
    bodies = f" in {len(found.bodies)} bodies" if len(found.bodies) > 1 else ""
    return f"{placed} of {len(found.names)} parts placed in the plane{bodies}, {'sure' if found.sure else 'not sure'}"


def planar_page(found: PlanarAssembly) -> Group:
    """Headline, doubts and a table of joints."""
    from rich.console import Group
    from rich.table import Column, Table
    from rich.text import Text

    table = Table(
        Column("joint", no_wrap=True), Column("parts", overflow="fold"), Column("length [mm]", no_wrap=True), box=None
    )
    for k, joint in enumerate(found.joints, 1):
        table.add_row(f"J{k}", " - ".join(found.names[row] for row in joint.parts), f"{joint.length:.4g}")
    doubts = [Text(f"  because: {doubt}") for doubt in found.doubts]
    return Group(Text(planar_headline(found), style="bold"), *doubts, table)
