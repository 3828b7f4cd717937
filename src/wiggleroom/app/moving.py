"""Shape, flex, drag and wiggle: what follows the hand."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Hashable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.app.command import command
from wiggleroom.app.messages import Design, Drag, Flex, Json, Release, Shape, Wiggle
from wiggleroom.app.out import Out
from wiggleroom.assembly.model import Assembly
from wiggleroom.compare.monte_carlo import swing
from wiggleroom.drawing.model import Drawing, Goal
from wiggleroom.freespace.free_space import FreeSpace
from wiggleroom.geometry.relative_pose import turn
from wiggleroom.live.live_result import Shot
from wiggleroom.live.live_session import Live
from wiggleroom.report.told import answer_told, contacts_told, rings_told
from wiggleroom.report.ways import way_frames
from wiggleroom.search.answer import Answer, witnessed
from wiggleroom.solve.verdict import Verdict

if TYPE_CHECKING:
    from wiggleroom.app.sheet import Sheet

Floats = NDArray[np.float64]

SECONDS = 0.1
"""A quick answer takes about so long [s]."""
MOST_SHOTS = 10
"""So many quick answers are looked for before the full one."""
MOST_TURNS, MOST_STUCK = 50, 3
"""So often a drag is gone on with, and so often in vain."""
AGAIN = 3.0
"""Outlines that changed are told with every reply for so long [s]."""
LITTLE = 1e-4
"""A drag that gets nearer by less than this share is stuck."""
WORTH = 1e-3
"""A quick answer that is better by less than this share is not told; the full one is looked for then."""


class Moves:
    """Where the parts of one drawing are shown, and what moves them.

    Parameters
    ----------
    sheet : Sheet
    drawing : Drawing
    """

    def __init__(self, sheet: Sheet, drawing: Drawing) -> None:
        self._sheet = sheet
        self._live = Live(drawing)
        self._outlines: Hashable = None
        self._rings: list[list[list[list[float]]]] = []
        self._told, self._since = threading.Event(), 0.0
        self._shown: tuple[Assembly, Floats] | None = None

    def at(self, design: Design) -> Live:
        """The engine, its design set."""
        self._live.design(self._sheet.designs.gap(design), design.extra, design.fixed, design.glue)
        return self._live

    def flex(self, request: Flex, out: Out) -> bool:
        """Answer quickly, and again while that brings more; True where the full answer is to come."""
        design, sheet = request.design, self._sheet
        if sheet.kept(design) is not None:
            return self.settled(request, out)
        goals = sheet.asked(design)
        live = self.at(design)
        last: float | None = None
        for _ in range(MOST_SHOTS):
            shot = live.flex(goals, seconds=SECONDS, stop=out.stop)
            out.check()
            value = math.inf if shot.objective is None else shot.objective
            if last is not None and not value > last + WORTH * abs(last):
                break
            last, self._shown = value, (live.assembly, shot.motion)
            content = answer_told(quick(live.assembly, goals, shot), command("flex", sheet.file, design))
            content |= self.new_rings(design, live.assembly, out)
            out.reply(content | {"settled": False}, [shot.motion[None]])
            if shot.settled:
                break
        return True

    def settled(self, request: Flex, out: Out) -> bool:
        """Answer fully."""
        answer = self._sheet.answer(request.design, out)
        self._shown = answer.assembly, answer.motion
        content = answer_told(answer, command("flex", self._sheet.file, request.design))
        content |= self.new_rings(request.design, answer.assembly, out)
        out.reply(content | {"settled": True}, [way_frames(answer.assembly, answer.waypoints)])
        return False

    def settle(self, design: Design, out: Out) -> Answer:
        """The full answer, worked out."""
        goals = self._sheet.asked(design)
        return self.at(design).settle(goals, stop=out.stop, progress=out.progress)

    def drag(self, request: Drag, out: Out) -> None:
        """Bring a part as near to a place as it goes; told at once, and again while it gets nearer."""
        live = self.at(request.design)
        rings, start, last = self.new_rings(request.design, live.assembly, out), request.from_, math.inf
        stuck = 0
        for times in range(MOST_TURNS):
            shot = live.drag(request.part, request.grip, request.target, start=start, seconds=SECONDS, stop=out.stop)
            out.check()
            assert shot.distance is not None
            stuck = stuck + 1 if shot.distance > last * (1 - LITTLE) else 0
            settled = shot.settled or times == MOST_TURNS - 1 or stuck == MOST_STUCK
            self._shown = live.assembly, shot.motion
            content = {
                "part": request.part,
                "target": list(request.target),
                "reached": shot.reached,
                "distance": shot.distance,
                "held": contacts_told(shot.contacts),
                "blocking": list(shot.blocking),
                "settled": settled,
            }
            out.reply(content | rings, [shot.motion[None]])
            if settled:
                return
            rings, start, last = {}, "here", min(last, shot.distance)

    def wiggle(self, request: Wiggle, out: Out) -> None:
        """Show the freedoms that are left."""
        modes = self.at(request.design).wiggle(request.part, stop=out.stop)
        out.check()
        told = [{"size": mode.size, "parts": list(mode.parts), "ends": mode.ends} for mode in modes]
        out.reply({"modes": told}, [mode.frames for mode in modes], kind="modes")

    def new_rings(self, design: Design, assembly: Assembly, out: Out) -> Json:
        """Outlines as made, where the page may not have them: a page drops replies that a newer request has overtaken."""
        key, now = self._sheet.designs.shape(design), time.monotonic()
        if key != self._outlines:
            self._outlines, self._since, self._rings = key, now, rings_told(assembly.parts)
        elif self._told.is_set():
            self._since = now
        elif now > self._since + AGAIN:
            return {}
        self._told = out.stop
        return {"rings": self._rings}

    def relative(self, space: FreeSpace) -> list[float]:
        """Where the pair of a free space is shown: motion of its pivot [mm] and turn [deg]."""
        if self._shown is None or not set(space.parts) <= set(self._shown[0].names):
            return [0.0, 0.0, 0.0]
        assembly, motion = self._shown
        a, b = (assembly.names.index(name) for name in space.parts)
        rest, now = assembly.rest, assembly.rest + motion
        tau = turn(now[b, :2] - now[a, :2], -now[a, 2]) - turn(rest[b, :2] - rest[a, :2], -rest[a, 2])
        phi = motion[b, 2] - motion[a, 2]
        pivot = tau + swing(space, np.array([phi]))[0]
        return [float(pivot[0]), float(pivot[1]), float(np.degrees(phi))]


def drag(sheet: Sheet, request: Drag, out: Out) -> None:
    """Bring a part as near to a place as it goes."""
    sheet.moves.drag(request, out)


def release(_: Sheet, __: Release, out: Out) -> None:
    """End a drag; the parts stay where they are shown."""
    out.reply({})


def wiggle(sheet: Sheet, request: Wiggle, out: Out) -> None:
    """Show the freedoms that are left."""
    sheet.moves.wiggle(request, out)


def shape(sheet: Sheet, request: Shape, out: Out) -> None:
    """Outlines with the gap applied."""
    out.reply({"rings": rings_told(sheet.assembly(request.design).parts)})


def quick(assembly: Assembly, goals: tuple[Goal, ...], shot: Shot) -> Answer:
    """What was found in the time there was, as an answer."""
    return witnessed(
        assembly,
        goals,
        Verdict.UNBOUNDED if shot.objective is None else Verdict.STOPPED,
        shot.objective,
        shot.motion[None],
        "not checked",
        contacts=shot.contacts,
        seconds={"total": shot.seconds},
        leaves=shot.leaves,
        turns=shot.turns,
    )
