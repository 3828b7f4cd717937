"""A proven bound beside an answer: no motion that can be reached from rest is worth more."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.bound.branch_and_bound import MANY_BODIES, BranchAndBound
from wiggleroom.bound.certificate import ProvenBound, certificate
from wiggleroom.bound.confined_pairs import confined_pairs
from wiggleroom.bound.joint_constraints import JointConstraints, first_ranges, narrowed
from wiggleroom.bound.outer_regions import outer_regions
from wiggleroom.bound.proof_steps import ProofNode
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.deadline import Deadline, WorkBudget
from wiggleroom.errors import InputError, WiggleroomError
from wiggleroom.freespace.outer.caging_surface import CagingSurface
from wiggleroom.freespace.outer.outer_region import OuterRegion
from wiggleroom.program.objectives import PointMotion, objective
from wiggleroom.search.answer import Answer, Bound, with_bound
from wiggleroom.search.prepare import Survey, survey
from wiggleroom.search.progress import Progress
from wiggleroom.verdict import PathState

Ints = NDArray[np.int64]

CUTOFF_SHARE, MANY_CUTOFF_SHARE = 0.6, 0.95
"""Motions worth more than the witness by this share of what is asked for are looked for. The second share is that of assemblies with more
bodies than `MANY_BODIES`: fewer motions are left, and the bound comes as near as asked in half the time, though seldom nearer."""
WORK = 60_000.0
"""Work of a proof for which neither time nor work is said: about a minute."""
CONFINED_SHARE = 0.5
"""Pairs that others keep together may take this share of the work that is left."""
LOOSE_SHARE = 1.0
"""Where the first linear program allows this share more than the witness, pairs whose joints are open are looked at too."""


def prove(
    answer: Answer,
    within: float = 0.01,
    *,
    seconds: float | None = None,
    work: float | None = None,
    certify: bool = False,
    context: Context = UNLIMITED,
) -> Answer:
    """A value that no motion in the plane can exceed; see `wiggleroom.prove`.

    Source: outer regions after Varava et al., "Free Space of Rigid Objects" (2020); tightening of bounds as in global optimisation.
    """
    check_request(within, seconds, work)
    if answer.model != "walls":
        finding = f"a bound is proven for the model walls only; this answer is of {answer.model}"
        raise InputError(finding)
    clock = Deadline(seconds, context.stop)
    budget = proof_budget(work, clock)
    surveyed = survey(answer.assembly)
    goal = objective(answer.assembly, surveyed.bodies, answer.goals)
    if not isinstance(goal, PointMotion):
        raise InputError("a bound is proven for pulls, turns and w only, not for sums of squares")
    if answer.objective is None:
        return not_proven(answer, clock, "nothing stops the motion")
    witness = answer.objective
    aim = within * max(abs(witness), 1e-3 * surveyed.clearance)

    def tell(stage: str, most: float) -> None:
        shown = most if math.isfinite(most) else math.nan
        context.tell(Progress(f"proof, {clock.spent:.0f} s: {stage}", 0, 0, shown))

    tell("caging surfaces" if certify else "outer regions", math.nan)
    joints, regions = outer_regions(surveyed, budget, certify)
    ranges = first_ranges(surveyed.bodies.fixed, joints, regions)
    asked = goal.body[(goal.direction != 0).any(1) | (goal.turn != 0)]
    held = surveyed.bodies.fixed | np.isfinite(ranges.far)
    if not held[asked].all():
        return not_proven(
            answer, clock, _why_open(answer.assembly, surveyed, joints, asked[~held[asked]], budget, certify)
        )
    proof = ProofNode() if certify else None
    cut = witness + (MANY_CUTOFF_SHARE if held.sum() > MANY_BODIES else CUTOFF_SHARE) * aim

    def bounding_of(joints: JointConstraints, regions: Sequence[OuterRegion | CagingSurface]) -> BranchAndBound:
        return BranchAndBound(
            surveyed, joints, [*regions], goal, cut, budget, lambda most, doing: tell(doing, most), proof
        )

    bounding = bounding_of(joints, regions)
    outer = [region for region in regions if isinstance(region, OuterRegion)]
    few = not certify and held.sum() <= MANY_BODIES
    if few and bounding.relaxed(ranges) > witness + LOOSE_SHARE * abs(witness):
        tell("pairs that others keep together", math.nan)
        joints, outer, ranges = confined_pairs(surveyed, joints, outer, ranges, budget.part(CONFINED_SHARE))
        bounding = bounding_of(joints, outer)
    ranges = narrowed(bounding.first(), ranges.low, ranges.high)
    most = bounding.run(ranges, witness + aim)
    if not math.isfinite(most):
        return not_proven(answer, clock, "no bound was found in the time or work given")
    check_bound(most, answer)
    if answer.at_most is not None and answer.at_most < most and not certify:
        if answer.at_most <= witness + aim:
            return answer  # the quick bound is as near as was asked for
        return not_proven(answer, clock, "nothing nearer was found in the time or work given")
    paper = None
    if proof is not None:
        paper = certificate(
            surveyed,
            answer.assembly,
            bounding.joints,
            [r for r in regions if isinstance(r, CagingSurface)],
            goal,
            ranges,
            ProvenBound(bounding.cut, bounding.windows, proof),
        )
    if answer.at_most is not None:
        most = min(most, answer.at_most)  # what was known before may be nearer than what has a certificate
    share = (most - witness) / abs(witness) if witness else None
    return with_bound(answer, Bound(float(most), share, clock.spent, certificate=paper))


def _why_open(
    assembly: Assembly, surveyed: Survey, joints: JointConstraints, open_: Ints, budget: WorkBudget, certify: bool
) -> str:
    """Why nothing bounds what is pulled, in a sentence."""
    if budget.is_set():
        return "the time or work given did not suffice to look at all joints"
    part = assembly.names[surveyed.bodies.members[int(open_[0])][0]]
    near = (surveyed.near.a == open_[0]) | (surveyed.near.b == open_[0])
    closed = (joints.a == open_[0]) | (joints.b == open_[0])
    if not near.any():
        return f"{part} touches nothing that could hold it"
    missing = ", or no caging surface was found round one of them" if certify else ""
    if not closed.any():
        return f"no joint of {part} closes round it: every one lets it out by itself{missing}"
    return f"{part} is joined to others, but no chain of joints that close leads from it to what is fixed{missing}"


def proof_budget(work: float | None, clock: Deadline) -> WorkBudget:
    """What a proof may spend: some work, by default a minute's, or where only time is limited as much as it takes."""
    most = WORK if clock.seconds is None else math.inf
    return WorkBudget(most if work is None else work, clock)


