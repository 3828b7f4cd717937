"""Importance of gaps: what a little more gap round each part, or in each joint, adds to the motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.util import find_spec
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.displayable import Drawable
from wiggleroom.errors import InputError
from wiggleroom.parallel.parallel_run import run_each
from wiggleroom.sensitivity.dual_face import DualFace, is_unique
from wiggleroom.sensitivity.gap_study import DifferenceQuotients, GapDerivatives, GapStudy, check_end
from wiggleroom.sensitivity.planar_study import PlanarStudy
from wiggleroom.solve.dual_linear_program import need_highs, quiet_solver, standard_form

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_LP_ROWS = 3000
"""With more active rows than this, ranges are estimated from random directions, not found by linear programs."""

MAX_LP_ROWS_ELSEWHERE = 300
"""The same for motions elsewhere that are as large, of which there are many."""

ROUNDING = 1e-9
"""Share of the largest derivative below which one is none."""

JUMP = 0.2
"""With the largest derivative by the multipliers, solves that lose more than this share of it for more gap, or change by more than it over
this share, ended in another optimum."""

MAX_SOLVED_AGAIN = 40
"""Where the motion may slide without loss, up to so many parts whose derivative is not unique are solved again without being asked for."""

Minimum = Callable[[Floats], float]

DEPENDENT = 1e-12
"""Equations whose squared distance from the span of others is below this share of the largest square depend on them."""


@dataclass(frozen=True, eq=False)
class Ranking(Drawable):
    """Effect of gaps on the motion of an answer.

    Extra gap e round a part means that its outline alone moves inward by e/2; extra gap e in a joint, that both
    outlines do so where they face each other.

    Parameters
    ----------
    answer : Answer
    by : str
        "duals" or "differences".
    looser, tighter : (n,) float64
        Gain of the objective per mm of extra gap round a part, and loss per mm of gap less; they differ if the holding forces are not
        unique.
    unique : (n,) bool
        True if both sides agree.
    by_duals : (n,) float64
        The same from the middle of all possible multipliers; equal to `looser` if unique.
    joints : (m, 2) int64
        Pairs of parts that hold each other.
    joint_looser, joint_tighter, joint_unique : (m,)
        The same for the gap of each joint.
    ends : str
        "whole" if ranges are exact, "sampled" if they are at least so wide.
    virtual : float
        Share of the force held by walls without contact, which limits the certainty of the ranking.
    """

    answer: Any
    by: str
    looser: Floats
    tighter: Floats
    unique: NDArray[np.bool_]
    by_duals: Floats
    joints: Ints
    joint_looser: Floats
    joint_tighter: Floats
    joint_unique: NDArray[np.bool_]
    ends: str
    virtual: float

    @property
    def importance(self) -> Floats:
        """What the gap round each part (n,) is worth: the middle of `looser` and `tighter` where these differ.

        Of two equal stops side by side neither lets the motion grow when it alone gets looser, and each takes it away when it alone gets
        tighter.
        """
        return _middle(self.looser, self.tighter, self.unique)

    @property
    def joint_importance(self) -> Floats:
        """What a gap of its own is worth for each joint (m,): the middle of `joint_looser` and `joint_tighter` where these differ."""
        return _middle(self.joint_looser, self.joint_tighter, self.joint_unique)

    @property
    def percent(self) -> Floats:
        """Share of each part (n,) [%] in the sum of importance over all parts."""
        return _percent(self.importance)

    @property
    def joint_percent(self) -> Floats:
        """Share of each joint (m,) [%] in the sum of importance over all joints."""
        return _percent(self.joint_importance)

    @property
    def order(self) -> Ints:
        """Parts (n,), the most important first."""
        return np.argsort(-np.nan_to_num(self.importance), kind="stable")

    @property
    def joint_order(self) -> Ints:
        """Joints (m,), the most important first."""
        return np.argsort(-np.nan_to_num(self.joint_importance), kind="stable")


def _middle(looser: Floats, tighter: Floats, unique: NDArray[np.bool_]) -> Floats:
    """Middle of two one-sided derivatives; the one that is known where the other is not."""
    both = np.isfinite(looser) & np.isfinite(tighter) & ~unique
    return np.where(both, (looser + tighter) / 2, np.where(np.isfinite(looser), looser, tighter))


def _percent(value: Floats) -> Floats:
    total = float(np.nansum(value))
    return 100 * value / total if total > 0 else np.zeros_like(value)


def rank(study: GapStudy[Any], *, by: str = "duals", exact: bool = False, context: Context = UNLIMITED) -> Ranking:
    """Importance of every part's gap, and of every joint's, for the largest motion; see `wiggleroom.rank`.

    Raises
    ------
    InputError
        If nothing stops the motion or the search for it was cut short.

    Source: Mind the Gap, section 6.2, for the differences; the derivatives are those of a program by its constraints.
    """
    if by not in ("duals", "differences"):
        finding = f"by {by!r}: a ranking is by duals or by differences"
        raise InputError(finding)
    answer = study.answer(context)
    check_end(study, answer)
    if by == "duals" and not exact:
        derivatives = study.derivatives(answer)
        ranking = ranking_of(answer, derivatives, context=context)
        slides = bool(derivatives.elsewhere) and 0 < (~ranking.unique).sum() <= MAX_SOLVED_AGAIN
        if not slides:
            return ranking
    found = study.quotients(answer, context)
    ranking = ranking_of(answer, found.derivatives, context=context)
    parts = np.arange(len(ranking.looser)) if by == "differences" else np.flatnonzero(~ranking.unique)
    return _by_differences(ranking, found, parts, by, context)


def rank_at_once(answer: Any, study: GapStudy[Any] | None = None) -> Ranking:
    """Ranking of an answer without any further solve: where derivatives are not unique, ranges are at least so wide.

    Raises
    ------
    InputError
        If nothing stops the motion or the search for it was cut short.
    """
    its = study or PlanarStudy(answer.assembly, answer.goals)
    check_end(its, answer)
    return ranking_of(answer, its.derivatives(answer), most_rows=0)


def ranking_of(
    answer: Any, found: GapDerivatives, most_rows: int = MAX_LP_ROWS, context: Context = UNLIMITED
) -> Ranking:
    """Ranking from the forces that hold an answer."""
    places, rows = (found.here, *found.elsewhere), len(found.here.face.force)
    whole = rows <= most_rows
    sides = []
    for worth in ([place.part for place in places], [place.joint for place in places]):
        middle = worth[0] @ found.here.face.force
        ends = [_ends(found.here.face, worth[0], whole, context)]
        exact = whole and rows <= MAX_LP_ROWS_ELSEWHERE
        ends += [_ends(p.face, by, exact, context) for p, by in zip(found.elsewhere, worth[1:], strict=True)]
        least, most, known = (np.array(side).T for side in zip(*ends, strict=True))
        whole = whole and bool(known[:, 0].all())
        unique = is_unique(least.min(axis=1), most.max(axis=1))
        known[:, 0] = True
        # with more gap the motion takes the place where the least force makes it worth most, with less that where the largest loses least
        looser = np.where(unique, middle, np.where(known, least, -np.inf).max(axis=1))
        tighter = np.where(unique, middle, np.where(known, most, np.inf).min(axis=1))
        sides.append((*_without_rounding(looser, tighter), unique, middle))
    (looser, tighter, unique, middle), (joint_looser, joint_tighter, joint_unique, _) = sides
    most = np.maximum(joint_looser, joint_tighter)
    held = most > ROUNDING * most.max(initial=0.0)
    certain = whole and not found.elsewhere
    return Ranking(
        answer, "duals", looser, tighter, unique, middle, found.joints[held], joint_looser[held], joint_tighter[held],
        joint_unique[held], "whole" if certain else "sampled", found.virtual,
    )  # fmt: skip


def _ends(
    face: DualFace, worth: sp.csr_matrix, exact: bool, context: Context
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Least and largest value (n,) of linear functions of forces, by linear programs if `exact`, and whether both are known."""
    middle, (low, high) = worth @ face.force, face.spread(worth)
    known = is_unique(low, high)
    low, high = np.where(known, middle, low), np.where(known, middle, high)
    some = np.flatnonzero(~known)
    if exact and len(some):
        least, most = ranges(face, worth[some], context).T
        found = np.isfinite(least), np.isfinite(most)
        low[some] = np.where(found[0], np.minimum(least, middle[some]), low[some])
        high[some] = np.where(found[1], np.maximum(most, middle[some]), high[some])
        known[some] = found[0] & found[1]
    return low, high, known


