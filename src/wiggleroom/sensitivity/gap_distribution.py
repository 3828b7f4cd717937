"""Gaps drawn at random: their distribution, and how much the parts of one sheet share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from wiggleroom.errors import InputError

Floats = NDArray[np.float64]

DISTRIBUTIONS = ("normal", "uniform", "truncated")
CONFIDENCE = 0.95
"""Share of the cases in which a confidence interval holds."""
TRUNCATION = 2.0
"""A truncated normal distribution ends at this many standard deviations of the one that is cut."""


@dataclass(frozen=True)
class Spread:
    """Distribution of the extra gaps round parts.

    Parameters
    ----------
    width : float [mm]
        Standard deviation of the extra gap for "normal"; that of the distribution before it is cut for "truncated";
        half of the interval for "uniform".
    kind : str
        "normal", "uniform" or "truncated": normal, cut at two standard deviations.
    sheet : float
        Correlation of the parts of a sheet: 0 independent, 1 all alike, as with a drifting kerf.
    bias : float [mm]
        Mean of the extra gap.

    Raises
    ------
    InputError
        If a number makes no sense.
    """

    width: float
    kind: str = "normal"
    sheet: float = 0.0
    bias: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what cannot be drawn from."""
        wrong = []
        if not 0 < self.width < np.inf:
            wrong.append(f"spread {self.width:g}: it must be more than 0")
        if self.kind not in DISTRIBUTIONS:
            wrong.append(f'distribution "{self.kind}": it is one of {", ".join(DISTRIBUTIONS)}')
        if not 0 <= self.sheet <= 1:
            wrong.append(f"correlation {self.sheet:g}: it must be between 0 and 1")
        if not np.isfinite(self.bias):
            wrong.append(f"bias {self.bias:g}: it must be a finite number")
        if wrong:
            raise InputError(wrong)

    @property
    def deviation(self) -> float:
        """Standard deviation of the extra gap of one part [mm]."""
        if self.kind == "uniform":
            return self.width / np.sqrt(3)
        if self.kind == "normal":
            return self.width
        inside = 2 * ndtr(TRUNCATION) - 1
        return float(
            self.width * np.sqrt(1 - 2 * TRUNCATION * np.exp(-(TRUNCATION**2) / 2) / np.sqrt(2 * np.pi) / inside)
        )

    def draw(self, draws: int, parts: int, seed: int) -> Floats:
        """Extra gaps (draws, parts) [mm]; the first draws of a longer list are those of a shorter one.

        Examples
        --------
        >>> Spread(0.1, "uniform", sheet=1.0).draw(2, 3, seed=0).round(3).tolist()
        [[0.01, 0.01, 0.01], [-0.041, -0.041, -0.041]]
        """
        z = np.random.default_rng(seed).standard_normal((draws, parts + 1))
        # correlated normal numbers, then to the wanted distribution by their rank
        z = np.sqrt(self.sheet) * z[:, :1] + np.sqrt(1 - self.sheet) * z[:, 1:]
        if self.kind == "uniform":
            z = 2 * ndtr(z) - 1
        elif self.kind == "truncated":
            z = ndtri(ndtr(-TRUNCATION) + ndtr(z) * (1 - 2 * ndtr(-TRUNCATION)))
        return self.bias + self.width * z


def wilson(good: int, count: int) -> tuple[float, float]:
    """95 % confidence interval of a share, from `good` of `count` draws.

    Source: Wilson 1927; unlike the usual one it holds near 0 and 1 too.

    Examples
    --------
    >>> [round(x, 4) for x in wilson(50, 50)]
    [0.9287, 1.0]
    """
    z = float(ndtri(0.5 + CONFIDENCE / 2))
    share = good / count
    middle = (share + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * np.sqrt(share * (1 - share) / count + z * z / (4 * count**2))
    return max(0.0, float(middle - half)), min(1.0, float(middle + half))
