"""Whether it comes apart, as a picture and as a film."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from wiggleroom.disassembly.interlock import Interlock
from wiggleroom.disassembly.largest_gap import LargestGap
from wiggleroom.report.film import film
from wiggleroom.report.leaving_picture import Leaving, leaving_picture
from wiggleroom.report.separability import as_answer, check_facts, check_title


@dataclass(frozen=True, eq=False)
class Checked:
    """What `check` found, with the largest gap where that was asked for."""

    found: Interlock
    border: LargestGap | None = None


def picture_of_check(checked: Checked, *, command: str = "") -> str:
    """All parts at rest, with a number in the order of leaving and an arrow on each that leaves, as an SVG picture."""
    found = checked.found
    order = [Leaving(e.parts, e.path) for e in found.escapes]
    moved = {n for e in found.escapes for k, n in enumerate(found.assembly.names) if e.path[:, k].any()}
    aside = moved - {n for e in found.escapes for n in e.parts}
    said = check_facts(found, checked.border)
    return leaving_picture(found.assembly, order, aside, title=check_title(found), said=said, command=command)


def film_of_check(
    checked: Checked, path: Path, *, command: str = "", progress: Callable[[int, int], None] | None = None
) -> None:
    """Write a film of all that leave, one after the other."""
    answer = as_answer(checked.found)
    film(
        answer.assembly,
        answer.waypoints,
        path,
        goals=answer.goals,
        pulled="leaves",
        title=check_title(checked.found),
        facts=tuple(check_facts(checked.found, checked.border)),
        command=command,
        progress=progress,
    )
