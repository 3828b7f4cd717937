"""Everything that is wrong with a design in space at once, and changes that put it right."""

from __future__ import annotations

from wiggleroom.app.review import GAP_SHARE, nothing_stands, round_up
from wiggleroom.app.spatial_designs import SpatialDesignCache, suggested_pull
from wiggleroom.disassembly.ground import drawn_sizes
from wiggleroom.errors import TouchingError
from wiggleroom.report.results.answer_words import number, short
from wiggleroom.schema.replies import Fault, Mend
from wiggleroom.schema.requests import Design
from wiggleroom.spatial.search.spatial_prepare import prepare_spatial

OVERLAP_MARGIN = 1.25
"""A gap that is to open an overlap is this many times as large."""


def spatial_review(designs: SpatialDesignCache, design: Design) -> list[Fault]:
    """List what is wrong with a design.

    Raises
    ------
    InputError
        If it names parts that are not there, or parts cannot be made.
    """
    assembly = designs.assembly(design)
    found = []
    if not any(p.fixed for p in assembly.parts):
        found.append(nothing_stands(assembly.names, drawn_sizes(assembly), design))
    elif all(p.fixed for p in assembly.parts):
        name = design.fixed[-1]
        mends = [Mend(f"Let {short(name)} go", fixed=design.fixed[:-1])] if len(design.fixed) > 1 else []
        found.append(Fault("stands", "Everything is fixed: leave at least one part free to move", mends=mends))
        return found
    if not design.goals and len(assembly.parts) > 1:
        goal = suggested_pull(assembly)
        mend = Mend(f"Pull {short(goal.part)}", goals=[goal])
        words = "Nothing is pulled: say which part, and which way"
        found.append(Fault("pulled", words, [goal.part], mends=[mend], missing=True))
    try:
        prepare_spatial(assembly)
    except TouchingError as problem:
        found.append(_meeting(problem, designs.gap(design), assembly.size, design))
    return found


def _meeting(problem: TouchingError, gap: float, size: float, design: Design) -> Fault:
    """Two parts that overlap or touch at rest."""
    a, b = problem.parts
    deep = max(0.0, -problem.clearance)
    wanted = round_up(gap + OVERLAP_MARGIN * deep + (GAP_SHARE * size if deep < GAP_SHARE * size else 0.0))
    words = (
        f"{short(a)} and {short(b)} overlap by {number(deep, 3)} mm"
        if deep > 1e-6 * size
        else f"{short(a)} and {short(b)} touch at rest: there is no room to move"
    )
    mends = [Mend(f"Use a gap of {number(wanted)} mm", gap=wanted)] if wanted < size / 20 else []
    return Fault("gap", words, [a, b], mends=[*mends, Mend("Glue them", glue=[*design.glue, [a, b]])])
