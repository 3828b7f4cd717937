"""Whether it comes apart, as JSON (`wiggleroom.check/1`), in words, and as an answer that can be drawn."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np
from msgspec import UNSET

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.inner_point import inner_point
from wiggleroom.disassembly.interlock_result import Escape, Interlock
from wiggleroom.disassembly.largest_gap import RELATIVE_TOLERANCE, LargestGap
from wiggleroom.drawing.model import Pull, Vector
from wiggleroom.planning.plan import Plan
from wiggleroom.planning.steps import STILL, axes_of, moves_of
from wiggleroom.report.results.answer_words import MIN_MOTION, few, number, towards
from wiggleroom.report.results.json_results import part_motion
from wiggleroom.schema.disassembly_schema import (
    CheckResult,
    EscapeEntry,
    LargestGapEntry,
    SeparabilityEntry,
    StateSearchEntry,
)
from wiggleroom.schema.spatial_result_schema import (
    SpatialCheckResult,
    SpatialEscapeEntry,
    SpatialLargestGapEntry,
    SpatialSeparabilityEntry,
)
from wiggleroom.search.answer import Answer, witnessed
from wiggleroom.verdict import Certainty, PathState, Separability, Verdict


@dataclass(frozen=True, eq=False)
class Checked:
    """What `check` found, with the largest gap where that was asked for."""

    found: Interlock
    border: LargestGap | None = None

    @property
    def assembly(self) -> Assembly:
        """As it was asked about."""
        return self.found.assembly


def check_result(
    found: Interlock, border: LargestGap | None = None, command: str = ""
) -> CheckResult | SpatialCheckResult:
    """Everything `check --json` says; lengths in mm, angles in degrees."""
    kind: Any = SpatialCheckResult if _in_space(found) else CheckResult
    gap_kind: Any = SpatialLargestGapEntry if _in_space(found) else LargestGapEntry
    return kind(
        **msgspec.structs.asdict(_separability(found)),
        gap=found.assembly.gap,
        largest_gap=UNSET if border is None else gap_kind(
            interlocked_at=border.holds,
            comes_apart_at=border.parts_at,
            interlocked=None if border.interlocked is None else _separability(border.interlocked),
            comes_apart=None if border.apart is None else _separability(border.apart),
        ),
        seconds=round(found.seconds, 4),
        notes=list(found.assembly.drawing.notes),
        command=command,
    )  # fmt: skip


def _separability(found: Interlock) -> Any:
    names = found.assembly.names
    paths = [(list(e.parts), _waypoints(names, e)) for e in found.escapes]
    if _in_space(found):
        return SpatialSeparabilityEntry(
            verdict=found.verdict,
            certainty=found.certainty,
            escapes=[SpatialEscapeEntry(*path) for path in paths],
            spins=list(found.spins),
            remains=list(found.remains),
        )
    return SeparabilityEntry(
        verdict=found.verdict,
        certainty=found.certainty,
        at_most=found.at_most,
        escapes=[EscapeEntry(*path) for path in paths],
        spins=list(found.spins),
        remains=list(found.remains),
        search=search_entry(found),
    )


def _waypoints(names: tuple[str, ...], escape: Escape) -> list[dict[str, Any]]:
    """Waypoints; each says only the parts that are not at rest anywhere on the path."""
    moved = np.flatnonzero((np.abs(escape.path) > MIN_MOTION).any(axis=(0, 2))).tolist()
    return [{names[k]: part_motion(m[k]) for k in moved} for m in escape.path]


def remains(found: Interlock) -> str:
    """Say what stays; several fixed parts hold others, but are not interlocked with each other."""
    if _in_space(found):  # what stands is among them
        return f"remains: {few(found.remains)}"
    fixed = {p.name for p in found.assembly.parts if p.fixed}
    held = [name for name in found.remains if name not in fixed]
    if len(fixed) < 2 or not held:
        return f"remains interlocked: {few(found.remains)}"
    return f"remains interlocked with what is fixed: {few(held)}"


def why(found: Interlock) -> str:
    """What the verdict rests on."""
    if found.verdict is Separability.COMES_APART:
        if found.certainty is Certainty.SEARCHED:
            return "parts touch at rest; with a little gap this is a path out, every step checked for overlap"
        return "every step of the path checked for overlap"
    if _in_space(found):
        return _why_in_space(found)
    if found.tight:
        return "parts touch at rest, and their contacts lock them" + (
            ", proven by forces" if found.certainty is Certainty.PROVEN else "; curves were taken as polygons"
        )
    if found.verdict is Separability.UNKNOWN:
        return f"the search was cut short, or found no end that is certain: {extent_text(found)}"
    if found.at_most is not None:
        return f"proven, no part gets further than {further(found.at_most)} mm from where it lies"
    if found.certainty is Certainty.PROVEN:
        return "proven, free spaces are closed"
    if found.states > 1:
        return (
            f"searched, nothing leaves from {found.states:,} states to which slides and turns of single parts lead, nor along "
            f"{found.questions:,} largest motions"
        )
    return f"searched, no path out was found along {found.questions:,} largest motions"


def _why_in_space(found: Interlock) -> str:
    if found.verdict is Separability.UNKNOWN:
        return "no path out was found, and not every motion was covered"
    if found.certainty is Certainty.PROVEN:
        return "proven"
    return "searched: no path out by slides, turns in place and largest motions; others were not tried"


def _in_space(found: Interlock) -> bool:
    return found.assembly.dimension == 3


def further(distance: float) -> str:
    """A distance in three digits, rounded up.

    >>> further(0.12341)
    '0.124'
    """
    unit = 10.0 ** (math.floor(math.log10(distance)) - 2)
    return number(math.ceil(distance / unit) * unit)


def leaves(found: Interlock, escape: Escape) -> str:
    """Who leaves, and how."""
    verb = "leaves" if len(escape.parts) == 1 else "leave together"
    return f"{few(escape.parts)} {verb} {direction_text(found, escape)}"


def check_title(found: Interlock) -> str:
    """Verdict and gap in one line."""
    return f"{found.verdict} at gap {number(found.assembly.gap)} mm"


def check_facts(found: Interlock, border: LargestGap | None) -> list[str]:
    """Facts under the title."""
    gone = [name for escape in found.escapes for name in escape.parts]
    said = [f"{len(found.assembly.parts)} parts", why(found)]
    said += [f"leaves: {few(gone)}"] if gone else []
    return said + ([border_sentence(border)] if border is not None else [])


def check_sure(found: Interlock) -> list[tuple[str, str]]:
    """What a verdict rests on and what it took: a word and a sentence each."""
    return [
        ("verdict", f"{found.verdict}: {why(found)}"),
        ("certainty", found.certainty),
        ("took", f"{found.seconds:.2f} seconds, {extent_text(found)}"),
    ]


def direction_text(found: Interlock, escape: Escape) -> str:
    """How the parts go: along which axes, in how many moves where none of these turns anything."""
    way = towards(last_direction(found, escape))
    moves = int(moves_of(escape.path)[-1]) + 1
    if moves == 1:
        return f"straight in {way}"
    axes = axes_of(escape.path)
    if np.abs(escape.path[..., axes:] - escape.path[0, :, axes:]).max() > STILL:
        return f"on a path of {len(escape.path)} points, at last in {way}"
    change = np.abs(np.diff(escape.path[..., :axes], axis=0)) > STILL
    used = ["xyz"[k] for k in range(axes) if change[..., k].any()]
    along = f" along {few(used)}" if (change.sum(axis=2) < 2).all() else ""
    return f"in {moves} moves{along}, at last in {way}"


def last_direction(found: Interlock, escape: Escape) -> Vector:
    """Unit vector along which the first of the parts leaves at last."""
    rows = [found.assembly.names.index(name) for name in escape.parts]
    steps = np.diff(escape.path[:, rows, : found.assembly.dimension], axis=0)
    length = np.linalg.norm(steps, axis=2)
    last = int(length.max(axis=1).argmax())
    return tuple((steps[last, 0] / length[last, 0]).tolist())


def border_sentence(border: LargestGap) -> str:
    """Say at which gap it comes apart."""
    if border.holds is None:
        return "largest gap: none was found" if border.parts_at is None else "largest gap: no gap holds it together"
    if border.parts_at is None:
        return f"largest gap: it holds up to {number(border.holds)} mm; beyond that parts fall to pieces"
    between = (
        ""
        if border.parts_at - border.holds <= RELATIVE_TOLERANCE * border.parts_at
        else "; between them it was not decided"
    )
    return f"largest gap: interlocked at {number(border.holds, 5)} mm, comes apart at {number(border.parts_at, 5)} mm{between}"


def as_answer(found: Interlock) -> Answer:
    """The paths of all that leave, one after the other, as an answer that can be drawn and filmed."""
    n = len(found.assembly.names)
    waypoints = np.concatenate([e.path for e in found.escapes]) if found.escapes else np.zeros((1, n, 3))
    gone = tuple(name for e in found.escapes for name in e.parts)
    goals = tuple(
        Pull(e.parts[0], last_direction(found, e), inner_point(found.assembly, e.parts[0])) for e in found.escapes
    )
    verdict, objective = (Verdict.UNBOUNDED, None) if gone else (Verdict.STATIONARY, 0.0)
    return witnessed(
        found.assembly, goals, verdict, objective, waypoints, PathState.CHECKED, leaves=gone, turns=found.spins
    )


def extent_text(found: Interlock | Plan) -> str:
    """Words for the states that were visited, those in which parts were turned, and the largest motions that were searched."""
    said = []
    if found.states > 1:
        said.append(f"{found.states:,} states visited")
        if found.turned:
            all_ = found.turned == found.states and found.whole
            said.append("parts turned in all of them" if all_ else f"parts turned in {found.turned:,} of them")
    count = found.questions
    without = f" ({found.unanswered:,} without an end that is certain)" if found.unanswered else ""
    said.append(f"{count or 'no'} largest motion{'s' if count > 1 else ''} searched{without}")
    return ", ".join(said)


def search_entry(found: Interlock | Plan) -> StateSearchEntry:
    """The same as JSON."""
    return StateSearchEntry(
        states=found.states,
        turned=found.turned,
        whole=found.whole,
        questions=found.questions,
        unanswered=found.unanswered,
    )
