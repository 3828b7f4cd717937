"""Prepared assemblies for the designs of one drawing: what was worked out for one gap is carried over to others."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, rings_at
from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.statements import unknown
from wiggleroom.drawing.model import Drawing, JointGap
from wiggleroom.errors import InputError, Stop
from wiggleroom.freespace.cells.cells import replaced
from wiggleroom.geometry.bodies import Bodies, corners
from wiggleroom.geometry.offset_bodies import offset_bodies
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.program.gap_sensitivity import OUTLINE_TOLERANCE, carried
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.program.objectives import ZERO_MOTION
from wiggleroom.search.prepare import Prepared, cells_at
from wiggleroom.search.prepare_walls import prepare_walls

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_CACHED = 12
"""Number of prepared designs that are kept."""
MIN_CARRIED_CLEARANCE = 0.02
"""Where a carried cell leaves rest less room than this share of the clearance, it is grown anew."""


@dataclass(frozen=True, eq=False)
class GapDesign:
    """One design, made ready for questions.

    Parameters
    ----------
    roles : tuple
        Who is fixed, who is glued and which joints have a gap of their own; designs that agree in this share bodies and pairs.
    inward : (parts,) float64 [mm]
        How far each outline lies inside the drawn one.
    assembly : Assembly
    ready : Prepared
    proven : bool
        True where its cells were grown for these very outlines, False where they were carried over from another gap.
    """

    roles: tuple[object, ...]
    inward: Floats
    assembly: Assembly
    ready: Prepared
    proven: bool

    @cached_property
    def order(self) -> Ints | None:
        """Which corner of the assembly's outlines each corner of the bodies is (N,); None where there are others."""
        from scipy.spatial import cKDTree  # slow to load

        there, here = outline_corners(self.assembly), corners(self.ready.bodies)[1]
        if len(there) != len(here):
            return None
        far, nearest = cKDTree(there).query(here, distance_upper_bound=OUTLINE_TOLERANCE * self.ready.size)
        return nearest if (far < np.inf).all() and len(np.unique(nearest)) == len(there) else None

    def same(self, bodies: Bodies, made: Assembly) -> bool:
        """True where the corners of bodies that were moved from this design's are those of the assembly's outlines."""
        there = outline_corners(made)
        if self.order is None or len(there) != len(self.order):
            return False
        return bool(
            np.abs(there[self.order] - corners(bodies)[1]).max(initial=0.0) < OUTLINE_TOLERANCE * self.ready.size
        )


