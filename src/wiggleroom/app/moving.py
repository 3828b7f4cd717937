"""Shape, flex, drag and wiggle: what follows the hand."""

from __future__ import annotations

import threading
from collections.abc import Hashable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.analysis.answer import Answer
from wiggleroom.analysis.audit import swing
from wiggleroom.analysis.flex import flex
from wiggleroom.app.command import command
from wiggleroom.app.frames import way_frames
from wiggleroom.app.messages import Design, Drag, Flex, Json, Release, Shape, Wiggle
from wiggleroom.app.opening import rings_of
from wiggleroom.app.out import Out
from wiggleroom.assembly.model import Assembly
from wiggleroom.drawing.model import Pull
from wiggleroom.errors import InputError
from wiggleroom.freespace.space import FreeSpace
from wiggleroom.report.html import answer_sure
from wiggleroom.report.motion import Way
from wiggleroom.report.words import headline

if TYPE_CHECKING:
    from wiggleroom.app.desk import Desk

Floats = NDArray[np.float64]


class Moves:
    """Where the parts of one drawing are shown, and what moves them.

    Parameters
    ----------
    desk : Desk
    """

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self._told: tuple[Hashable, threading.Event] | None = None
        self._shown: tuple[Assembly, Floats] | None = None

    def flex(self, request: Flex, out: Out) -> bool:
        """Answer; True where a fuller one is to come."""
        return self.settled(request, out)

    def settled(self, request: Flex, out: Out) -> bool:
        """The full answer."""
        answer = self._desk.answer(request.design, out)
        content = flex_content(self._desk, request.design, answer) | self.new_rings(request.design, out)
        self._shown = answer.assembly, answer.motion
        out.reply(content | {"settled": True}, [way_frames(answer.assembly, answer.waypoints)])
        return False

    def drag(self, request: Drag, out: Out) -> None:
        """As near to a place as the part can be drawn."""
        ready = self._desk.prepared(request.design)
        names, rest = ready.assembly.names, ready.assembly.rest
        grip, target = np.array(request.grip), np.array(request.target)
        if request.part not in names:
            finding = f'drag: there is no part "{request.part}"'
            raise InputError(finding)
        k = names.index(request.part)
        answer = flex(ready, Pull(request.part, tuple(target - grip), tuple(grip)), stop=out.stop)
        way = Way(ready.assembly, answer.waypoints)
        motions = way.at(np.linspace(0, way.length, 65))
        arm = grip - rest[k, :2]
        c, s = np.cos(motions[:, k, 2]), np.sin(motions[:, k, 2])
        at = rest[k, :2] + motions[:, k, :2] + np.column_stack([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]])
        away = np.hypot(*(at - target).T)
        best = int(away.argmin())
        self._shown = ready.assembly, motions[best]
        held = contacts(answer) if best == len(motions) - 1 else []
        content = {
            "part": request.part,
            "target": list(request.target),
            "reached": at[best].tolist(),
            "distance": float(away[best]),
            "held": held,
            "blocking": sorted({name for c in held for name in c["parts"]} - {request.part}),
            "settled": True,
        }
        out.reply(content, [motions[best : best + 1]])

    def release(self, _: Release, out: Out) -> None:
        """End a drag; the parts stay where they are shown."""
        out.reply({})

    def new_rings(self, design: Design, out: Out) -> Json:
        """Outlines as made, where the page has not had them: a reply that was stopped did not get there."""
        key = self._desk.designs.shape(design)
        if self._told is not None and self._told[0] == key and not self._told[1].is_set():
            return {}
        self._told = key, out.stop
        return {"rings": rings(self._desk.assembly(design))}

    def relative(self, space: FreeSpace) -> list[float]:
        """Where the pair of a free space is shown: motion of its pivot [mm] and turn [deg]."""
        if self._shown is None or not set(space.parts) <= set(self._shown[0].names):
            return [0.0, 0.0, 0.0]
        assembly, motion = self._shown
        a, b = (assembly.names.index(name) for name in space.parts)
        rest, now = assembly.rest, assembly.rest + motion
        tau = _in_axes(now[b, :2] - now[a, :2], now[a, 2]) - _in_axes(rest[b, :2] - rest[a, :2], rest[a, 2])
        phi = motion[b, 2] - motion[a, 2]
        pivot = tau + swing(space, np.array([phi]))[0]
        return [float(pivot[0]), float(pivot[1]), float(np.degrees(phi))]


def shape(desk: Desk, request: Shape, out: Out) -> None:
    """Outlines with the gap applied."""
    out.reply({"rings": rings(desk.assembly(request.design))})


def wiggle(desk: Desk, request: Wiggle, out: Out) -> None:
    """The freedoms that are left."""
    raise InputError("wiggle: not there yet")


def rings(assembly: Assembly) -> list[list[list[list[float]]]]:
    """Outlines of all parts as made, at rest, in world coordinates [mm]."""
    return [[ring.tolist() for ring in rings_of(part)] for part in assembly.parts]


def contacts(answer: Answer) -> list[Json]:
    """Contacts with a force, the strongest first."""
    held = sorted((c for c in answer.contacts if c.force > 0), key=lambda c: -c.force)
    return [
        {"parts": list(c.parts), "point": list(c.point), "normal": list(c.normal), "force": float(c.force)}
        for c in held
    ]


def flex_content(desk: Desk, design: Design, answer: Answer) -> Json:
    """What an answer says, in the words of the commands."""
    return {
        "objective": answer.objective,
        "verdict": answer.verdict.value,
        "headline": headline(answer),
        "sure": answer_sure(answer),
        "at_most": answer.at_most,
        "leaves": list(answer.leaves),
        "turns": list(answer.turns),
        "contacts": contacts(answer),
        "collision_free": bool(answer.collision_free),
        "path": answer.path,
        "seconds": answer.seconds.get("total", 0.0),
        "command": command("flex", desk.file, design),
    }


def _in_axes(way: Floats, angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * way[0] + s * way[1], c * way[1] - s * way[0]])