def _without_rounding(looser: Floats, tighter: Floats) -> tuple[Floats, Floats]:
    """Derivatives (n,) with more and with less gap, zero where they are rounding beside the largest."""
    least = ROUNDING * np.abs([looser, tighter]).max(initial=0.0)
    return np.where(np.abs(looser) > least, looser, 0.0), np.where(np.abs(tighter) > least, tighter, 0.0)


def _by_differences(ranking: Ranking, found: DifferenceQuotients, parts: Ints, by: str, context: Context) -> Ranking:
    """The same ranking, the derivatives of some parts taken from solving again."""
    tasks = [(int(k), sign) for k in parts for sign in (1.0, -1.0)]
    slopes = run_each(found.work, found.shared, tasks, context)
    if any(s is None for s in slopes):
        finding = f"stopped after {sum(s is not None for s in slopes)} of {len(tasks)} solves: there is no ranking yet"
        raise InputError(finding)
    pair = np.array(slopes, dtype=float).reshape(-1, 2)
    most = float(ranking.tighter.max(initial=0.0))
    another_optimum = (pair < -JUMP * most) | (pair > most / JUMP)
    solved = (np.isfinite(pair) & ~another_optimum).all(axis=1)  # the others keep what the multipliers say
    parts, pair = parts[solved], pair[solved]
    known = solved.all() and not found.derivatives.elsewhere
    ends = "whole" if known else ranking.ends
    looser, tighter = ranking.looser.copy(), ranking.tighter.copy()
    looser[parts], tighter[parts] = pair.T
    looser, tighter = _without_rounding(looser, tighter)
    unique = ranking.unique.copy()
    low, high = pair.min(axis=1), pair.max(axis=1)
    # a difference over a finite step feels the curvature a little
    unique[parts] = high - low <= 0.01 * np.maximum(high, 1e-3 * looser.max(initial=0.0))
    return replace(ranking, by=by, looser=looser, tighter=tighter, unique=unique, ends=ends)


