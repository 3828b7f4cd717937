"""What a solver process has in hand, and which function answers which request."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Hashable
from typing import Any

import msgspec

from wiggleroom.analysis.answer import Answer
from wiggleroom.analysis.interlock import Interlock
from wiggleroom.analysis.interlock import check as interlock
from wiggleroom.app import moving, regions, saving, studies
from wiggleroom.app.designs import Designs, Recent
from wiggleroom.app.link import Start
from wiggleroom.app.messages import AnyRequest, Design, Flex, Open, decode
from wiggleroom.app.opening import File, opened, told
from wiggleroom.app.out import Out, StoppedError
from wiggleroom.assembly.findings import role_findings
from wiggleroom.assembly.model import Assembly
from wiggleroom.assembly.statements import statement_findings
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError, WiggleroomError


class Desk:
    """One drawing and what was worked out about it.

    What is kept is kept for speed alone: every request carries its whole design.
    """

    def __init__(self) -> None:
        self._file: File | None = None

    @property
    def file(self) -> File:
        """The drawing that is open; raises InputError where none is."""
        if self._file is None:
            raise InputError("nothing is open: open a drawing first")
        return self._file

    def open(self, request: Open, out: Out) -> None:
        """Read a drawing and tell the page; where that fails the one before stays."""
        file = opened(request)
        design = request.design
        drawing = file.drawing if design is None else Designs(file.drawing).drawing(design)
        content = told(file, drawing)
        if design is not None:
            content["design"]["extra"] = design.extra
        out.check()
        self._file, self.designs = file, Designs(file.drawing)
        self.answers: Recent[Answer] = Recent(4)
        self.checks: Recent[Interlock] = Recent(2)
        self.moves = moving.Moves(self, file.drawing)
        out.reply(content, kind="opened")

    def assembly(self, design: Design) -> Assembly:
        """Parts as made for a design."""
        return self.designs.assembly(design)

    def asked(self, design: Design) -> tuple[Goal, ...]:
        """What a design asks; raises InputError where a question about motion lacks something."""
        drawing = self.designs.drawing(design)
        wrong = statement_findings(drawing) or list(role_findings(drawing))
        if wrong:
            raise InputError(wrong)
        return drawing.goals

    def kept(self, design: Design) -> Answer | None:
        """The full answer, where it is known."""
        return self.answers.peek(whole(design))

    def answer(self, design: Design, out: Out) -> Answer:
        """The full answer, worked out once for a design."""
        answer = self.kept(design)
        if answer is None:
            answer = self.moves.settle(design, out)
            out.check()
            self.know(design, answer)
        return answer

    def know(self, design: Design, answer: Answer) -> None:
        """Keep a fuller answer to a design."""
        self.answers.keep(whole(design), answer)

    def checked(self, design: Design, out: Out) -> Interlock:
        """Whether it comes apart, worked out once for a design."""
        key = self.designs.body(design)
        kept = self.checks.peek(key)
        if kept is not None:
            return kept
        found = interlock(self.assembly(design), stop=out.stop, progress=out.progress)
        out.check()
        self.checks.keep(key, found)
        return found

    def work(self, order: Start, stop: threading.Event, say: Callable[[object], None]) -> tuple[bool, bool]:
        """Answer one request; whether that went well, and whether a full answer is still to come."""
        request = decode(order.request)
        out = Out(order.ticket, request.id, kind_of(request), stop, say, order.quiet)
        try:
            out.check()
            return True, self._answered(request, order.settle, out)
        except StoppedError:
            pass
        except InputError as problem:
            if not stop.is_set():
                out.failed(problem.findings)
        except WiggleroomError as problem:
            out.failed([str(problem)])
        except MemoryError:
            out.failed(["this needs more memory than a page may take; the command line may have it"])
        except Exception as problem:
            out.failed(
                [f"this is a fault in wiggleroom, not in your drawing: {type(problem).__name__}: {_line(problem)}"]
            )
        return False, False

    def _answered(self, request: AnyRequest, settle: bool, out: Out) -> bool:
        if isinstance(request, Open):
            self.open(request, out)
            return False
        if isinstance(request, Flex):
            return self.moves.settled(request, out) if settle else self.moves.flex(request, out)
        self.file  # noqa: B018  # raises where nothing is open
        ANSWERS[type(request).__name__.lower()](self, request, out)
        return False


ANSWERS: dict[str, Callable[[Desk, Any, Out], None]] = {
    "shape": moving.shape,
    "drag": lambda desk, request, out: desk.moves.drag(request, out),
    "release": lambda desk, request, out: desk.moves.release(request, out),
    "wiggle": lambda desk, request, out: desk.moves.wiggle(request, out),
    "rank": studies.rank,
    "check": studies.check,
    "sweep": studies.sweep,
    "prove": studies.prove,
    "space": regions.space,
    "save": saving.save,
}


def kind_of(request: AnyRequest) -> str:
    """Kind of a request, as in its message."""
    return str(request.__struct_config__.tag)


def whole(design: Design) -> Hashable:
    """Everything a design says, as a key."""
    return msgspec.json.encode(design)


def _line(problem: BaseException) -> str:
    place, trace = "", problem.__traceback__
    while trace is not None:
        place = f" ({os.path.basename(trace.tb_frame.f_code.co_filename)}:{trace.tb_lineno})"
        trace = trace.tb_next
    return f"{problem}{place}"
