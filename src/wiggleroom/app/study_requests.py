"""Rank, check, sweep, prove and declared questions, for the page: the same functions as the commands', in the same words."""

from __future__ import annotations

import math
from collections.abc import Mapping
from importlib.util import find_spec
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from wiggleroom.app.command import command
from wiggleroom.app.dimension_messages import frames_of, still_frame
from wiggleroom.app.motion_requests import searched, tell_answer
from wiggleroom.app.reporter import Reporter
from wiggleroom.errors import InputError
from wiggleroom.report.page.study_messages import check_message, ranking_message, step_message
from wiggleroom.report.results.answer_words import bound_sentence, proven
from wiggleroom.report.results.separability import border_sentence
from wiggleroom.schema.requests import (
    BoundRequest,
    CheckRequest,
    LimitRequest,
    OptionValue,
    PlanRequest,
    ProveRequest,
    RankRequest,
    StudyRequest,
    SweepRequest,
)
from wiggleroom.schema.study_replies import BoundReply, LimitReply, ProveReply, SweepReply

if TYPE_CHECKING:
    from wiggleroom.app.document import Document
    from wiggleroom.sensitivity.sweep import SweepStep

BOUND_WORK = 20_000.0
"""Work of a quick bound that was not asked for, about milliseconds."""


def rank(document: Document, request: RankRequest, out: Reporter) -> None:
    """Whose gap matters, of parts; from the forces of the full answer."""
    from wiggleroom.studies.rank import rank as work_out

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
    from wiggleroom.sensitivity.perturbation import exceeds
    from wiggleroom.studies.sweep import sweep as work_out

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


def study(document: Document, request: StudyRequest, out: Reporter) -> None:
    """A declared question, put and told as its declaration says."""
    from wiggleroom.context import Context
    from wiggleroom.report.page.finding_page import study_message
    from wiggleroom.studies.registry import BY_NAME

    kind = BY_NAME.get(request.of)
    if kind is None or not kind.heading:
        wrong = f"{request.of}: there is no such question"
        raise InputError(wrong)
    if document.in_space and not kind.spatial:
        wrong = f"{request.of}: is for drawings; {document.file.name} is an assembly in space"
        raise InputError(wrong)
    try:
        question = msgspec.convert(request.options, kind)
    except msgspec.ValidationError as problem:
        wrong = f"{request.of}: {problem}"
        raise InputError(wrong) from None
    question.check(3 if document.in_space else 2)
    asked = question.asks_motion
    about = searched(document, request.design, out) if asked else document.assembly(request.design)
    found = question.ask(about, Context(stop=out.stop, progress=out.progress, counted=out.counted, workers=1))
    out.check()
    said = command(request.of, document.file, request.design, _options(request.options), pulled=asked)
    out.reply(study_message(question.finding(found, said), request.of, said))


def _options(options: Mapping[str, OptionValue]) -> tuple[str, ...]:
    """Options as a command has them."""
    found: list[str] = []
    for name, value in options.items():
        option = f"--{name.replace('_', '-')}"
        if value is True:
            found.append(option)
        elif value is not None and value is not False:
            found += [option, value if isinstance(value, str) else f"{value:.12g}"]
    return tuple(found)


def prove(document: Document, request: ProveRequest, out: Reporter) -> None:
    """A value that no motion exceeds."""
    from wiggleroom.questions import prove as work_out

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
