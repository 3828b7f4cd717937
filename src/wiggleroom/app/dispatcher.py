"""Which function answers which request, and what is said where one cannot."""

from __future__ import annotations

import threading
from collections.abc import Callable
from importlib import import_module

from wiggleroom.app.document import Document
from wiggleroom.app.messages import decode, kind_of
from wiggleroom.app.open_requests import opened
from wiggleroom.app.reporter import Reporter
from wiggleroom.app.worker_protocol import StartOrder
from wiggleroom.errors import InputError, StoppedError, WiggleroomError, where_raised
from wiggleroom.schema.replies import Fault
from wiggleroom.schema.requests import AnyRequest, DragRequest, FlexRequest, OpenRequest, ShapeRequest

ANSWERS = {
    "shape": "motion_requests",
    "drag": "motion_requests",
    "pose": "motion_requests",
    "reach": "motion_requests",
    "wiggle": "motion_requests",
    "rank": "study_requests",
    "check": "study_requests",
    "limit": "study_requests",
    "plan": "study_requests",
    "sweep": "study_requests",
    "prove": "study_requests",
    "bound": "study_requests",
    "study": "study_requests",
    "space": "space_requests",
    "save": "save_requests",
    "assemble": "sheet_requests",
    "lay": "sheet_requests",
}
"""Modules whose function of that name answers; loaded when first asked, so that a drawing is open before the solver is there."""
OF_DRAWINGS = ("reach", "bound", "space", "assemble", "lay")
"""What is not answered in space."""


class Dispatcher:
    """Where requests are answered, one after the other."""

    def __init__(self) -> None:
        self._document: Document | None = None

    def open(self, request: OpenRequest, out: Reporter) -> None:
        """Read a drawing and tell the page; where that fails the one before stays."""
        document = Document(opened(request))
        content = document.opened(request.design)
        out.check()
        self._document = document
        out.reply(content)

    def work(self, order: StartOrder, stop: threading.Event, say: Callable[[object], None]) -> tuple[bool, bool]:
        """Answer one request; whether that went well, and whether a full answer is still to come."""
        request = decode(order.request)
        out = Reporter(order.ticket, request.id, kind_of(request), stop, say, order.quiet)
        try:
            out.check()
            return True, self._answered(request, order.settle, out)
        except StoppedError:
            pass
        except InputError as problem:
            if not stop.is_set():
                out.failed(problem.findings, self._review(request))
        except WiggleroomError as problem:
            out.failed([str(problem)])
        except MemoryError:
            out.failed(["this needs more memory than a page may take; the command line may have it"])
        except Exception as problem:
            out.failed(
                [
                    f"this is a fault in wiggleroom, not in your drawing: {type(problem).__name__}: {problem}{where_raised(problem)}"
                ]
            )
        return False, False

    def _review(self, request: AnyRequest) -> list[Fault]:
        """Everything that is wrong with the design of a request, where that can be said."""
        if self._document is None or not isinstance(request, FlexRequest | ShapeRequest | DragRequest):
            return []
        try:
            return self._document.review(request.design)
        except InputError:
            return []

    def _answered(self, request: AnyRequest, settle: bool, out: Reporter) -> bool:
        if isinstance(request, OpenRequest):
            self.open(request, out)
            return False
        if self._document is None:
            raise InputError("nothing is open: open a drawing first")
        if isinstance(request, FlexRequest):
            from wiggleroom.app import motion_requests  # slow to import; a drawing is open before

            return (motion_requests.settled if settle else motion_requests.flex)(self._document, request, out)
        kind = str(request.__struct_config__.tag)
        if self._document.in_space and kind in OF_DRAWINGS:
            message = f"{kind}: is for drawings; {self._document.file.name} is an assembly in space"
            raise InputError(message)
        getattr(import_module(f"wiggleroom.app.{ANSWERS[kind]}"), kind)(self._document, request, out)
        return False
