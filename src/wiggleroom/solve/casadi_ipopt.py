"""CasADi's interface to IPOPT: its options, and a callback that sees every iterate."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop, require_extra
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]

TOLERANCE_SHARE = 1e-2
"""IPOPT bounds each complementarity, ours their sum: its tolerance is this share of ours."""
MAX_ITERATIONS = 1000
"""Of one program."""


@dataclass(eq=False, kw_only=True)
class IterationMonitor(ABC):
    """Sees every iterate, and knows the reasons to end.

    Parameters
    ----------
    unit : float
        Largest derivative of the objective, by which it is divided.
    horizon : float [mm]
        A body that moves further than this is taken to escape.
    stop, progress : optional
        Asked and told (iteration, objective) at every iterate.

    Attributes
    ----------
    iteration : int
    status : SolverStatus or None
        Why it ends here; None where IPOPT ends by itself.
    error : BaseException or None
        Raised while an iterate was looked at.
    """

    unit: float
    horizon: float
    stop: Stop | None
    progress: Callable[[int, float], None] | None
    iteration: int = -1
    status: SolverStatus | None = None
    error: BaseException | None = None

    def see(self, u: Floats, value: float, h: Floats, lam: Floats) -> bool:
        """Look at variables u, scaled objective, rows h and their multipliers; True to go on."""
        self.iteration += 1
        if self.progress is not None:
            self.progress(self.iteration, value * self.unit)
        escapes = self.keep(u, value, h, lam)
        if self.stop is not None and self.stop.is_set():
            self.status = SolverStatus.STOPPED
        elif escapes:
            self.status = SolverStatus.ESCAPING
        return self.status is None

    @abstractmethod
    def keep(self, u: Floats, value: float, h: Floats, lam: Floats) -> bool:
        """Keep what is of use of an iterate; True where a body escapes there."""


def import_casadi() -> Any:
    """CasADi, imported when it is needed."""
    require_extra("ipopt", 'solver "ipopt" needs CasADi', "casadi")
    import casadi

    return casadi


def ipopt_options(listener: object | None, mu: float, tolerance: float) -> dict[str, object]:
    """Options of CasADi and IPOPT: quiet, sharp, rows never relaxed, and the start left where it is."""
    push = dict.fromkeys(("slack_bound_push", "slack_bound_frac", "mult_bound_push"), 1e-9)
    return {
        "iteration_callback": listener,
        "print_time": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.linear_solver": "mumps",
        "ipopt.nlp_scaling_method": "none",
        "ipopt.bound_relax_factor": 0.0,
        "ipopt.tol": TOLERANCE_SHARE * tolerance,
        "ipopt.acceptable_tol": 10 * TOLERANCE_SHARE * tolerance,
        "ipopt.max_iter": MAX_ITERATIONS,
        "ipopt.mu_init": mu,
        "ipopt.warm_start_init_point": "yes",
        **{f"ipopt.warm_start_{k}": v for k, v in push.items()},
    }


def iteration_listener(casadi: Any, watch: IterationMonitor, variables: int, rows: int) -> object:
    """CasADi's iteration callback, which hands every iterate to `watch`."""
    sizes = {"x": variables, "f": 1, "g": rows}
    sizes |= {"lam_x": sizes["x"], "lam_g": sizes["g"], "lam_p": 0}

    class Listener(casadi.Callback):
        """Input: what `nlpsol` puts out; output: other than 0 to end."""

        def __init__(self) -> None:
            casadi.Callback.__init__(self)
            self.construct("listener", {})

        def get_n_in(self) -> int:
            return casadi.nlpsol_n_out()

        def get_n_out(self) -> int:
            return 1

        def get_sparsity_in(self, i: int) -> object:
            return casadi.Sparsity.dense(sizes[casadi.nlpsol_out(i)], 1)

        def eval(self, arguments: list) -> list[int]:
            x, f, g, _, lam, _ = (np.array(a).ravel() for a in arguments)
            try:
                return [0 if watch.see(x, -float(f[0]), g, np.maximum(-lam, 0.0)) else 1]
            except BaseException as error:  # raised again once IPOPT has let go
                watch.error = error
                return [1]

    return Listener()
