"""Plans as pictures: numbered stills, films, and a page on which every step can be played."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.inner_point import inner_point
from wiggleroom.disassembly.remaining import displaced, only
from wiggleroom.drawing.model import Pull
from wiggleroom.files import write_whole
from wiggleroom.planning.plan import Plan
from wiggleroom.planning.steps import STILL, Step
from wiggleroom.report.films.film import film
from wiggleroom.report.page.plan_messages import plan_steps, plan_sure
from wiggleroom.report.page.standalone_page import packed_frames, shown_drawing, standalone_page
from wiggleroom.report.pictures.leaving_picture import Leaving, leaving_picture
from wiggleroom.report.pictures.picture import LegendWords, picture
from wiggleroom.report.results.plan_results import (
    PlanTolerances,
    plan_facts,
    plan_title,
    searched_sentence,
    step_sentence,
    tolerance_sentences,
)
from wiggleroom.schema.standalone_schema import StandaloneCheck
from wiggleroom.schema.study_replies import CheckReply, Title
from wiggleroom.search.answer import witnessed
from wiggleroom.verdict import PathState, Verdict

SECONDS_PER_STEP, MAX_SECONDS = 0.8, 20.0
"""Time of each step in the film of a plan, and of the whole film at most [s]."""
STEP_WORDS = LegendWords("moves", "goes this way", "before the step")
"""Legend of the picture of a step."""


def picture_of_plan(found: Plan, *, command: str = "") -> str:
    """All parts at rest, with a number in the order of leaving and an arrow on each that leaves, as an SVG picture."""
    order = [Leaving(step.leaves, step.path) for step in found.steps if step.leaves]
    gone = {name for leaving in order for name in leaving.parts}
    aside = {name for step in found.steps for name in step.parts} - gone
    title, said = plan_title(found), plan_facts(found)
    return leaving_picture(found.assembly, order, aside, title=title, said=said, command=command)


def film_of_plan(
    found: Plan, path: Path, *, command: str = "", progress: Callable[[int, int], None] | None = None
) -> None:
    """Write a film of all steps, one after the other."""
    film(
        found.assembly,
        found.path,
        path,
        title=plan_title(found),
        facts=tuple(plan_facts(found)),
        command=command,
        least_seconds=min(SECONDS_PER_STEP * len(found.steps), MAX_SECONDS),
        progress=progress,
    )


def page_of_plan(found: Plan, told: PlanTolerances | None = None, *, command: str = "") -> str:
    """Plan as one HTML page: the drawing, the steps, each of which can be played, and what is known of it when gaps vary."""
    title, said = plan_title(found), [*plan_facts(found), *tolerance_sentences(told or PlanTolerances())]
    reply = CheckReply(
        verdict=found.verdict,
        certainty=found.certainty,
        words=f"{found.verdict}: {'; '.join(said) or searched_sentence(found)}",
        sure=plan_sure(found),
        escapes=plan_steps(found),
        spins=[],
        remains=list(found.remains),
        border=None,
        command=command,
    )
    paths = [packed_frames(found.assembly, step.path) for step in found.steps]
    return standalone_page(
        title,
        opened=shown_drawing(found.assembly),
        said=Title(title, said),
        tab="apart",
        check=StandaloneCheck(reply, paths),
    )


def write_stills(found: Plan, folder: Path, *, command: str = "") -> int:
    """Write a picture of every step into a folder: step_01.svg and so on; how many."""
    digits = max(2, len(str(len(found.steps))))
    for k in range(len(found.steps)):
        write_whole(folder / f"step_{k + 1:0{digits}}.svg", still(found, k, command=command))
    return len(found.steps)


def still(found: Plan, k: int, *, command: str = "") -> str:
    """Picture of step k, from 0: where it begins in thin lines, where it ends, and arrows along which parts go."""
    step = found.steps[k]
    title = f"step {k + 1} of {len(found.steps)}: {step_sentence(step)}"
    said = [f"hold: {', '.join(step.all_held)}"] if step.all_held else []
    if found.assembly.dimension == 3:
        from wiggleroom.report.solids.spatial_picture import step_svg

        return step_svg(found.assembly, step, k + 1, [title, *said])
    there = np.flatnonzero(step.there)
    begin = only(displaced(found.assembly, step.path[0]), there)
    path = (step.path - step.path[:1])[:, there]
    shown = _within(path, begin.size) if step.leaves else path
    answer = witnessed(
        begin, tuple(_arrow(begin, step, name, found) for name in step.parts), Verdict.STATIONARY,
        0.0, shown, PathState.CHECKED, command=command,
    )  # fmt: skip
    return picture(answer, magnify=1.0, title=title, said=said, words=STEP_WORDS)


def _within(path: NDArray[np.float64], size: float) -> NDArray[np.float64]:
    """The path with its last, long piece cut where the picture would get too large."""
    out = path.copy()
    last = out[-1] - out[-2]
    length = np.hypot(last[:, 0], last[:, 1]).max()
    out[-1] = out[-2] + last * min(1.0, 0.35 * size / length) if length > STILL else out[-1]
    return out


def _arrow(begin: Assembly, step: Step, name: str, found: Plan) -> Pull:
    """Arrow of a part, from a point inside it, along the path it goes."""
    row = found.assembly.names.index(name)
    change = step.path[-1, row] - step.path[0, row]
    direction = change[:2] if np.hypot(*change[:2]) > STILL else np.array([1.0, 0.0])
    return Pull(name, (float(direction[0]), float(direction[1])), inner_point(begin, name))
