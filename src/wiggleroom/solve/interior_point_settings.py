"""Parameters of the interior-point method, with their ranges and reasons."""

from __future__ import annotations

from dataclasses import dataclass, replace

INITIAL_BARRIER = 0.1
"""Complementarity to begin with, as a share of the objective's largest derivative."""
WARM_START_GAP = 3e-2
"""The next program starts at the last feasible iterate whose complementarity was still this share of the objective."""
COARSE_TOLERANCE, COARSE_PROGRAM, COARSE_WARM_START_GAP = 1e-3, 3000, 0.1
"""The same share for programs that are solved to a tolerance above the first and have more variables than the second: their walls are far
from the last ones, and multipliers from later on hold the next program back."""
SLACK_TOLERANCE = 1e-12
"""Slacks that are right to this share of `program.length` are exact."""
MAX_LIFTS = 8
"""Most steps that lift rows that are violated at the end."""
MAX_PULLS = 60
"""Most points tried between a feasible point and an end that violates rows."""


@dataclass(frozen=True)
class Settings:
    """Parameters of the method.

    Parameters
    ----------
    fraction_to_boundary : float in (0, 1)
        Share of the step to the nearest bound that is taken; nearer to 1 is quicker and less safe.
    max_correction : float > 1
        Mehrotra's second-order term is kept within this multiple of mu; larger ones come from steps too long to trust.
    min_step_length : float in (0, 1)
        A shorter step is tried again with a stronger diagonal.
    min_slack : float > 0 [program.length]
        Slacks never become smaller: their reciprocals stay finite.
    initial_slack : float > 0 [program.length]
        Slacks begin no smaller: a wall right beside the start would block every step away from the others.
    max_step_share : float in (0, 1)
        Share of the horizon that a body may move in one iteration.
    proximal_share : float in (0, 1)
        Share of the tolerance that may be given up to stay near rest, so that bodies that nothing holds do not drift.
    dual_error_ratio, dual_error_floor, dual_error_allowance : float in (0, 1)
        Bound on dual residual times displacement since the start, relative to the duality gap; it counts where it exceeds the floor, a
        share of the objective, as far as it exceeds the allowance. Without allowance it sets in with a jump, which is quick; in large
        programs such jumps follow each other.
    dual_tolerance : float in (0, 1)
        Largest dual residual at the end, as a share of the objective's largest derivative.
    min_iterations, max_iterations, max_monotone_iterations : int
        Of the predictor-corrector method, and of the monotone barrier method that takes over where it fails.
    max_stalled_iterations : int
        After this many iterations that do not reduce the error the predictor-corrector method has failed.
    max_saddle_escapes : int
        Most escapes from saddle points, where the first-order conditions hold but the objective curves upwards.
    min_kept_shift : float > 0
        A shift of the diagonal up to this is not kept: the next step begins with the least one. A larger one is divided by `shift_decay`.
    shift_decay, shift_growth : float > 1
        By how much a shift becomes smaller for the next step, and larger where it is not enough.
    definite_shift, longer_step_shift : float > 0
        First shift after the least one where the matrix is not positive definite, and where the step is too short.
    max_factorisations, max_lengthenings : int
        Of one step in all, and for the sake of a longer step.
    max_infeasibility_ratio : float in (0, 1)
        Feasibility falls behind where it exceeds this share of complementarity.
    decrement_weight : float > 0
        So many Newton decrements are what the dual residual may still bring, if that is less than its work along the whole motion.
    stride_growth, max_stride : float > 1
        Full steps in a row that a shift keeps short are tried so much longer each time, up to the second multiple.
    max_halvings : int
        Of a step that violates rows too much.
    max_violation, max_violation_growth : float > 0
        A step may violate rows by the first share of the complementarity, or by the second multiple of what was violated before.
    max_free_shift : float > 0
        A diagonal strengthened by more than this keeps steps short; then longer ones are tried.
    hopeless_shift : float > 0
        Where steps are too short even with a diagonal strengthened by this, a violated row whose slack has become nothing blocks them.
    max_centring : float > 0
        Where feasibility falls behind, complementarity becomes at most this multiple of what it was.
    min_restoring_step, lifted_slack : float in (0, 1), float > 0 [program.length]
        At the end of large programs, where steps that restore feasibility are shorter than the first, violated rows alone are
        lifted; slacks below the second weigh no more there.
    min_growth, moving_centring : float in (0, 1)
        After a step that raised the objective by more than the first share, complementarity is centred at no less than the second share
        of what it was: in very large programs the barrier else vanishes long before the bodies arrive, and they jam.
    corrected_gap : float in (0, 1)
        Centrality correctors lengthen the steps of large programs from this share of the objective on: before, they lead into worse basins.
    """

    fraction_to_boundary: float = 0.99
    max_correction: float = 10.0
    min_step_length: float = 0.05
    min_slack: float = 1e-14
    initial_slack: float = 1e-3
    max_step_share: float = 0.1
    proximal_share: float = 0.01
    dual_error_ratio: float = 0.3
    dual_error_floor: float = 0.05
    dual_error_allowance: float = 0.0
    dual_tolerance: float = 1e-3
    min_iterations: int = 3
    max_iterations: int = 100
    max_monotone_iterations: int = 200
    max_stalled_iterations: int = 30
    max_saddle_escapes: int = 2
    min_kept_shift: float = 1e-8
    shift_decay: float = 5.0
    shift_growth: float = 10.0
    definite_shift: float = 1e-5
    longer_step_shift: float = 1e-6
    max_factorisations: int = 16
    max_lengthenings: int = 5
    max_infeasibility_ratio: float = 0.3
    decrement_weight: float = 3.0
    stride_growth: float = 4.0
    max_stride: float = 4096.0
    max_halvings: int = 5
    max_violation: float = 0.5
    max_violation_growth: float = 2.0
    max_free_shift: float = 1e-3
    hopeless_shift: float = 1e6
    max_centring: float = 10.0
    min_restoring_step: float = 0.7
    lifted_slack: float = 1e-9
    min_growth: float = 0.02
    moving_centring: float = 0.0
    corrected_gap: float = 0.0


