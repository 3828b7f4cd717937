"""One drawing or assembly in space that is open, and what was worked out about it."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import msgspec

from wiggleroom.app.design_cache import DesignCache, LruCache, joint_gaps
from wiggleroom.app.open_requests import File, opened_reply
from wiggleroom.app.reporter import Reporter
from wiggleroom.assembly.findings import question_findings
from wiggleroom.context import Context
from wiggleroom.errors import InputError
from wiggleroom.schema.replies import Fault, Opened
from wiggleroom.schema.requests import Design
from wiggleroom.verdict import SearchState, Verdict

if TYPE_CHECKING:
    from wiggleroom.app.display import Display
    from wiggleroom.app.spatial_designs import SpatialDesignCache
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.disassembly.interlock_result import Interlock
    from wiggleroom.disassembly.largest_gap import LargestGap
    from wiggleroom.live.live_session import Live
    from wiggleroom.planning.plan import Plan
    from wiggleroom.search.answer import Answer
    from wiggleroom.spatial.spatial_live import SpatialLive


MAX_CALMED = 300
"""Of assemblies of more parts the answer is shown as it was found: to judge its path again takes too long."""


class Document:
    """A drawing, or an assembly in space, and what was worked out about it, kept for speed alone: every request carries its whole design.

    Parameters
    ----------
    file : File
    """

    def __init__(self, file: File) -> None:
        self.file = file
        self.designs = _cache_of(file)
        self._answers: LruCache[Answer] = LruCache(4)
        self._searched: LruCache[SearchState] = LruCache(4)
        self._calm: LruCache[tuple[Answer, Answer]] = LruCache(4)
        self._checks: LruCache[Interlock] = LruCache(2)
        self._plans: LruCache[Plan] = LruCache(2)

    @cached_property
    def display(self) -> Display:
        """What the page shows."""
        from wiggleroom.app.display import Display  # slow to import; a drawing is open before

        return Display()

    @property
    def in_space(self) -> bool:
        """True for an assembly in space."""
        return self.file.drawing.dimension == 3

    def opened(self, design: Design | None) -> Opened:
        """What the page is told when it is opened; with a design that one stands in place of what the file asks."""
        if isinstance(self.designs, DesignCache):
            content = opened_reply(self.file, self.file.drawing if design is None else self.designs.drawing(design))
        else:
            from wiggleroom.app.spatial_designs import spatial_opened_reply

            content = spatial_opened_reply(self.file, self.designs, design)
        if design is not None:
            content.design.extra = design.extra
        return content

    def review(self, design: Design) -> list[Fault]:
        """List what is wrong with a design; raises InputError where that cannot be said."""
        if isinstance(self.designs, DesignCache):
            from wiggleroom.app.review import review

            return review(self.designs, design)
        from wiggleroom.app.spatial_review import spatial_review

        return spatial_review(self.designs, design)

    @cached_property
    def _live(self) -> Live:
        from wiggleroom.live.live_session import Live

        return Live(self.file.drawing)

    @cached_property
    def _spatial_live(self) -> SpatialLive:
        from wiggleroom.spatial.spatial_live import SpatialLive

        return SpatialLive()

    def live(self, design: Design) -> Live | SpatialLive:
        """The live session, its design set."""
        if isinstance(self.designs, DesignCache):
            gaps = joint_gaps(design, self.file.drawing.gaps)
            self._live.design(self.designs.gap(design), design.extra, design.fixed, design.glue, gaps)
            return self._live
        self._spatial_live.take(self.designs.assembly(design))
        return self._spatial_live

    def assembly(self, design: Design) -> Assembly:
        """Parts as made for a design."""
        return self.designs.assembly(design)

    def flat(self, design: Design) -> Assembly:
        """The same of a drawing, for what is asked of drawings alone."""
        assert isinstance(self.designs, DesignCache)  # see `Dispatcher`
        return self.designs.assembly(design)

    def asked(self, design: Design) -> tuple[Any, ...]:
        """What a design asks; raises InputError where a question about motion lacks something."""
        drawing = self.designs.drawing(design)
        wrong = question_findings(drawing)
        if wrong:
            raise InputError(wrong)
        return drawing.goals

    def kept(self, design: Design) -> Answer | None:
        """The full answer, where it is known."""
        return self._answers.peek(whole(design))

    def answer(self, design: Design, out: Reporter) -> Any:
        """The full answer, worked out once for a design."""
        answer = self.kept(design)
        if answer is None:
            told: Any = out.iterated if self.in_space else out.progress
            answer = self.live(design).settle(self.asked(design), stop=out.stop, progress=told)
            out.check()
            self.know(design, answer)
        return answer

    def searched(self, design: Design, out: Reporter) -> Any:
        """The full answer after the search with which studies begin, and with what that came to; in space the full answer has one."""
        answer = self.answer(design, out)
        key = whole(design)
        if self.in_space or answer.objective is None or self._searched.peek(key):
            return answer
        from wiggleroom.sensitivity.perturbation import exceeds, is_searched, searched_answer

        few = is_searched(answer.assembly)
        if few:
            found = searched_answer(answer.assembly, answer.goals, Context(stop=out.stop))
            out.check()
            answer = found if exceeds(found, answer) else replace(answer, search=found.search)
            self.know(design, answer)
        self._searched.keep(key, SearchState.DONE if few else SearchState.FROM_REST)
        return answer

    def told(self, design: Design, answer: Any, out: Reporter) -> Any:
        """An answer as it is told: with whether the search has ended that a direct question makes from other starts.

        A bound that was met or no end need none; in space the full answer has one. Parts that nothing asks about rest, where there is room.
        """
        if self.in_space:
            return answer
        state = self._searched.peek(whole(design)) or SearchState.TO_COME
        if answer.objective is None or answer.verdict is Verdict.PROVEN:
            state = SearchState.DONE
        elif state is SearchState.TO_COME:
            from wiggleroom.sensitivity.perturbation import is_searched

            state = state if is_searched(answer.assembly) else SearchState.FROM_REST
        kept = self._calm.peek(whole(design))
        if kept is None or kept[0] is not answer:
            from wiggleroom.search.bystanders import with_bystanders_at_rest

            few = len(answer.assembly.parts) <= MAX_CALMED
            calm = with_bystanders_at_rest(answer, out.stop) if few else answer
            out.check()
            kept = answer, calm
            self._calm.keep(whole(design), kept)
        return replace(kept[1], search_state=state)

    def know(self, design: Design, answer: Answer) -> None:
        """Keep a fuller answer to a design."""
        self._answers.keep(whole(design), answer)

    def kept_check(self, design: Design) -> Any:
        """Whether it comes apart, where that is known."""
        return self._checks.peek(self.designs.body(design))

    def checked(self, design: Design, out: Reporter) -> Any:
        """Whether it comes apart, worked out once for a design."""
        kept = self.kept_check(design)
        if kept is not None:
            return kept
        from wiggleroom.questions import check

        found = check(self.assembly(design), stop=out.stop, progress=out.progress)
        out.check()
        self._checks.keep(self.designs.body(design), found)
        return found

    def largest_gap(self, design: Design, out: Reporter) -> LargestGap:
        """The largest gap that holds a design together."""
        from wiggleroom.questions import largest_gap

        found = largest_gap(self.assembly(design), stop=out.stop)
        out.check()
        return found

    def planned(
        self, design: Design, out: Reporter, targets: tuple[str, ...] = (), gravity: tuple[float, ...] | None = None
    ) -> Plan:
        """How a design is taken apart."""
        from wiggleroom.studies.plan import plan

        found = plan(self.assembly(design), targets, gravity=gravity, stop=out.stop, progress=out.progress)
        out.check()
        self._plans.keep(self.designs.body(design), found)
        return found

    def last_plan(self, design: Design, out: Reporter) -> Plan:
        """The plan of a design that was asked for last; where there is none, that of all parts."""
        return self._plans.peek(self.designs.body(design)) or self.planned(design, out)


def _cache_of(file: File) -> DesignCache | SpatialDesignCache:
    if file.drawing.dimension == 2:
        return DesignCache(file.drawing)
    from wiggleroom.app.spatial_designs import SpatialDesignCache  # slow to import, and of no use to drawings

    return SpatialDesignCache(file.drawing)


def whole(design: Design) -> Hashable:
    """Everything a design says, as a key."""
    return msgspec.json.encode(design)
