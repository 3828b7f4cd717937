"""Compute how far loose interlocking parts can move, whether they come apart, and which gap is to blame.

>>> import wiggleroom as wr
>>> assembly = wr.patterns.chain(3, joint="tee", gap=0.02)
>>> answer = wr.flex(assembly, wr.Pull("b3", (0, 1)))
>>> str(answer.verdict)
'proven'
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from wiggleroom.displayable import Displayable, Drawable

if TYPE_CHECKING:
    from wiggleroom.assembly import coupon, patterns
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.assembly.clearances import Clearances
    from wiggleroom.disassembly.interlock_result import Escape, Interlock
    from wiggleroom.disassembly.largest_gap import LargestGap
    from wiggleroom.drawing.model import (
        Closer,
        Drawing,
        JointGap,
        Part,
        Pull,
        Region,
        Tolerance,
        Towards,
        Translation,
        Turn,
        W,
    )
    from wiggleroom.drawing.readers.tolerances import read_tolerances
    from wiggleroom.errors import InputError, MissingExtraError, StoppedError, TouchingError, WiggleroomError
    from wiggleroom.form_closure.blocking_graph import Blocking, blocking
    from wiggleroom.form_closure.mobility import TightVerdict, tight_verdict
    from wiggleroom.freespace.free_space import FreeSpace, free_space
    from wiggleroom.freespace.models.pair_models import HalfPlane, Hull
    from wiggleroom.freespace.models.polyhedron import Polyhedron
    from wiggleroom.live.live_result import LiveResult, Mode
    from wiggleroom.live.live_session import Live
    from wiggleroom.maximise import prepare
    from wiggleroom.planning.plan import Plan
    from wiggleroom.planning.plan_tolerance import (
        PlanRanking,
        PlanSample,
        SmallestGap,
    )
    from wiggleroom.planning.steps import Step
    from wiggleroom.questions import assemble, check, flex, largest_gap, read
    from wiggleroom.report.films.film import film
    from wiggleroom.search.answer import Answer, Bound, Contact
    from wiggleroom.search.prepare import Prepared
    from wiggleroom.sensitivity.gap_distribution import Spread
    from wiggleroom.sensitivity.gap_trials import AllowableGap
    from wiggleroom.sensitivity.rank import Ranking
    from wiggleroom.sensitivity.sample import Sample
    from wiggleroom.sensitivity.sweep import Sweep
    from wiggleroom.sensitivity.tighten import Tightening
    from wiggleroom.sensitivity.worst_case import WorstCase
    from wiggleroom.studies.clearances import clearances
    from wiggleroom.studies.gap import allowable_gap
    from wiggleroom.studies.plan import plan, rank_plan, sample_plan, smallest_gap
    from wiggleroom.studies.rank import rank
    from wiggleroom.studies.sample import sample
    from wiggleroom.studies.sweep import sweep
    from wiggleroom.studies.tighten import tighten
    from wiggleroom.studies.tolerances import worst_case
    from wiggleroom.verdict import Verdict

_HOME = {
    "AllowableGap": "sensitivity.gap_trials",
    "Answer": "search.answer",
    "Assembly": "assembly.assembly",
    "Blocking": "form_closure.blocking_graph",
    "Bound": "search.answer",
    "Clearances": "assembly.clearances",
    "Closer": "drawing.model",
    "Contact": "search.answer",
    "Drawing": "drawing.model",
    "Escape": "disassembly.interlock_result",
    "FreeSpace": "freespace.free_space",
    "HalfPlane": "freespace.models.pair_models",
    "Hull": "freespace.models.pair_models",
    "InputError": "errors",
    "Interlock": "disassembly.interlock_result",
    "JointGap": "drawing.model",
    "LargestGap": "disassembly.largest_gap",
    "Live": "live.live_session",
    "MissingExtraError": "errors",
    "Mode": "live.live_result",
    "Part": "drawing.model",
    "Plan": "planning.plan",
    "PlanRanking": "planning.plan_tolerance",
    "PlanSample": "planning.plan_tolerance",
    "Polyhedron": "freespace.models.polyhedron",
    "Prepared": "search.prepare",
    "Pull": "drawing.model",
    "Ranking": "sensitivity.rank",
    "Region": "drawing.model",
    "Sample": "sensitivity.sample",
    "LiveResult": "live.live_result",
    "Spread": "sensitivity.gap_distribution",
    "SmallestGap": "planning.plan_tolerance",
    "Step": "planning.steps",
    "StoppedError": "errors",
    "Sweep": "sensitivity.sweep",
    "Tightening": "sensitivity.tighten",
    "TightVerdict": "form_closure.mobility",
    "TouchingError": "errors",
    "Tolerance": "drawing.model",
    "Towards": "drawing.model",
    "Translation": "drawing.model",
    "Turn": "drawing.model",
    "Verdict": "verdict",
    "W": "drawing.model",
    "WiggleroomError": "errors",
    "WorstCase": "sensitivity.worst_case",
    "allowable_gap": "studies.gap",
    "assemble": "questions",
    "blocking": "form_closure.blocking_graph",
    "check": "questions",
    "clearances": "studies.clearances",
    "coupon": "assembly",
    "film": "report.films.film",
    "flex": "questions",
    "free_space": "freespace.free_space",
    "largest_gap": "questions",
    "patterns": "assembly",
    "plan": "studies.plan",
    "prepare": "maximise",
    "prove": "questions",
    "rank": "studies.rank",
    "read": "questions",
    "rank_plan": "studies.plan",
    "sample": "studies.sample",
    "sample_plan": "studies.plan",
    "smallest_gap": "studies.plan",
    "sweep": "studies.sweep",
    "tighten": "studies.tighten",
    "tight_verdict": "form_closure.mobility",
    "read_tolerances": "drawing.readers.tolerances",
    "worst_case": "studies.tolerances",
}

__all__ = [
    "AllowableGap",
    "Answer",
    "Assembly",
    "Blocking",
    "Bound",
    "Clearances",
    "Closer",
    "Contact",
    "Drawing",
    "Escape",
    "FreeSpace",
    "HalfPlane",
    "Hull",
    "InputError",
    "Interlock",
    "JointGap",
    "LargestGap",
    "Live",
    "LiveResult",
    "MissingExtraError",
    "Mode",
    "Part",
    "Plan",
    "PlanRanking",
    "PlanSample",
    "Polyhedron",
    "Prepared",
    "Pull",
    "Ranking",
    "Region",
    "Sample",
    "SmallestGap",
    "Spread",
    "Step",
    "StoppedError",
    "Sweep",
    "TightVerdict",
    "Tightening",
    "Tolerance",
    "TouchingError",
    "Towards",
    "Translation",
    "Turn",
    "Verdict",
    "W",
    "WiggleroomError",
    "WorstCase",
    "allowable_gap",
    "assemble",
    "blocking",
    "check",
    "clearances",
    "coupon",
    "film",
    "flex",
    "free_space",
    "largest_gap",
    "patterns",
    "plan",
    "prepare",
    "prove",
    "rank",
    "rank_plan",
    "read",
    "read_tolerances",
    "sample",
    "sample_plan",
    "smallest_gap",
    "sweep",
    "tight_verdict",
    "tighten",
    "worst_case",
]


def _draw(found: Any, path: Any) -> None:
    from wiggleroom.studies.showing import draw  # slow to import, and not always needed

    draw(found, path)


def _mime_bundle(found: Any) -> dict[str, str]:
    from wiggleroom.studies.showing import mime_bundle  # slow to import, and needed in notebooks only

    return mime_bundle(found)


Drawable.writer = staticmethod(_draw)
Displayable.mime_bundle = staticmethod(_mime_bundle)


def __getattr__(name: str) -> object:
    """Import a public name when it is first used, so that `import wiggleroom` stays quick."""
    if name not in _HOME:
        message = f"module 'wiggleroom' has no attribute {name!r}"
        raise AttributeError(message)
    module = import_module(f"wiggleroom.{_HOME[name]}")
    is_module = name in ("coupon", "patterns")
    value = import_module(f"wiggleroom.assembly.{name}") if is_module else getattr(module, name)
    globals()[name] = value
    return value
