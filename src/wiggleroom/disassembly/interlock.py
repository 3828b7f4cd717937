"""Does it come apart: which parts leave, in which order, along which motion; or what shows that none do."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.bound.displacement_bound import furthest
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.disassemble import disassemble
from wiggleroom.disassembly.escape_effort import EscapeEffort
from wiggleroom.disassembly.ground import with_ground
from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.disassembly.passages_by_gap import PassagesByGap
from wiggleroom.disassembly.remaining import only
from wiggleroom.drawing.model import Turn
from wiggleroom.errors import InputError, TouchingError, WiggleroomError
from wiggleroom.form_closure.closure_bound import ClosureBound, closure_bound
from wiggleroom.geometry.bodies import bodies
from wiggleroom.maximise import witness
from wiggleroom.search.prepare_walls import prepare_walls
from wiggleroom.verdict import Certainty, PathState, Separability

Ints = NDArray[np.int64]

TRIAL_GAPS = 1e-4, 4e-6
"""Gaps, as shares of the drawing's size, with which parts that touch at rest are looked at: the next where they come apart with one."""
BOUND_WORK, BOUND_WORK_PER_PART = 1000.0, 50.0
"""Work of the bound on displacements, about milliseconds, and for each part."""
REFINED_SHARE = 0.1
"""Share of it for a tighter bound, where one is known already."""


def interlock(
    assembly: Assembly, effort: EscapeEffort | None = None, *, every: bool = True, context: Context = UNLIMITED
) -> Interlock:
    """Whether some parts of a drawing can be moved without limit away from the others; see `wiggleroom.check`.

    Notes
    -----
    Parts that touch at rest are locked where their contacts leave them no way, neither to first order nor further. Else they are looked
    at with a little gap everywhere, as one what contacts lock: what interlocks with it does so without.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = wr.check(wr.patterns.chain(3, joint="swallowtail", gap=0.02))
    >>> str(found.verdict), str(found.certainty)
    ('interlocked', 'proven')
    """
    effort = effort or EscapeEffort()
    began = time.perf_counter()
    standing = with_ground(assembly)
    try:
        done = disassemble(standing, effort=effort, every=every, returning=True, context=context)
    except TouchingError as why:
        if why.clearance < 0:
            raise
        return _tight(assembly, standing, effort, every, context)
    escapes, stage = done.escapes, done.last
    left = only(standing, done.remaining) if escapes else standing
    spins = _spins(left, stage.held, context) if every else ()
    verdict: Separability = Separability.COMES_APART if escapes else stage.ended
    at_most = None
    if verdict is Separability.INTERLOCKED and every:
        whole = stage.reach  # where that is finite, little is spent on a nearer one
        work = BOUND_WORK + BOUND_WORK_PER_PART * len(left.names)
        found = furthest(left, work if np.isinf(whole) else REFINED_SHARE * work, context.stop)
        at_most = min((float(d) for d in (found, whole) if d is not None and np.isfinite(d)), default=None)
    held = stage.ended is Separability.INTERLOCKED and not bodies(left).fixed.all()
    return Interlock(
        assembly,
        verdict,
        Certainty.PROVEN if escapes or at_most is not None else stage.certainty,
        escapes,
        spins,
        left.names if held else (),
        done.questions,
        done.states,
        time.perf_counter() - began,
        at_most=at_most,
        turned=done.turned,
        whole=done.last.whole,
        unanswered=done.unanswered,
    )


def _tight(assembly: Assembly, left: Assembly, effort: EscapeEffort, every: bool, context: Context) -> Interlock:
    """The same for parts that touch at rest."""
    began = time.perf_counter()
    known = closure_bound(left, context)
    if known.all_locked:
        # a curve drawn tight may turn where the polygon that stands for it does not
        exact = Path(assembly.drawing.source).suffix.lower() in ("", ".json")
        sure: Certainty = Certainty.PROVEN if exact else Certainty.SEARCHED
        names = tuple(assembly.names)
        return Interlock(
            assembly, Separability.INTERLOCKED, sure, remains=names, seconds=time.perf_counter() - began, tight=True
        )
    found = Interlock(left, Separability.UNKNOWN, Certainty.SEARCHED, whole=False)
    for share in TRIAL_GAPS:
        try:
            loose = _loosened(left, known, share * left.size)
            looked = interlock(loose, replace(effort, passages=PassagesByGap()), every=every, context=context)
        except InputError:  # what is thinner than the little gap is not there with it, so nothing is known
            continue
        # what a smaller gap leaves open is no reason to doubt the path of a larger one; that it holds is
        if looked.verdict is not Separability.UNKNOWN or found.verdict is Separability.UNKNOWN:
            found = looked
        if looked.verdict is not Separability.COMES_APART:
            break
    apart = found.verdict is Separability.COMES_APART  # with the little gap, which is not quite the drawing
    sure = Certainty.SEARCHED if apart else found.certainty
    return replace(found, assembly=assembly, certainty=sure, seconds=time.perf_counter() - began)


def _loosened(assembly: Assembly, known: ClosureBound, gap: float) -> Assembly:
    """The assembly as made with a little gap [mm] everywhere, whatever its joints had, and as one what contacts certainly lock.

    Raises
    ------
    InputError
        If parts vanish.
    """
    names, group = assembly.names, known.group[known.body_of]
    # a part that gets no further than the little gap from where it would be as one with others covers what is left of it there
    firm = (known.far < gap / 4)[known.body_of]
    drawing = assembly.as_cut()
    # what some parts pass through stays by itself: as one with others it would stop them
    firm &= ~np.isin(names, [name for pair in drawing.ignore for name in pair])
    glue = tuple(tuple(names[k] for k in np.flatnonzero(firm & (group == g))) for g in np.unique(group[firm]))
    return assemble(replace(drawing, glue=(*drawing.glue, *(g for g in glue if len(g) > 1)), flattening=None), gap=gap)


def _spins(assembly: Assembly, held: Ints, context: Context) -> tuple[str, ...]:
    """Names of the parts that turn in place without limit."""
    if not len(held) or (held == held[0]).all():
        return ()
    try:
        ready = prepare_walls(assembly, stop=context.stop)
    except WiggleroomError:
        return ()
    them, names = ready.bodies, assembly.names
    found: set[str] = set()
    for b in np.flatnonzero(held != held[int(np.flatnonzero(them.fixed)[0])]):
        name = names[them.members[b][0]]
        if name in found or context.stopped:
            continue
        answer = witness(ready, Turn(name), context=context.silent)
        if answer.path == PathState.CHECKED:
            found |= set(answer.turns)
    return tuple(n for n in names if n in found)
