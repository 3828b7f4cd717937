"""Rank, check, sweep and prove, for the page: the same functions as the commands', in the same words."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from wiggleroom.app.command import command
from wiggleroom.app.reporter import Reporter
from wiggleroom.report.answer_words import bounded
from wiggleroom.report.path_frames import way_frames
from wiggleroom.report.study_messages import check_message, ranking_message, step_message
from wiggleroom.schema.replies import ProveReply, SweepReply
from wiggleroom.schema.requests import CheckRequest, ProveRequest, RankRequest, SweepRequest

if TYPE_CHECKING:
    from wiggleroom.app.document import Document
    from wiggleroom.sensitivity.sweep import SweepStep


def rank(sheet: Document, request: RankRequest, out: Reporter) -> None:
    """Whose gap matters, of parts; from the forces of the full answer."""
    from wiggleroom.sensitivity.rank import rank as work_out

    found = work_out(sheet.answer(request.design, out), stop=out.stop, progress=out.counted)
    out.check()
    out.reply(ranking_message(found, command("rank", sheet.file, request.design)))


def check(sheet: Document, request: CheckRequest, out: Reporter) -> None:
    """Whether it comes apart; one film for each escape."""
    found = sheet.checked(request.design, out)
    content = check_message(found, command("check", sheet.file, request.design, pulled=False))
    out.reply(content, [way_frames(found.assembly, e.path) for e in found.escapes])


def sweep(sheet: Document, request: SweepRequest, out: Reporter) -> None:
    """Motion against gap, told gap by gap."""
    from wiggleroom.sensitivity.sweep import sweep as work_out

    def tell(step: SweepStep, motion: np.ndarray | None) -> None:
        out.check()
        out.reply(step_message(step), [] if motion is None else [motion[None]])

    sheet.asked(request.design)
    assembly = sheet.assembly(request.design)
    found = work_out(assembly, request.gaps, stop=out.stop, each=tell)
    out.check()
    said = command("sweep", sheet.file, request.design, _gaps(request))
    out.reply(SweepReply(steps=[step_message(s) for s in found.steps], lost=found.lost, command=said))


def _gaps(request: SweepRequest) -> tuple[str, ...]:
    return () if not request.gaps else ("--gaps", ",".join(f"{gap:.12g}" for gap in request.gaps))


def prove(sheet: Document, request: ProveRequest, out: Reporter) -> None:
    """A value that no motion exceeds."""
    from wiggleroom.bound.prove import prove as work_out

    answer = sheet.answer(request.design, out)
    done = work_out(answer, request.share, seconds=request.seconds, stop=out.stop, progress=out.progress)
    out.check()
    bound = done.bound
    within = None if bound is None or bound.within is None or not math.isfinite(bound.within) else bound.within
    more = ("--prove", f"{request.share:g}", "--time", f"{request.seconds:g}")
    said = command("flex", sheet.file, request.design, more)
    out.reply(ProveReply(at_most=done.at_most, within=within, words=bounded(done), command=said))
    if done.at_most is not None:
        sheet.know(request.design, replace(answer, at_most=done.at_most, bound=bound))
