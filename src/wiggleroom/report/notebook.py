"""Whatever is found, and what it is about, in a notebook: the one-file page in a frame, and a few lines where no page can be shown."""

from __future__ import annotations

import html

import numpy as np

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.disassembly.interlock_result import Escape, Interlock
from wiggleroom.disassembly.largest_gap import LargestGap
from wiggleroom.displayable import Displayable
from wiggleroom.form_closure.blocking_graph import Blocking
from wiggleroom.form_closure.mobility import TightVerdict
from wiggleroom.freespace.free_space import FreeSpace
from wiggleroom.freespace.models.polyhedron import Polyhedron
from wiggleroom.live.live_result import LiveResult, Mode
from wiggleroom.planning.plan import Plan
from wiggleroom.planning.plan_tolerance import PlanRanking, PlanSample, SmallestGap
from wiggleroom.planning.steps import Step
from wiggleroom.report.finding import Finding
from wiggleroom.report.free_space.space_report import space_facts, space_headline
from wiggleroom.report.page.finding_page import page_of_finding
from wiggleroom.report.page.pages import page_of_assembly
from wiggleroom.report.page.plan_pictures import page_of_plan
from wiggleroom.report.page.solid_page import page_of_spatial_assembly
from wiggleroom.report.pictures.finding_picture import subtitle
from wiggleroom.report.results.answer_words import (
    assembly_lines,
    facts,
    few,
    headline,
    number,
    towards,
    verdict_sentence,
)
from wiggleroom.report.results.plan_results import (
    PlanTolerances,
    plan_facts,
    plan_title,
    step_sentence,
    tolerance_sentences,
)
from wiggleroom.report.results.separability import Checked, border_sentence, check_facts, check_title
from wiggleroom.report.write_picture import page_of
from wiggleroom.search.answer import Answer
from wiggleroom.search.prepare import Prepared

Study = Interlock | LargestGap | FreeSpace | Checked | Plan
HEIGHT = 560
"""Height of the frame [px]."""
MAX_MOVES = 5
"""At most this many sets of parts that can begin to slide are listed."""


def mime_bundle(found: Displayable | Finding) -> dict[str, str]:
    """What a notebook shows: the page in a frame that may run its script and nothing else, and text.

    Where there is nothing to put on a page, an empty sweep or a thing that knows no assembly, the text is alone.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> bundle = mime_bundle(wr.patterns.chain(2, gap=0.02))
    >>> print(bundle["text/plain"])
    2 parts, gap 0.02 mm
    b1 stands; asked: b2 in +y
    >>> sorted(bundle)
    ['text/html', 'text/plain']
    """
    said, page = lines(found), _page(found)
    shown = {"text/plain": "\n".join(said)}
    return shown if page is None else shown | {"text/html": sandboxed_frame(page, said[0])}


def sandboxed_frame(page: str, title: str) -> str:
    """Page in a frame of its own: it sees nothing of the notebook, and the notebook nothing of it."""
    return (
        f'<iframe title="{html.escape(title)}" srcdoc="{html.escape(page)}" sandbox="allow-scripts allow-downloads" '
        f'style="width:100%;height:{HEIGHT}px;border:1px solid #8884"></iframe>'
    )


def lines(found: Displayable | Finding) -> list[str]:
    """What was found in a few lines of text, the headline first."""
    match found:
        case Assembly():
            return assembly_lines(found)
        case Prepared():
            return [*assembly_lines(found.assembly), f"prepared: {len(found.cells.a)} pairs of neighbours"]
        case Answer():
            return [headline(found), f"{found.verdict}: {verdict_sentence(found)}", *facts(found)]
        case Interlock():
            return [check_title(found), *check_facts(found, None)]
        case LargestGap():
            return [border_sentence(found)]
        case Checked():
            return [check_title(found.found), *check_facts(found.found, found.border)]
        case Plan():
            return [plan_title(found), *plan_facts(found)]
        case PlanSample() | PlanRanking() | SmallestGap():
            return [*tolerance_sentences(_tolerances(found)), plan_title(found.plan)]
        case Finding():
            return [found.title, *subtitle(found)]
        case FreeSpace():
            return [space_headline(found), *space_facts(found, None)]
    return _lines_alone(found)


def _lines_alone(found: Displayable | Finding) -> list[str]:
    """The same of what knows no assembly."""
    match found:
        case Polyhedron():
            low, high = (number(np.degrees(angle), 3) for angle in found.angles)
            ends = "closed" if found.closed else "open"
            return [
                f"{found.parts[1]} against {found.parts[0]}, model {found.model}: {found.rows} faces, {low}° to {high}°, {ends}"
            ]
        case TightVerdict():
            moving = f": {few(found.moving)}" if found.moving else ""
            return [f"{found.verdict}, drawn tight{moving}"]
        case Blocking():
            moves = [
                f"{few(names)} can begin to slide in {towards(direction)}"
                for names, direction in found.moves[:MAX_MOVES]
            ]
            return [f"{found.verdict}, drawn tight" + (f"; the key is {found.key}" if found.key else ""), *moves]
        case LiveResult():
            end = "its end" if found.settled else "not settled: ask again to go on"
            value = [] if found.objective is None else [f"objective {number(found.objective)}"]
            short = [] if found.distance is None else [f"{number(found.distance, 3)} mm short of the target"]
            held = [f"held by {few(found.blocking)}"] if found.blocking else []
            gone = [f"leaves: {few(found.leaves)}"] if found.leaves else []
            return [f"motion of {len(found.motion)} parts, {end}", *value, *short, *held, *gone]
        case Mode():
            far = f"up to {number(found.size, 3)} mm" if found.ends else "without end"
            return [f"freedom {far}, most of all {few(found.parts)}"]
        case Escape():
            return [
                f"{few(found.parts)} {'leaves' if len(found.parts) == 1 else 'leave'} on a path of {len(found.path)} points"
            ]
        case Step():
            return [step_sentence(found)]
    raise TypeError(type(found).__name__)


def _tolerances(found: PlanSample | PlanRanking | SmallestGap) -> PlanTolerances:
    match found:
        case PlanSample():
            return PlanTolerances(sample=found)
        case PlanRanking():
            return PlanTolerances(rank=found)
        case SmallestGap():
            return PlanTolerances(gap=found)


def _page(found: Displayable | Finding) -> str | None:
    """The page; None where there is nothing to put on one."""
    match found:
        case Assembly():
            return page_of_assembly(found) if found.dimension == 2 else page_of_spatial_assembly(found)
        case Prepared():
            return page_of_assembly(found.assembly)
        case Answer():
            return page_of(found)
        case PlanSample() | PlanRanking() | SmallestGap():
            return page_of_plan(found.plan, _tolerances(found))
        case Finding():
            return None if found.figure is None and found.motion is None else page_of_finding(found)
    return page_of(found) if isinstance(found, Study) and _has_page(found) else None


def _has_page(found: Study) -> bool:
    """False where there is nothing to put on a page."""
    return not isinstance(found, LargestGap) or (found.apart is not None or found.interlocked is not None)
