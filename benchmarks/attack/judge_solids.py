"""What the program says about one assembly in space, and what the collision library python-fcl finds wrong with it."""

from __future__ import annotations

import tempfile
import threading
from pathlib import Path

import numpy as np

from benchmarks.attack.judge import Finding, answered, judge_begin
from benchmarks.attack.search_solids import way_out
from benchmarks.attack.solids import Solids
from benchmarks.spatial_overlaps import Judge, worst_on

SHALLOW, ROUNDED = 1e-6, 1e-6
"""Overlaps count as touching that are shallower than this [mm] and this share of the size: meshes go through a file of seven digits."""
MOVES = 150
"""Moves of the judge's own search for a way out of what is said to be interlocked."""
CHECK_SECONDS = 30.0
"""After so long `check` is asked to stop; answers say then that they are unfinished."""


def ask_solids(family: str, number: int, made: Solids, programs: int) -> Finding:
    """Ask `flex`, and `check` unless there are no programs, about an assembly in space, and judge ends, paths and ways out."""
    import wiggleroom as wr

    out = Finding(family, number)
    with tempfile.TemporaryDirectory() as place:
        answer = answered(lambda: wr.flex(wr.read(made.write(Path(place)))), out)
        if answer is None:
            return out
        ground = SolidGround(made, answer.assembly.reference)
        path = answer.waypoints
        judge_begin(path, ground.fixed, out)
        depth = ground.overlap(path if answer.path == "checked" else path[-1:])
        if depth:
            out.wrong.append(f"path: parts overlap by {depth:.3g} mm")
        if answer.path != "checked":
            out.wrong.append("unchecked: the path is not checked")
        if answer.objective is not None and answer.objective < -SHALLOW:
            out.wrong.append(f"value: {answer.objective:.9g} is said, and rest is worth 0")
        if programs:
            _judge_check(made, ground, wr, answer.assembly, out)
    return out


class SolidGround:
    """The parts as they were drawn, moved about their reference points."""

    def __init__(self, made: Solids, reference: np.ndarray) -> None:
        self.names = [p.name for p in made.parts]
        self.fixed = [k for k, p in enumerate(made.parts) if p.fixed]
        self.pieces = [p.pieces() for p in made.parts]
        corners = np.vstack([piece for pieces in self.pieces for piece in pieces])
        self.near = SHALLOW + ROUNDED * float(np.abs(corners).max())
        self.reference = reference
        self.held = [p.fixed for p in made.parts]
        self.axes = np.unique(np.vstack([p.R.T for p in made.parts]).round(9), axis=0)

    def overlap(self, waypoints: np.ndarray, gone: frozenset[str] = frozenset()) -> float:
        """Deepest overlap on a path [mm]; 0 where parts at most touch."""
        stay = [k for k, name in enumerate(self.names) if name not in gone]
        judge = Judge([self.pieces[k] for k in stay], self.reference[stay], [self.held[k] for k in stay])
        deepest = worst_on(judge, np.asarray(waypoints)[:, stay])
        return deepest if deepest > self.near else 0.0

    def way_out(self, rng: np.random.Generator, moves: int) -> np.ndarray | None:
        """A way out that the judge finds itself; None where it finds none."""
        judge = Judge(self.pieces, self.reference, self.held)
        corners = np.vstack([piece for pieces in self.pieces for piece in pieces])
        free = [k for k, fixed in enumerate(self.held) if not fixed]
        found = way_out(
            judge.depth, len(self.held), free, self.axes, float(np.ptp(corners, axis=0).max()), rng, moves, self.near
        )
        return None if found is None or self.overlap(found) else found


def _judge_check(made: Solids, ground: SolidGround, wr, assembly, out: Finding) -> None:
    stop = threading.Event()
    clock = threading.Timer(CHECK_SECONDS, stop.set)
    clock.start()
    try:
        found = wr.check(assembly, stop=stop)
    except wr.InputError as error:
        out.check = "refused"
        out.wrong.append(f"refused by check: {error}")
        return
    finally:
        clock.cancel()
    out.check = f"{found.verdict}, {found.certainty}"
    gone: set[str] = set()
    for escape in found.escapes:
        depth = ground.overlap(escape.path, frozenset(gone))
        gone |= set(escape.parts)
        if depth:
            out.wrong.append(f"escape of {', '.join(escape.parts)}: parts overlap by {depth:.3g} mm")
    if found.verdict == "interlocked":
        kind = "check:" if found.certainty == "proven" else "low:"
        if made.comes_apart:
            out.wrong.append(f"{kind} it says interlocked, {found.certainty}, and it comes apart")
        elif ground.way_out(np.random.default_rng([out.number, 5]), MOVES) is not None:
            out.wrong.append(f"{kind} it says interlocked, {found.certainty}, and the judge finds a way out")
    if found.verdict == "comes apart" and made.comes_apart is False:
        out.wrong.append("check: it says comes apart, and it is locked")
