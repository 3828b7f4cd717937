"""What is known about passages at one gap of an assembly, for its other gaps: what is closed stays closed when parts grow."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import Context
from wiggleroom.freespace.subdivision.passage import Passage
from wiggleroom.search.prepare import Prepared

Ints = NDArray[np.int64]
Names = frozenset[str]
Sides = tuple[float, frozenset[Names]]
"""Chord error of the curves [mm], and who is on either side."""


@dataclass(eq=False)
class PassagesByGap:
    """Passages of one assembly that were looked at, from rest, with several gaps.

    Parts only shrink as the gap grows. So what certainly does not leave at a gap does not leave at a smaller one, and an escape path stays
    one at a larger gap. What the same boxes decided neither at a smaller nor at a larger gap is not looked at in between. Curves that were
    cut into other edges are other outlines, of which nothing is known.
    """

    _closed: dict[Sides, tuple[float, Passage]] = field(default_factory=dict)
    _held: dict[Sides, tuple[float, Passage]] = field(default_factory=dict)
    _open: dict[Sides, tuple[float, Passage | None]] = field(default_factory=dict)
    _undecided: dict[tuple[Sides, int], list[tuple[float, Passage]]] = field(default_factory=dict)

    def look(
        self, ready: Prepared, a: Ints, b: Ints, most: int, passage: Callable[[], Passage | None], context: Context
    ) -> Passage | None:
        """The passage of bodies `b` out of bodies `a`, by `passage` with `most` boxes where it is not known; None: slides lead apart."""
        gap, how = ready.assembly.gap, ready.assembly.drawing.flattening
        key = (0.0 if how is None else how.error, frozenset((_names(ready, a), _names(ready, b))))
        for table in (self._held, self._closed):
            if key in table and gap <= table[key][0]:
                return table[key][1]
        if key in self._open and gap >= self._open[key][0]:
            return self._open[key][1]
        seen = self._undecided.setdefault((key, most), [])
        if any(g <= gap for g, _ in seen) and any(g >= gap for g, _ in seen):
            return seen[0][1]
        found = passage()
        if found is None or found.path is not None:
            self._open[key] = gap, found
        elif found.closed:
            (self._held if found.held else self._closed)[key] = gap, found
        elif not context.stopped:
            seen.append((gap, found))
        return found


def _names(ready: Prepared, bodies: Ints) -> Names:
    return frozenset(ready.assembly.names[part] for body in bodies for part in ready.bodies.members[body])
