"""Questions asked while parts are dragged and gaps are changed: each is answered safely in the time there is, from earlier answers."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, require_planar
from wiggleroom.assembly.findings import asked_goals
from wiggleroom.context import Context
from wiggleroom.drawing.model import Drawing, Goal, JointGap, Towards
from wiggleroom.errors import InputError, Stop
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.geometry.rigid_motions import of_bodies, of_parts
from wiggleroom.live.drag_search import ARRIVAL_TOLERANCE, dragged, dragged_among_few, holding_contacts, others_back
from wiggleroom.live.drag_target import target_in_sight
from wiggleroom.live.gap_continuation import KnownEnds, kept
from wiggleroom.live.live_result import LiveResult, Mode
from wiggleroom.live.loose_modes import modes
from wiggleroom.live.planar_loose import PlanarLoose
from wiggleroom.live.prepared_designs import GapDesign, PreparedDesigns, with_outlines
from wiggleroom.live.warm_start import (
    FIRST_BARRIER,
    State,
    TimeBudget,
    WarmSearch,
    free_of_overlap,
    seated,
    state_at,
    state_at_rest,
    state_beside,
)
from wiggleroom.maximise import witness
from wiggleroom.program.objectives import Approach
from wiggleroom.search.answer import Answer
from wiggleroom.search.build_answer import unlimited
from wiggleroom.search.multistart import pulls
from wiggleroom.search.prepare import Prepared
from wiggleroom.search.progress import Progress
from wiggleroom.search.recession import recession_direction

Floats = NDArray[np.float64]
Spot = tuple[float, float]


@dataclass(frozen=True, eq=False)
class _AmongFew:
    """Where `body` was brought while `count` bodies were free to move, not settled."""

    body: int
    count: int
    state: State


@dataclass(frozen=True, eq=False)
class _Dragged:
    """Where the last drag ended: a state in the cells of `ready`, whose outlines may be finer than those of the design."""

    ready: Prepared
    state: State
    few: _AmongFew | None = None
    began: State | None = None

    @property
    def here(self) -> State:
        """The state that is shown."""
        return self.state if self.few is None else self.few.state


MAX_LEFT, MAX_SEEN = 24, 4
"""Number of poses that are kept with the cells round them: where parts were left, and where drags ended lately."""
NO_GAIN = 1e-2
"""A part that is held, and comes nearer by less than this share of the clearance, stays with all others where it was."""
MAX_BACK_BODIES = 300
"""Of larger assemblies others are not brought back after a drag."""


_Key = tuple[int, bytes]
_Seen = tuple[GapDesign, Prepared, State]
"""A design, which must live as long as its key, and a state in the outlines in which it was found."""


def _key(design: GapDesign, motion: Floats) -> _Key:
    """A motion in a design, to single precision: as a page knows it."""
    return id(design.assembly), (motion.astype(np.float32) + np.float32(0)).tobytes()


class Live:
    """A session with one drawing: its design changes, its parts are dragged, with quick answers.

    Every returned motion is free of overlap by exact geometry, and connected with rest by a chain of cells.

    Parameters
    ----------
    drawing : Drawing or Assembly
        Nothing is computed before the first question.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> live = wr.Live(wr.patterns.chain(3, joint="tee", gap=0.02))
    >>> result = live.drag("b3", (2.0, 0.0), (2.0, 0.03))
    >>> round(result.distance, 3)
    0.0
    >>> round(live.design(gap=0.01).gap, 3)
    0.01
    """

    def __init__(self, drawing: Drawing | Assembly) -> None:
        if not isinstance(drawing, Drawing) or drawing.dimension == 3:
            require_planar(drawing, "Live")
        self._designs = PreparedDesigns(drawing.drawing if isinstance(drawing, Assembly) else drawing)
        self._now: GapDesign | None = None
        self._dragged: _Dragged | None = None
        self._ends = KnownEnds()
        self._left: OrderedDict[_Key, _Seen] = OrderedDict()
        self._seen: OrderedDict[_Key, _Seen] = OrderedDict()

    def design(
        self,
        gap: float | None = None,
        extra: Mapping[str, float] | None = None,
        fixed: Collection[str] | None = None,
        glue: Sequence[Sequence[str]] | None = None,
        gaps: Sequence[JointGap] | None = None,
    ) -> Assembly:
        """Change the design; quick where it was seen before, or where only gaps change.

        Parameters
        ----------
        gap : float, optional [mm]
        extra : mapping of names to float, optional [mm]
            Extra gap round single parts: their outlines alone move inward by half of it.
        fixed : names, optional
        glue : groups of names, optional
        gaps : sequence of JointGap, optional
            Each in place of what the drawing says; by default that.

        Returns
        -------
        Assembly
            The parts as they are made; without goals, which come with the questions.

        Raises
        ------
        InputError
            If a part is not known or cannot be made, or nothing can move. The design before stays.
        TouchingError
            If two parts touch at rest.
        """
        new, old = self._designs.design(gap, extra or {}, fixed, glue, gaps), self._now
        if new is not old:
            last, self._dragged, self._now = self._dragged, None, new
            state = None if last is None or old is None else kept(last.state, replace(old, ready=last.ready), new)
            if state is not None:
                self._dragged = _Dragged(new.ready, state)
        return new.assembly

    @property
    def assembly(self) -> Assembly:
        """The present design."""
        return self._design.assembly

    @property
    def ready(self) -> Prepared:
        """The present design, prepared."""
        return self._design.ready

    @contextmanager
    def aside(self) -> Iterator[None]:
        """Drags in here leave no trace: the next one begins where the last one before ended."""
        before = self._dragged, self._seen.copy()
        try:
            yield
        finally:
            self._dragged, self._seen = before

    def rest(self) -> None:
        """Put all parts back to rest: the next drag begins there."""
        self._dragged = None

    @property
    def dragged(self) -> bool:
        """Whether a drag has ended somewhere in this design."""
        return self._dragged is not None

    def leave(self, motion: Floats) -> bool:
        """Leave all parts at a motion (n, 3) [mm, mm, rad], where a later drag may begin; False where some overlap there.

        Where a drag ended lately, at that motion to single precision, its state is kept with it. Parts that touch may overlap by rounding.
        """
        if self._known(motion) is not None:
            return True
        bodies = of_bodies(self.ready.assembly, self.ready.bodies, motion[None])[0]
        return free_of_overlap(self.ready, bodies) or state_beside(self.ready, bodies) is not None

    def _known(self, motion: Floats) -> _Seen | None:
        """What is known of a motion (n, 3) where parts were left; from then on it is kept."""
        key = _key(self._design, motion)
        found = self._left.pop(key, None)
        if found is None and key in self._seen:
            design, ready, state = self._seen[key]
            found = design, ready, seated(ready, state)
        if found is not None:
            self._left[key] = found
            while len(self._left) > MAX_LEFT:
                self._left.popitem(last=False)
        return found

    def _see(self, ready: Prepared, state: State) -> Floats:
        """Motion (n, 3) of a state that is shown, which parts may be left at."""
        motion = self._of_parts(ready, state)
        self._seen[_key(self._design, motion)] = self._design, ready, state
        while len(self._seen) > MAX_SEEN:
            self._seen.popitem(last=False)
        return motion

    def others_back(
        self, part: str, pinned: Collection[str] = (), *, seconds: float = 0.3, stop: Stop | None = None
    ) -> Floats | None:
        """Motion (n, 3) after all parts but the dragged one went back towards where the last drag began; None where none was found.

        The dragged part stays where it is: of all motions that bring it there, the others take the least.
        """
        last = self._dragged
        if last is None or last.began is None or len(self.ready.bodies.fixed) > MAX_BACK_BODIES:
            return None
        body = int(last.ready.bodies.body_of[self.assembly.names.index(part)])
        after = others_back(
            last.ready, last.here, last.began, body, self._held(last.ready, pinned), TimeBudget(seconds, stop)
        )
        if after is None:
            return None
        self._dragged = _Dragged(last.ready, after, began=last.began)
        return self._see(last.ready, after)

    def _of_parts(self, ready: Prepared, state: State) -> Floats:
        return of_parts(ready.assembly, ready.bodies, state.motion[None])[0]

    def _held(self, ready: Prepared, pinned: Collection[str]) -> frozenset[int]:
        """Bodies of parts that are pinned."""
        names = self.assembly.names
        return frozenset(int(ready.bodies.body_of[names.index(name)]) for name in pinned)

    def drag(
        self,
        part: str,
        grip: Spot,
        target: Spot,
        *,
        start: str | Floats = "here",
        goals: Goal | Sequence[Goal] | None = None,
        within: int | None = None,
        pinned: Collection[str] = (),
        seconds: float = 0.1,
        stop: Stop | None = None,
    ) -> LiveResult:
        """Bring a point of a part as near to a place as the assembly lets it; the other parts give way.

        Parameters
        ----------
        part : str
        grip : (x, y) [mm]
            The point, where it lies at rest.
        target : (x, y) [mm]
        start : str or (n, 3) float64 [mm, mm, rad]
            "here", where the last drag ended, "rest", or "answer", the end of what was last found for some goals; or a motion of all parts.
        goals : optional
            These goals; by default what the drawing asks for.
        within : int, optional
            Number of bodies that may move, those that the part pushes first; all others stand where they are. The motion is one
            of the whole assembly, but not settled where others that stand hold the part; then the next drag of this part among
            as many or fewer goes on from there, and one among more begins where this one did. By default all may move.
        pinned : names, optional
            Parts that stand where they are, although they are not fixed.
        seconds : float
            After that time the best safe motion so far is returned, not settled; asking again goes on from there.
        stop : optional
            Anything with `is_set()`, asked every iteration.

        Raises
        ------
        InputError
            If there is no such part, it cannot move, or parts overlap at the motion where it is to begin.
        """
        began = time.perf_counter()
        ready, state, few = self._begun(start, goals)
        held = self._held(ready, pinned)
        since = state if not isinstance(start, str) or start != "here" or self._dragged is None else self._dragged.began
        aim = target_in_sight(grip, target, ready.size)
        goal = Towards(part, (float(aim[0]), float(aim[1])), (float(grip[0]), float(grip[1])))
        term = cast(Approach, ready.objective(self._asked(goal)))
        body, until = int(term.points.body[0]), TimeBudget(seconds, stop)
        if body in held:
            message = f'"{part}" is pinned: let it go before you drag it'
            raise InputError(message)
        near = None
        if within is not None or held:
            begin = (
                few.state
                if few is not None and within is not None and few.body == body and within <= few.count
                else state
            )
            near = dragged_among_few(ready, term, aim, seated(ready, begin) if held else begin, within, until, held)
        if near is None and held:  # what would have to give way is pinned
            near = state, None, False
        after, search, settled = near or dragged(ready, term, state, float(np.sum(np.subtract(aim, grip) ** 2)), until)
        left, before = (float(np.hypot(*(grip + term.points.moved(m)[0] - aim))) for m in (after.motion, state.motion))
        if settled and few is None and left > NO_GAIN * ready.clearance and before - left < NO_GAIN * ready.clearance:
            after = state  # what holds the part stays, too: step by step the search would lead it out of the way
        # pressed against what could give way, few parts are a bad place for more to begin at
        few = None if near is None or within is None or settled else _AmongFew(body, within, after)
        self._dragged = _Dragged(ready, state if few else after, few, since)
        motion = self._see(ready, after)
        x, y = np.add(grip, term.points.moved(after.motion)[0]).tolist()
        reached = (x, y)
        distance = float(np.hypot(*np.subtract(target, reached)))
        left = float(np.hypot(*np.subtract(aim, reached)))
        holds = settled and search is not None and left > ARRIVAL_TOLERANCE * ready.clearance
        contacts = holding_contacts(search, 2 * left) if holds and search is not None else ()
        blocking = dict.fromkeys(n for c in contacts if part in c.parts for n in c.parts if n != part)
        seconds = time.perf_counter() - began
        return LiveResult(motion, settled, seconds, contacts, tuple(blocking), reached=reached, distance=distance)

    def follows(self, goals: Goal | Sequence[Goal] | None = None) -> bool:
        """Whether `flex` would begin at the end of an answer to these goals, at this gap or one nearby."""
        return self._ends.near(self._asked(goals), self._design) is not None

    def flex(
        self, goals: Goal | Sequence[Goal] | None = None, *, seconds: float = 0.1, stop: Stop | None = None
    ) -> LiveResult:
        """Largest motion as far as it can be found quickly: from the end at a gap nearby where there is one, else from rest.

        Parameters
        ----------
        goals : Pull, Turn, W, Towards, Translation or Closer, or several that add up
            By default what the drawing asks for.
        seconds, stop
            As for `drag`.

        Raises
        ------
        InputError
            If nothing is fixed or pulled, or a goal names an unknown part.
        """
        began, ready = time.perf_counter(), self.ready
        asked = self._asked(goals)
        term, until = ready.objective(asked), TimeBudget(seconds, stop)
        state = self._ends.near(asked, self._design)
        if state is None:
            state = state_at_rest(ready)
            for pull in pulls(ready.bodies, term, ready.clearance)[:1]:  # rest shows no direction
                state, _ = WarmSearch(ready, pull, state, until).reach()
        search = WarmSearch(ready, term, state, until)
        state, settled = search.reach()
        settled = settled and state.linked
        self._ends.keep(asked, self._design, state)
        motion = of_parts(ready.assembly, ready.bodies, state.motion[None])[0]
        if search.search.unlimited and recession_direction(ready, term, state.motion) is not None:
            leaves, turns = unlimited(ready.assembly, ready.bodies, state.motion, ready.size)
            return LiveResult(motion, settled, time.perf_counter() - began, leaves=leaves, turns=turns)
        held = holding_contacts(search, 1.0)
        settled = (
            settled and not search.search.unlimited
        )  # whether a turn repeats for ever is for the full answer to say
        return LiveResult(motion, settled, time.perf_counter() - began, held, objective=term.value(state.motion))

    def settle(
        self,
        goals: Goal | Sequence[Goal] | None = None,
        *,
        stop: Stop | None = None,
        progress: Callable[[Progress], None] | None = None,
    ) -> Answer:
        """Return the answer of `wiggleroom.flex` with `search=0` for the present design, without a bound; later quick ones begin near it.

        The climb begins at rest alone: no global search, no quick bound.

        Raises
        ------
        StoppedError
            If it was asked to stop before there was anything to say.
        """
        asked = self._asked(goals)
        old, self._now = self._design, self._designs.prove(self._design, stop)
        if self._now is not old:
            self._dragged = None
        answer = witness(self.ready, asked, context=Context(stop=stop, progress=progress))
        found = answer.warm_start
        if found is not None and answer.objective == found.value and answer.collision_free:  # else it was cut back
            cells = found.program.cells
            ended = relative_pose(self.ready.bodies, cells.a, cells.b, found.motion)
            state = State(cells, found.program.motion(found.solution.inner), found.motion, ended=ended)
            bodies, design = found.program.bodies, self._design
            if bodies is not design.ready.bodies:  # outlines of many corners were refined where they touch
                design = replace(design, ready=with_outlines(design.ready, bodies))
            self._ends.keep(asked, design, state)
        return answer

    def wiggle(
        self, part: str | None = None, *, count: int = 4, seconds: float = 8.0, stop: Stop | None = None
    ) -> tuple[Mode, ...]:
        """Return the loosest freedoms at rest, each followed to its end both ways.

        Parameters
        ----------
        part : str, optional
            Freedoms that move this part most; by default of the whole assembly.
        count : int
            Most freedoms that are returned.
        seconds : float
            After that time those that were found are returned.
        stop : optional
            Anything with `is_set()`, asked every iteration; it ends the search like the time.

        Raises
        ------
        InputError
            If there is no such part, or it cannot move.
        """
        body = None
        if part is not None:
            self._asked(Towards(part, (0.0, 0.0)))
            body = int(self.ready.bodies.body_of[self.assembly.names.index(part)])
        return modes(PlanarLoose(self.ready), body, count, TimeBudget(seconds, stop))

    @property
    def _design(self) -> GapDesign:
        if self._now is None:
            self.design()
        assert self._now is not None
        return self._now

    def _asked(self, goals: Goal | Sequence[Goal] | None) -> tuple[Goal, ...]:
        """Goals, by default what the drawing asks for, once it is sure that they make sense."""
        return asked_goals(self.assembly.drawing, self._designs.drawing.goals if goals is None else goals)

    def _begun(
        self, start: str | Floats, goals: Goal | Sequence[Goal] | None
    ) -> tuple[Prepared, State, _AmongFew | None]:
        """Where a drag begins, and in which outlines."""
        if not isinstance(start, str):
            known = self._known(start)
            if known is not None:
                return known[1], replace(known[2], mu=FIRST_BARRIER, near=False, ended=None), None
            bodies = of_bodies(self.ready.assembly, self.ready.bodies, start[None])[0]
            state = state_at(self.ready, bodies) or state_beside(self.ready, bodies)
            if state is None:
                raise InputError("drag: no free space was found where the parts were left; bring them back to rest")
            return self.ready, state, None
        if start == "here" and self._dragged is not None:
            return self._dragged.ready, self._dragged.state, self._dragged.few
        if start == "answer":
            found = self._ends.at(self._asked(goals), self._design)
            if found is not None and found.state.linked:
                return found.design.ready, replace(found.state, mu=FIRST_BARRIER, ended=None), None
        return self.ready, state_at_rest(self.ready), None
