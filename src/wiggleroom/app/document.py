"""One drawing that is open, and what was worked out about it."""

from __future__ import annotations

from collections.abc import Hashable
from functools import cached_property
from typing import TYPE_CHECKING

import msgspec

from wiggleroom.app.design_cache import DesignCache, LruCache
from wiggleroom.app.open_requests import File
from wiggleroom.app.reporter import Reporter
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.findings import question_findings
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError
from wiggleroom.schema.requests import Design

if TYPE_CHECKING:
    from wiggleroom.app.display import Display
    from wiggleroom.disassembly.interlock import Interlock
    from wiggleroom.live.live_session import Live
    from wiggleroom.planning.plan import Plan
    from wiggleroom.search.answer import Answer


class Document:
    """A drawing and what was worked out about it, kept for speed alone: every request carries its whole design.

    Parameters
    ----------
    file : File
    """

    def __init__(self, file: File) -> None:
        self.file = file
        self.designs = DesignCache(file.drawing)
        self._answers: LruCache[Answer] = LruCache(4)
        self._checks: LruCache[Interlock] = LruCache(2)
        self._plans: LruCache[Plan] = LruCache(2)

    @cached_property
    def display(self) -> Display:
        """What the page shows."""
        from wiggleroom.app.display import Display  # slow to import; a drawing is open before

        return Display()

    @cached_property
    def _live(self) -> Live:
        from wiggleroom.live.live_session import Live

        return Live(self.file.drawing)

    def live(self, design: Design) -> Live:
        """The live session, its design set."""
        self._live.design(self.designs.gap(design), design.extra, design.fixed, design.glue)
        return self._live

    def assembly(self, design: Design) -> Assembly:
        """Parts as made for a design."""
        return self.designs.assembly(design)

    def asked(self, design: Design) -> tuple[Goal, ...]:
        """What a design asks; raises InputError where a question about motion lacks something."""
        drawing = self.designs.drawing(design)
        wrong = question_findings(drawing)
        if wrong:
            raise InputError(wrong)
        return drawing.goals

    def kept(self, design: Design) -> Answer | None:
        """The full answer, where it is known."""
        return self._answers.peek(whole(design))

    def answer(self, design: Design, out: Reporter) -> Answer:
        """The full answer, worked out once for a design."""
        answer = self.kept(design)
        if answer is None:
            answer = self.live(design).settle(self.asked(design), stop=out.stop, progress=out.progress)
            out.check()
            self.know(design, answer)
        return answer

    def know(self, design: Design, answer: Answer) -> None:
        """Keep a fuller answer to a design."""
        self._answers.keep(whole(design), answer)

    def kept_check(self, design: Design) -> Interlock | None:
        """Whether it comes apart, where that is known."""
        return self._checks.peek(self.designs.body(design))

    def checked(self, design: Design, out: Reporter) -> Interlock:
        """Whether it comes apart, worked out once for a design."""
        kept = self.kept_check(design)
        if kept is not None:
            return kept
        from wiggleroom.disassembly.interlock import check

        found = check(self.assembly(design), stop=out.stop, progress=out.progress)
        out.check()
        self._checks.keep(self.designs.body(design), found)
        return found

    def planned(
        self, design: Design, out: Reporter, targets: tuple[str, ...] = (), gravity: tuple[float, float] | None = None
    ) -> Plan:
        """How a design is taken apart."""
        from wiggleroom.planning.plan import plan

        found = plan(self.assembly(design), targets, gravity=gravity, stop=out.stop, progress=out.progress)
        out.check()
        self._plans.keep(self.designs.body(design), found)
        return found

    def last_plan(self, design: Design, out: Reporter) -> Plan:
        """The plan of a design that was asked for last; where there is none, that of all parts."""
        return self._plans.peek(self.designs.body(design)) or self.planned(design, out)


def whole(design: Design) -> Hashable:
    """Everything a design says, as a key."""
    return msgspec.json.encode(design)
