"""Plots of what `sweep`, `sample`, `gap` and `tolerances` found."""

from __future__ import annotations

import math

import numpy as np

from wiggleroom.errors import InputError
from wiggleroom.report.pictures.leaving_picture import picture_of_check
from wiggleroom.report.pictures.plots import bars, curve, histogram
from wiggleroom.report.results.allowable_gap_results import GAP_DIGITS, gap_facts, gap_sentence
from wiggleroom.report.results.answer_words import goals_text, number, unit
from wiggleroom.report.results.separability import Checked
from wiggleroom.report.results.study_results import band_sentence, has_band, lost_sentence, spread_words, yield_sentence
from wiggleroom.report.results.tolerance_results import tolerance_name, tolerances_facts, tolerances_sentence
from wiggleroom.sensitivity.gap_trials import AllowableGap
from wiggleroom.sensitivity.sample import Sample
from wiggleroom.sensitivity.sweep import Sweep
from wiggleroom.sensitivity.worst_case import WorstCase
from wiggleroom.verdict import Verdict

SHOWN_QUANTILES = (0.05, 0.5, 0.95)


def sweep_title(found: Sweep) -> str:
    """Say what a sweep is about, such as "b2 in +y against the gap"."""
    return f"{goals_text(found.goals)} against the gap"


def sweep_facts(found: Sweep) -> list[str]:
    """Facts under the title of a sweep."""
    odd = [s.verdict for s in found.steps if s.verdict in (Verdict.TOUCHING, Verdict.NOT_MAKEABLE)]
    unsure = sum(not s.checked for s in found.steps if s.objective is not None)
    return [
        f"{len(found.steps)} gaps",
        lost_sentence(found),
        *([band_sentence(found)] if has_band(found) else []),
        *(
            [f"{len(odd)} {'gap' if len(odd) == 1 else 'gaps'} without room: {', '.join(dict.fromkeys(odd))}"]
            if odd
            else []
        ),
        *([f"path not checked at {unsure}"] if unsure else []),
    ]


def picture_of_sweep(found: Sweep, *, command: str = "") -> str:
    """Motion against gap as an SVG curve, with the gap at which the motion loses its end.

    Raises
    ------
    InputError
        If no gap was finished.
    """
    if not found.steps:
        finding = "sweep: stopped before the first gap was done, there is nothing to draw"
        raise InputError(finding)
    gaps = np.array([s.gap for s in found.steps])
    motions = np.array([np.nan if s.objective is None else s.objective for s in found.steps])
    marks = [] if found.lost is None else [(found.lost[1], f"nothing stops it from {number(found.lost[1])} mm on")]
    return curve(
        gaps,
        motions,
        labels=("gap mm", f"motion {unit(found.goals)}".rstrip()),
        title=sweep_title(found),
        facts=sweep_facts(found),
        marks=marks,
        most=np.array([np.nan if s.at_most is None else s.at_most for s in found.steps]),
        command=command,
    )


def sample_title(found: Sample) -> str:
    """Say what a sample is about, such as "b2 in +y when gaps vary"."""
    return f"{goals_text(found.answer.goals)} when gaps vary"


def sample_facts(found: Sample) -> list[str]:
    """Facts under the title of a sample."""
    bounded, what = found.bounded, unit(found.answer.goals)
    said = [f"{len(found.value)} draws", spread_words(found)]
    if len(bounded):
        said.append(f"mean {number(float(bounded.mean()))} {what}".rstrip())
    if found.limit is not None:
        said.append(yield_sentence(found))
    if found.misfits:
        said.append(f"in {found.misfits} parts do not fit")
    if found.loose:
        said.append(f"in {found.loose} nothing stops the motion")
    return said


def picture_of_sample(found: Sample, *, command: str = "", framed: bool = True) -> str:
    """Motions of all draws that end as an SVG histogram, with quantiles and the limit."""
    what = unit(found.answer.goals)
    ends = [(q, found.quantile(q)) for q in SHOWN_QUANTILES]
    marks = [(value, f"{100 * q:g} % below {number(value)}") for q, value in ends if np.isfinite(value)]
    return histogram(
        found.bounded,
        label=f"motion {what}".rstrip(),
        title=sample_title(found),
        facts=sample_facts(found),
        marks=marks,
        limit=None if found.limit is None else (found.limit, f"limit {number(found.limit)}"),
        command=command,
        framed=framed,
    )


def picture_of_gap(found: AllowableGap, *, command: str = "", framed: bool = True) -> str:
    """Curve of motion, or of overlap, against the gap with the crossing marked; of `holds` the parts as they come apart."""
    held, apart = found.sides
    if found.question == "holds" and (apart or held) is not None:
        state = apart or held
        assert state is not None
        return picture_of_check(Checked(state), command=command)
    gaps = np.array([t.gap for t in found.trials])
    values = np.array([np.nan if t.value is None or math.isinf(t.value) else t.value for t in found.trials])
    marks = [] if found.gap is None else [(found.gap, f"{found.certainty}: {number(found.gap, GAP_DIGITS)} mm")]
    if found.beyond is not None:
        marks.append((found.beyond, f"fails: {number(found.beyond, GAP_DIGITS)} mm"))
    level = (found.limit, f"limit {number(found.limit)}") if found.question == "at most" and found.limit else None
    what = "overlap mm" if found.question == "fits" else f"motion {unit(found.goals)}".rstrip()
    return curve(
        gaps,
        values,
        labels=("gap mm", what),
        title=gap_sentence(found) if framed else "",
        facts=gap_facts(found) if framed else (),
        marks=marks,
        level=level,
        command=command,
    )


def picture_of_tolerances(found: WorstCase, *, command: str = "") -> str:
    """What every tolerance adds to the worst case, as SVG bars."""
    return bars(
        [tolerance_name(c.tolerance) for c in found.contributions],
        np.array([c.looser for c in found.contributions]),
        label="adds to the worst case mm",
        title=tolerances_sentence(found),
        facts=tolerances_facts(found),
        command=command,
    )
