"""Parameters of the interior-point method over bodies and planes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class SeparatingPlaneSettings:
    """Parameters of the interior-point method over bodies and planes; they have no units where none is given.

    Parameters
    ----------
    fraction : float in (0, 1)
        Share of the way to the nearest row that a step goes.
    least_share_of_row : float in (0, 1)
        A row keeps this share of itself in one iteration.
    behind : float > 0
        Rows may fall behind their slacks by this share of the complementarity before that is kept up.
    largest_correction : float > 0
        Mehrotra's term of second order is kept within this multiple of mu.
    short : float in (0, 1)
        A shorter step of the predictor and corrector is tried again with a stronger diagonal.
    first_mu : float > 0
        Barrier parameter at the start.
    carried_mu : tuple of float > 0
        The same where a round begins at the end of the one before, times the rows, as a share of the objective; tried one after the other.
    carried_damping : float > 0 [objective's unit per clearance squared]
        First damping of rows there.
    first_slack : float > 0 [clearances]
        Least slack at the start, where slacks run ahead.
    least_slack : float > 0 [clearances]
        Least slack later.
    longest : float > 0
        No body moves further in one iteration than this share of the horizon.
    largest_turn : float > 0 [rad]
        No body turns further in one iteration.
    tiny_shift : float > 0
        Least strengthening of the diagonal.
    negligible_shift : float > 0
        A smaller strengthening or damping is forgotten in the next iteration.
    least_damping : float > 0 [objective's unit per clearance squared]
        Levenberg's damping of rows where the matrix is not positive definite or a step is a stub, at first.
    damping_growth : float > 1
        It grows by this factor where that is not enough, and shrinks by it in the next iteration.
    damping_of_freedoms : float > 0
        The diagonal is strengthened by this multiple of it.
    balanced : float > 0
        Imbalance above which nothing is called converged.
    rounding : float > 0
        mu stays above this, times the size in clearances: rows that are as small as their rounding make multipliers of noise.
    least_curvature : float > 0 [objective's unit per clearance squared]
        Curvature upwards that counts.
    most_weights : tuple of float > 0
        Largest weights of rows with which curvature is looked at, one after the other.
    anchored : float > 0
        Weight of the proximal term, in units of the barrier's, where iterates stay inside all rows.
    loose : float > 0
        The same where slacks run ahead.
    saddles : int >= 0
        Number of times the method goes on where the conditions of first order hold and the objective curves upwards, or where there are
        many rows and only multipliers keep the conditions from holding.
    many_rows : int > 0
        Programs of more rows have many.
    least_iterations : int >= 0
        Before these nothing is called converged.
    rough : float > 0
        Error of a rough answer.
    acceptable : float > 0
        Error of an iterate that is good enough where rounding spoils the conditions again.
    lost : float > 1
        Factor by which the error has grown then.
    diverged : float > 1
        An error above this is beyond hope.
    patience : int > 0
        After this many iterations that do not reduce the error the mode with slacks has failed.
    patience_damped : int > 0
        The same where rows are damped.
    unheld, unheld_damped, unheld_centred : float > 0
        Weight of what is not held, where slacks run ahead and it counts; the same where rows are damped, and where iterates are centred.
    early, early_damped, early_centred : float > 0
        Share of the objective from which on it counts.
    stuck : int > 0
        After this many iterations at one mu the path is narrow, and mu grows.
    raised : float > 1
        Factor by which it does, and the anchor follows.
    highest : float > 0
        Up to this value.
    reduction : float in (0, 1)
        mu becomes this share of itself when its problem is solved.
    solved : float > 0
        To this multiple of mu.
    progress : float in (0, 1)
        The predictor and corrector go on while the error is below this share of the largest of the last few.
    memory : int > 0
        Number of these last errors.
    balance_share : float > 0
        What an imbalance counts in the error, beside complementarity.
    downhill : float in (0, 1)
        Share of the foreseen descent that a step must bring.
    apart : float > 1
        At a fixed mu a multiplier may differ from mu / row by this factor.
    far_apart : float > 1
        The same after a predictor and corrector.
    free : float > 0
        A diagonal strengthened by more than this keeps steps short; then longer ones are tried.
    heaviest : float > 1
        Largest weight of a row in the fit of the planes, against the lightest.
    centrality_corrections : int >= 0
        Where rows are damped, at most so many corrections of a step bring products of slacks and multipliers nearer to each other.
    off_centre : float > 1
        They bring them to within this factor of the barrier parameter.
    longer : float in (0, 1)
        They aim at a step that is longer by this.
    worthwhile : float in (0, 1)
        And count where both lengths together grow by this.
    corrections : int >= 0
        Corrections of second order per step at most.
    corrected : float in (0, 1)
        Rows that are behind by less than this share are not corrected.
    """

    fraction: float = 0.99
    least_share_of_row: float = 0.005
    behind: float = 0.3
    largest_correction: float = 10.0
    short: float = 0.05
    first_mu: float = 0.1
    carried_mu: tuple[float, ...] = (0.03, 0.3)
    carried_damping: float = 1e-4
    first_slack: float = 1e-3
    least_slack: float = 1e-15
    longest: float = 0.1
    largest_turn: float = 0.5
    tiny_shift: float = 1e-11
    negligible_shift: float = 1e-8
    least_damping: float = 1e-5
    damping_growth: float = 5.0
    damping_of_freedoms: float = 3.0
    balanced: float = 1e-3
    rounding: float = 500 * float(np.finfo(float).eps)
    least_curvature: float = 1e-6
    most_weights: tuple[float, ...] = (1e4, 1e6, 1e8, float("inf"))
    anchored: float = 1.0
    loose: float = 1e-3
    saddles: int = 2
    many_rows: int = 5000
    least_iterations: int = 3
    rough: float = 1e-2
    acceptable: float = 1e-6
    lost: float = 1e3
    diverged: float = 1e9
    patience: int = 12
    patience_damped: int = 60
    unheld: float = 0.3
    unheld_damped: float = 0.3
    unheld_centred: float = 3.0
    early: float = 0.05
    early_damped: float = 5e-4
    early_centred: float = 5e-4
    stuck: int = 10
    raised: float = 100.0
    highest: float = 1e-3
    reduction: float = 0.2
    solved: float = 10.0
    progress: float = 0.99
    memory: int = 4
    balance_share: float = 0.03
    downhill: float = 1e-4
    apart: float = 10.0
    far_apart: float = 1e10
    free: float = 1e-3
    heaviest: float = 1e12
    centrality_corrections: int = 2
    off_centre: float = 10.0
    longer: float = 0.3
    worthwhile: float = 0.03
    corrections: int = 4
    corrected: float = 0.05


SETTINGS = SeparatingPlaneSettings()