class PreparedDesigns:
    """Designs of one drawing, the last ones kept."""

    def __init__(self, drawing: Drawing) -> None:
        self.drawing = drawing
        self._kept: OrderedDict[tuple[object, ...], GapDesign] = OrderedDict()
        self._last: tuple[object, tuple[object, ...]] | None = None

    def design(
        self,
        gap: float | None,
        extra: Mapping[str, float],
        fixed: Collection[str] | None,
        glue: Sequence[Sequence[str]] | None,
        gaps: Sequence[JointGap] | None = None,
    ) -> GapDesign:
        """Return one design; arguments and errors as for `wiggleroom.Live.design`."""
        stand, groups = (None if some is None else list(some) for some in (fixed, glue))
        joints = None if gaps is None else tuple(gaps)
        asked = (gap, dict(extra), stand, groups, joints)
        if self._last is not None and self._last[0] == asked:  # as for every place of a dragged part
            return self._kept[self._last[1]]
        drawing = self._with_roles(fixed, glue)
        drawing = drawing if joints is None else replace(drawing, gaps=joints)
        gap = drawing.gap if gap is None else float(gap)
        roles = (tuple(p.fixed for p in drawing.parts), drawing.glue, drawing.gaps)
        key = (*roles, gap, tuple(sorted((name, float(x)) for name, x in extra.items() if x)))
        if key not in self._kept:
            made = assemble(drawing, gap=gap, offset={name: -x / 2 for name, x in extra.items() if x})
            inward = np.array([gap / 2 - part.offset for part in made.drawing.parts])
            ready = self._carried(roles, inward, made)
            self._keep(key, GapDesign(roles, inward, made, ready or prepare_walls(made), ready is None))
        self._kept.move_to_end(key)
        self._last = asked, key
        return self._kept[key]

    def prove(self, design: GapDesign, stop: Stop | None = None) -> GapDesign:
        """Return the same design with cells grown for its very outlines; raises StoppedError where it is asked to stop."""
        if design.proven:
            return design
        proven = replace(design, ready=prepare_walls(design.assembly, stop=stop), proven=True)
        for key, kept in self._kept.items():
            if kept is design:
                self._kept[key] = proven
        return proven

    def _keep(self, key: tuple[object, ...], design: GapDesign) -> None:
        """Keep a design; the oldest goes, but one that others can be carried from stays."""
        self._kept[key] = design
        if len(self._kept) > MAX_CACHED:
            older = [other for other in self._kept if other != key]
            self._kept.pop(next((k for k in older if not self._kept[k].proven), older[0]))

    def _with_roles(self, fixed: Collection[str] | None, glue: Sequence[Sequence[str]] | None) -> Drawing:
        """Return the drawing with other parts fixed and glued."""
        names = {p.name: None for p in self.drawing.parts}
        named = {"fixed": fixed or (), "glue": [name for group in glue or () for name in group]}
        wrong = [f"{what}: {unknown(n, names)}" for what, some in named.items() for n in some if n not in names]
        if wrong:
            raise InputError(wrong)
        drawing = replace(self.drawing, goals=())  # they come with the question: a pulled part may be fixed now
        if fixed is not None:
            stand = set(fixed)
            parts = (p if p.fixed == (p.name in stand) else replace(p, fixed=not p.fixed) for p in drawing.parts)
            drawing = replace(drawing, parts=tuple(parts))
        return drawing if glue is None else replace(drawing, glue=tuple(tuple(group) for group in glue))

    def _carried(self, roles: tuple[object, ...], inward: Floats, made: Assembly) -> Prepared | None:
        """Return the nearest proven design with its outlines moved; None where that is not all that changes."""
        near = [d for d in self._kept.values() if d.proven and d.roles == roles]
        if not near or made.drawing.gaps:
            return None
        base = min(near, key=lambda d: float(np.abs(d.inward - inward).max()))
        before, by = base.ready.bodies, inward - base.inward
        try:
            after = offset_bodies(before, by)
        except InputError:
            return None
        if not base.same(after, made):
            return None
        if overlaps(after, np.zeros_like(after.rest), base.ready.ignored).deepest > 0:
            return None  # `prepare_walls` then raises the error that names the parts
        clearance = base.ready.clearance + 2 * float(np.median(by))
        if clearance < 0.1 * base.ready.clearance:
            return None
        ready = replace(
            base.ready, assembly=made, bodies=after, clearance=clearance, cells=carried(base.ready.cells, before, after)
        )
        return _with_room(ready)


def outline_corners(assembly: Assembly) -> Floats:
    """Corners (N, 2) [mm] of the outlines of all parts at rest, one after the other."""
    return np.vstack([ring for part in assembly.parts for ring in rings_at(part)])


def with_outlines(ready: Prepared, bodies: Bodies) -> Prepared:
    """Return the same with other outlines of its bodies, and cells grown for them at rest."""
    a, b = ready.cells.a, ready.cells.b
    cells = cells_at(ready.assembly, bodies, a, b, np.full(len(a), ready.clearance))
    return replace(ready, bodies=bodies, cells=cells)


def _with_room(ready: Prepared) -> Prepared:
    """Return the same, with new cells for the pairs that have hardly any room at rest in the carried ones."""
    program = build_program(ready.bodies, ready.cells, ZERO_MOTION, length=ready.clearance)
    tight = program.values(np.zeros(len(program.scale))) < MIN_CARRIED_CLEARANCE
    pairs = np.unique(ready.cells.pair[tight])
    if not len(pairs):
        return ready
    room = np.full(len(pairs), ready.clearance)
    grown = cells_at(ready.assembly, ready.bodies, ready.cells.a[pairs], ready.cells.b[pairs], room)
    return replace(ready, cells=replaced(ready.cells, pairs, grown))
