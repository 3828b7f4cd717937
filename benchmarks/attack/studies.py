"""What studies of gaps say about one assembly, held against the judge's own outlines at each gap and its own search.

The file's outlines get a gap of their own, STUDY_GAP of the size, so that there is something to vary. Outlines at another gap are those of
the file moved inward by shapely, with mitres.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from benchmarks.attack.drawing import Json
from benchmarks.attack.judge import LOW, PROGRAMS, UNLIMITED, Finding
from benchmarks.attack.oracle import Ground
from benchmarks.attack.search import Climber

STUDY_GAP = 6e-4
"""Gap of the file, as a share of the size."""
SWEPT = (0.5, 1.0, 3.0)
"""Gaps of the sweep, as multiples of that."""
DRAWS = 6
SECONDS = 8.0
"""Time for the largest gap."""
STEPS = (0.02, 0.004)
"""Extra gap of differences, as shares of the gap."""


def inward(made: Json, by: dict[str, float]) -> Json:
    """The assembly as it is made, the outlines of some parts moved inward [mm]."""
    return made | {"gap": 0.0, "parts": [_smaller(p, by.get(p["name"], 0.0)) for p in made["parts"]]}


def _smaller(part: Json, by: float) -> Json:
    regions = []
    for region in part.get("outlines", [part]):
        solid = shapely.Polygon(region["outline"], region.get("holes", []))
        for piece in shapely.get_parts(shapely.buffer(solid, -by, join_style="mitre", mitre_limit=1e3)):
            one = shapely.orient_polygons(piece)
            rings = [np.array(r.coords[:-1]).tolist() for r in (one.exterior, *one.interiors)]
            regions.append({"outline": rings[0], "holes": rings[1:]})
    return {k: v for k, v in part.items() if k not in ("outline", "holes", "outlines")} | {"outlines": regions}


class _Case:
    """One assembly with a gap, as the program reads it and as the judge does."""

    def __init__(self, made: Json, number: int, programs: int, out: Finding) -> None:
        self.gap = STUDY_GAP * Ground(made).size
        self.made, self.number, self.programs, self.out = made | {"gap": self.gap}, number, programs, out

    def ground(self, gap: float, extra: dict[str, float] | None = None) -> Ground:
        """The parts at a gap, with extra gap round some of them."""
        more = extra or {}
        return Ground(inward(self.made, {p["name"]: (gap + more.get(p["name"], 0.0)) / 2 for p in self.made["parts"]}))

    def reached(self, ground: Ground, enough: float = np.inf) -> float:
        """The best value that the judge's search finds."""
        most = UNLIMITED * ground.size
        return Climber(ground, self.number, self.programs).search(min(enough, most)).value

    def judge_path(self, what: str, ground: Ground, answer: Any) -> None:
        """The path of an answer, and its value."""
        overlap = ground.overlap_on(answer.waypoints) if answer.path == "checked" else ground.overlap(answer.motion)
        if overlap is not None:
            self.out.wrong.append(f"{what} path: {overlap}")
        value = ground.value(answer.motion)
        if answer.objective is not None and abs(value - answer.objective) > 1e-8 * max(ground.size, abs(value)):
            self.out.wrong.append(f"{what} value: {answer.objective!r} is said, the motion is worth {value!r}")


def ask_studies(family: str, number: int, made: Json, programs: int = PROGRAMS) -> Finding:
    """Ask `sweep`, `gap`, `sample`, `rank` and `tighten` about an assembly, and judge what they say."""
    import wiggleroom as wr

    out = Finding(family, number)
    case = _Case(made, number, programs, out)
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / f"{family}_{number}.json"
        file.write_text(json.dumps(case.made), encoding="utf-8")
        try:
            assembly = wr.read(str(file))
            answer = wr.flex(assembly)
        except wr.InputError as error:
            out.verdict = "refused"
            out.wrong.append(f"refused: {error}")
            return out
        out.verdict, out.path, out.value = str(answer.verdict), answer.path, answer.objective
        studies: list[Callable[..., None]] = [_sweep]
        if answer.objective is not None and answer.objective > 1e-6 * assembly.size:
            studies += [_largest_gap, _sample, _rank, _tighten]
        for study in studies:
            try:
                study(wr, case, assembly, answer)
            except wr.InputError as error:
                # what a study finds to move without end the search has missed: a wrong word only where it was proven to end
                kind = "low" if "nothing stops" in str(error) and out.verdict != "proven" else "refused"
                out.wrong.append(f"{kind}-{study.__name__[1:]}: {error}")
    return out


def _sweep(wr: Any, case: _Case, assembly: Any, answer: Any) -> None:
    """Values never fall with the gap, and nothing larger is reached where one is proven."""
    del answer
    found = wr.sweep(assembly, [case.gap * k for k in SWEPT])
    before: Any = None
    for step in found.steps:
        if step.answer is None or step.objective is None:
            if str(step.verdict) == "unbounded":
                before = np.inf
            continue
        if before is not None and step.objective < before * (1 - 1e-6) - 1e-9 * assembly.size:
            case.out.wrong.append(f"sweep: {before!r} at a smaller gap, {step.objective!r} at {step.gap:g}")
        before = step.objective
        ground = case.ground(step.gap)
        case.judge_path("sweep", ground, step.answer)
    last = found.steps[-1]
    if last.objective is not None:
        best = case.reached(case.ground(last.gap))
        if best > last.objective * (1 + LOW) + 1e-6 * assembly.size:
            kind = "sweep proven" if str(last.verdict) == "proven" else "low-sweep"
            case.out.wrong.append(f"{kind}: {last.objective:.9g} is said at {last.gap:g}, {best:.9g} is reached")