def check_bound(most: float, answer: Answer) -> None:
    """Refuse a bound below the motion found, which would be a mistake of ours."""
    if answer.objective is not None and most < answer.objective and answer.path == PathState.CHECKED:
        wrong = f"the bound {most} lies below the motion found, {answer.objective}: a mistake in wiggleroom; please report it"
        raise WiggleroomError(wrong)


def not_proven(answer: Answer, clock: Deadline, why: str) -> Answer:
    """The answer and why nothing is proven, or nothing nearer than what it had."""
    had = answer.bound or Bound(None, None, 0.0)
    return replace(answer, bound=replace(had, seconds=clock.spent, why=why, certificate=None))


def check_request(
    within: float,
    seconds: float | None = None,
    work: float | None = None,
    names: tuple[str, str] = ("within", "seconds"),
) -> None:
    """Refuse numbers that make no sense; `names` is what the asker calls them."""
    wrong = [
        f"{name} {value:g}: it must be {right}"
        for name, value, right, fits in (
            (names[0], within, "more than 0 and less than 10; 0.01 is one per cent", 0 < within < 10),
            (names[1], seconds or 0.0, "a number of seconds, more than 0", seconds is None or 0 < seconds < math.inf),
            ("work", work or 0.0, "more than 0", work is None or work > 0),
        )
        if not fits
    ]
    if wrong:
        raise InputError(wrong)
