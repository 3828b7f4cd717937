"""Everything that is wrong with a design at once: in words, where it is, and changes that put it right."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.app.design_cache import DesignCache
from wiggleroom.app.open_requests import suggested
from wiggleroom.app.reporter import on_the_page
from wiggleroom.assembly.findings import examine_parts, free_overlaps
from wiggleroom.assembly.loops import placed_regions
from wiggleroom.assembly.overlaps import CONTACT_TOLERANCE
from wiggleroom.drawing.model import Drawing, Part
from wiggleroom.drawing.writers.glue_groups import collidable
from wiggleroom.report.results.answer_words import number, short
from wiggleroom.schema.replies import Fault, Mend
from wiggleroom.schema.requests import Design

MAX_FINDINGS = 60
"""At most this many findings are told; the rest is counted."""
MAX_GAP_SHARE = 0.03
"""No gap above this share of the median part's size is proposed."""
MAX_HALVINGS = 8
"""A gap at which parts cannot be made is halved at most this many times."""
DEPTH_MARGIN = 1.25
"""A gap that is to open overlaps is this many times as large as the deepest of them."""
GAP_SHARE = 1 / 2000
"""A gap that opens what touches, as a share of the drawing's size."""


def review(designs: DesignCache, design: Design) -> list[Fault]:
    """List what is wrong with a design.

    Raises
    ------
    InputError
        If it names parts that are not there.
    """
    drawing = designs.with_offsets(design)
    parts, lines = examine_parts(drawing)
    found = [*_roles(drawing, design), *_unmakeable(drawing, lines)]
    found += _meeting(drawing, parts, design)
    if len(found) > MAX_FINDINGS:
        found = [*found[:MAX_FINDINGS], Fault("parts", f"and {len(found) - MAX_FINDINGS} more")]
    return found


def _roles(drawing: Drawing, design: Design) -> list[Fault]:
    """What a question about motion lacks."""
    found = []
    fixed = [part.name for part in drawing.parts if part.fixed]
    if not fixed and len(drawing.parts) > 1:
        names = [part.name for part in drawing.parts]
        found.append(nothing_stands(names, _areas(drawing), design))
    elif len(fixed) == len(drawing.parts):
        name = fixed[-1]
        mend = Mend(f"Let {short(name)} go", fixed=fixed[:-1])
        found.append(
            Fault(
                "stands", "Everything is fixed: leave at least one part free to move", mends=[mend] * (len(fixed) > 1)
            )
        )
    if not drawing.goals and len(drawing.parts) > 1:
        goal = suggested(drawing)
        mend = Mend(f"Pull {short(goal.part)}", goals=[goal])
        words = "Nothing is pulled: say which part, and which way"
        found.append(Fault("pulled", words, [goal.part], mends=[mend], missing=True))
    return found


def nothing_stands(names: Sequence[str], size: NDArray[np.float64], design: Design) -> Fault:
    """Fault that no part is fixed; it proposes the largest part that is neither pulled nor glued to a pulled one.

    Where there is no such part, nothing is proposed: whatever was fixed, what is asked would change.
    """
    goals = design.goals if isinstance(design.goals, list) else []
    moved = {goal.part for goal in goals}
    moved.update(name for group in design.glue if moved.intersection(group) for name in group)
    order = np.argsort(-size, kind="stable").tolist()
    still = next((names[k] for k in order if names[k] not in moved), None)
    if still is None:
        words = "Nothing stands, and every part is pulled or glued to a pulled one: stop pulling one of them and fix it"
        return Fault("stands", words, missing=True)
    words = "Nothing stands: some part must hold still for others to move against"
    return Fault("stands", words, [still], mends=[Mend(f"Fix {short(still)}", fixed=[still])], missing=True)


def _areas(drawing: Drawing) -> NDArray[np.float64]:
    """Material of every part (parts,) [mm2]."""
    shapes, owner = placed_regions(drawing.parts)
    area: NDArray[np.float64] = np.bincount(owner, shapely.area(shapes), minlength=len(drawing.parts)).astype(
        np.float64
    )
    return area


def usual_size(drawing: Drawing) -> float:
    """Side of a square with as much material as the median part [mm]."""
    return float(np.median(np.sqrt(_areas(drawing))))


def _unmakeable(drawing: Drawing, lines: Sequence[str]) -> list[Fault]:
    """What is wrong with single parts; a smaller gap may help where they cannot be made."""
    mends: list[Mend] = []
    gap = min(drawing.gap, 2 * MAX_GAP_SHARE * usual_size(drawing)) if 0 < drawing.gap < math.inf else 0.0
    for _ in range(MAX_HALVINGS if lines and gap else 0):
        gap = round_up(gap / 2)
        if not examine_parts(dataclasses.replace(drawing, gap=gap))[1]:
            mends = [Mend(f"Use a gap of {number(gap)} mm", gap=gap)]
            break
    names = [part.name for part in drawing.parts]
    return [Fault("parts", on_the_page(line), [n for n in names if f'"{n}"' in line], mends=mends) for line in lines]