def ranges(face: DualFace, worth: sp.csr_matrix, context: Context = UNLIMITED) -> Floats:
    """Least and largest value (m, 2) of linear functions `worth` (m, k) of the multipliers; nan where it is not known.

    An end is not known if nothing bounds the function there, or if `stop` was set before it was found. Many equations of the balance
    depend on others: those of parts that can move freely, and those that hold only because the motion is an optimum. Rounding makes
    them contradict each other a little, which would cut off much of the face, so only independent ones are asked for.
    """
    share = face.force / face.force.max(initial=1e-300)
    balance = (face.balance @ sp.diags_array(share)).tocsr()  # of multipliers in units of those that the solver found
    balance = balance[independent_rows(balance)]
    minimum = _from_the_last_basis(balance, context) if find_spec("highspy") else _from_no_basis(balance)
    out = np.full((worth.shape[0], 2), np.nan)
    for k, row in enumerate(worth):
        cost = row.toarray().ravel() * face.force
        for side, sign in enumerate((1.0, -1.0)):
            if context.stopped:
                return out
            out[k, side] = sign * minimum(sign * cost)
    return out


def independent_rows(matrix: sp.csr_matrix) -> Ints:
    """As many rows of a matrix (m, k) as do not depend on each other, in order.

    Examples
    --------
    >>> independent_rows(sp.csr_matrix([[1.0, 1.0], [3.0, 3.0], [0.0, 1.0], [0.0, 0.0]]))
    array([1, 2])

    Source: Higham, Accuracy and Stability of Numerical Algorithms, section 10.3 (Cholesky factorisation with complete pivoting).
    """
    from scipy.linalg.lapack import dpstrf

    gram = (matrix @ matrix.T).toarray()
    if not gram.any():
        return np.zeros(0, np.int64)
    _, pivot, rank, _ = dpstrf(gram, tol=DEPENDENT * gram.diagonal().max(), lower=1)
    return np.sort(pivot[:rank] - 1).astype(np.int64)


def _from_the_last_basis(balance: sp.csr_matrix, context: Context) -> Minimum:
    """Minimum of a cost (k,) over x >= 0 with the same balance as x = 1: each begins at the vertex where the last one ended."""
    highspy = need_highs()
    rows, count = balance.shape
    solver = quiet_solver(highspy, lambda: context.stopped, rows)
    solver.setOptionValue("simplex_strategy", highspy.simplex_constants.kSimplexStrategyPrimal.value)
    solver.passModel(standard_form(highspy, np.zeros(count), balance.tocsc(), balance @ np.ones(count)))
    every = np.arange(count, dtype=np.int32)

    def minimum(cost: Floats) -> float:
        solver.changeColsCost(count, every, cost)
        solver.run()
        known = solver.getModelStatus() == highspy.HighsModelStatus.kOptimal
        return float(solver.getInfo().objective_function_value) if known else np.nan

    return minimum


def _from_no_basis(balance: sp.csr_matrix) -> Minimum:
    """The same by what scipy carries of HiGHS, about ten times as slow."""
    from scipy.optimize import linprog

    total = balance @ np.ones(balance.shape[1])

    def minimum(cost: Floats) -> float:
        found = linprog(cost, A_eq=balance, b_eq=total, bounds=(0, None), method="highs")
        return float(found.fun) if found.status == 0 else np.nan

    return minimum
