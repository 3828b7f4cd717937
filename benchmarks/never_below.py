"""Proven bounds of random small assemblies against their true optima: `python -m benchmarks.never_below [COUNT [FIRST [KIND ..]]]`.

`certified` as the first word asks for certificates, and what `verify` says of them.

Every bound is asked for far too little on purpose: to leave nothing above 50 %, then above 98 % of the truth, and to tighten for
0.4 seconds of processor time each, the latter once more with local windows, which otherwise only many parts have. What it says has to
stay above the truth all the same; so has the quick bound of the answer, where there is one. Truths share nothing with the proof: a
dynamic programme over exact slices for chains, a dense search through the turns of exact slices for pairs, and else the best of a
motion that was found and checked and of a climb from it that tests every step for overlap. Seeds begin at FIRST.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import shapely
import shapely.ops
from tests.audit import as_assembly
from tests.flex_truth import Ground, climbed, value_of
from tests.flexing import displaced, mirrored, random_assembly, random_goals, row_of
from tests.oracle import chain, random_joints
from tests.oracle.slices import Slices

import wiggleroom as wr
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.joints import JOINTS
from wiggleroom.bound import branch_and_bound
from wiggleroom.bound.branch_and_bound import BranchAndBound
from wiggleroom.bound.certificate import certificate
from wiggleroom.bound.confined_pairs import confined_pairs
from wiggleroom.bound.dual_bound import quick_bound
from wiggleroom.bound.joint_constraints import first_ranges, narrowed
from wiggleroom.bound.outer_regions import outer_regions
from wiggleroom.bound.proof_steps import ProofNode
from wiggleroom.deadline import WorkBudget
from wiggleroom.drawing.model import Drawing, Goal, Part, Pull, Region, Turn
from wiggleroom.freespace.outer.caging_surface import CagingSurface
from wiggleroom.freespace.outer.outer_region import OuterRegion
from wiggleroom.program.objectives import PointMotion, objective
from wiggleroom.search.answer import Answer
from wiggleroom.search.prepare import survey
from wiggleroom.verify.checker import verify

SHARES, SECONDS = (0.5, 0.98), 0.4
WINDOW_SECONDS = 1.0
CERTIFIED_SECONDS = 20.0
CONFINED_SECONDS = 8.0
ROUNDING = 1e-11
OPEN = {"finger"}
"""Joints that do not close."""
Case = tuple[Assembly, tuple[Goal, ...], float | None]


class ProcessorTime:
    """A request to stop after some processor time [s], so that a busy machine proves as much as another one."""

    def __init__(self, seconds: float) -> None:
        self.end = time.process_time() + seconds

    def is_set(self) -> bool:
        """Whether the time is up."""
        return time.process_time() > self.end


def a_chain(seed: int) -> Case:
    """Two to four blocks with one random joint, the last pulled anywhere: dynamic programme."""
    rng = np.random.default_rng([seed, 7])
    made = random_joints.tab_pair(seed, float(np.exp(rng.uniform(np.log(0.004), np.log(0.03)))))
    a, b, D = made.local()
    n, angle = int(rng.integers(2, 5)), float(rng.uniform(-np.pi, np.pi))
    e = (float(np.cos(angle)), float(np.sin(angle)))
    # a block with the pocket, blocks with pocket and tab, a block with the tab
    both = shapely.difference(a, shapely.box(-2.0, -2.0, 0.0, 2.0)).union(
        shapely.difference(b, shapely.box(0.0, -2, 2, 2))
    )
    if n > 2 and both.geom_type != "Polygon":
        n = 2
    shapes = [a, *[both] * (n - 2), b]
    assembly = assemble(row_of(shapes), gap=0.0)
    goals = (wr.Pull(assembly.names[-1], e),)
    return assembly, goals, chain.reach(Slices(a, b, tuple(D)), n, e, cells=60).value


def a_pair(seed: int) -> Case:
    """Two blocks or a peg in a hole with pulls at points, turns and Ws: all turns of exact slices."""
    rng = np.random.default_rng([seed, 8])
    gap, holes = float(np.exp(rng.uniform(np.log(0.004), np.log(0.03)))), bool(rng.integers(2))
    made = (random_joints.tab_pair if rng.integers(2) else random_joints.peg_pair)(seed, gap, holes)
    assembly = as_assembly(made)
    goals = random_goals(assembly, seed)
    a, b, D = made.local()
    slices = Slices(a, b, tuple(D))

    def best(phi: float) -> float:
        corners = slices.corners(phi)
        motions = np.zeros((len(corners), 2, 3))
        motions[:, 1, :2], motions[:, 1, 2] = corners, phi
        return float(value_of(assembly, goals, motions).max(initial=-np.inf))

    turns = np.linspace(slices.low, slices.high, 241)
    values = np.array([best(t) for t in turns])
    top, step = int(values.argmax()), turns[1] - turns[0]
    at, value = turns[top], values[top]
    while step > 1e-9:
        step /= 3
        near = at + step * np.arange(-3, 4)
        seen = [best(t) for t in near]
        if max(seen) > value:
            at, value = near[int(np.argmax(seen))], max(seen)
    return assembly, goals, float(value)


def several(seed: int) -> Case:
    """A small chain, jigsaw, grid or peg with up to three goals: what was found, and what a climb finds."""
    assembly = random_assembly(seed)
    return _climbed(assembly, random_goals(assembly, seed), seed)


def glued(seed: int) -> Case:
    """The same with two free parts glued to each other."""
    rng = np.random.default_rng([seed, 9])
    assembly = random_assembly(seed)
    free = [p.name for p in assembly.parts if not p.fixed]
    if len(free) > 2:
        drawing = assembly.drawing
        pair = rng.permutation(len(free))[:2]
        assembly = assemble(replace(drawing, glue=((free[pair[0]], free[pair[1]]),)), gap=assembly.gap)
    return _climbed(assembly, random_goals(assembly, seed), seed)


def a_grid(seed: int) -> Case:
    """Blocks in rings, some left out, all turned and drawn in frames of their own: local windows and what was found."""
    rng = np.random.default_rng([seed, 10])
    gap, joint = float(np.exp(rng.uniform(np.log(0.004), np.log(0.03)))), str(rng.choice(sorted(set(JOINTS) - OPEN)))
    nx, ny = (int(k) for k in rng.integers(3, 5, 2))
    made = wr.patterns.grid(nx, ny, joint=joint, gap=gap)
    out = set(rng.choice(nx * ny - 1, int(rng.integers(0, 3)), replace=False).tolist())
    parts = [replace(p, fixed=False) for k, p in enumerate(made.drawing.parts) if k not in out]
    stands = int(rng.integers(len(parts)))
    parts[stands] = replace(parts[stands], fixed=True)
    drawing = replace(made.drawing, parts=tuple(parts), goals=())
    drawing = displaced(drawing, float(rng.uniform(-np.pi, np.pi)), tuple(rng.uniform(-50, 50, 2)), seed)
    assembly = assemble(drawing, gap=gap)
    goals = random_goals(assembly, seed)
    answer = wr.flex(assembly, goals, search=0)
    return assembly, goals, None if answer.objective is None or answer.path != "checked" else answer.objective


def mixed(seed: int) -> Case:
    """Small assemblies with another clearance round every part, up to three parts fixed, some mirrored, all turned."""
    rng = np.random.default_rng([seed, 11])
    made = random_assembly(seed)
    size = max(made.gap, 1e-3)
    parts = [replace(p, offset=-size * float(np.exp(rng.uniform(-3, 1.5)))) for p in made.drawing.parts]
    for k in rng.choice(len(parts), int(rng.integers(0, 3)), replace=False):
        parts[k] = replace(parts[k], fixed=sum(not p.fixed for p in parts) > 1 or parts[k].fixed)
    drawing = replace(made.drawing, parts=tuple(parts), goals=())
    if rng.integers(2):
        drawing = mirrored(drawing)
    drawing = displaced(drawing, float(rng.uniform(-np.pi, np.pi)), tuple(rng.uniform(-50, 50, 2)), seed)
    assembly = assemble(drawing, gap=made.gap * float(rng.choice([0.1, 1.0])))
    return _climbed(assembly, random_goals(assembly, seed), seed)


def near_copies(seed: int) -> Case:
    """Two pairs of long plates that are nearly congruent, turned against each other: all turns of exact slices of the second one."""
    rng = np.random.default_rng([seed, 12])
    gap, long = float(10 ** rng.uniform(-4, -1.5)), float(10 ** rng.uniform(0, 2.3))
    made = random_joints.tab_pair(seed, gap)
    a = made.made[0].union(shapely.box(-0.5 - long, -0.4, -0.4, 0.4))
    b = shapely.transform(made.made[1].union(shapely.box(1.4, -0.4, 1.5 + long, 0.4)), lambda p: p - made.D)
    away = made.D + 10 ** rng.uniform(-11, -7) * long * rng.choice([-1.0, 0.0, 1.0], 2)
    if shapely.intersects(a, shapely.transform(b, lambda p: p + away)):
        raise ValueError("the second pair overlaps at rest")
    angle, down = float(rng.choice([0.0, np.pi / 2, 0.3])), np.array([0.0, -5.0 - 2 * long])
    c, s = np.cos(angle), np.sin(angle)
    turned = np.array([[c, s], [-s, c]])
    parts = [
        part("a1", a, (0.0, 0.0, 0.0), True),
        part("b1", b, (*made.D, 0.0)),
        part("a2", a, (*down, angle), True),
        part("b2", b, (*(down + away @ turned), angle)),
    ]
    order = rng.permutation(2)
    assembly = assemble(Drawing(tuple(parts[2 * int(k) + i] for k in order for i in (0, 1))), gap=0.0)
    turn = Turn("b2", "ccw" if rng.integers(2) else "cw")
    e = rng.standard_normal(2)
    pull = Pull("b2", (float(e[0]), float(e[1])), tuple(down + away @ turned))
    goals: tuple[Goal, ...] = (turn,) if rng.integers(3) == 0 else (pull,)
    slices = Slices(a, b, tuple(away))

    def best(phi: float) -> float:
        corners = slices.corners(phi) @ turned
        motions = np.zeros((len(corners), 4, 3))
        k = assembly.names.index("b2")
        motions[:, k, :2], motions[:, k, 2] = corners, phi
        return float(value_of(assembly, goals, motions).max(initial=-np.inf))

    return assembly, goals, max(best(t) for t in np.linspace(slices.low, slices.high, 801))


def part(name: str, shape: shapely.Polygon, at: tuple[float, float, float], fixed: bool = False) -> Part:
    """A part of one polygon."""
    ring = shapely.get_coordinates(shapely.orient_polygons(shape).exterior)[:-1]
    return Part(name, (Region(ring),), at, fixed)


def a_tray(seed: int) -> Case:
    """A board cut by straight lines into two to four pieces, in a frame round it: pairs that only the frame keeps together."""
    rng = np.random.default_rng([seed, 11])
    wide, high = (float(x) for x in rng.uniform(8, 25, 2))
    board = shapely.box(0, 0, wide, high)
    if rng.integers(2):
        board = board.union(shapely.box(wide - 0.1, 0.3 * high, wide + 2, 0.6 * high))
    pieces = [board]
    for _ in range(int(rng.integers(1, 4))):
        pieces.sort(key=shapely.area)
        piece = pieces.pop()
        angle = float(rng.choice([0.0, np.pi / 2, rng.uniform(0, np.pi)]))
        along = 100 * np.array([np.cos(angle), np.sin(angle)])
        middle = shapely.get_coordinates(piece.centroid)[0] + rng.uniform(-1, 1, 2)
        pieces += shapely.ops.split(piece, shapely.LineString([middle - along, middle + along])).geoms
    frame = board.buffer(3, join_style="mitre").difference(board)
    drawing = row_of([frame, *pieces], pitch=0.0)
    drawing = displaced(drawing, float(rng.uniform(-np.pi, np.pi)), tuple(rng.uniform(-50, 50, 2)), seed)
    assembly = assemble(drawing, gap=float(np.exp(rng.uniform(np.log(0.02), np.log(0.3)))))
    return _climbed(assembly, random_goals(assembly, seed), seed)


def _climbed(assembly: Assembly, goals: tuple[Goal, ...], seed: int) -> Case:
    answer = wr.flex(assembly, goals)
    if answer.objective is None or answer.path != "checked":
        return assembly, goals, None
    glue = assembly.drawing.glue
    more = 0.0 if glue else climbed(answer, Ground(assembly), seed, rounds=30)
    return assembly, goals, max(answer.objective, more)


def _proven(assembly: Assembly, goals: tuple[Goal, ...], truth: float) -> list[float]:
    """Bounds that are asked for too little; infinite where joints do not close."""
    surveyed = survey(assembly)
    goal = objective(assembly, surveyed.bodies, goals)
    links, closed = outer_regions(surveyed, WorkBudget())
    ranges = first_ranges(surveyed.bodies.fixed, links, closed)
    regions = [region for region in closed if isinstance(region, OuterRegion)]
    links, regions, ranges = confined_pairs(
        surveyed, links, regions, ranges, WorkBudget(stop=ProcessorTime(CONFINED_SECONDS))
    )
    if not isinstance(goal, PointMotion) or not (surveyed.bodies.fixed | np.isfinite(ranges.far))[goal.body].all():
        return [np.inf]
    found = []
    for cut, seconds, many in (
        *((share * truth, SECONDS, branch_and_bound.MANY_BODIES) for share in SHARES),
        (SHARES[-1] * truth, WINDOW_SECONDS, 0),
    ):
        branch_and_bound.MANY_BODIES, before = many, branch_and_bound.MANY_BODIES
        bounding = BranchAndBound(
            surveyed, links, [*regions], goal, cut, WorkBudget(stop=ProcessorTime(seconds)), lambda *_: None
        )
        found.append(bounding.run(narrowed(bounding.first(), ranges.low, ranges.high), cut))
        branch_and_bound.MANY_BODIES = before
        WINDOWS[0] += len(bounding.windows)
    return found


def _certified(assembly: Assembly, goals: tuple[Goal, ...], truth: float) -> list[float]:
    """What certificates state that were asked for too little, with and without windows; all of them must verify."""
    surveyed = survey(assembly)
    goal = objective(assembly, surveyed.bodies, goals)
    budget = WorkBudget(stop=ProcessorTime(CERTIFIED_SECONDS))
    links, regions = outer_regions(surveyed, budget, certify=True)
    ranges = first_ranges(surveyed.bodies.fixed, links, regions)
    if not isinstance(goal, PointMotion) or not (surveyed.bodies.fixed | np.isfinite(ranges.far))[goal.body].all():
        return [np.inf]
    found = []
    for many in (branch_and_bound.MANY_BODIES, 0):
        proof = ProofNode()
        branch_and_bound.MANY_BODIES, before = many, branch_and_bound.MANY_BODIES
        cut = SHARES[-1] * truth
        budget = WorkBudget(stop=ProcessorTime(WINDOW_SECONDS))
        bounding = BranchAndBound(surveyed, links, [*regions], goal, cut, budget, lambda *_: None, proof)
        ranges = bounding.first()
        bounding.run(ranges, cut)
        branch_and_bound.MANY_BODIES = before
        surfaces = [r for r in regions if isinstance(r, CagingSurface)]
        paper = certificate(surveyed, assembly, bounding.joints, surfaces, goal, ranges, cut, bounding.windows, proof)
        if not np.isfinite(paper["at_most"]):
            continue
        judged = verify(json.loads(json.dumps(paper)))
        if not judged.proven:
            REFUSED[0] += 1
            print(f"a certificate is refused: {judged.why}", flush=True)
        found.append(judged.at_most if judged.proven else np.inf)
        WINDOWS[0] += len(bounding.windows)
    return found or [np.inf]


def _quick(answer: Answer) -> float:
    """Quick bound at whatever cost; infinite where there is none."""
    found = answer.warm_start
    if found is None or not isinstance(found.program.objective, PointMotion):
        return np.inf
    most = quick_bound(found, found.program.objective, 1e9)
    return np.inf if most is None else most


WINDOWS, REFUSED = [0], [0]
"""So many local windows were worked out; so many certificates were refused."""
KINDS: dict[str, Callable[[int], Case]] = {
    "chain": a_chain,
    "pair": a_pair,
    "several": several,
    "glued": glued,
    "grid": a_grid,
    "mixed": mixed,
    "near": near_copies,
    "tray": a_tray,
}


def main(words: list[str]) -> None:
    """Print one line for each kind, one for each bound that lies too low, and how many were judged."""
    papers = words[:1] == ["certified"]
    words = words[papers:]
    count, first = (int(words[k]) if len(words) > k else default for k, default in ((0, 1000), (1, 20000)))
    kinds = words[2:] or list(KINDS)
    rows = {kind: np.zeros(4, dtype=int) for kind in kinds}  # looked at, unlimited or no way, no bound, below
    nearest = dict.fromkeys(kinds, np.inf)
    began, judged = time.perf_counter(), 0
    for seed in range(first, first + count):
        kind = kinds[seed % len(kinds)]
        rows[kind][0] += 1
        try:
            assembly, goals, truth = KINDS[kind](seed)
            survey(assembly)
        except (ValueError, wr.InputError) as why:
            print(f"{kind} {seed}: no assembly ({why})", flush=True)
            rows[kind][1] += 1
            continue
        if truth is None:
            rows[kind][1] += 1
            continue
        if papers:
            bounds = _certified(assembly, goals, truth)
        else:
            bounds = [*_proven(assembly, goals, truth), _quick(wr.flex(assembly, goals, search=0))]
        over = min(bounds) / truth - 1
        rows[kind][2] += not np.isfinite(over)
        judged += int(np.isfinite(bounds).sum())
        nearest[kind] = min(nearest[kind], over)
        if over < -ROUNDING:
            rows[kind][3] += 1
            print(f"{kind} {seed}: bounds {bounds} below {truth!r}", flush=True)
        if seed % 50 == 49:
            print(f"# {seed - first + 1} in {time.perf_counter() - began:.0f} s", file=sys.stderr, flush=True)
    print("| kind | assemblies | without a truth | without a bound | nearest bound above the truth | bounds below it |")
    print("| --- " * 6 + "|")
    for kind, row in rows.items():
        print(f"| {kind} | {row[0]} | {row[1]} | {row[2]} | {nearest[kind]:.1e} | {row[3]} |")
    asked, unknown, without, below = sum(rows.values(), np.zeros(4, dtype=int))
    print(
        f"{asked} assemblies, {asked - unknown - without} of them judged by {judged} bounds, {below} of them with one that lies too low; "
        f"{WINDOWS[0]} local windows, {REFUSED[0]} certificates refused"
    )


if __name__ == "__main__":
    main(sys.argv[1:])
