"""How a question ended; the values are the words in files, `sentence` is what people read."""

from __future__ import annotations

from enum import StrEnum


class Verdict(StrEnum):
    """Outcome of a solve or of a whole question."""

    OPTIMAL = "optimal"
    STATIONARY = "stationary"
    UNBOUNDED = "unbounded"
    STOPPED = "stopped"

    @property
    def sentence(self) -> str:
        """One sentence for people."""
        return _SENTENCES[self]


_SENTENCES = {
    Verdict.OPTIMAL: "every active wall is a real contact and the optimality conditions hold",
    Verdict.STATIONARY: "the optimality conditions hold, but a branch at a corner contact is left open",
    Verdict.UNBOUNDED: "nothing stops the motion",
    Verdict.STOPPED: "stopped before the end; this is the best safe motion so far",
}