def _largest_gap(wr: Any, case: _Case, assembly: Any, answer: Any) -> None:
    """At the gap that is named no more than the limit is reached, and at the one beyond it the limit is."""
    limit = 1.3 * answer.objective
    found = wr.allowable_gap(assembly, at_most=limit, seconds=SECONDS)
    for trial in found.trials:
        if trial.answer is not None:
            case.judge_path("gap", case.ground(trial.gap), trial.answer)
    if found.beyond is not None:
        over = [t for t in found.trials if t.gap == found.beyond]
        if over and over[0].value is not None and over[0].value <= limit:
            case.out.wrong.append(f"gap: {over[0].value!r} at {found.beyond:g}, which is not beyond {limit!r}")
    if found.gap is None:
        return
    best = case.reached(case.ground(found.gap), limit * (1 + LOW))
    if best > limit * (1 + LOW):
        kind = "gap proven" if str(found.certainty) == "proven" else "low-gap"
        case.out.wrong.append(f"{kind}: {limit:.9g} at most is said at {found.gap:g}, {best:.9g} is reached")


def _sample(wr: Any, case: _Case, assembly: Any, answer: Any) -> None:
    """No draw moves further than parts that all have the largest gap that was drawn."""
    del answer
    found = wr.sample(assembly, wr.Spread(case.gap / 4, "uniform"), draws=DRAWS, seed=case.number, workers=1)
    ends = found.value[np.isfinite(found.value)]
    if not len(ends):
        return
    extra = dict(zip(assembly.names, found.extra.max(axis=0).tolist(), strict=True))
    loosest = wr.flex(wr.assemble(assembly.drawing, offset={n: -e / 2 for n, e in extra.items()}))
    if loosest.objective is None:
        return
    most = max(loosest.objective, float(found.answer.objective))
    if ends.max() > most * (1 + 1e-3) + 1e-6 * assembly.size:
        best = case.reached(case.ground(case.gap, extra), float(ends.max()))
        if ends.max() > best * (1 + LOW):
            case.out.wrong.append(f"sample: a draw moves {ends.max():.9g}, with all its gaps at most {most:.9g}")


def _rank(wr: Any, case: _Case, assembly: Any, answer: Any) -> None:
    """Values that are called unique are differences of the motion on both sides, wherever these exist."""
    ranking = wr.rank(answer)
    largest = float(np.nanmax(ranking.importance, initial=0.0))
    for k in ranking.order[:1]:
        name, sides = assembly.names[k], {}
        for sign in (1.0, -1.0):
            slopes = []
            for share in STEPS:
                h = sign * share * case.gap
                try:
                    beside = wr.flex(wr.assemble(assembly.drawing, offset={name: -h / 2})).objective
                except wr.InputError:
                    beside = None
                slopes.append(np.nan if beside is None else (beside - answer.objective) / h)
            if abs(slopes[1] - slopes[0]) <= 0.02 * max(abs(slopes[1]), 0.05 * largest):
                sides[sign] = slopes[1]  # else the search went elsewhere, or the curve bends
        low, high = sorted((ranking.looser[k], ranking.tighter[k]))
        slack = 0.05 * max(abs(high), 0.05 * largest)
        for sign, slope in sides.items():
            if not low - slack <= slope <= high + slack and (ranking.unique[k] or ranking.ends == "whole"):
                which = "more" if sign > 0 else "less"
                case.out.wrong.append(f"rank: {name} is worth {low:.6g} to {high:.6g}, with {which} gap {slope:.6g}")


def _tighten(wr: Any, case: _Case, assembly: Any, answer: Any) -> None:
    """Tightened parts move no further than before, and no further than is said."""
    found = wr.tighten(assembly, parts=1, draws=1, workers=1)
    after = found.after
    if after.objective is None:
        case.out.wrong.append("tighten: tighter parts move without end")
        return
    if after.objective > found.before.objective * (1 + 1e-3):
        case.out.wrong.append(f"tighten: {found.before.objective:.9g} before, {after.objective:.9g} with tighter parts")
    if after.objective > answer.objective * (1 + 1e-3):
        case.out.wrong.append(f"low-tighten: {answer.objective:.9g} before, {after.objective:.9g} with tighter parts")
    extra = {p.name: -2 * p.offset for p in after.assembly.drawing.parts}
    ground = case.ground(case.gap, extra)
    case.judge_path("tighten", ground, after)
    best = case.reached(ground, after.objective * (1 + 2 * LOW))
    if best > after.objective * (1 + LOW) + 1e-6 * assembly.size:
        kind = "tighten proven" if str(after.verdict) == "proven" else "low-tighten"
        case.out.wrong.append(f"{kind}: {after.objective:.9g} is said, {best:.9g} is reached")
