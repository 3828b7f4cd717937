"""Answers to `assemble` and `lay`: a cutting sheet put together, with what was clicked on it as hints."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

from wiggleroom.app.command import reading_options
from wiggleroom.app.open_requests import saved_name, temporary_file
from wiggleroom.app.reporter import Reporter, on_the_page
from wiggleroom.context import Context
from wiggleroom.errors import InputError
from wiggleroom.mating.assembled_sheet import AssembledSheet, assemble_sheet
from wiggleroom.mating.cutting_sheet import CuttingSheet, read_sheet
from wiggleroom.mating.hints import EdgePair, FixedPlate, Hints, edge_reference
from wiggleroom.mating.loose_panel_poses import laid_plates
from wiggleroom.report.page.sheet_messages import assembled_message
from wiggleroom.schema.replies import LayReply
from wiggleroom.schema.requests import AssembleRequest, LayRequest, PlateHint, SheetHints, SheetRequest

if TYPE_CHECKING:
    from wiggleroom.app.document import Document
    from wiggleroom.app.open_requests import File


def assemble(document: Document, request: AssembleRequest, out: Reporter) -> None:
    """The panels of the sheet that is open put together in space."""
    found, hints = _assembled(document.file, request, out)
    reply = assembled_message(found, hints, request.thickness, _command(document.file, request))
    reply.doubts = [on_the_page(doubt) for doubt in reply.doubts]
    reply.notes = [on_the_page(line) for line in reply.notes]
    out.reply(reply)


def lay(document: Document, request: LayRequest, out: Reporter) -> None:
    """Where a loose panel could lie that touches another one."""
    found, _ = _assembled(document.file, request, out)
    poses = laid_plates(found, request.panel, request.at, request.onto, request.there, context=Context(stop=out.stop))
    out.check()
    out.reply(
        LayReply(
            panel=request.panel,
            poses=[PlateHint(pose.panel, pose.frame, pose.centre, pose.right, pose.up) for pose in poses],
        )
    )


def _assembled(file: File, request: SheetRequest, out: Reporter) -> tuple[AssembledSheet, Hints]:
    sheet = _sheet(file)
    hints = _hints(request.hints, request.thickness, request.burn)
    context = Context(stop=out.stop, progress=lambda count: out.counted(count, len(sheet.panels)))
    found = assemble_sheet(sheet, request.thickness, burn=request.burn, hints=hints, context=context)
    out.check()
    return found, hints


def _sheet(file: File) -> CuttingSheet:
    """The open drawing read as a sheet, in a folder that is gone afterwards."""
    with temporary_file(file.name) as path:
        path.write_bytes(file.data)
        return read_sheet(path, unit=file.unit, options=file.options)


def _hints(said: SheetHints, thickness: float, burn: float | None) -> Hints:
    """Hints of a request.

    Raises
    ------
    InputError
        If a text names no edge.
    """
    pairs: dict[str, list[EdgePair]] = {"join": [], "flush": []}
    for key, texts in (("join", said.join), ("flush", said.flush)):
        for one, other in texts:
            a, b = edge_reference(one), edge_reference(other)
            if a is None or b is None:
                message = f'{key}: "{one}" and "{other}" must both be edges, such as "lid:top" or "lid@12.5,40"'
                raise InputError(message)
            pairs[key].append((a, b))
    return Hints(
        thickness=thickness,
        burn=burn,
        groups=tuple(tuple(group) for group in said.groups),
        joins=tuple(pairs["join"]),
        flush=tuple(pairs["flush"]),
        plates=tuple(FixedPlate(p.panel, p.centre, p.right, p.up, p.frame) for p in said.plate),
        skip=tuple(said.skip),
    )


def _command(file: File, request: SheetRequest) -> str:
    """The command that makes the same assembly file; hints go in the file that the page saves."""
    said = ["wiggleroom", "assemble", file.path, "--thickness", f"{request.thickness:g}"]
    if request.burn is not None:
        said += ["--burn", f"{request.burn:g}"]
    if request.hints != SheetHints():
        said += ["--hints", saved_name(file.name, ".toml")]
    return shlex.join([*said, *reading_options(file), "-o", saved_name(file.name, "-assembled.json")])