SETTINGS = Settings()
LARGE_PROGRAM = 300
"""Programs of more variables are large: they take more iterations, so these are made to count, and roundings add up."""
LARGE_SETTINGS = replace(SETTINGS, max_centring=1.0, dual_error_allowance=SETTINGS.dual_error_floor, corrected_gap=0.3)


VERY_LARGE_PROGRAM = 100_000
"""Programs of more variables need more iterations to move their bodies than the barrier parameter takes to fall."""
VERY_LARGE_SETTINGS = replace(LARGE_SETTINGS, max_iterations=200, moving_centring=0.7)
FULL_SHIFT_PROGRAM = 200_000
"""Up to so many variables the first shift for a longer step is `longer_step_shift`."""


def warm_start_gap(variables: int, tolerance: float) -> float:
    """The share of the objective that complementarity still is where the next program starts."""
    coarse = variables > COARSE_PROGRAM and tolerance > COARSE_TOLERANCE
    return COARSE_WARM_START_GAP if coarse else WARM_START_GAP


def settings_for(variables: int) -> Settings:
    """Parameters for a program of `variables` variables.

    The least curvature falls with the square of their count, and with it the shift that keeps a step short enough.
    """
    if variables > VERY_LARGE_PROGRAM:
        share = min(1.0, (FULL_SHIFT_PROGRAM / variables) ** 2)
        return replace(
            VERY_LARGE_SETTINGS,
            longer_step_shift=share * SETTINGS.longer_step_shift,
            min_kept_shift=share * SETTINGS.min_kept_shift,
        )
    return LARGE_SETTINGS if variables > LARGE_PROGRAM else SETTINGS
