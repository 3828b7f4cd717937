"""Shape, flex, drag and wiggle: what follows the hand."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from msgspec import UNSET
from msgspec.structs import replace

from wiggleroom.app.command import command
from wiggleroom.app.dimension_messages import (
    as_frames,
    frames_of,
    motion_of,
    still_frame,
    tell_outlines,
)
from wiggleroom.app.document import Document
from wiggleroom.app.reporter import Reporter
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError
from wiggleroom.live.live_result import LiveResult
from wiggleroom.live.live_session import Live
from wiggleroom.report.free_space.stacked_slices import rings
from wiggleroom.report.page.page_messages import answer_message, contacts_message
from wiggleroom.schema.replies import (
    DragReply,
    ModeEntry,
    Modes,
    PoseReply,
    ReachReply,
    ShapeReply,
)
from wiggleroom.schema.requests import (
    Design,
    DragRequest,
    FlexRequest,
    PoseRequest,
    ReachRequest,
    ShapeRequest,
    WiggleRequest,
)
from wiggleroom.search.answer import Answer, witnessed
from wiggleroom.verdict import PathState, Verdict

if TYPE_CHECKING:
    from wiggleroom.spatial.spatial_live import SpatialLive

QUICK_SECONDS = 0.1
"""Time that a quick answer takes, about [s]."""
MAX_QUICK_BODIES = 100
"""Of larger assemblies a quick answer from rest would say nothing yet; they have one where an answer at another gap is near."""
MAX_QUICK_ANSWERS = 10
"""At most this many quick answers are looked for before the full one."""
NEIGHBOURHOODS = (64, 512, None)
"""Number of parts that may give way to a dragged one: at first, then where others hold it, then all."""
MAX_WHOLE_BODIES = 300
"""In smaller assemblies all may give way from the first: that takes no longer, and there is nothing to be found afterwards."""
DRAG_SECONDS = {2: (0.025, 0.1), 3: (0.4, 0.4)}
"""Time that the first reply to a drag takes in the plane and in space, about [s], and each after it: a moving hand sees first ones."""
HAND_SECONDS = 0.04
"""A hand that moves on asks anew within this time of a reply [s]: only after it more work is begun that would have to be stopped first."""
BACK_SECONDS = 0.3
"""Time to bring others back once the hand rests [s]."""
MAX_DRAG_STEPS, MAX_STALLED_STEPS = 50, 3
"""A drag is continued at most this many times, and at most this many times without gain."""
MIN_APPROACH = 1e-4
"""A drag that gets nearer by less than this share is stuck."""
MIN_IMPROVEMENT = 1e-3
"""A quick answer that is better by less than this share is not told; the full one is looked for then."""


def flex(document: Document, request: FlexRequest, out: Reporter) -> bool:
    """Answer quickly, and again while that brings more; True where the full answer is to come."""
    design, display = request.design, document.display
    if document.kept(design) is not None:
        return settled(document, request, out)
    goals = document.asked(design)
    live = document.live(design)
    if not isinstance(live, Live):
        return True  # in space there is no quicker answer
    if len(live.ready.bodies.fixed) > MAX_QUICK_BODIES and not live.follows(goals):
        return True
    last: float | None = None
    for _ in range(MAX_QUICK_ANSWERS):
        result = live.flex(goals, seconds=QUICK_SECONDS, stop=out.stop)
        out.check()
        value = math.inf if result.objective is None else result.objective
        if last is not None and not value > last + MIN_IMPROVEMENT * abs(last):
            break
        last = value
        display.move(live.assembly, result.motion)
        content = answer_message(quick(live.assembly, goals, result), command("flex", document.file, design))
        tell_outlines(content, display.new_outlines(document.designs.shape(design), live.assembly, request.shown))
        content.settled = False
        out.reply(content, [result.motion[None]])
        if result.settled:
            break
    return True


def settled(document: Document, request: FlexRequest, out: Reporter) -> bool:
    """Answer fully."""
    tell_answer(document, request.design, document.answer(request.design, out), request.shown, out)
    return False


def searched(document: Document, design: Design, out: Reporter) -> Any:
    """The full answer after the search of a direct question; the page is told where that is another than it shows."""
    before = document.answer(design, out)
    answer = document.searched(design, out)
    if answer is not before:
        tell_answer(document, design, answer, "", out)
    return answer


def tell_answer(document: Document, design: Design, answer: Any, shown: str, out: Reporter) -> None:
    """Tell the page a full answer."""
    answer = document.told(design, answer, out)
    document.display.move(answer.assembly, answer.motion)
    content = answer_message(answer, command("flex", document.file, design))
    shape = document.designs.shape(design)
    tell_outlines(content, document.display.new_outlines(shape, answer.assembly, shown))
    out.reply(content, [frames_of(answer.assembly, answer.waypoints)])


def drag(document: Document, request: DragRequest, out: Reporter) -> None:
    """Bring a part as near to a place as it goes; told at once, and again while it gets nearer."""
    live = document.live(request.design)
    grip, target = (_spot(place, live) for place in (request.grip, request.target))
    outlines = document.display.new_outlines(document.designs.shape(request.design), live.assembly, request.shown)
    goals = document.asked(request.design) if request.from_ == "answer" else None
    names = live.assembly.names
    left = motion_of(request.pose, names, not isinstance(live, Live))
    start: Any = request.from_
    if start == "pose" or (start == "here" and not live.dragged):  # a process that was lost knows of no drag
        start = left if request.pose else "rest"
    pinned = tuple(name for name in request.pinned if name in names)
    shown, last = math.inf, math.inf
    stuck, large = 0, isinstance(live, Live) and len(live.ready.bodies.fixed) > MAX_WHOLE_BODIES
    first, later = DRAG_SECONDS[2 if isinstance(live, Live) else 3]
    for times in range(MAX_DRAG_STEPS):
        within = NEIGHBOURHOODS[min(times, len(NEIGHBOURHOODS) - 1)] if large else None
        result = live.drag(
            request.part, grip, target,
            start=start, goals=goals, within=within, pinned=pinned, seconds=later if times else first, stop=out.stop,
        )  # fmt: skip
        out.check()
        assert result.distance is not None
        assert result.reached is not None
        if within is None:
            stuck, last = stuck + 1 if result.distance > last * (1 - MIN_APPROACH) else 0, min(last, result.distance)
        settled = result.settled or times == MAX_DRAG_STEPS - 1 or stuck == MAX_STALLED_STEPS
        start = "here"
        if result.distance > shown and not settled:  # few parts came nearer than all have so far
            continue
        document.display.move(live.assembly, result.motion)
        content = DragReply(
            part=request.part,
            target=request.target,
            reached=result.reached,
            distance=result.distance,
            held=contacts_message(result.contacts),
            blocking=list(result.blocking),
            settled=settled,
        )
        tell_outlines(content, outlines)
        out.reply(content, [still_frame(result.motion)])
        if settled:
            _let_stand(live, content, pinned, out)
            return
        outlines, shown = None, min(shown, result.distance)
        if not times or within is not None:
            out.stop.wait(HAND_SECONDS)
            out.check()


def _let_stand(live: Live | SpatialLive, content: DragReply, pinned: tuple[str, ...], out: Reporter) -> None:
    """Once the hand rests, bring the others back towards where they were before the drag; told where that moves any."""
    if not isinstance(live, Live):
        return
    out.stop.wait(HAND_SECONDS)
    out.check()
    motion = live.others_back(content.part, pinned, seconds=BACK_SECONDS, stop=out.stop)
    out.check()
    if motion is not None:
        told = replace(content, rings=UNSET, solids=UNSET, shown=UNSET)
        out.reply(told, [still_frame(motion)])


def pose(document: Document, request: PoseRequest, out: Reporter) -> None:
    """Whether parts overlap where they were left; the next drag may begin there."""
    live = document.live(request.design)
    free = live.leave(motion_of(request.pose, live.assembly.names, not isinstance(live, Live)))
    out.reply(PoseReply(free=free, words="" if free else "parts overlap there at this gap: they are back at rest"))


def _spot(place: tuple[float, ...], live: Live | SpatialLive) -> Any:
    """A point of a request, of as many numbers as there are axes; raises InputError else."""
    axes = 2 if isinstance(live, Live) else 3
    if len(place) != axes:
        message = f"drag: grip and target have {axes} numbers here; one has {len(place)}"
        raise InputError(message)
    return place


def wiggle(document: Document, request: WiggleRequest, out: Reporter) -> None:
    """Show the freedoms that are left."""
    live = document.live(request.design)
    modes = live.wiggle(request.part, stop=out.stop)
    out.check()
    told = [ModeEntry(mode.size, list(mode.parts), mode.ends) for mode in modes]
    out.reply(Modes(modes=told), [as_frames(mode.frames) for mode in modes])


def reach(document: Document, request: ReachRequest, out: Reporter) -> None:
    """Where the point of a part can be brought."""
    from wiggleroom.live import reachable

    live = document.live(request.design)
    assert isinstance(live, Live)  # see `Dispatcher`
    found = reachable.reachable_region(live, request.part, request.grip, stop=out.stop)
    out.check()
    how = (
        f"free at {reachable.SLICES} turns; between them hardly more can be reached"
        if found.exact
        else f"sampled in {reachable.DIRECTIONS} directions, corners reached"
    )
    words = how + ("; it leaves, and the rest is cut off" if found.open else "")
    content = ReachReply(
        part=request.part, grip=request.grip, rings=[ring.tolist() for ring in rings(found.region)],
        exact=found.exact, open=found.open, words=words,
    )  # fmt: skip
    out.reply(content)


def shape(document: Document, request: ShapeRequest, out: Reporter) -> None:
    """Outlines, or solids, with the gap applied."""
    content = ShapeReply()
    assembly = document.assembly(request.design)
    tell_outlines(content, document.display.new_outlines(document.designs.shape(request.design), assembly, ""))
    out.reply(content)


def quick(assembly: Assembly, goals: tuple[Goal, ...], result: LiveResult) -> Answer:
    """What was found in the time there was, as an answer."""
    return witnessed(
        assembly,
        goals,
        Verdict.UNBOUNDED if result.objective is None else Verdict.STOPPED,
        result.objective,
        result.motion[None],
        PathState.NOT_CHECKED,
        contacts=result.contacts,
        seconds={"total": result.seconds},
        leaves=result.leaves,
        turns=result.turns,
    )
