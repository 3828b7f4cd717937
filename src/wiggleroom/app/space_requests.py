"""The free space of a pair, for the page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wiggleroom.app.command import command
from wiggleroom.app.reporter import Reporter
from wiggleroom.freespace.free_space import free_slices
from wiggleroom.report.free_space.space_solid import space_message
from wiggleroom.schema.requests import SpaceRequest

if TYPE_CHECKING:
    from wiggleroom.app.document import Document


def space(document: Document, request: SpaceRequest, out: Reporter) -> None:
    """How one part can move against another."""
    found = free_slices(document.flat(request.design), request.a, request.b, stop=out.stop)
    out.check()
    line = command("space", document.file, request.design, (request.a, request.b), pulled=False)
    out.reply(space_message(found, document.display.relative(found), line))
