"""Whether it comes apart, as a film."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from wiggleroom.report.films.film import film
from wiggleroom.report.results.separability import Checked, as_answer, check_facts, check_title


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
