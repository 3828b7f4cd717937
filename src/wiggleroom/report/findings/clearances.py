"""How the answer is told: how near parts are to each other."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from msgspec import UNSET

from wiggleroom.report.finding import Bars, Cell, Finding, Panel, PartTints, Table
from wiggleroom.report.results.answer_words import few, number, short, towards
from wiggleroom.report.results.json_results import dimension
from wiggleroom.schema.clearances_schema import ClearanceEntry, ClearancesResult

if TYPE_CHECKING:
    from wiggleroom.assembly.clearances import Clearances


MAX_PAIRS = 15
"""Rows that the terminal shows."""
MAX_BINDING = 3
"""Pairs that a sentence names."""


def finding(found: Clearances, command: str = "") -> Finding:
    """The tightest pairs, and what makes all fit."""
    tight = found.too_near if found.assembly.dimension == 3 else found.touching
    marked = {found.assembly.names[k]: 1.0 for pair in found.pairs[tight].tolist() for k in pair}
    facts = [*_print_facts(found), *_fit_facts(found)]
    return Finding(
        title=_title(found),
        record=partial(_record, found, command),
        assembly=found.assembly,
        facts=facts,
        sections=(*_bars(found), _table(found)),
        data=_data(found),
        tints=PartTints(marked, legend="touches or is too near") if marked else None,
        tab="Clearances",
    )


def _title(found: Clearances) -> str:
    """Answer in one line."""
    overlaps, touch = int((found.gap < 0).sum()), int(found.touching.sum())
    if not len(found.gap):
        return f"no two parts are nearer than {number(found.within)} mm"
    least = f"{_pair(found, 0)}"
    deep = -float(found.gap[0])
    if touch and overlaps and found.touching[0] and deep > _rounding(found):
        more = "" if overlaps == 1 else f", the deepest of {overlaps} overlaps"
        return f"{least} overlap by {number(deep)} mm{more}"
    if touch:
        return f"{least} touch" + ("" if touch == 1 else f", and {touch - 1} more pair{'s' * (touch > 2)}")
    return f"least gap {number(float(found.gap[0]))} mm, of {least}"


def _rounding(found: Clearances) -> float:
    from wiggleroom.assembly.overlaps import CONTACT_TOLERANCE

    return CONTACT_TOLERANCE * found.assembly.size


def _print_facts(found: Clearances) -> list[str]:
    """Which parts would become one body where they are printed in place, and which pairs are too near for that."""
    asked = [
        f"{number(least)} mm {what} layers"
        for least, what in ((found.least_xy, "along"), (found.least_z, "across"))
        if least is not None
    ]
    if not asked:
        return []
    near = np.flatnonzero(found.too_near & ~found.touching).tolist()
    pairs = few([_pair(found, k) for k in near], MAX_BINDING) if near else "no pair"
    fused = [f"fused, for they touch or overlap: {few(names)}" for names in found.fused]
    return [*fused, f"nearer than {' or '.join(asked)}: {pairs}"]


def _fit_facts(found: Clearances) -> list[str]:
    """The offset at which all fit, the kerf that explains it, and which pairs allow no more."""
    if found.offset is None:
        return [f"no offset of the outlines makes all fit: {found.why}"] if found.why else []
    bind = [" | ".join(short(found.assembly.names[k]) for k in pair) for pair in found.binding.tolist()]
    binding = f"{few(bind, MAX_BINDING)} {'binds' if len(bind) == 1 else 'bind'} then"
    if abs(found.offset) <= _rounding(found):
        return [f"all fit as drawn, and with no larger outlines: {binding}"]
    if found.kerf is None:
        return [f"all fit as drawn, with every outline up to {number(found.offset)} mm further out; {binding}"]
    gap = number(found.assembly.gap + found.kerf)
    cut = f"a cut {number(found.kerf)} mm wide along the lines does that"
    return [
        f"all fit with every outline {number(-found.offset)} mm further in; {binding}",
        cut if found.assembly.dimension == 3 else f"{cut}, and so does --gap {gap}",
    ]


def _pair(found: Clearances, k: int) -> str:
    return " | ".join(short(found.assembly.names[n]) for n in found.pairs[k].tolist())


def _layer_columns(found: Clearances) -> list[tuple[str, list[float]]]:
    asked = ((found.least_xy, "xy", found.xy), (found.least_z, "z", found.z))
    return [(name, gap.tolist()) for least, name, gap in asked if least is not None and gap is not None]


def _table(found: Clearances) -> Table:
    layers = _layer_columns(found)
    rows: list[tuple[Cell, ...]] = [
        (
            _pair(found, k),
            float(found.gap[k]),
            *(column[k] for _, column in layers),
            towards(found.direction[k]),
            ", ".join(number(x) for x in found.at[k].tolist()),
        )
        for k in range(len(found.gap))
    ]
    heads = ("pair", "gap mm", *(f"{name} mm" for name, _ in layers), "direction", "at")
    left = f"Pairs no further apart than {number(found.within)} mm."
    return Table(heads, rows, "Near pairs", MAX_PAIRS, text=left)


def _data(found: Clearances) -> Table:
    axes, layers = "xyz"[: found.assembly.dimension], _layer_columns(found)
    names = found.assembly.names
    rows: list[tuple[Cell, ...]] = [
        (
            names[i],
            names[j],
            float(found.gap[k]),
            *found.direction[k].tolist(),
            *found.at[k].tolist(),
            *(column[k] for _, column in layers),
        )
        for k, (i, j) in enumerate(found.pairs.tolist())
    ]
    heads = ("part", "other", "gap_mm", *(f"direction_{x}" for x in axes), *(f"{x}_mm" for x in axes))
    return Table((*heads, *(f"gap_{name}_mm" for name, _ in layers)), rows)


def _bars(found: Clearances) -> list[Panel]:
    """Gaps of the tightest pairs, where there are any."""
    names = [_pair(found, k) for k in range(min(len(found.gap), MAX_PAIRS))]
    return [Panel("Least gaps", Bars(names, found.gap[:MAX_PAIRS], "least gap [mm]"))] if names else []


def _record(found: Clearances, command: str) -> ClearancesResult:
    names = found.assembly.names
    in_space, asked = found.assembly.dimension == 3, found.least_xy is not None or found.least_z is not None
    layers = dict(_layer_columns(found))
    return ClearancesResult(
        dimension=dimension(found.assembly),
        gap=found.assembly.gap,
        within=found.within,
        pairs=[
            ClearanceEntry(
                parts=(names[i], names[j]),
                gap=float(found.gap[k]),
                direction=tuple(found.direction[k].tolist()),
                at=tuple(found.at[k].tolist()),
                xy=_finite(layers["xy"][k]) if "xy" in layers else UNSET,
                z=_finite(layers["z"][k]) if "z" in layers else UNSET,
                too_near=bool(found.too_near[k]) if asked else UNSET,
            )
            for k, (i, j) in enumerate(found.pairs.tolist())
        ],
        offset=found.offset,
        kerf=found.kerf,
        binding=[(names[i], names[j]) for i, j in found.binding.tolist()],
        note=found.why,
        xy=UNSET if found.least_xy is None else found.least_xy,
        z=UNSET if found.least_z is None else found.least_z,
        fused=[list(group) for group in found.fused] if in_space else UNSET,
        notes=list(found.assembly.drawing.notes),
        command=command,
    )


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
