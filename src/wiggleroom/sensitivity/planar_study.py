"""The assembly of a drawing, as studies of gaps ask it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, reduce
from typing import Any, Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.assembly.findings import asked_goals
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.context import Context
from wiggleroom.disassembly.clearance_program import ClearanceProblem, MovingBodies, largest_clearance_path
from wiggleroom.drawing.model import Drawing, Goal
from wiggleroom.errors import Stop, go_on
from wiggleroom.freespace.cells.cells import Cells, concatenated, replaced
from wiggleroom.geometry.bodies import bodies
from wiggleroom.geometry.rigid_motions import of_bodies, of_parts
from wiggleroom.geometry.row_kinds import HIGH_TURN, LOW_TURN
from wiggleroom.geometry.touching_corners import TouchingCorners, touching_corners
from wiggleroom.maximise import flex, witness
from wiggleroom.parallel.parallel_run import Work
from wiggleroom.program.gap_sensitivity import gains
from wiggleroom.program.nonlinear_program import Program, build_program
from wiggleroom.program.objectives import Objective, objective
from wiggleroom.search.active_set import EDGE_END_TOLERANCE, touching
from wiggleroom.search.answer import Answer, witnessed
from wiggleroom.search.contact_forces import BALANCE_TOLERANCE, TOUCHING_DISTANCE
from wiggleroom.search.global_search import local_optima
from wiggleroom.search.incumbent import start_at_rest
from wiggleroom.search.local_search import LocalSearch
from wiggleroom.search.moves import THOROUGH
from wiggleroom.search.prepare import Prepared, survey
from wiggleroom.search.prepare_walls import prepare_walls, refined_at_contacts
from wiggleroom.search.recession import recession_direction
from wiggleroom.sensitivity.counted_bound import counted_bound
from wiggleroom.sensitivity.dual_face import face, shared_with
from wiggleroom.sensitivity.flat_motions import other_optima
from wiggleroom.sensitivity.found_motion import verdict_of_carried
from wiggleroom.sensitivity.gap_study import (
    DIFFERENCE_STEP,
    DifferenceQuotients,
    GapDerivatives,
    GapStudy,
    PlaceDerivatives,
)
from wiggleroom.sensitivity.joint_gains import JointGains
from wiggleroom.sensitivity.perturbation import (
    SAME_VALUE,
    PerturbationBase,
    PerturbedObjective,
    base,
    can_be_ranked,
    ended,
    is_searched,
    objective_in_same_walls,
    perturbed_objective,
    searched_answer,
    varied,
)
from wiggleroom.solve.interior_point import solve
from wiggleroom.solve.nonnegative_least_squares import nonnegative_least_squares
from wiggleroom.solve.solution import Solution
from wiggleroom.verdict import PathState, Verdict

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ROUNDING = 1e-9
"""Share of an objective to which solving the same program again may differ."""


OTHER_CLIMBS, MAX_OTHERS, OTHER_SHARE = 24, 4, 0.5
"""Draws begin also at optima of up to so many further climbs: the highest few that are worth this share of the answer at least."""


MAX_WIDENED, STILL = 6, 1e-9
"""Paths of at most so many bodies are moved away from others; what moves less than this [mm, rad] stands."""
WIDENING_STEPS = 1.0, 0.1, 0.01
"""They are moved by these multiples of the clearance, one after the other."""

LEAST_SHARE = 1e-3
"""A corner that can carry this share of what its pair holds is one of those that hold."""


@dataclass(frozen=True, eq=False)
class PlanarStudy:
    """An assembly of the plane and what is asked of it, with the answer where one was found before; prepared when something needs that."""

    question: Assembly | Prepared
    goals: tuple[Goal, ...]
    found: Answer | None = None
    climbs: list[Answer] = field(default_factory=list, init=False, repr=False)
    """The climb from rest, once it was needed."""
    optima: list[PerturbationBase] = field(default_factory=list, init=False, repr=False)
    """The end of the answer and other optima, once they were needed."""

    @property
    def assembly(self) -> Assembly:
        """The assembly as it is."""
        return self.question if isinstance(self.question, Assembly) else self.question.assembly

    @cached_property
    def ready(self) -> Prepared:
        """Pairs and free spaces."""
        return prepare_walls(self.question) if isinstance(self.question, Assembly) else self.question

    @property
    def clearance(self) -> float:
        """Typical clearance between neighbours [mm]."""
        return self.ready.clearance

    def at_gap(self, gap: float, stop: Stop | None = None) -> Self:
        """The same question with another gap [mm] of the whole assembly."""
        go_on(stop)
        return replace(self, question=assemble(self.assembly.drawing, gap=gap), found=None)

    def made_of(self, drawing: Drawing, stop: Stop | None = None) -> Self:
        """The same question of another drawing of the same parts."""
        go_on(stop)
        return replace(self, question=assemble(drawing), found=None)

    def with_inward(self, inward: Floats, stop: Stop | None = None) -> Self:
        """The same question with the outline of each part moved inward by `inward` (n,) [mm]."""
        go_on(stop)
        return replace(self, question=varied(self.assembly, inward), found=None)

    def answer(self, context: Context) -> Answer:
        """Largest motion as a direct question finds it, without a bound; the one that was found before, where there is one."""
        return self.found or searched_answer(self._asked, self.goals, context)

    def flexed(self, search: int | None, context: Context) -> Answer:
        """Answer of `wiggleroom.flex`, its quick bound included, from rest and `search` more starts."""
        return flex(self._asked, self.goals, search=search, stop=context.stop, progress=context.progress)

    def with_bound(self, answer: Answer, within: float, context: Context) -> Answer:
        """The answer with a bound; itself where sums of squares are asked, or the extra for proofs is not there."""
        return counted_bound(answer, within, context=context)

    def with_assembly(self, answer: Answer) -> Answer:
        """The motion of an answer at a smaller gap, as an answer for this one."""
        return replace(answer, assembly=self.assembly)

    def in_place_of(self, lower: Answer, smaller: Answer) -> Answer:
        """The motion of a smaller gap in place of a lower answer of this one; what was proven of larger parts is not of these."""
        verdict = verdict_of_carried(smaller, lower)
        return replace(self.with_assembly(smaller), verdict=verdict, bound=None, at_most=None, search=None)

    def with_room(self, answer: Answer, limit: float, context: Context) -> Answer:
        """The answer with its path, up to where it is worth more than `limit`, as far from other parts as it can be moved."""
        path = _cut(self.assembly, self.goals, answer, limit)
        if path is None or len(path) < 2:
            return answer
        moved = _widened(self.assembly, path, context)
        kept = replace(answer, waypoints=moved, motion=moved[-1])
        return answer if self.followed(kept, limit) is None else kept

    def followed(self, looser: Answer, limit: float) -> Answer | None:
        """The path of smaller parts, up to where it is worth more than `limit`, as an answer for these; None where parts meet."""
        path = _cut(self.assembly, self.goals, looser, limit)
        if path is None or not audit_path(self.assembly, path).free:
            return None
        its = bodies(self.assembly)
        goal, end = objective(self.assembly, its, self.goals), of_bodies(self.assembly, its, path[-1:])[0]
        value = float(goal.value(end))
        whole = looser.objective is None and len(path) == len(looser.waypoints)
        if whole and recession_direction(survey(self.assembly), goal, end) is not None:
            return replace(self.with_assembly(looser), motion=path[-1], waypoints=path, warm_start=None)
        if value <= limit:
            return None
        return witnessed(self.assembly, self.goals, Verdict.STOPPED, value, path, PathState.CHECKED)

    @property
    def _asked(self) -> Assembly | Prepared:
        return self.ready if "ready" in vars(self) else self.question

    def _climb(self, answer: Answer, context: Context) -> Answer:
        """A climb from rest: the answer itself where a direct question makes no more."""
        if not is_searched(self.assembly):
            return answer
        if not self.climbs:
            self.climbs.append(witness(self._asked, self.goals, context=context.silent))
        return self.climbs[0]

    def is_beyond_climb(self, answer: Answer, context: Context) -> bool:
        """True where a climb from rest ends at less than an answer."""
        value = self._climb(answer, context).objective
        climb = np.inf if value is None else value
        return answer.objective is None or climb < (1 - SAME_VALUE) * answer.objective

    def can_be_ranked(self, answer: Answer) -> bool:
        """True where the motion ends, with forces that say what each contact is worth."""
        return can_be_ranked(answer)

    def derivatives(self, answer: Answer) -> GapDerivatives:
        """Derivatives by the gap of every part and joint."""
        found = ended(answer)
        return _derivatives(answer.assembly, found.program, found.solution)

    def quotients(self, answer: Answer, context: Context) -> DifferenceQuotients:  # noqa: ARG002
        """How derivatives are found by solving the last program again."""
        found = ended(answer)
        start = base(self.ready, found)
        program, lam = on_contacts(start.program, start.solution.u, start.solution.lam)
        start = replace(start, program=program, solution=replace(start.solution, lam=lam))
        return DifferenceQuotients(slope, start, _derivatives(answer.assembly, program, start.solution))

    def moved(self, answer: Answer, inward: Floats, context: Context) -> Answer:
        """Largest motion when the outline of each part moves inward by `inward` (n,) [mm]; by a climb where that led to the answer."""
        made = varied(self.assembly, inward)
        if self.is_beyond_climb(answer, context):
            return searched_answer(made, answer.goals, context)
        return witness(made, answer.goals, context=context.silent)

    def draws(self, answer: Answer, context: Context) -> tuple[Work, Any]:
        """What many such motions need: moved walls of the prepared assembly."""
        ready = refined_at_contacts(self.ready, answer, self._climb(answer, context))  # draws climb from rest
        return one_draw, (ready, ready.objective(answer.goals), answer.goals, *self._known(answer, context))

    def _known(self, answer: Answer, context: Context) -> tuple[float, tuple[PerturbationBase, ...]]:
        """Objective of an answer, and, where a direct question searches, its end and other optima: for other gaps they may be larger."""
        if answer.objective is None:
            return np.inf, ()
        if not is_searched(self.assembly):
            return answer.objective, ()
        if not self.optima:
            self.optima.append(base(self.ready, ended(answer)))
            first = LocalSearch(self.ready, self.ready.objective(answer.goals), solve, THOROUGH, context.stop)
            first.improve(start_at_rest(self.ready))
            below = (1 - SAME_VALUE) * answer.objective
            others = [o for o in local_optima(first, OTHER_CLIMBS) if OTHER_SHARE * answer.objective < o.value < below]
            self.optima.extend(base(self.ready, o) for o in others[:MAX_OTHERS])
        return answer.objective, tuple(self.optima)

    def room(self, whole: float, aim: float) -> Floats:
        """How far the outline of each part (n,) may move out [mm]; a joint with a smaller gap of its own limits both its parts."""
        drawing = self.assembly.drawing
        own = np.array([p.offset for p in drawing.parts])
        room = (whole - aim) / 2 - own
        index = {name: k for k, name in enumerate(self.assembly.names)}
        for joint in drawing.gaps:
            for name in joint.parts:
                room[index[name]] = min(room[index[name]], (joint.gap - aim) / 2 - own[index[name]])
        return np.maximum(room, 0.0)


def _derivatives(assembly: Assembly, program: Program, solution: Solution) -> GapDerivatives:
    """Derivatives from the multipliers of a program, those of corners that touch where these can carry what its walls do."""
    program, lam = on_contacts(program, solution.u, solution.lam)
    active = touching(program, solution.u, lam)
    row = active.row
    some = gains(program, solution.u, row)
    by_joint = JointGains(assembly, program, some)
    total = float(active.force.sum())
    others = other_optima(program, solution.u, row, lam[row])
    return GapDerivatives(
        _at_place(program, by_joint, row, solution.u, lam[row]),
        by_joint.joints,
        float(active.force[active.virtual].sum()) / total if total > 0 else 0.0,
        tuple(_at_place(program, by_joint, row, other.u, other.force) for other in others),
    )


def _at_place(program: Program, by_joint: JointGains, row: Ints, u: Floats, force: Floats) -> PlaceDerivatives:
    """Derivatives by the gap of every part and joint at one optimum `u` (V,), held by the forces (k,) of some rows."""
    some = gains(program, u, row)
    between, by_joint_between = by_joint.between(some, u, row)
    by_body = some.by_part(program.bodies, len(row)) / 2
    jacobian = program.linearise(u).jacobian()[row]
    kept, more = shared_with(force, between)
    return PlaceDerivatives(
        sp.hstack([by_body, by_body @ between], format="csr"),
        sp.hstack([by_joint.at(some, u, row), by_joint_between], format="csr"),
        face(sp.vstack([jacobian, between.T @ jacobian], format="csr"), np.concatenate([kept, more]), program.length),
    )


def slope(start: PerturbationBase, task: tuple[int, float]) -> float:
    """Objective gained per mm of extra gap round one part, from solving again with a little more (+1) or less (-1) of it."""
    part, sign = task
    for step in (DIFFERENCE_STEP, DIFFERENCE_STEP / 10):
        extra = sign * step * start.program.length
        inward = np.zeros(len(start.program.bodies.body_of))
        inward[part] = extra / 2
        gain = objective_in_same_walls(start, inward) - start.value
        if sign * gain >= -ROUNDING * abs(start.value):  # less motion for more gap: another optimum
            return gain / extra
    return np.nan


def one_draw(
    shared: tuple[Prepared, Objective, tuple[Goal, ...], float, tuple[PerturbationBase, ...]], inward: Floats
) -> PerturbedObjective:
    """One draw, with the moved walls of the prepared assembly."""
    ready, objective, goals, usual, ends = shared
    return perturbed_objective(ready, objective, goals, inward, usual, ends)


def _cut(assembly: Assembly, goals: tuple[Goal, ...], answer: Answer, limit: float) -> Floats | None:
    """The path (k, n, 3) of an answer up to where it is worth more than `limit`; the whole of one without end; None where it is not."""
    its = bodies(assembly)
    goal = objective(assembly, its, goals)
    worth = np.array([goal.value(motion) for motion in of_bodies(assembly, its, answer.waypoints)])
    beyond = np.flatnonzero(worth > limit)
    if len(beyond):
        return answer.waypoints[: beyond[0] + 1]
    return answer.waypoints if answer.objective is None else None


def _widened(assembly: Assembly, path: Floats, context: Context) -> Floats:
    """The path (k, n, 3) of the parts, its waypoints but the first moved to where the least clearance is largest."""
    ready = survey(assembly)
    its = ready.bodies
    moved = of_bodies(assembly, its, path)
    who = np.flatnonzero((np.abs(moved - moved[:1]) > STILL).any(axis=(0, 2)))
    if not 0 < len(who) <= MAX_WIDENED:
        return path
    moving = MovingBodies(who, as_one=False)
    for share in WIDENING_STEPS:
        if context.stopped:
            break
        clearance = share * ready.clearance
        problem = ClearanceProblem(its, np.ones(len(its.fixed), bool), ready.ignored, clearance, ready.size, moving)
        moved = largest_clearance_path(problem, moved)
    return of_parts(assembly, its, moved)


def study_of(
    question: Assembly | Prepared | Answer | GapStudy[Any], goals: Goal | Sequence[Goal] | None
) -> GapStudy[Any]:
    """What a study asks: the question itself where it is one; an answer is studied as it is.

    Raises
    ------
    InputError
        If nothing is fixed or pulled, or a goal names an unknown part.
    """
    if isinstance(question, Answer):
        return PlanarStudy(question.assembly, question.goals, question)
    if not isinstance(question, Assembly | Prepared):
        return question
    assembly = question if isinstance(question, Assembly) else question.assembly
    return PlanarStudy(question, asked_goals(assembly.drawing, goals))


def on_contacts(program: Program, u: Floats, lam: Floats) -> tuple[Program, Floats]:
    """A program with the same solution u (3F,), and multipliers `lam` (R,) of its rows.

    Pairs with force on walls that nothing touches, or on the end of a cell's angle, are held by the corners that touch inside edges, where
    these can carry the same force and torque; all that can take part in that do. Neither kind moves with the gaps as the parts do.
    """
    active = touching(program, u, lam)
    cells, at = program.cells, program.linearise(u)
    pairs = np.unique(active.pair[active.virtual])
    corners = touching_corners(
        program.bodies, cells.a[pairs], cells.b[pairs], at.g[pairs], TOUCHING_DISTANCE * program.length, 0.0
    )
    inside = (corners.place > EDGE_END_TOLERANCE) & (corners.place < 1 - EDGE_END_TOLERANCE)
    held: list[int] = []
    found: list[Cells] = []
    forces: dict[int, Floats] = {}
    for k, pair in enumerate(pairs.tolist()):
        mine = active.row[active.pair == pair]
        wrench = lam[mine] @ at.d[mine]
        lever = np.array([1.0, 1.0, 1.0 / program.bodies.radius[cells.b[pair]]])
        some = corners.row[k] + np.flatnonzero(inside[slice(*corners.row[k : k + 2])])
        force = _shared_by_all(corners.d[some] / program.length * lever, wrench * lever)
        if force is None:
            continue
        some, force = some[force > 0], force[force > 0]
        idle = np.setdiff1d(np.arange(*cells.row[pair : pair + 2]), mine)
        idle = idle[cells.is_wall[idle]]
        held.append(pair)
        found.append(_held_by(program, pair, corners, some, idle))
        forces[pair] = np.concatenate([force, np.zeros(len(idle) + 2)])
    if not held:
        return program, lam
    split = np.split(lam, cells.row[1:-1])
    both = np.concatenate([forces.get(p, own) for p, own in enumerate(split)])
    made = replaced(cells, np.array(held), reduce(concatenated, found))
    return build_program(program.bodies, made, program.objective, length=program.length, like=program), both


def _shared_by_all(d: Floats, wrench: Floats) -> Floats | None:
    """Forces (k,) of corners with derivatives `d` (k, 3) that add up to a wrench (3,), positive where they can be; None if none do."""
    if not len(d):
        return None
    size = np.linalg.norm(wrench)
    least = LEAST_SHARE * size / np.linalg.norm(d, axis=1)
    found = []
    for part in (*np.diag(least), np.zeros(len(d))):
        force, left = nonnegative_least_squares(d, wrench - part @ d)
        if left <= BALANCE_TOLERANCE * size:
            found.append(part + force)
    return np.mean(found, axis=0) if found else None


def _held_by(program: Program, pair: int, corners: TouchingCorners, some: Ints, idle: Ints) -> Cells:
    """The cell of a pair with walls of some corners that touch, and its own ones that hold nothing; it may turn a little further."""
    cells = program.cells
    a, b = cells.a[pair : pair + 1], cells.b[pair : pair + 1]
    further = program.length / np.minimum(program.bodies.radius[a], program.bodies.radius[b])
    kind = np.concatenate([corners.kind[some], cells.kind[idle], [LOW_TURN, HIGH_TURN]]).astype(np.int8)
    edge, corner = (
        np.concatenate([new[some], old[idle], [0, 0]]).astype(np.int32)
        for new, old in ((corners.edge, cells.edge), (corners.corner, cells.corner))
    )
    ends = cells.ends[pair] + further * np.array([-1.0, 1.0])
    return Cells(a, b, np.array([0, len(kind)]), kind, edge, corner, ends[None], cells.seed[pair : pair + 1])
