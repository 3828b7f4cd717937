"""Fig. 9: ten blocks in a row, the first fixed, how far the last moves sideways, by every method and in truth."""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib.resources import files

from wiggleroom.assembly import patterns
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.bench.physics import pulled_to_rest
from wiggleroom.bench.result import Bench, Column, Record, ResultTable
from wiggleroom.errors import Stop, require_extra
from wiggleroom.freespace.models.pair_models import HalfPlane, Hull, PairModel, Walls
from wiggleroom.maximise import witness

JOINTS = ("tee", "swallowtail")
TRUTH = "true optimum"

Found = tuple[float | None, float]
"""Displacement [mm], None where nothing stops it, and how deep parts overlap there [mm]."""
Method = Callable[[Assembly, Stop | None], Found]


def by_model(model: PairModel) -> Method:
    """Method that asks `flex` with a pair model."""

    def ask(assembly: Assembly, stop: Stop | None) -> Found:
        answer = witness(assembly, model=model, stop=stop)
        return answer.objective, 0.0 if answer.collision_free else answer.deepest_overlap

    return ask


def by_physics(assembly: Assembly, _: Stop | None) -> Found:
    """Method that pulls in a physics engine until everything is at rest."""
    rest = pulled_to_rest(assembly)
    return rest.objective, rest.deepest_overlap


METHODS: dict[str, Method] = {
    "walls": by_model(Walls()),
    "hull, reference": by_model(Hull("reference")),
    "hull, joint": by_model(Hull("joint")),
    "half-planes, at rest": by_model(HalfPlane(iterated=False)),
    "half-planes": by_model(HalfPlane()),
    "physics engine": by_physics,
}
"""Registry: every method that is given a chain."""


def optima() -> tuple[int, dict[tuple[str, float], float]]:
    """Number of blocks, and the true optimum [mm] by joint and gap [mm].

    From an exact dynamic programme over the turns of the links, `python -m benchmarks.optima` in the repository.
    """
    stored = json.loads(files("wiggleroom.bench").joinpath("optima.json").read_text(encoding="utf-8"))
    split = {key: key.split() for key in stored["optima"]}
    return stored["blocks"], {(split[k][0], float(split[k][1])): value for k, value in stored["optima"].items()}


def require_engine() -> None:
    """Check that the physics engine is there; raises MissingExtraError."""
    require_extra("bench", "bench chains compares with a physics engine", "pymunk")


def chains(*, stop: Stop | None = None, progress: Callable[[int, int], None] | None = None) -> Bench:
    """Displacement against gap for every method, beside the true optimum.

    Parameters
    ----------
    stop, progress : optional
        Asked all the time; told how many questions are done, and how many there are.

    Source: Mind the Gap, Fig. 9; its figures are in a plot only, and its blocks' sizes are not given.
    """
    blocks, true = optima()
    cases = [(joint, gap) for joint in JOINTS for j, gap in true if j == joint]
    found: list[Record] = []
    for k, (joint, gap) in enumerate(cases):
        optimum = true[joint, gap]
        base: Record = {"joint": joint, "gap_mm": gap, "blocks": blocks, "published": False}
        found.append({**base, "method": TRUTH, "moves_mm": optimum, "overlap_mm": 0.0, "share_percent": 100.0})
        chain = patterns.chain(blocks, joint, gap)
        for i, (name, method) in enumerate(METHODS.items()):
            if stop is not None and stop.is_set():
                break
            if progress is not None:
                progress(k * len(METHODS) + i, len(cases) * len(METHODS))
            value, deep = method(chain, stop)
            share = None if value is None else 100 * value / optimum
            found.append({**base, "method": name, "moves_mm": value, "overlap_mm": deep, "share_percent": share})
    cut = stop is not None and stop.is_set()
    notes = (
        f"{blocks} unit blocks in a row, the first fixed, the last pulled in +y. The true optimum is an exact "
        "dynamic programme over the turns of the links (stored with the package, accurate to 1e-9; `python -m "
        "benchmarks.optima` works it out anew).",
        "A star: parts overlap in that motion. Hull: three slices, about the reference point or the joint. "
        "Half-planes: step by step; at rest: one linear program. Physics engine: Chipmunk, no friction, a force lowered until "
        "all is at rest; bodies sink into each other a little.",
        "† Mind the Gap shows such curves in its Fig. 9, without figures or the sizes of its blocks: there "
        "experiments with real blocks move furthest, then its hull, then PuzzleFlex.",
    )
    title = "Chains: displacement against gap, beside the true optimum"
    return Bench("chains", title, tuple(found), _sheets(found), notes, "wiggleroom bench chains", cut)


def _sheets(found: list[Record]) -> tuple[ResultTable, ...]:
    """Displacement, and share of the true optimum, with a column for every gap."""
    gaps = sorted({r["gap_mm"] for r in found})
    sheets = []
    for title, key, places in (
        ("Moves [mm] by gap [mm]", "moves_mm", 3),
        ("Share of the true optimum [%] by gap [mm]", "share_percent", 2),
    ):
        rows: dict[tuple[str, str], Record] = {}
        for r in found:
            row = rows.setdefault((r["joint"], r["method"]), {"joint": r["joint"], "method": r["method"]})
            row[f"{r['gap_mm']:g}"] = (
                "unbounded" if r[key] is None else f"{r[key]:.{places}f}{'*' if r['overlap_mm'] else ''}"
            )
        order = [rows[j, m] for j in JOINTS for m in (TRUTH, *METHODS) if (j, m) in rows]
        columns = (
            Column("joint", "joint"),
            Column("method", "method"),
            *[Column(f"{g:g}", f"{g:g}", right=True) for g in gaps],
        )
        sheets.append(ResultTable(title, columns, tuple(order)))
    return tuple(sheets)
