"""A cutting sheet put together, as the page reads it: panels and edges on the sheet, joints, and the solids."""

from __future__ import annotations

import numpy as np

from wiggleroom.mating.assembled_sheet import AssembledSheet
from wiggleroom.mating.flanks import SheetPlate
from wiggleroom.mating.hints import EdgeReference, Hints, write_hints
from wiggleroom.mating.plates_writer import write_plates
from wiggleroom.mating.refinement import plate_solid
from wiggleroom.report.page.solid_page import packed
from wiggleroom.report.sheets.sheet_record import assemble_record, sheet_headline, sheet_point
from wiggleroom.schema.fields import Point
from wiggleroom.schema.replies import Assembled, SheetEdge, SheetPanel, Solids, SolidShape


def assembled_message(found: AssembledSheet, hints: Hints, thickness: float, command: str) -> Assembled:
    """Everything the page shows of a sheet; `thickness` is that of the material [mm]."""
    record = assemble_record(found, command=command)
    names = [plate.name for plate in found.plates]
    placed = [row for body in found.bodies for row in body.rows]
    return Assembled(
        certainty=record.certainty,
        headline=sheet_headline(found),
        doubts=record.doubts,
        notes=record.notes,
        thickness=thickness,
        burn=found.burn,
        panels=[_panel(found, row) for row in range(len(names))],
        joints=record.joints,
        unmatched=record.unmatched,
        placed=[names[row] for row in placed],
        solids=_solids(found),
        file=write_plates(found) if placed else "",
        toml=write_hints(hints),
        command=command,
    )


def _panel(found: AssembledSheet, row: int) -> SheetPanel:
    plate = found.plates[row]
    rings = [
        [sheet_point(point + plate.centre) for point in np.asarray(ring.coords)[:-1]]
        for ring in (plate.polygon.exterior, *plate.polygon.interiors)
    ]
    state = "placed" if row not in found.unplaced else "loose" if row in found.loose else "waiting"
    return SheetPanel(plate.name, rings, sheet_point(plate.centre), state, _edges(found, row, plate))  # type: ignore[arg-type]


def _edges(found: AssembledSheet, row: int, plate: SheetPlate) -> list[SheetEdge]:
    """Rows of fingers, slots and holes of a panel that a partner could hold."""
    joints: dict[int, set[str]] = {}
    for k, joint in enumerate(found.joints, 1):
        for side, panel in enumerate(joint.panels):
            if panel == row:
                for flank in joint.flanks[:, side].tolist():
                    joints.setdefault(flank, set()).add(f"J{k}")
    unmet = set(found.open.get(row, np.zeros(0, dtype=int)).tolist())
    edges = []
    for number in np.unique(plate.joint_rows).tolist():
        flanks = np.flatnonzero(plate.joint_rows == number)
        held = sorted({name for flank in flanks.tolist() for name in joints.get(flank, ())}, key=_number)
        if not plate.needed[flanks].any() and not held:
            continue  # a lone step of the outline
        points = plate.middle[flanks] + plate.centre
        along = points @ plate.inward[flanks[0]]
        ends = points[int(np.argmin(along))], points[int(np.argmax(along))]
        middle: Point = (round(float(ends[0][0] + ends[1][0]) / 2, 2), round(float(ends[0][1] + ends[1][1]) / 2, 2))
        edges.append(
            SheetEdge(
                reference=str(EdgeReference(plate.name, point=middle)),
                ends=(sheet_point(ends[0]), sheet_point(ends[1])),
                joints=held,
                open=len(unmet & set(flanks.tolist())),
            )
        )
    return edges


def _number(name: str) -> int:
    return int(name[1:])


def _solids(found: AssembledSheet) -> Solids:
    """The placed plates, each about its centre."""
    shapes, reference = [], []
    for body in found.bodies:
        for row, turn, move in zip(body.rows, body.turns, body.moves, strict=True):
            mesh = plate_solid(found.plates[row], found.thickness[row], turn, np.zeros(3), found.relief).to_mesh()
            vertices, triangles = np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts)
            shapes.append(SolidShape(packed(vertices, "<f4"), packed(triangles, "<u4")))
            x, y, z = move.tolist()
            reference.append((x, y, z))
    none = [(0.0, 0.0, 0.0)] * len(shapes)  # a sheet is shown put together
    return Solids(shapes=shapes, of=list(range(len(shapes))), reference=reference, aside=none)
