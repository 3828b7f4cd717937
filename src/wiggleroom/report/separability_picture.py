"""Whether it comes apart, as a picture and as a film."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from wiggleroom.disassembly.interlock import Interlock
from wiggleroom.disassembly.largest_gap import LargestGap
from wiggleroom.report.film import film
from wiggleroom.report.picture import picture
from wiggleroom.report.separability import as_answer, check_facts, check_title


@dataclass(frozen=True, eq=False)
class Checked:
    """What `check` found, with the largest gap where that was asked for."""

    found: Interlock
    border: LargestGap | None = None


def picture_of_check(checked: Checked, *, command: str = "") -> str:
    """Parts where they came to, those that leave beside those that stay, as an SVG picture."""
    answer, said = as_answer(checked.found, command), check_facts(checked.found, checked.border)
    return picture(answer, title=check_title(checked.found), said=said, leaving=True)


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
        title=check_title(checked.found),
        facts=tuple(check_facts(checked.found, checked.border)),
        command=command,
        progress=progress,
    )
