"""Rank, check, sweep and prove, for the page: the same functions as the commands', in the same words."""

from __future__ import annotations

import math
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

from wiggleroom.app.command import command
from wiggleroom.app.dimension_messages import frames_of, still_frame
from wiggleroom.app.motion_requests import searched, tell_answer
from wiggleroom.app.reporter import Reporter
from wiggleroom.report.page.study_messages import check_message, ranking_message, step_message
from wiggleroom.report.results.answer_words import bound_sentence, proven
from wiggleroom.report.results.separability import border_sentence
from wiggleroom.schema.requests import (
    BoundRequest,
    CheckRequest,
    LimitRequest,
    PlanRequest,
    ProveRequest,
    RankRequest,
    SampleRequest,
    SweepRequest,
    TightenRequest,
)
from wiggleroom.schema.study_replies import BoundReply, LimitReply, ProveReply, SweepReply

if TYPE_CHECKING:
    from wiggleroom.app.document import Document
    from wiggleroom.sensitivity.sweep import SweepStep

BOUND_WORK = 20_000.0
"""Work of a quick bound that was not asked for, about milliseconds."""


def rank(document: Document, request: RankRequest, out: Reporter) -> None:
    """Whose gap matters, of parts; from the forces of the full answer."""
    from wiggleroom.gap_questions import rank as work_out

    found = work_out(searched(document, request.design, out), stop=out.stop, progress=out.counted)
    out.check()
    out.reply(ranking_message(found, command("rank", document.file, request.design)))


def check(document: Document, request: CheckRequest, out: Reporter) -> None:
    """Whether it comes apart; one film for each escape."""
    found = document.checked(request.design, out)
    content = check_message(found, command("check", document.file, request.design, pulled=False))
    out.reply(content, [frames_of(found.assembly, e.path) for e in found.escapes])


def limit(document: Document, request: LimitRequest, out: Reporter) -> None:
    """The largest gap that holds everything together."""
    found = document.largest_gap(request.design, out)
    said = command("check", document.file, request.design, ("--largest-gap",), pulled=False)
    out.reply(LimitReply(words=border_sentence(found), holds=found.holds, parts_at=found.parts_at, command=said))


def plan(document: Document, request: PlanRequest, out: Reporter) -> None:
    """How it is taken apart; one film for each step."""
    from wiggleroom.report.page.plan_messages import plan_message, plan_options

    found = document.planned(request.design, out, tuple(request.targets), request.gravity)
    said = command("plan", document.file, request.design, plan_options(found), pulled=False)
    out.reply(plan_message(found, said), [frames_of(found.assembly, step.path) for step in found.steps])


def sweep(document: Document, request: SweepRequest, out: Reporter) -> None:
    """Motion against gap, told gap by gap; what it finds at the design's own gap is the answer, where that is more."""
    from wiggleroom.gap_questions import sweep as work_out
    from wiggleroom.sensitivity.perturbation import exceeds

    def tell(step: SweepStep, motion: np.ndarray | None) -> None:
        out.check()
        out.reply(step_message(step), [] if motion is None else [still_frame(motion)])
        if step.gap == made.gap and step.answer is not None and exceeds(step.answer, document.kept(request.design)):
            document.know(request.design, step.answer)
            tell_answer(document, request.design, step.answer, "", out)

    goals = document.asked(request.design)
    made = document.assembly(request.design)
    found = work_out(made, request.gaps, goals, stop=out.stop, each=tell)
    out.check()
    said = command("sweep", document.file, request.design, _gaps(request))
    out.reply(SweepReply(steps=[step_message(s) for s in found.steps], lost=found.lost, command=said))


def _gaps(request: SweepRequest) -> tuple[str, ...]:
    return () if not request.gaps else ("--gaps", ",".join(f"{gap:.12g}" for gap in request.gaps))


def tighten(document: Document, request: TightenRequest, out: Reporter) -> None:
    """Which parts to make tighter."""
    from wiggleroom.gap_questions import tighten as work_out
    from wiggleroom.report.page.study_tabs import tightening_message

    found = work_out(
        searched(document, request.design, out),
        parts=request.parts, limit=request.limit, draws=0, workers=1, stop=out.stop, progress=out.counted,
    )  # fmt: skip
    out.check()
    more = _option("--parts", request.parts) + _option("--limit", request.limit) + ("--draws", "0")
    out.reply(tightening_message(found, command("tighten", document.file, request.design, more)))


def sample(document: Document, request: SampleRequest, out: Reporter) -> None:
    """How far it moves where gaps vary at random."""
    from wiggleroom.gap_questions import sample as work_out
    from wiggleroom.report.page.study_tabs import sample_message

    found = work_out(
        searched(document, request.design, out), request.spread,
        draws=request.draws, limit=request.limit, workers=1, stop=out.stop, progress=out.counted,
    )  # fmt: skip
    out.check()
    more = _option("--spread", request.spread) + _option("--draws", request.draws) + _option("--limit", request.limit)
    out.reply(sample_message(found, command("sample", document.file, request.design, more)))


def _option(name: str, value: float | None) -> tuple[str, ...]:
    return () if value is None else (name, f"{value:g}")


def prove(document: Document, request: ProveRequest, out: Reporter) -> None:
    """A value that no motion exceeds."""
    from wiggleroom.bound.prove import prove as work_out

    answer = searched(document, request.design, out)
    done = work_out(answer, request.share, seconds=request.seconds, stop=out.stop, progress=out.progress)
    out.check()
    bound = done.bound
    within = None if bound is None or bound.within is None or not math.isfinite(bound.within) else bound.within
    more = ("--prove", f"{request.share:g}", "--time", f"{request.seconds:g}")
    said = command("flex", document.file, request.design, more)
    if done.at_most is not None:
        document.know(request.design, done)
        if (done.at_most, done.verdict) != (answer.at_most, answer.verdict):
            tell_answer(document, request.design, done, "", out)
    out.reply(ProveReply(at_most=done.at_most, within=within, words=bound_sentence(done), command=said))


def bound(document: Document, request: BoundRequest, out: Reporter) -> None:
    """What a direct question finds beyond the climb from rest, and a quick bound of that; in idle time."""
    from wiggleroom.bound.dual_bound import with_bound_by_work

    answer = searched(document, request.design, out)
    done = with_bound_by_work(answer, BOUND_WORK, out.stop) if find_spec("highspy") else answer
    out.check()
    within = None if done.bound is None else done.bound.within
    out.reply(BoundReply(at_most=done.at_most, within=within, words=proven(done)))
    if done.at_most is not None:
        document.know(request.design, done)
