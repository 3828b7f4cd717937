"""Whether it comes apart, as a picture, as a film and as a report."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from wiggleroom.analysis.interlock import Interlock
from wiggleroom.analysis.largest_gap import LargestGap
from wiggleroom.report.apart import along, as_answer, border_sentence, some, why
from wiggleroom.report.film import film
from wiggleroom.report.html import film_of, magnified
from wiggleroom.report.page import Section, figure, items, page, table
from wiggleroom.report.picture import picture
from wiggleroom.report.words import number


@dataclass(frozen=True, eq=False)
class Checked:
    """What `check` found, with the largest gap where that was asked for."""

    found: Interlock
    border: LargestGap | None = None

    @property
    def title(self) -> str:
        """Verdict and gap in one line."""
        return f"{self.found.verdict} at gap {number(self.found.assembly.gap)} mm"

    @property
    def facts(self) -> list[str]:
        """Facts under the title."""
        leaves = [name for escape in self.found.escapes for name in escape.parts]
        said = [f"{len(self.found.assembly.parts)} parts", why(self.found)]
        said += [f"leaves: {some(tuple(leaves))}"] if leaves else []
        return said + ([border_sentence(self.border)] if self.border is not None else [])


def picture_of_check(checked: Checked, *, command: str = "") -> str:
    """Parts where they came to, those that leave beside those that stay, as an SVG picture."""
    return picture(as_answer(checked.found, command), title=checked.title, said=checked.facts)


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
        title=checked.title,
        facts=tuple(checked.facts),
        command=command,
        progress=progress,
    )


def page_of_check(checked: Checked, *, command: str = "") -> str:
    """Report as one HTML page: who leaves, in which order and how, as a table, a film and a picture."""
    found = checked.found
    answer = as_answer(found)
    sections = []
    if found.escapes:
        rows = [(k + 1, ", ".join(e.parts), along(found, e)) for k, e in enumerate(found.escapes)]
        sections += [
            film_of(answer),
            Section("Who leaves, in this order", table(["", "parts", "way"], rows), wide=True),
        ]
    shown = picture(answer, framed=False, title=checked.title, said=checked.facts)
    heading = "Where they come to" if found.escapes else "The parts at rest"
    sure = [
        ("verdict", f"{found.verdict}: {why(found)}"),
        *([("largest gap", border_sentence(checked.border).removeprefix("largest gap: "))] if checked.border else []),
        *([("remains", f"interlocked: {some(found.remains)}")] if found.escapes and len(found.remains) > 1 else []),
        *([("turns", f"in place without limit: {some(found.spins)}")] if found.spins else []),
        ("searched", f"{found.questions} largest motions, {found.seconds:.2f} seconds"),
    ]
    sections += [
        Section(heading, figure(shown, magnified(answer)), wide=True),
        Section("How sure is it", items(sure), wide=True),
    ]
    return page(checked.title, checked.facts, sections, command)
