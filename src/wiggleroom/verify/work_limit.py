"""How much work a certificate may ask for: a fixed amount for every number in it, so that time grows with the file and no faster."""

from __future__ import annotations

from wiggleroom.verify.ball_arithmetic import need

STEPS = 1000
"""Steps for every number of the file, each a few operations on doubles; what proofs that were found need is below a tenth of it."""
FLOAT = 10
"""Steps that one comparison counts for which doubles are enough."""
EXACT = 400
"""Steps that one comparison in ball arithmetic counts for."""


class WorkLimit:
    """Counts steps and refuses to go beyond those that the file's size allows."""

    def __init__(self, numbers: int) -> None:
        self.left = STEPS * (numbers + 10_000)

    def spend(self, steps: int) -> None:
        """Count steps before they are taken."""
        self.left -= steps
        need(self.left >= 0, "it asks for more work than a proof of its size needs")