def _meeting(drawing: Drawing, parts: Sequence[Part], design: Design) -> list[Fault]:
    """Pairs of parts that overlap or touch at rest."""
    if len(parts) < 2:
        return []
    index = {part.name: k for k, part in enumerate(parts)}
    whole = _whole(parts)
    size = float(np.ptp(shapely.total_bounds(whole).reshape(2, 2), axis=0).max())
    deep = free_overlaps(drawing, parts)
    pairs = {(a, b): depth for a, b, depth in deep}
    touching = [pair for pair in _near(drawing, parts, whole, CONTACT_TOLERANCE * size) if pair not in pairs]
    if not pairs and not touching:
        return []
    wanted = max([GAP_SHARE * size, *(drawing.gap + DEPTH_MARGIN * depth for depth in pairs.values())])
    usual = float(np.median([math.sqrt(one.area) for one in whole]))
    gap = _opening(drawing, round_up(wanted), MAX_GAP_SHARE * usual, CONTACT_TOLERANCE * size)
    wider = [] if gap is None else [Mend(f"Use a gap of {number(gap)} mm", gap=gap)]

    def finding(
        words: str, a: str, b: str, names: list[str], place: shapely.Geometry, alone: bool, missing: bool = False
    ) -> Fault:
        x, y = shapely.get_coordinates(place)[0].tolist()
        glued = [Mend("Glue them", glue=[*design.glue, [a, b]])]
        return Fault("gap", words, names, (x, y), [*wider, *glued] if alone else wider, missing)

    found = []
    for (a, b), depth in pairs.items():
        place = shapely.point_on_surface(shapely.intersection(whole[index[a]], whole[index[b]]))
        words = f"{short(a)} and {short(b)} overlap by {number(depth, 3)} mm"
        found.append(finding(words, a, b, [a, b], place, alone=True))
    if touching:
        a, b = touching[0]
        more = f", and so do {len(touching) - 1} more pairs" if len(touching) > 1 else ""
        words = f"{short(a)} and {short(b)} touch at rest{more}: there is no room to move"
        names = list(dict.fromkeys(name for pair in touching[:MAX_FINDINGS] for name in pair))
        place = shapely.shortest_line(whole[index[a]], whole[index[b]])
        found.append(finding(words, a, b, names, place, alone=len(touching) == 1, missing=not drawing.gap))
    return found


def _whole(parts: Sequence[Part]) -> list[shapely.Geometry]:
    """Material of every part, as placed [mm]."""
    shapes, owner = placed_regions(parts)
    return [shapely.union_all(own) for own in np.split(shapes, np.searchsorted(owner, np.arange(1, len(parts))))]


def _near(
    drawing: Drawing, parts: Sequence[Part], whole: list[shapely.Geometry], reach: float
) -> list[tuple[str, str]]:
    """Pairs of parts no further apart than `reach` [mm] that are neither glued nor ignored nor both fixed."""
    collide = collidable(drawing.glue, drawing.ignore)
    i, j = shapely.STRtree(whole).query(whole, predicate="dwithin", distance=reach)
    pairs = ((parts[k], parts[m]) for k, m in zip(i.tolist(), j.tolist(), strict=True) if k < m)
    return [(a.name, b.name) for a, b in pairs if collide(a.name, b.name) and not (a.fixed and b.fixed)]


def _opening(drawing: Drawing, gap: float, most: float, near: float) -> float | None:
    """A gap near this one [mm] at which all can be made and no parts are `near` each other; None where none up to `most` was found."""
    for wider in (gap, round_up(1.6 * gap), round_up(2.5 * gap)):
        if wider > most:
            return None
        parts, wrong = examine_parts(dataclasses.replace(drawing, gap=wider))
        if wrong:
            return None
        overlap = free_overlaps(dataclasses.replace(drawing, gap=wider), parts)
        if not overlap and not _near(drawing, parts, _whole(parts), near):
            return wider
    return None


def round_up(x: float) -> float:
    """A round number at or just above x.

    >>> round_up(0.37), round_up(1.9), round_up(0.001)
    (0.4, 2.0, 0.001)
    """
    power = 10.0 ** math.floor(math.log10(x))
    lead = next((k for k in (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8) if k * power >= x * (1 - 1e-9)), 10)
    return float(f"{lead * power:.6g}")
